"""Queries with points, and with regions."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import floats, rows, scalars, thread_count, together, vectors
from ._mesh import OnMesh
from ._results import ClosestPoints, Within


class PointQueries(OnMesh):
    """What can be asked of places."""

    __slots__ = ()

    def contains(
        self, points: ArrayLike, *, sign: str = "parity", threads: int | None = None
    ) -> NDArray[np.bool_]:
        """Whether points, `(…, 3)`, are inside; points on the surface may get either answer.

        With `sign="parity"`, whether a line from there crosses the surface an odd number of times:
        right for every closed mesh, whichever way its triangles are wound. With
        `sign="winding"`, whether the mesh winds around the point more than half a time: for meshes
        with holes whose triangles are wound consistently. [JKS13]

        Examples
        --------
        >>> import kdray
        >>> corners = [[0., 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
        >>> tree = kdray.build(corners, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
        >>> tree.contains([[.1, .1, .1], [1, 1, 1]])
        array([ True, False])
        """
        queries, winding = vectors("points", points), is_winding(sign)
        inside = self._tree.contains(rows(queries), winding, thread_count(threads))
        return inside.reshape(queries.shape[:-1])

    def signed_distance(
        self, points: ArrayLike, *, sign: str = "parity", threads: int | None = None
    ) -> NDArray[Any]:
        """How far points, `(…, 3)`, are from the surface: negative inside, and of their dtype.

        `sign` as for `contains`. Infinite for a mesh without triangles and for points that are not
        finite.

        Examples
        --------
        >>> import kdray
        >>> corners = [[0., 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
        >>> tree = kdray.build(corners, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
        >>> tree.signed_distance([[.125, .25, .25], [-2, .1, .1]])
        array([-0.125,  2.   ])
        """
        queries, winding = vectors("points", points), is_winding(sign)
        distance = self._tree.signed_distance(rows(queries), winding, thread_count(threads))
        return distance.reshape(queries.shape[:-1]).astype(queries.dtype, copy=False)

    def winding_number(
        self, points: ArrayLike, *, tolerance: float = 1e-3, threads: int | None = None
    ) -> NDArray[np.float64]:
        """How often the mesh winds around points, `(…, 3)`, off by at most `tolerance`.

        1 inside a closed mesh whose triangles are counter-clockwise as seen from outside, 0
        outside, and in between for a mesh with holes. [JKS13], [BDS+18]

        Examples
        --------
        >>> import kdray
        >>> corners = [[0., 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
        >>> tree = kdray.build(corners, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
        >>> tree.winding_number([[.1, .1, .1], [1, 1, 1]]).round(2) + 0.0
        array([1., 0.])
        """
        queries = vectors("points", points)
        limit = float(floats("tolerance", tolerance))
        if not limit >= 0.0:
            raise ValueError(f"tolerance is {limit}; at least 0 is expected")
        numbers = self._tree.winding_number(rows(queries), limit, thread_count(threads))
        return numbers.reshape(queries.shape[:-1])

    def closest_point(
        self, points: ArrayLike, *, max_distance: float = np.inf, threads: int | None = None
    ) -> ClosestPoints:
        """The point of the surface closest to each of `points`, `(…, 3)`, if there is one within
        `max_distance`.

        Examples
        --------
        >>> import kdray
        >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> tree.closest_point([3., 3, 0]).point
        array([2., 2., 0.])
        """
        queries = vectors("points", points)
        limit = float(floats("max_distance", max_distance))
        if not limit >= 0.0:
            raise ValueError(f"max_distance is {limit}; at least 0 is expected")
        found = self._tree.closest_point(rows(queries), limit, thread_count(threads))
        point, distance, triangle, u, v = found
        shape, dtype = queries.shape[:-1], queries.dtype
        return ClosestPoints(
            point.reshape(*shape, 3).astype(dtype, copy=False),
            distance.reshape(shape).astype(dtype, copy=False),
            triangle.reshape(shape),
            u.reshape(shape),
            v.reshape(shape),
        )

    def within_sphere(
        self, centers: ArrayLike, radius: ArrayLike, *, threads: int | None = None
    ) -> Within:
        """The triangles of which some point is within `radius` of each of `centers`, `(…, 3)`.

        `radius` is one number, or one for each centre.

        Examples
        --------
        >>> import kdray
        >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> tree.within_sphere([[1, 1, 1], [9, 9, 9]], 2).offsets
        array([0, 1, 1])
        """
        queries = vectors("centers", centers)
        radii = scalars("radius", radius, queries.shape[:-1])
        if np.less(radii, 0).any():
            raise ValueError("radius is negative")
        return Within(*self._tree.within_sphere(rows(queries), radii, thread_count(threads)))

    def within_box(
        self, lower: ArrayLike, upper: ArrayLike, *, threads: int | None = None
    ) -> Within:
        """The triangles that have a point in common with each box, touching included. [AM01]

        `lower` and `upper` are the boxes' corners, `(…, 3)`; a box whose lower corner is above its
        upper one has nothing in it.

        Examples
        --------
        >>> import kdray
        >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> tree.within_box([3, 3, -1], [[4, 4, 1], [9, 9, 1]]).triangle
        array([], dtype=int32)
        """
        corners = ("lower", vectors("lower", lower)), ("upper", vectors("upper", upper))
        _, (lowest, highest) = together(*corners)
        return Within(*self._tree.within_box(rows(lowest), rows(highest), thread_count(threads)))


def is_winding(sign: str) -> bool:
    """Whether the winding number tells inside from outside, and not the parity of crossings."""
    if sign not in ("parity", "winding"):
        raise ValueError(f"sign is {sign!r}; 'parity' or 'winding' is expected")
    return sign == "winding"
