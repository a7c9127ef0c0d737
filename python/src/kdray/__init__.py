"""Exact-SAH kd-trees over triangles, and the ray queries that such a tree allows.

>>> import kdray
>>> tree = kdray.build([[0., 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
>>> hits = tree.closest_hit([[.25, .25, 1], [2, 2, 1]], [0, 0, -1])
>>> hits.triangle
array([ 0, -1], dtype=int32)

`kdray.trimesh`, `kdray.open3d` and `kdray.dask` have classes and functions in the places and
shapes that these libraries' users know.
"""

from __future__ import annotations

import os
import warnings

import numpy as np
from numpy.typing import NDArray

from . import _kdray, generate
from ._build import build
from ._device import Device, devices
from ._results import AllHits, ClosestPoints, Hits, Stats, Within
from ._tree import Tree

__version__: str = _kdray.__version__

__all__ = [
    "AllHits",
    "ClosestPoints",
    "Device",
    "Hits",
    "Stats",
    "Tree",
    "Within",
    "build",
    "devices",
    "generate",
    "load",
]


def load(path: str | os.PathLike[str]) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    r"""Vertices `(n, 3)` and faces `(m, 3)` of a PLY, OBJ, STL, OFF, glTF or GLB file.

    Polygons come as triangles. What the loader left out without harm is warned of.

    Raises
    ------
    OSError
        The file cannot be read.
    ValueError
        The file is in no known format, or breaks the rules of its format: names the file, the
        place and the reason.

    Examples
    --------
    >>> import kdray, pathlib, tempfile
    >>> path = pathlib.Path(tempfile.mkdtemp(), "triangle.obj")
    >>> _ = path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3")
    >>> kdray.load(path)[1]
    array([[0, 1, 2]], dtype=int32)
    """
    path = os.fspath(path)
    vertices, faces, notes = _kdray.load(path)
    for note in notes:
        warnings.warn(f"{path}: {note}", stacklevel=2)
    return vertices, faces
