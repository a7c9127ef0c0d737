"""What Open3D has for rays and distances, answered by kdray; with Open3D and without.

>>> import numpy as np
>>> from kdray.open3d import RaycastingScene
>>> scene = RaycastingScene()
>>> scene.add_triangles(np.eye(3, dtype=np.float32), [[0, 1, 2]])
0
>>> ans = scene.cast_rays([[2, 2, 2, -1, -1, -1], [9, 9, 9, 1, 1, 1]])
>>> ans["t_hit"].numpy(), ans["primitive_ids"].numpy()
(array([1.6666666,       inf], dtype=float32), array([         0, 4294967295], dtype=uint32))

Given tensors of Open3D, methods give such tensors; given anything else, arrays of numpy with the
few methods of a tensor that its users call first: `numpy`, `cpu`, `isfinite`, `isinf`, `isnan`.

Where answers differ from Open3D's: intersections are listed in order of distance; each crossing
comes once, whatever edge or vertex the ray passes through, so inside is inside with one sample, and
`nsamples` changes nothing. float64 is taken, and kept until points are near the mesh. Errors are
ValueError and TypeError.
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import array, face_rows, vectors, whole
from ._build import build
from ._tree import Tree

__all__ = ["Array", "RaycastingScene"]

Answers = dict[str, Any]


class Array(np.ndarray):
    """An array that can also be asked like a tensor."""

    def numpy(self) -> NDArray[Any]:
        """The array, without the methods of a tensor."""
        return self.view(np.ndarray)

    def cpu(self) -> Array:
        """The array: it is there already."""
        return self

    def isfinite(self) -> NDArray[np.bool_]:
        """Which elements are finite."""
        return np.isfinite(self)

    def isinf(self) -> NDArray[np.bool_]:
        """Which elements are infinite."""
        return np.isinf(self)

    def isnan(self) -> NDArray[np.bool_]:
        """Which elements are not a number."""
        return np.isnan(self)


class RaycastingScene:
    """Meshes, and queries over all of them. The tree is built with the first query, and again when
    meshes were added since.

    Parameters
    ----------
    nthreads
        Threads of queries that do not say otherwise; 0 for one a core.
    device
        Taken for compatibility; queries run on the CPU.
    """

    INVALID_ID = 0xFFFF_FFFF

    def __init__(self, nthreads: int = 0, device: Any = None) -> None:
        self._threads = whole("nthreads", nthreads, 0)
        self._vertices: list[NDArray[Any]] = []
        self._faces: list[NDArray[np.uint32]] = []
        self._tree: Tree | None = None
        # By geometry its first triangle, and the number of all.
        self._starts = np.zeros(1, np.int64)

    def add_triangles(self, *args: Any, **kwargs: Any) -> int:
        """Adds a mesh; gives its geometry id.

        `add_triangles(vertex_positions, triangle_indices)` takes `(n, 3)` float32 or float64 and
        `(m, 3)` integers, `add_triangles(mesh)` a `TriangleMesh` of `open3d.t.geometry`.
        """
        vertices, indices = _mesh(*args, **kwargs)
        points = vectors("vertex_positions", _numpy(vertices))
        if points.ndim != 2:
            raise ValueError(f"vertex_positions has shape {points.shape}; (n, 3) is expected")
        faces = face_rows(_numpy(indices), len(points))
        if not np.isfinite(points).all():
            place = int(np.flatnonzero(~np.isfinite(points).all(axis=1))[0])
            raise ValueError(f"vertex_positions[{place}] is not finite: {points[place].tolist()}")
        # Copies, because the arrays may change before the tree is built.
        self._vertices.append(points.copy())
        self._faces.append(faces.copy())
        self._starts = np.append(self._starts, self._starts[-1] + len(faces))
        self._tree = None
        return len(self._faces) - 1

    @property
    def tree(self) -> Tree:
        """The tree of all meshes together."""
        if self._tree is None:
            firsts = np.cumsum([0, *map(len, self._vertices)])
            if firsts[-1] >= 1 << 32:
                raise ValueError("the meshes have more vertices than a 32-bit index can name")
            faces = [faces + np.uint32(first) for faces, first in zip(self._faces, firsts)]
            self._tree = build(
                np.concatenate([np.zeros((0, 3), np.float32), *self._vertices]),
                np.concatenate([np.zeros((0, 3), np.uint32), *faces]),
            )
        return self._tree

    # Queries with rays: `(…, 6)`, origins and then directions, float32 or float64.

    def cast_rays(self, rays: ArrayLike, nthreads: int = 0) -> Answers:
        """First hits: `t_hit` (infinite without), `geometry_ids`, `primitive_ids` (`INVALID_ID`
        without) `(…)`, `primitive_uvs` `(…, 2)` and `primitive_normals` `(…, 3)` (zero without)."""
        origins, directions = _rays(rays)
        hits = self.tree.closest_hit(origins, directions, threads=self._of(nthreads))
        geometry, primitive = self._ids(hits.triangle)
        return _answers(
            rays,
            t_hit=hits.t,
            geometry_ids=geometry,
            primitive_ids=primitive,
            primitive_uvs=np.stack([hits.u, hits.v], axis=-1),
            primitive_normals=self._normals(hits.triangle),
        )

    def test_occlusions(
        self, rays: ArrayLike, tnear: float = 0.0, tfar: float = np.inf, nthreads: int = 0
    ) -> Any:
        """Whether anything is hit between `tnear` and `tfar`: bool `(…)`."""
        threads = self._of(nthreads)
        hit = self.tree.any_hit(*_rays(rays), t_min=tnear, t_max=tfar, threads=threads)
        return _answer(rays, hit)

    def count_intersections(self, rays: ArrayLike, nthreads: int = 0) -> Any:
        """How many triangles each ray crosses: int32 `(…)`."""
        return _answer(rays, self.tree.count_hits(*_rays(rays), threads=self._of(nthreads)))

    def list_intersections(self, rays: ArrayLike, nthreads: int = 0) -> Answers:
        """All hits, those of ray `i` at `ray_splits[i]:ray_splits[i + 1]`, in order of `t_hit`:
        `ray_ids`, `t_hit`, `geometry_ids`, `primitive_ids` `(n,)` and `primitive_uvs` `(n, 2)`."""
        hits = self.tree.all_hits(*_rays(rays), threads=self._of(nthreads))
        if hits.offsets[-1] >= 1 << 32:
            raise ValueError("more hits than a uint32 can count: ask for fewer rays at once")
        geometry, primitive = self._ids(hits.triangle)
        return _answers(
            rays,
            ray_splits=hits.offsets.astype(np.uint32),
            ray_ids=hits.ray.astype(np.uint32),
            t_hit=hits.t,
            geometry_ids=geometry,
            primitive_ids=primitive,
            primitive_uvs=np.stack([hits.u, hits.v], axis=-1),
        )

    # Queries with points: `(…, 3)`, float32 or float64.

    def compute_closest_points(self, query_points: ArrayLike, nthreads: int = 0) -> Answers:
        """Closest points of the surfaces: `points` `(…, 3)`, `geometry_ids`, `primitive_ids` `(…)`,
        `primitive_uvs` `(…, 2)` and `primitive_normals` `(…, 3)`."""
        found = self.tree.closest_point(_points(query_points), threads=self._of(nthreads))
        geometry, primitive = self._ids(found.triangle)
        return _answers(
            query_points,
            points=found.point.astype(np.float32, copy=False),
            geometry_ids=geometry,
            primitive_ids=primitive,
            primitive_uvs=np.stack([found.u, found.v], axis=-1),
            primitive_normals=self._normals(found.triangle),
        )

    def compute_distance(self, query_points: ArrayLike, nthreads: int = 0) -> Any:
        """Distances from the surfaces: float32 `(…)`."""
        found = self.tree.closest_point(_points(query_points), threads=self._of(nthreads))
        return _answer(query_points, found.distance.astype(np.float32, copy=False))

    def compute_signed_distance(
        self, query_points: ArrayLike, nthreads: int = 0, nsamples: int = 1
    ) -> Any:
        """Distances from the surfaces, negative inside: float32 `(…)`."""
        _check_samples(nsamples)
        distance = self.tree.signed_distance(_points(query_points), threads=self._of(nthreads))
        return _answer(query_points, distance.astype(np.float32, copy=False))

    def compute_occupancy(
        self, query_points: ArrayLike, nthreads: int = 0, nsamples: int = 1
    ) -> Any:
        """1 inside and 0 outside: float32 `(…)`."""
        _check_samples(nsamples)
        inside = self.tree.contains(_points(query_points), threads=self._of(nthreads))
        return _answer(query_points, inside.astype(np.float32))

    # Rays of cameras.

    @staticmethod
    def create_rays_pinhole(*args: Any, **kwargs: Any) -> Any:
        """Rays of a pinhole camera: float32 `(height_px, width_px, 6)`, one through the middle of
        each pixel, whose direction is 1 along the view.

        `create_rays_pinhole(intrinsic_matrix, extrinsic_matrix, width_px, height_px)` takes `(3,3)`
        and the `(4, 4)` that maps the world to the camera;
        `create_rays_pinhole(fov_deg, center, eye, up, width_px, height_px)` the horizontal field of
        view in degrees, and where the camera looks, is and has its top.
        """
        if len(args) + len(kwargs) == 6:
            return _rays_of_view(*args, **kwargs)
        return _rays_of_matrices(*args, **kwargs)

    # How answers come about.

    def _of(self, nthreads: int) -> int | None:
        return (whole("nthreads", nthreads, 0) or self._threads) or None

    def _ids(self, triangle: NDArray[np.int32]) -> tuple[NDArray[np.uint32], NDArray[np.uint32]]:
        """Geometries, and triangles in them; `INVALID_ID` where there is none."""
        geometry = np.searchsorted(self._starts, triangle, side="right") - 1
        primitive = triangle - self._starts[geometry]
        missing = triangle < 0
        geometry[missing] = primitive[missing] = self.INVALID_ID
        return geometry.astype(np.uint32), primitive.astype(np.uint32)

    def _normals(self, triangle: NDArray[np.int32]) -> NDArray[np.float32]:
        """Unit normals; zero where there is no triangle."""
        normals: NDArray[np.float32] = self.tree._normals(triangle)
        normals[triangle < 0] = 0.0
        return normals


def _mesh(*args: Any, **kwargs: Any) -> tuple[Any, Any]:
    """Vertices and triangles, from the arguments of either `add_triangles`."""
    names = ("vertex_positions", "triangle_indices")
    if len(args) + len(kwargs) == 1:
        (mesh,) = (*args, *kwargs.values())
        if set(kwargs) <= {"mesh"} and hasattr(mesh, "vertex") and hasattr(mesh, "triangle"):
            return mesh.vertex.positions, mesh.triangle.indices
    given = {**dict(zip(names, args)), **kwargs}
    if len(args) > 2 or set(given) != set(names) or len(given) != len(args) + len(kwargs):
        raise TypeError(
            "add_triangles takes vertex_positions and triangle_indices, or a mesh of open3d.t"
        )
    return given[names[0]], given[names[1]]


def _is_tensor(value: Any) -> bool:
    """Whether a value is a tensor of Open3D."""
    module = sys.modules.get("open3d")
    return module is not None and isinstance(value, module.core.Tensor)


def _numpy(value: Any) -> Any:
    """A tensor of Open3D as an array that shares its memory; other things as they are."""
    return value.cpu().numpy() if _is_tensor(value) else value


def _answer(asked: Any, answer: NDArray[Any]) -> Any:
    """An answer of the kind that the question was."""
    if _is_tensor(asked):
        # A tensor has at least one dimension fewer than its question, but is contiguous.
        return sys.modules["open3d"].core.Tensor.from_numpy(np.ascontiguousarray(answer))
    return np.asarray(answer).view(Array)


def _answers(asked: Any, **answers: NDArray[Any]) -> Answers:
    return {name: _answer(asked, answer) for name, answer in answers.items()}


def _rays(value: Any) -> tuple[NDArray[Any], NDArray[Any]]:
    """Origins and directions, as views of the rays where they have floats."""
    rays = array("rays", _numpy(value))
    if rays.ndim == 0 or rays.shape[-1] != 6:
        raise ValueError(f"rays has shape {rays.shape}; (…, 6) is expected")
    return vectors("rays", rays[..., :3]), vectors("rays", rays[..., 3:])


def _points(value: Any) -> NDArray[Any]:
    return vectors("query_points", _numpy(value))


def _check_samples(nsamples: int) -> None:
    if whole("nsamples", nsamples, 1) % 2 == 0:
        raise ValueError(f"nsamples is {nsamples}; an odd number is expected")


def _rays_of_view(
    fov_deg: float, center: Any, eye: Any, up: Any, width_px: int, height_px: int
) -> Any:
    fov = float(fov_deg)
    if not 0.0 < fov < 180.0:
        raise ValueError(f"fov_deg is {fov}; an angle between 0 and 180 degrees is expected")
    width, height = whole("width_px", width_px, 1), whole("height_px", height_px, 1)
    at, place, top = (
        _matrix(n, v, (3,)) for n, v in (("center", center), ("eye", eye), ("up", up))
    )
    forward = at - place
    # As in Open3D, rows of pixels go up, and so columns go to the left.
    across = np.cross(top, forward)
    if not (np.linalg.norm(forward) > 0 and np.linalg.norm(across) > 0):
        raise ValueError("center - eye and up are parallel, or zero: there is no such view")
    upward = np.cross(forward, across)
    world_to_camera = np.eye(4)
    world_to_camera[:3, :3] = [axis / np.linalg.norm(axis) for axis in (across, upward, forward)]
    world_to_camera[:3, 3] = -world_to_camera[:3, :3] @ place
    focal = 0.5 * width / np.tan(0.5 * np.radians(fov))
    intrinsic = np.array([[focal, 0, 0.5 * width], [0, focal, 0.5 * height], [0, 0, 1]])
    rays = _rays_of_matrices(intrinsic, world_to_camera, width, height)
    return _answer(center if _is_tensor(center) else eye, rays)


def _rays_of_matrices(
    intrinsic_matrix: Any, extrinsic_matrix: Any, width_px: int, height_px: int
) -> Any:
    width, height = whole("width_px", width_px, 1), whole("height_px", height_px, 1)
    intrinsic = _matrix("intrinsic_matrix", intrinsic_matrix, (3, 3))
    extrinsic = _matrix("extrinsic_matrix", extrinsic_matrix, (4, 4))
    try:
        world_from_pixel = extrinsic[:3, :3].T @ np.linalg.inv(intrinsic)
    except np.linalg.LinAlgError:
        raise ValueError("intrinsic_matrix has no inverse") from None
    rays = np.empty((height, width, 6), np.float32)
    rays[..., :3] = -extrinsic[:3, :3].T @ extrinsic[:3, 3]
    x, y = np.arange(width) + 0.5, np.arange(height) + 0.5
    across, down, forward = world_from_pixel.T
    rays[..., 3:] = x[:, None] * across + y[:, None, None] * down + forward
    return _answer(intrinsic_matrix, rays)


def _matrix(name: str, value: Any, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Finite numbers of a shape."""
    try:
        matrix = np.asarray(_numpy(value), np.float64)
    except (TypeError, ValueError) as error:
        raise TypeError(f"{name} is not an array of numbers") from error
    if matrix.shape != shape or not np.isfinite(matrix).all():
        raise ValueError(f"{name} has shape {matrix.shape}; finite numbers, {shape}, are expected")
    return matrix
