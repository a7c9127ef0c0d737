"""Distances, in the words of `trimesh.proximity`."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from trimesh import proximity, triangles
from trimesh.constants import tol

from ._tree import MeshTree, shaped

Closest = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]


class ProximityQuery(proximity.ProximityQuery):
    """Distances from a trimesh mesh, as `mesh.nearest` has them: positive inside.

    The tree is built with the first query, and again when the mesh has changed.

    >>> import trimesh
    >>> ProximityQuery(trimesh.creation.box()).signed_distance([[0.1, 0.2, 0.3], [0, 0, 2]])
    array([ 0.2, -1.5])
    """

    def __init__(self, mesh: Any) -> None:
        super().__init__(mesh)
        self._kdray = MeshTree(mesh)

    def on_surface(self, points: ArrayLike) -> Closest:
        """The closest points of the surface `(m, 3)`, how far they are, and their triangles."""
        queries = shaped(points, "points").astype(np.float64, copy=False)
        if not np.isfinite(queries).all():
            raise ValueError("points must be finite")
        triangle = self._kdray.tree.closest_point(queries).triangle.astype(np.int64)
        corners = self._mesh.vertices.view(np.ndarray)[self._mesh.faces[triangle]]
        # Once more in double precision, by trimesh's own formula.
        closest = triangles.closest_point(corners, queries)
        return closest, np.linalg.norm(queries - closest, axis=1), triangle

    def signed_distance(self, points: ArrayLike) -> NDArray[np.float64]:
        """Distances `(n,)`, positive inside and on the surface."""
        queries = shaped(points, "points").astype(np.float64, copy=False)
        distance = self.on_surface(queries)[1]
        outside = (distance > tol.merge) & ~self._kdray.contains(queries)
        return np.where(outside, -distance, distance)


def closest_point(mesh: Any, points: ArrayLike) -> Closest:
    """As `trimesh.proximity.closest_point`.

    >>> import trimesh
    >>> closest_point(trimesh.creation.box(), [[0.1, 0.2, 2.0]])[0]
    array([[0.1, 0.2, 0.5]])
    """
    return ProximityQuery(mesh).on_surface(points)


def signed_distance(mesh: Any, points: ArrayLike) -> NDArray[np.float64]:
    """As `trimesh.proximity.signed_distance`: positive inside.

    >>> import trimesh
    >>> signed_distance(trimesh.creation.box(), [[0.1, 0.2, 0.3]])
    array([0.2])
    """
    return ProximityQuery(mesh).signed_distance(points)
