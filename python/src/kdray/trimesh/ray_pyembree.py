"""The intersector with the argument orders and dtypes of `trimesh.ray.ray_pyembree`."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._tree import Intersector


class RayMeshIntersector(Intersector):
    """Rays against a trimesh mesh, as `mesh.ray` has them where embreex is installed.

    The tree is built with the first query, and again when the mesh has changed. `scale_to_box` has
    no effect: the tree finds itself a scale.

    >>> import trimesh
    >>> ray = RayMeshIntersector(trimesh.creation.box())
    >>> ray.intersects_location([[0.1, 0.2, 2]], [[0, 0, -1]])[0]
    array([[ 0.1,  0.2,  0.5],
           [ 0.1,  0.2, -0.5]])
    """

    def __init__(self, geometry: Any, scale_to_box: bool = True) -> None:
        super().__init__(geometry)
        self._scale_to_box = scale_to_box

    def intersects_location(
        self, ray_origins: ArrayLike, ray_directions: ArrayLike, multiple_hits: bool = True
    ) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
        """Places `(h, 3)`, rays `(h,)` and triangles `(h,)` of hits."""
        triangle, ray, places = self._hits(ray_origins, ray_directions, multiple_hits, None, True)
        return places, ray, triangle

    def intersects_id(
        self,
        ray_origins: ArrayLike,
        ray_directions: ArrayLike,
        multiple_hits: bool = True,
        max_hits: int | None = None,
        return_locations: bool = False,
    ) -> tuple[NDArray[Any], ...]:
        """Triangles `(h,)` and rays `(h,)` of hits, and if wanted their places `(h, 3)`."""
        rays = ray_origins, ray_directions
        return self._hits(*rays, multiple_hits, max_hits, return_locations)

    def intersects_first(
        self, ray_origins: ArrayLike, ray_directions: ArrayLike
    ) -> NDArray[np.int32]:
        """The first triangle of each ray `(n,)`, or -1."""
        return self._first(ray_origins, ray_directions)

    def intersects_any(
        self, ray_origins: ArrayLike, ray_directions: ArrayLike
    ) -> NDArray[np.bool_]:
        """Whether each ray hits anything `(n,)`."""
        return self._any(ray_origins, ray_directions)

    def contains_points(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Whether points `(n, 3)` are inside."""
        return self.contains(points)

    def __getstate__(self) -> dict[str, Any]:
        return {**super().__getstate__(), "scale_to_box": self._scale_to_box}

    def __setstate__(self, state: dict[str, Any]) -> None:
        super().__setstate__(state)
        self._scale_to_box = state["scale_to_box"]

    def __copy__(self) -> RayMeshIntersector:
        return RayMeshIntersector(self.mesh, self._scale_to_box)

    def __deepcopy__(self, memo: dict[int, Any]) -> RayMeshIntersector:
        return self.__copy__()
