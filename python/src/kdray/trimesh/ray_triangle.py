"""The intersector with the argument orders and dtypes of `trimesh.ray.ray_triangle`."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._tree import Intersector


class RayMeshIntersector(Intersector):
    """Rays against a trimesh mesh, as `mesh.ray` has them where embreex is not installed.

    >>> import trimesh
    >>> ray = RayMeshIntersector(trimesh.creation.box())
    >>> ray.intersects_first([[0.1, 0.2, 2], [9, 9, 9]], [[0, 0, -1], [0, 0, -1]])
    array([ 4, -1])
    """

    def intersects_id(
        self,
        ray_origins: ArrayLike,
        ray_directions: ArrayLike,
        return_locations: bool = False,
        multiple_hits: bool = True,
        **kwargs: Any,
    ) -> tuple[NDArray[Any], ...]:
        """Triangles `(h,)` and rays `(h,)` of hits, and if wanted their places `(h, 3)`."""
        rays, limit = (ray_origins, ray_directions), kwargs.get("max_hits")
        return self._hits(*rays, multiple_hits, limit, return_locations)

    def intersects_location(
        self, ray_origins: ArrayLike, ray_directions: ArrayLike, **kwargs: Any
    ) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
        """Places `(h, 3)`, rays `(h,)` and triangles `(h,)` of hits."""
        triangle, ray, places = self.intersects_id(
            ray_origins, ray_directions, return_locations=True, **kwargs
        )
        return places, ray, triangle

    def intersects_first(
        self, ray_origins: ArrayLike, ray_directions: ArrayLike, **kwargs: Any
    ) -> NDArray[np.int64]:
        """The first triangle of each ray `(n,)`, or -1."""
        return self._first(ray_origins, ray_directions).astype(np.int64)

    def intersects_any(
        self, ray_origins: ArrayLike, ray_directions: ArrayLike, **kwargs: Any
    ) -> NDArray[np.bool_]:
        """Whether each ray hits anything `(n,)`."""
        return self._any(ray_origins, ray_directions)

    def contains_points(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Whether points `(n, 3)` are inside."""
        return self.contains(points)
