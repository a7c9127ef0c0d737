"""The mesh of a tree."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _kdray


class OnMesh:
    """What is about the mesh that a tree was built for."""

    __slots__ = ("_tree",)

    def __init__(self, tree: _kdray.Tree) -> None:
        self._tree = tree

    @property
    def triangle_count(self) -> int:
        """How many triangles the mesh has.

        >>> import kdray
        >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> tree.triangle_count
        1
        """
        return self._tree.triangle_count

    @property
    def vertex_count(self) -> int:
        """How many vertices the mesh has.

        >>> import kdray
        >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> tree.vertex_count
        3
        """
        return self._tree.vertex_count

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Lower and upper corner of the mesh's box, `(2, 3)`.

        >>> import kdray
        >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> tree.bounds
        array([[0., 0., 0.],
               [4., 4., 0.]])
        """
        return self._tree.bounds

    @property
    def vertices(self) -> NDArray[np.float64]:
        """The vertices `(n, 3)` as the tree keeps them: in f32, near the mesh if it is far away; a
        copy.

        >>> import kdray
        >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> tree.vertices[1]
        array([4., 0., 0.])
        """
        return self._tree.vertices()

    @property
    def faces(self) -> NDArray[np.int32]:
        """Three vertices a triangle, `(m, 3)`; a copy.

        >>> import kdray
        >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> tree.faces
        array([[0, 1, 2]], dtype=int32)
        """
        return self._tree.faces()

    # For the results.

    def _points(self, triangle: NDArray[Any], u: NDArray[Any], v: NDArray[Any]) -> NDArray[Any]:
        return self._tree.points(triangle, u, v).reshape(*triangle.shape, 3)

    def _normals(self, triangle: NDArray[Any]) -> NDArray[Any]:
        return self._tree.normals(triangle).reshape(*triangle.shape, 3)
