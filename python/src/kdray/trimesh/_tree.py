"""The tree of a trimesh mesh, and what both kinds of intersectors have in common."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from trimesh import caching

from .._tree import Tree, build

Hits = tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]


class MeshTree:
    """The tree of a mesh, built when it is first needed and again when the mesh has changed."""

    def __init__(self, mesh: Any) -> None:
        self.mesh = mesh
        self._cache = caching.Cache(id_function=mesh.__hash__)

    @property
    def tree(self) -> Tree:
        """The tree of the mesh as it is now."""
        self._cache.verify()
        if "tree" not in self._cache:
            self._cache["tree"] = build(np.asarray(self.mesh.vertices), np.asarray(self.mesh.faces))
        tree: Tree = self._cache["tree"]
        return tree

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Whether `(n, 3)` points are inside: by crossings if the mesh is closed, and otherwise by
        its winding number."""
        sign = "parity" if self.mesh.is_watertight else "winding"
        return self.tree.contains(shaped(points, "points"), sign=sign)

    def __getstate__(self) -> dict[str, Any]:
        return {"mesh": self.mesh}

    def __setstate__(self, state: dict[str, Any]) -> None:
        MeshTree.__init__(self, state["mesh"])


class Intersector(MeshTree):
    """Queries with rays, in the words of trimesh."""

    def _rays(self, origins: ArrayLike, directions: ArrayLike) -> tuple[NDArray[Any], NDArray[Any]]:
        starts = shaped(origins, "ray_origins")
        ways = shaped(directions, "ray_directions")
        if starts.shape != ways.shape:
            raise ValueError("Ray origin and direction don't match!")
        return starts, ways

    def _hits(
        self, origins: ArrayLike, directions: ArrayLike, multiple_hits: bool, max_hits: int | None
    ) -> Hits:
        """Triangles, rays and places of hits."""
        starts, ways = self._rays(origins, directions)
        limit = max_hits if multiple_hits else 1
        hits = self.tree.all_hits(starts, ways, max_hits=limit)
        triangle, ray = hits.triangle.astype(np.int64), hits.ray
        places = self._places(hits.points, triangle, starts[ray], ways[ray])
        return triangle, ray, places

    def _first(self, origins: ArrayLike, directions: ArrayLike) -> NDArray[np.int32]:
        return self.tree.closest_hit(*self._rays(origins, directions)).triangle

    def _any(self, origins: ArrayLike, directions: ArrayLike) -> NDArray[np.bool_]:
        return self.tree.any_hit(*self._rays(origins, directions))

    def _places(
        self,
        near: NDArray[np.float64],
        triangle: NDArray[np.int64],
        origins: NDArray[np.float64],
        directions: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        """Where rays meet the planes of triangles, in double precision, as trimesh has it; the
        points that are known to be near where that is out of reach."""
        a, b, c = self.mesh.vertices.view(np.ndarray)[self.mesh.faces[triangle]].transpose(1, 0, 2)
        normals = np.cross(b - a, c - a)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            t = ((a - origins) * normals).sum(1) / (directions * normals).sum(1)
            places = origins + t[:, None] * directions
            reach = 1e-5 * self.mesh.scale
            good = (np.abs(places - near) <= reach).all(axis=1)
        return np.where(good[:, None], places, near)


def shaped(value: ArrayLike, name: str) -> NDArray[np.float64]:
    """`(n, 3)` numbers in double precision."""
    numbers = np.asanyarray(value, dtype=np.float64)
    if numbers.shape == (0,):
        numbers = numbers.reshape(0, 3)
    if numbers.ndim != 2 or numbers.shape[1] != 3:
        raise ValueError(f"{name} must be (n,3)")
    return numbers
