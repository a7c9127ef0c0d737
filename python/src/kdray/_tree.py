"""The tree and its queries."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _kdray
from ._arrays import (
    face_rows,
    floats,
    positive,
    ray_arguments,
    rows,
    scalars,
    thread_count,
    together,
    vectors,
    vertex_rows,
    whole,
)
from ._device import Device, device_word
from ._results import AllHits, ClosestPoints, Hits, Stats, Within

Progress = Callable[[float], object]


def build(
    vertices: ArrayLike,
    faces: ArrayLike,
    *,
    device: Device | str | int = "auto",
    builder: str = "exact",
    cost_traversal: float | None = None,
    cost_intersect: float | None = None,
    empty_bonus: float | None = None,
    max_depth: int | None = None,
    max_leaf: int = 0,
    clip: bool = True,
    threads: int | None = None,
    memory_budget: int | None = None,
    progress: Progress | None = None,
) -> Tree:
    """Builds the exact-SAH kd-tree of a mesh.

    The same mesh and options give the same tree, byte for byte, on every machine and with any
    number of threads. [WH06]

    Parameters
    ----------
    vertices
        `(n, 3)`, float32 or float64; other numbers are converted. Far from the origin, in units
        that are huge or tiny: the tree finds itself a frame near the mesh.
    faces
        `(m, 3)`, integers: three vertices a triangle.
    device
        Where the tree is built, and its rays are answered; the tree and the answers have the same
        bits everywhere. `"auto"`: a GPU if there is one that is not a program, and otherwise, or
        if that fails, the CPU; `Tree.device` says which. `"cpu"`; `"gpu"`, the best there is; or
        one of `kdray.devices()`, its index, or a part of its name. [WZL11]
    builder
        `"exact"`: O(N log N). `"resort"` and `"naive"` give the same tree, more slowly and on the
        CPU only; `"naive"`, O(N²), looks between nodes whether to end.
    cost_traversal, cost_intersect, empty_bonus
        What a ray is thought to pay for a step and for a triangle, between 1e-6 and 1e6, and how
        much cutting off empty space is favoured, in 0..1. By default what was measured to be fast.
    max_depth
        Depth at which every node is a leaf, at most 255; by default `8 + 1.3 log2 m`.
    max_leaf
        Nodes of at most this many references are leaves. More makes the tree smaller; 0 leaves it
        to the cost.
    clip
        Whether triangles are clipped to their nodes. Without, the build is faster and rays slower.
    threads
        Threads that build, on the CPU; by default one a core.
    memory_budget
        Bytes the build may have allocated on its device at any time, the tree included and, on
        the CPU, the mesh not.
    progress
        Called now and then, on the calling thread, with the fraction that is done; what it raises
        ends the build.

    Raises
    ------
    ValueError
        A wrong shape, a vertex that is not finite, an index or an option out of range, or no such
        device.
    TypeError
        Arrays that are not of numbers.
    MemoryError
        The memory budget, or the device, cannot hold the build.
    OSError
        The device failed.

    Examples
    --------
    >>> import kdray
    >>> kdray.build([[0., 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    kdray.Tree(1 triangle, 3 vertices, 1 node, bounds [0 0 0] to [1 1 0])
    """
    points = vertex_rows(vertices)
    traversal, intersect, bonus = _kdray.default_cost()
    options = {
        "device": device_word(device),
        "builder": builder,
        "cost_traversal": traversal if cost_traversal is None else cost_traversal,
        "cost_intersect": intersect if cost_intersect is None else cost_intersect,
        "empty_bonus": bonus if empty_bonus is None else empty_bonus,
        "max_depth": None if max_depth is None else whole("max_depth", max_depth, 0),
        "max_leaf": whole("max_leaf", max_leaf, 0),
        "clip": clip,
        "threads": thread_count(threads),
        "memory_budget": None
        if memory_budget is None
        else whole("memory_budget", memory_budget, 0, 2**63),
        "progress": progress,
    }
    return Tree(_kdray.Tree.build(points, face_rows(faces, len(points)), options))


class Tree:
    """A mesh, its kd-tree, and the queries they allow; made by `kdray.build` and `Tree.open`.

    A tree does not change, so threads can share it. Queries run on all cores (or on `threads`),
    without the interpreter's lock, and end with KeyboardInterrupt on Ctrl-C. On a tree that is on
    a GPU, rays are answered there, unless there is a `mask`; all else on the CPU.

    Queries take arrays of any leading shape, `(…, 3)`, and answer in that shape; float32 and
    float64 arrays are not copied. Coordinates are those of the mesh's vertices. A ray
    or point that is not finite hits, finds and is in nothing.

    >>> import kdray
    >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
    >>> tree
    kdray.Tree(1 triangle, 3 vertices, 1 node, bounds [0 0 0] to [4 4 0])
    """

    __slots__ = ("_tree",)

    def __init__(self, tree: _kdray.Tree) -> None:
        self._tree = tree

    # Queries with rays.

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

    # Queries with points.

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

    # Pictures.

    def render(
        self,
        width: int = 960,
        height: int = 640,
        *,
        shading: str = "path",
        samples: int | None = None,
        eye: ArrayLike | None = None,
        target: ArrayLike | None = None,
        up: ArrayLike = (0.0, 1.0, 0.0),
        fov: float = 35.0,
        ground: bool = True,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> NDArray[np.uint8]:
        """A picture of the mesh: sRGB, `(height, width, 3)`, from the top left.

        `shading` is `"path"` (sun and sky), `"ao"` (ambient occlusion), `"normals"`, or `"cost"`:
        what each pixel's rays cost in the tree. Without `eye` and `target` all of the mesh is in
        view. `fov` is the vertical field of view in degrees.

        Examples
        --------
        >>> import kdray
        >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> tree.render(64, 48, shading="normals").shape
        (48, 64, 3)
        """
        if positive("width", width) * positive("height", height) > 1 << 28:
            raise ValueError(f"width and height are {width} and {height}: too many pixels")
        if not 0.0 < fov < 180.0:
            raise ValueError(f"fov is {fov}; an angle between 0 and 180 degrees is expected")
        options = {
            "width": width,
            "height": height,
            "shading": shading,
            "samples": None if samples is None else positive("samples", samples),
            "eye": None if eye is None else point("eye", eye),
            "target": None if target is None else point("target", target),
            "up": point("up", up),
            "fov": fov,
            "ground": ground,
            "threads": thread_count(threads),
            "progress": progress,
        }
        return self._tree.render(options)

    # The tree itself.

    @property
    def triangle_count(self) -> int:
        """How many triangles the mesh has.

        >>> import kdray
        >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> tree.triangle_count
        1
        """
        return self._tree.triangle_count

    @property
    def vertex_count(self) -> int:
        """How many vertices the mesh has.

        >>> import kdray
        >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> tree.vertex_count
        3
        """
        return self._tree.vertex_count

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Lower and upper corner of the mesh's box, `(2, 3)`.

        >>> import kdray
        >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> tree.bounds
        array([[0., 0., 0.],
               [4., 4., 0.]])
        """
        return self._tree.bounds

    @property
    def vertices(self) -> NDArray[np.float64]:
        """The vertices `(n, 3)` as the tree keeps them: in f32, near the mesh if it is far away; a
        copy.

        >>> import kdray
        >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> tree.vertices[1]
        array([4., 0., 0.])
        """
        return self._tree.vertices()

    @property
    def faces(self) -> NDArray[np.int32]:
        """Three vertices a triangle, `(m, 3)`; a copy.

        >>> import kdray
        >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> tree.faces
        array([[0, 1, 2]], dtype=int32)
        """
        return self._tree.faces()

    @property
    def device(self) -> str:
        """Where rays are answered: `"cpu"`, or the name of a GPU.

        >>> import kdray
        >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> tree.to("cpu").device
        'cpu'
        """
        gpu = self._tree.gpu
        return "cpu" if gpu is None else gpu[1]

    @property
    def stats(self) -> Stats:
        """What the tree is like. Costs one pass over its nodes.

        >>> import kdray
        >>> kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]]).stats.leaves
        1
        """
        return Stats(**self._tree.stats())

    def validate(self) -> None:
        """Proves the tree against the geometry of its mesh; costs about as much as the build.

        Raises
        ------
        ValueError
            The first violation, in words.

        Examples
        --------
        >>> import kdray
        >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> tree.validate()
        """
        self._tree.validate()

    def to(self, device: Device | str | int) -> Tree:
        """The same tree on a device, named as for `kdray.build`; itself, if it is there.

        Raises
        ------
        ValueError
            There is no such device.
        MemoryError
            The device cannot hold the tree.
        OSError
            The device failed.

        Examples
        --------
        >>> import kdray
        >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> tree.to("cpu").device
        'cpu'
        """
        moved = self._tree.to(device_word(device))
        return self if moved.gpu == self._tree.gpu else Tree(moved)

    # Keeping it.

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the mesh and its tree into one file, which `Tree.open` reads.

        The file appears in one piece: what was there before stays until all is written.

        Raises
        ------
        OSError
            The file cannot be written.

        Examples
        --------
        >>> import kdray, os, tempfile
        >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> tree.save(os.path.join(tempfile.mkdtemp(), "triangle.kdray"))
        """
        path = os.fspath(path)
        folder = os.path.dirname(path) or "."
        handle, temporary = tempfile.mkstemp(prefix=os.path.basename(path), dir=folder)
        try:
            with open(handle, "wb") as file:
                file.write(self._tree.to_bytes())
            os.chmod(temporary, 0o666 & ~_umask())
            os.replace(temporary, path)
        except BaseException:
            # After a Ctrl-C it may be in its place already.
            with contextlib.suppress(FileNotFoundError):
                os.unlink(temporary)
            raise

    @staticmethod
    def open(
        path: str | os.PathLike[str],
        vertices: ArrayLike | None = None,
        faces: ArrayLike | None = None,
    ) -> Tree:
        """Opens what `save` wrote, or what `kdray build` wrote for the mesh that is given.

        Nothing is built: the file is mapped into memory and checked, and its nodes are used where
        they are, so processes share them.

        Raises
        ------
        OSError
            The file cannot be read.
        ValueError
            The file is damaged, or of another mesh.

        Examples
        --------
        >>> import kdray, os, tempfile
        >>> tree = kdray.build([[0., 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        >>> path = os.path.join(tempfile.mkdtemp(), "triangle.kdray")
        >>> tree.save(path)
        >>> kdray.Tree.open(path)
        kdray.Tree(1 triangle, 3 vertices, 1 node, bounds [0 0 0] to [1 1 0])
        """
        path = os.fspath(path)
        if vertices is None and faces is None:
            return Tree(_kdray.Tree.open(path))
        if vertices is None or faces is None:
            raise ValueError("vertices and faces go together")
        points = vertex_rows(vertices)
        return Tree(_kdray.Tree.open(path, (points, face_rows(faces, len(points)))))

    # A pickle knows of no devices: what comes of it is on the CPU.
    def __reduce__(self) -> tuple[Any, ...]:
        return _from_bytes, (self._tree.to_bytes(),)

    def __copy__(self) -> Tree:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Tree:
        return self

    def __repr__(self) -> str:
        stats = self.stats
        lower, upper = (" ".join(f"{x:.5g}" for x in corner) for corner in self.bounds)
        place = "" if self.device == "cpu" else f", on {self.device}"
        return (
            f"kdray.Tree({_count(self.triangle_count, 'triangle')}, "
            f"{_count(self.vertex_count, 'vertex', 'vertices')}, "
            f"{_count(stats.nodes, 'node')}, bounds [{lower}] to [{upper}]{place})"
        )

    # For the results.

    def _points(self, triangle: NDArray[Any], u: NDArray[Any], v: NDArray[Any]) -> NDArray[Any]:
        return self._tree.points(triangle, u, v).reshape(*triangle.shape, 3)

    def _normals(self, triangle: NDArray[Any]) -> NDArray[Any]:
        return self._tree.normals(triangle).reshape(*triangle.shape, 3)


def is_winding(sign: str) -> bool:
    """Whether the winding number tells inside from outside, and not the parity of crossings."""
    if sign not in ("parity", "winding"):
        raise ValueError(f"sign is {sign!r}; 'parity' or 'winding' is expected")
    return sign == "winding"


def point(name: str, value: ArrayLike) -> list[float]:
    """One finite point or direction."""
    numbers = vectors(name, value)
    if numbers.shape != (3,) or not np.isfinite(numbers).all():
        raise ValueError(
            f"{name} is {np.asarray(value).tolist()}; three finite numbers are expected"
        )
    return [float(number) for number in numbers]


def _from_bytes(data: bytes) -> Tree:
    """For pickles."""
    return Tree(_kdray.Tree.from_bytes(data))


def _count(number: int, one: str, many: str | None = None) -> str:
    return f"{number:,} {one if number == 1 else many or one + 's'}"


def _umask() -> int:
    """What the process takes away from the rights of its files."""
    mask = os.umask(0o077)
    os.umask(mask)
    return mask
