"""The engines, and how each is asked what. Answers are numbers that can be compared."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import open3d
import trimesh
from numpy.typing import NDArray

import kdray

Rays = tuple[NDArray[np.float32], NDArray[np.float32]]

# By query, how many times fewer of them trimesh is asked, lest it take minutes.
QUERIES = {
    "build": 1,
    "first hit": 1,
    "bounce": 1,
    "shadow": 1,
    "all hits": 1,
    "inside": 20,
    "closest point": 1000,
    "signed distance": 1000,
}


class Queries(NamedTuple):
    first: Rays
    shadow: Rays
    bounce: Rays
    points: NDArray[np.float32]

    def count(self, query: str, divisor: int) -> dict[str, int]:
        """How many queries each engine is asked."""
        whole = len(self.points) if query in POINTS else len(self.first[0])
        whole = 1 if query == "build" else whole
        return {"kdray": whole, "open3d": whole, "trimesh": max(whole // divisor, 1)}


POINTS = ("inside", "closest point", "signed distance")


class Kdray:
    def __init__(self, vertices: NDArray, faces: NDArray) -> None:
        self.mesh = vertices, faces
        self.tree = kdray.build(vertices, faces)

    def ask(self, query: str, asked: Queries, divisor: int) -> NDArray | None:
        tree = self.tree
        if query == "build":
            kdray.build(*self.mesh)
            return None
        answers = {
            "first hit": lambda: tree.closest_hit(*asked.first).triangle,
            "bounce": lambda: tree.closest_hit(*asked.bounce).triangle,
            "shadow": lambda: tree.any_hit(*asked.shadow, t_max=1.0),
            "all hits": lambda: np.diff(tree.all_hits(*asked.first).offsets),
            "inside": lambda: tree.contains(asked.points),
            "closest point": lambda: tree.closest_point(asked.points).distance,
            "signed distance": lambda: tree.signed_distance(asked.points),
        }
        # Those that all engines are asked.
        return answers[query]()[: asked.count(query, divisor)["trimesh"]]


class Open3D:
    def __init__(self, vertices: NDArray, faces: NDArray) -> None:
        self.mesh = vertices, faces.astype(np.uint32)
        self.scene = self.built()
        self.tensors: dict = {}

    def built(self) -> open3d.t.geometry.RaycastingScene:
        scene = open3d.t.geometry.RaycastingScene()
        scene.add_triangles(*self.mesh)
        # The first query builds.
        scene.cast_rays(np.zeros((1, 6), np.float32))
        return scene

    def ask(self, query: str, asked: Queries, divisor: int) -> NDArray | None:
        if query == "build":
            self.built()
            return None
        scene = self.scene
        if not self.tensors:
            rays = {"first": asked.first, "shadow": asked.shadow, "bounce": asked.bounce}
            self.tensors = {
                name: open3d.core.Tensor(np.concatenate(both, axis=1))
                for name, both in rays.items()
            }
            self.tensors["points"] = open3d.core.Tensor(asked.points)
        sent = self.tensors
        answers = {
            "first hit": lambda: scene.cast_rays(sent["first"])["primitive_ids"],
            "bounce": lambda: scene.cast_rays(sent["bounce"])["primitive_ids"],
            "shadow": lambda: scene.test_occlusions(sent["shadow"], tfar=1.0),
            "all hits": lambda: scene.list_intersections(sent["first"])["ray_splits"],
            "inside": lambda: scene.compute_occupancy(sent["points"]),
            "closest point": lambda: scene.compute_distance(sent["points"]),
            "signed distance": lambda: scene.compute_signed_distance(sent["points"]),
        }
        answer = answers[query]().numpy()
        if query == "all hits":
            answer = np.diff(answer.astype(np.int64))
        if answer.dtype == np.uint32:
            answer = answer.view(np.int32)
        return answer[: asked.count(query, divisor)["trimesh"]]


class Trimesh:
    def __init__(self, vertices: NDArray, faces: NDArray) -> None:
        self.mesh = self.built(vertices, faces)
        self.arrays = vertices, faces

    def built(self, vertices: NDArray, faces: NDArray) -> trimesh.Trimesh:
        mesh = trimesh.Trimesh(vertices, faces, process=False)
        # The first query builds.
        mesh.ray.intersects_first(np.zeros((1, 3)), np.ones((1, 3)))
        return mesh

    def ask(self, query: str, asked: Queries, divisor: int) -> NDArray | None:
        if query == "build":
            self.built(*self.arrays)
            return None
        mesh, count = self.mesh, asked.count(query, divisor)["trimesh"]
        points = asked.points[:count]
        origins, directions = (part[:count] for part in asked.first)

        answers = {
            "first hit": lambda: mesh.ray.intersects_first(*asked.first),
            "bounce": lambda: mesh.ray.intersects_first(*asked.bounce),
            # It knows no end of a ray; the light is beyond everything.
            "shadow": lambda: mesh.ray.intersects_any(*asked.shadow),
            "all hits": lambda: np.bincount(
                mesh.ray.intersects_id(origins, directions, multiple_hits=True)[1], minlength=count
            ),
            "inside": lambda: mesh.ray.contains_points(points),
            "closest point": lambda: mesh.nearest.on_surface(points)[1],
            "signed distance": lambda: -mesh.nearest.signed_distance(points),
        }
        return answers[query]()


ENGINES = {"kdray": Kdray, "open3d": Open3D, "trimesh": Trimesh}
