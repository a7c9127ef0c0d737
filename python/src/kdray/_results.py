"""What queries give: tuples of arrays, with what can be worked out of them on demand."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from typing_extensions import Self

    from ._mesh import OnMesh


class _HitsFields(NamedTuple):
    t: NDArray[np.float32]
    triangle: NDArray[np.int32]
    u: NDArray[np.float32]
    v: NDArray[np.float32]


class _AllHitsFields(NamedTuple):
    offsets: NDArray[np.int64]
    t: NDArray[np.float32]
    triangle: NDArray[np.int32]
    u: NDArray[np.float32]
    v: NDArray[np.float32]


class _ClosestPointsFields(NamedTuple):
    point: NDArray[Any]
    distance: NDArray[Any]
    triangle: NDArray[np.int32]
    u: NDArray[np.float32]
    v: NDArray[np.float32]


class _OnTriangles:
    """What is known of hits by their triangles, for those who still have the tree."""

    triangle: NDArray[np.int32]
    u: NDArray[np.float32]
    v: NDArray[np.float32]
    _known: tuple[OnMesh, np.dtype[Any]] | None = None

    def _of(self, tree: OnMesh, dtype: np.dtype[Any]) -> Self:
        self._known = tree, dtype
        return self

    def _tree_and_dtype(self) -> tuple[OnMesh, np.dtype[Any]]:
        if self._known is None:
            raise ValueError("these hits came without their tree")
        return self._known

    @property
    def points(self) -> NDArray[Any]:
        """Where the hits are, `(…, 3)`: of the dtype of the rays, NaN where there is no hit."""
        tree, dtype = self._tree_and_dtype()
        return tree._points(self.triangle, self.u, self.v).astype(dtype, copy=False)

    @property
    def normals(self) -> NDArray[Any]:
        """Unit normals of the triangles, `(…, 3)`: seen from where they point, the vertices turn
        counter-clockwise. NaN where there is no hit; zero for a triangle without area."""
        tree, dtype = self._tree_and_dtype()
        return tree._normals(self.triangle).astype(dtype, copy=False)


class Hits(_OnTriangles, _HitsFields):
    """Hits by ray: `t`, `triangle`, `u`, `v`, each of the rays' shape.

    `t` is in units of the direction's length. A ray that hits nothing has `triangle` -1, `t`
    infinite and `u`, `v` zero. A hit lies at `(1 - u - v) v0 + u v1 + v v2` of its triangle's
    vertices.

    >>> import kdray
    >>> tree = kdray.build([[0., 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> hits = tree.closest_hit([[.25, .25, 2], [2, 2, 2]], [0, 0, -1])
    >>> hits.mask
    array([ True, False])
    >>> hits.points[0], hits.normals[0]
    (array([0.25, 0.25, 0.  ]), array([0., 0., 1.]))
    """

    @property
    def mask(self) -> NDArray[np.bool_]:
        """Whether each ray hits anything, of the rays' shape."""
        return self.triangle >= 0


class AllHits(_OnTriangles, _AllHitsFields):
    """Hits of ray `i` at `offsets[i]:offsets[i + 1]` of `t`, `triangle`, `u` and `v`.

    Rays of more than one dimension count in C order. A ray's hits are in order of `t`, and at one
    `t` of `triangle`; each crossing comes once.

    >>> import kdray
    >>> corners = [[0., 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1]]
    >>> tree = kdray.build(corners, [[0, 1, 2], [3, 4, 5]])
    >>> hits = tree.all_hits([[.25, .25, 2], [2, 2, 2]], [0, 0, -1])
    >>> hits.offsets, hits.triangle, hits.ray
    (array([0, 2, 2]), array([1, 0], dtype=int32), array([0, 0]))
    """

    @property
    def ray(self) -> NDArray[np.int64]:
        """Which ray each hit is of, `(n,)`."""
        return np.repeat(np.arange(len(self.offsets) - 1), np.diff(self.offsets))


class ClosestPoints(_ClosestPointsFields):
    """Closest points: `point` `(…, 3)`, `distance`, `triangle`, `u` and `v` `(…)`.

    `point` and `distance` have the dtype of the query. Where there is no point within the distance
    asked for, `triangle` is -1, `distance` infinite and `point` NaN. Of several triangles at the
    same distance it is the one with the lowest index.

    >>> import kdray
    >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
    >>> tree.closest_point([[1., 1, 3], [1, 1, 9]], max_distance=5).distance
    array([ 3., inf])
    """


class Within(NamedTuple):
    """Triangles near query `i` at `offsets[i]:offsets[i + 1]` of `triangle`, in ascending order.

    >>> import kdray
    >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
    >>> tree.within_box([[0, 0, -1], [9, 9, 9]], [[1, 1, 1], [10, 10, 10]])
    Within(offsets=array([0, 1, 1]), triangle=array([0], dtype=int32))
    """

    offsets: NDArray[np.int64]
    triangle: NDArray[np.int32]


class Stats(NamedTuple):
    """What a tree is like. `e_inner`, `e_leaf` and `e_prim` are what a random line through the
    root's box is expected to meet of inner nodes, leaves and references.

    >>> import kdray
    >>> kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]]).stats.references
    1
    """

    nodes: int
    """Inner nodes and leaves."""
    leaves: int
    """Leaves, the empty ones included."""
    empty_leaves: int
    """Leaves without references."""
    references: int
    """References of all leaves together."""
    depth: int
    """Inner nodes on the longest way to a leaf."""
    leaf_histogram: list[int]
    """`leaf_histogram[n]` leaves have `n` references."""
    e_inner: float
    e_leaf: float
    e_prim: float
    sah_cost: float
    """What a ray is expected to pay, in units of one intersection [MB90]."""
    tree_bytes: int
    """Bytes of nodes and references."""
    tracer_bytes: int
    """Bytes of the layout that queries read."""
