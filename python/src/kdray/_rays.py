"""Queries with rays."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import positive, ray_arguments
from ._mesh import OnMesh
from ._results import AllHits, Hits


class RayQueries(OnMesh):
    """What can be asked along rays."""

    __slots__ = ()

    def closest_hit(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        *,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        exclude: ArrayLike | None = None,
        mask: ArrayLike | None = None,
        threads: int | None = None,
    ) -> Hits:
        """The first triangle along each ray; of several at one `t` the one with the lowest index.

        Watertight: no ray slips between triangles that share an edge. [PH04], [WBA13]

        Parameters
        ----------
        origins, directions
            `(…, 3)`, broadcast against each other. Directions need not have unit length: `t` is in
            units of their length. With float64, points are brought near the mesh before they
            are rounded.
        t_min, t_max
            Which `t` count, ends included; one number, or one for each ray.
        exclude
            A triangle that does not count, one for each ray (-1 for none): the one that the ray
            starts on.
        mask
            One bool for each triangle of the mesh: whether it counts.
        threads
            Threads that answer; by default one a core.

        Raises
        ------
        ValueError
            Shapes that do not fit, or a NaN in `t_min` or `t_max`.
        TypeError
            Arrays that are not of numbers.

        Examples
        --------
        >>> import kdray
        >>> tree = kdray.build([[0., 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        >>> hits = tree.closest_hit([[.25, .25, 2], [2, 2, 2]], [0, 0, -1])
        >>> hits.t, hits.triangle
        (array([ 2., inf], dtype=float32), array([ 0, -1], dtype=int32))
        """
        shape, rays = ray_arguments(origins, directions, t_min, t_max, exclude, mask, threads)
        t, triangle, u, v = self._tree.closest_hit(rays)
        hits = Hits(t.reshape(shape), triangle.reshape(shape), u.reshape(shape), v.reshape(shape))
        return hits._of(self, rays.origins.dtype)

    def any_hit(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        *,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        exclude: ArrayLike | None = None,
        mask: ArrayLike | None = None,
        threads: int | None = None,
    ) -> NDArray[np.bool_]:
        """Whether each ray hits anything; faster than asking what. Arguments as `closest_hit`.

        Examples
        --------
        >>> import kdray
        >>> tree = kdray.build([[0., 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        >>> tree.any_hit([.25, .25, 2], [[0, 0, -1], [0, 0, 1]])
        array([ True, False])
        """
        shape, rays = ray_arguments(origins, directions, t_min, t_max, exclude, mask, threads)
        return self._tree.any_hit(rays).reshape(shape)

    def count_hits(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        *,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        exclude: ArrayLike | None = None,
        mask: ArrayLike | None = None,
        threads: int | None = None,
    ) -> NDArray[np.int32]:
        """How many triangles each ray crosses. Arguments as `closest_hit`.

        A line through a closed mesh crosses it an even number of times, whatever edges and
        vertices it passes through.

        Examples
        --------
        >>> import kdray
        >>> tree = kdray.build([[0., 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 1]])
        >>> tree.count_hits([[.25, .25, 2]], [0, 0, -1])
        array([2], dtype=int32)
        """
        shape, rays = ray_arguments(origins, directions, t_min, t_max, exclude, mask, threads)
        return self._tree.count_hits(rays).reshape(shape)

    def all_hits(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        *,
        max_hits: int | None = None,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        exclude: ArrayLike | None = None,
        mask: ArrayLike | None = None,
        threads: int | None = None,
    ) -> AllHits:
        """Every crossing of every ray, sorted by ray and then by `t`; each once.

        Arguments as `closest_hit`; with `max_hits`, no more than that many a ray, the nearest.

        Examples
        --------
        >>> import kdray
        >>> tree = kdray.build([[0., 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 1]])
        >>> tree.all_hits([[.25, .25, 2]], [0, 0, -1]).triangle
        array([0, 1], dtype=int32)
        """
        _, rays = ray_arguments(origins, directions, t_min, t_max, exclude, mask, threads)
        limit = 2**62 if max_hits is None else positive("max_hits", max_hits)
        offsets, columns = self._tree.all_hits(rays, limit)
        return AllHits(offsets, *columns)._of(self, rays.origins.dtype)
