"""The tree of a trimesh mesh, and what both kinds of intersectors have in common."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from trimesh import caching

from .._build import build
from .._tree import Tree


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
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        multiple_hits: bool,
        max_hits: int | None,
        with_places: bool,
    ) -> tuple[NDArray[Any], ...]:
        """Triangles and rays of hits, and if wanted their places."""
        starts, ways = self._rays(origins, directions)
        tree = self.tree
        hits = tree.all_hits(starts, ways, max_hits=max_hits if multiple_hits else 1)
        triangle, ray = hits.triangle.astype(np.int64), hits.ray
        if not with_places:
            return triangle, ray
        # In double precision, as trimesh has it; where that is out of reach, what the tree knows.
        vertices = np.ascontiguousarray(self.mesh.vertices, np.float64)
        faces = np.ascontiguousarray(self.mesh.faces, np.int64)
        on = ray, hits.t, hits.triangle, hits.u, hits.v
        reach = 1e-5 * float(self.mesh.scale)
        places = tree._tree.meet_planes((vertices, faces), (starts, ways), on, reach)
        return triangle, ray, places

    def _first(self, origins: ArrayLike, directions: ArrayLike) -> NDArray[np.int32]:
        return self.tree.closest_hit(*self._rays(origins, directions)).triangle

    def _any(self, origins: ArrayLike, directions: ArrayLike) -> NDArray[np.bool_]:
        return self.tree.any_hit(*self._rays(origins, directions))


def shaped(value: ArrayLike, name: str) -> NDArray[Any]:
    """`(n, 3)` numbers: those in single precision as they are, others in double."""
    numbers = np.asarray(value)
    if numbers.dtype != np.float32:
        numbers = numbers.astype(np.float64, copy=False)
    if numbers.shape == (0,):
        numbers = numbers.reshape(0, 3)
    if numbers.ndim != 2 or numbers.shape[1] != 3:
        raise ValueError(f"{name} must be (n,3)")
    return numbers
