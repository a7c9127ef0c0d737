"""Building."""

from __future__ import annotations

from numpy.typing import ArrayLike

from . import _kdray
from ._arrays import face_rows, thread_count, vertex_rows, whole
from ._device import Device, device_word
from ._tree import Progress, Tree


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
