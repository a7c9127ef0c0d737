"""The tree: where it is, what it is like, pictures and files of it."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _kdray
from ._arrays import face_rows, positive, thread_count, vectors, vertex_rows
from ._device import Device, device_word
from ._files import write_whole
from ._points import PointQueries
from ._rays import RayQueries
from ._results import Stats

Progress = Callable[[float], object]


class Tree(RayQueries, PointQueries):
    """A mesh, its kd-tree, and the queries they allow; made by `kdray.build` and `Tree.open`.

    A tree does not change, so threads can share it. Queries run on all cores (or on `threads`),
    without the interpreter's lock, and end with KeyboardInterrupt on Ctrl-C. On a tree that is on
    a GPU, rays are answered there, unless there is a `mask`; all else on the CPU.

    Queries take arrays of any leading shape, `(…, 3)`, and answer in that shape; float32 and
    float64 arrays are not copied. Coordinates are those of the mesh's vertices. A ray
    or point that is not finite hits, finds and is in nothing.

    >>> import kdray
    >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
    >>> tree
    kdray.Tree(1 triangle, 3 vertices, 1 node, bounds [0 0 0] to [4 4 0])
    """

    __slots__ = ()

    def render(
        self,
        width: int = 960,
        height: int = 640,
        *,
        shading: str = "path",
        samples: int | None = None,
        eye: ArrayLike | None = None,
        target: ArrayLike | None = None,
        up: ArrayLike = (0.0, 1.0, 0.0),
        fov: float = 35.0,
        ground: bool = True,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> NDArray[np.uint8]:
        """A picture of the mesh: sRGB, `(height, width, 3)`, from the top left.

        `shading` is `"path"` (sun and sky), `"ao"` (ambient occlusion), `"normals"`, or `"cost"`:
        what each pixel's rays cost in the tree. Without `eye` and `target` all of the mesh is in
        view. `fov` is the vertical field of view in degrees.

        Examples
        --------
        >>> import kdray
        >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> tree.render(64, 48, shading="normals").shape
        (48, 64, 3)
        """
        if positive("width", width) * positive("height", height) > 1 << 28:
            raise ValueError(f"width and height are {width} and {height}: too many pixels")
        if not 0.0 < fov < 180.0:
            raise ValueError(f"fov is {fov}; an angle between 0 and 180 degrees is expected")
        options = {
            "width": width,
            "height": height,
            "shading": shading,
            "samples": None if samples is None else positive("samples", samples),
            "eye": None if eye is None else point("eye", eye),
            "target": None if target is None else point("target", target),
            "up": point("up", up),
            "fov": fov,
            "ground": ground,
            "threads": thread_count(threads),
            "progress": progress,
        }
        return self._tree.render(options)

    # The tree itself.

    @property
    def device(self) -> str:
        """Where rays are answered: `"cpu"`, or the name of a GPU.

        >>> import kdray
        >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> tree.to("cpu").device
        'cpu'
        """
        gpu = self._tree.gpu
        return "cpu" if gpu is None else gpu[1]

    @property
    def stats(self) -> Stats:
        """What the tree is like. Costs one pass over its nodes.

        >>> import kdray
        >>> kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]]).stats.leaves
        1
        """
        return Stats(**self._tree.stats())

    def validate(self) -> None:
        """Proves the tree against the geometry of its mesh; costs about as much as the build.

        Raises
        ------
        ValueError
            The first violation, in words.

        Examples
        --------
        >>> import kdray
        >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> tree.validate()
        """
        self._tree.validate()

    def to(self, device: Device | str | int) -> Tree:
        """The same tree on a device, named as for `kdray.build`; itself, if it is there.

        Raises
        ------
        ValueError
            There is no such device.
        MemoryError
            The device cannot hold the tree.
        OSError
            The device failed.

        Examples
        --------
        >>> import kdray
        >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> tree.to("cpu").device
        'cpu'
        """
        moved = self._tree.to(device_word(device))
        return self if moved.gpu == self._tree.gpu else Tree(moved)

    # Keeping it.

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the mesh and its tree into one file, which `Tree.open` reads.

        The file appears in one piece: what was there before stays until all is written.

        Raises
        ------
        OSError
            The file cannot be written.

        Examples
        --------
        >>> import kdray, os, tempfile
        >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> tree.save(os.path.join(tempfile.mkdtemp(), "triangle.kdray"))
        """
        write_whole(path, self._tree.to_bytes())

    @staticmethod
    def open(
        path: str | os.PathLike[str],
        vertices: ArrayLike | None = None,
        faces: ArrayLike | None = None,
    ) -> Tree:
        """Opens what `save` wrote, or what `kdray build` wrote for the mesh that is given.

        Nothing is built: the file is mapped into memory and checked, and its nodes are used where
        they are, so processes share them.

        Raises
        ------
        OSError
            The file cannot be read.
        ValueError
            The file is damaged, or of another mesh.

        Examples
        --------
        >>> import kdray, os, tempfile
        >>> tree = kdray.build([[0., 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        >>> path = os.path.join(tempfile.mkdtemp(), "triangle.kdray")
        >>> tree.save(path)
        >>> kdray.Tree.open(path)
        kdray.Tree(1 triangle, 3 vertices, 1 node, bounds [0 0 0] to [1 1 0])
        """
        path = os.fspath(path)
        if vertices is None and faces is None:
            return Tree(_kdray.Tree.open(path))
        if vertices is None or faces is None:
            raise ValueError("vertices and faces go together")
        points = vertex_rows(vertices)
        return Tree(_kdray.Tree.open(path, (points, face_rows(faces, len(points)))))

    # A pickle knows of no devices: what comes of it is on the CPU.
    def __reduce__(self) -> tuple[Any, ...]:
        return _from_bytes, (self._tree.to_bytes(),)

    def __copy__(self) -> Tree:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Tree:
        return self

    def __repr__(self) -> str:
        stats = self.stats
        lower, upper = (" ".join(f"{x:.5g}" for x in corner) for corner in self.bounds)
        place = "" if self.device == "cpu" else f", on {self.device}"
        return (
            f"kdray.Tree({_count(self.triangle_count, 'triangle')}, "
            f"{_count(self.vertex_count, 'vertex', 'vertices')}, "
            f"{_count(stats.nodes, 'node')}, bounds [{lower}] to [{upper}]{place})"
        )


def point(name: str, value: ArrayLike) -> list[float]:
    """One finite point or direction."""
    numbers = vectors(name, value)
    if numbers.shape != (3,) or not np.isfinite(numbers).all():
        raise ValueError(
            f"{name} is {np.asarray(value).tolist()}; three finite numbers are expected"
        )
    return [float(number) for number in numbers]


def _from_bytes(data: bytes) -> Tree:
    """For pickles."""
    return Tree(_kdray.Tree.from_bytes(data))


def _count(number: int, one: str, many: str | None = None) -> str:
    return f"{number:,} {one if number == 1 else many or one + 's'}"
