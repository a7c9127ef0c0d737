"""Scenes and oracles that the tests share."""

from __future__ import annotations

import ctypes
import os
import sys
import tempfile
from pathlib import Path

import numpy as np
import pytest

import kdray


def icosphere(level=2, dtype=np.float64):
    """A closed sphere of radius 1 around the origin."""
    golden = (1 + 5**0.5) / 2
    plane = np.array([[-1, golden], [1, golden], [-1, -golden], [1, -golden]])
    corners = np.zeros((12, 3))
    corners[0:4, :2], corners[4:8, 1:], corners[8:12, 2], corners[8:12, 0] = plane, plane, *plane.T
    faces = [
        [0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11], [1, 5, 9], [5, 11, 4],
        [11, 10, 2], [10, 7, 6], [7, 1, 8], [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8],
        [3, 8, 9], [4, 9, 5], [2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1],
    ]  # fmt: skip
    faces = np.array(faces)
    for _ in range(level):
        edges = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        unique, place = np.unique(edges, axis=0, return_inverse=True)
        middle = place.reshape(-1, 3) + len(corners)
        corners = np.concatenate([corners, corners[unique].mean(axis=1)])
        (a, b, c), (ab, bc, ca) = faces.T, middle.T
        faces = np.stack([a, ab, ca, b, bc, ab, c, ca, bc, ab, bc, ca], axis=1).reshape(-1, 3)
    corners /= np.linalg.norm(corners, axis=1, keepdims=True)
    return corners.astype(dtype), faces


def cube(lower=0.0, upper=1.0):
    """A closed box of twelve triangles, seen counter-clockwise from outside."""
    corners = np.array(
        [[x, y, z] for x in (lower, upper) for y in (lower, upper) for z in (lower, upper)]
    )
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    faces = [face for a, b, c, d in quads for face in ([a, b, c], [a, c, d])]
    return corners.astype(np.float64), np.array(faces)


def soup(count=200, seed=1, dtype=np.float32):
    """Triangles anywhere."""
    random = np.random.default_rng(seed)
    centers = random.uniform(-1, 1, (count, 1, 3))
    corners = (centers + random.normal(0, 0.2, (count, 3, 3))).astype(dtype)
    return corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3)


def random_rays(count=500, seed=2, dtype=np.float32):
    random = np.random.default_rng(seed)
    origins = random.uniform(-2, 2, (count, 3)).astype(dtype)
    directions = (random.uniform(-1, 1, (count, 3)) - origins).astype(dtype)
    return origins, directions


def crossings(vertices, faces, origins, directions):
    """By ray and triangle: `t`, or infinity where the ray misses by more than a rounding."""
    a, b, c = np.asarray(vertices, np.float64)[np.asarray(faces)].transpose(1, 0, 2)
    o, d = (np.asarray(x, np.float64)[:, None] for x in (origins, directions))
    e, f = b - a, c - a
    p = np.cross(d, f)
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = 1 / (p * e).sum(-1)
        u = ((o - a) * p).sum(-1) * inverse
        q = np.cross(o - a, e)
        v = (d * q).sum(-1) * inverse
        t = (f * q).sum(-1) * inverse
        hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (t >= 0)
    return np.where(hit, t, np.inf)


@pytest.fixture(scope="session")
def sphere():
    return kdray.build(*icosphere(3))


@pytest.fixture(scope="session")
def triangle():
    return kdray.build([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])


DRIVERS = Path(__file__).parents[2] / "target" / "vulkan"


@pytest.fixture(scope="session")
def gpu():
    """The name of a GPU: that in `KDRAY_TEST_GPU`, or Mesa's program, which `.ci/vulkan` brings."""
    if named := os.environ.get("KDRAY_TEST_GPU"):
        return named
    if sys.platform != "linux":
        pytest.skip("name a GPU in KDRAY_TEST_GPU")
    use_drivers()
    return "llvmpipe"


def use_drivers():
    """Makes software Vulkan known to this process."""
    manifests = [DRIVERS / name for name in ("lavapipe.json", "swiftshader.json")]
    assert all(manifest.exists() for manifest in manifests), (
        "there are no software Vulkan drivers: run .ci/vulkan, or name a GPU in KDRAY_TEST_GPU"
    )
    paths = os.pathsep.join(map(str, manifests))
    # The second name is the one that older loaders know; Mesa complains without a folder.
    os.environ.update(VK_DRIVER_FILES=paths, VK_ICD_FILENAMES=paths)
    os.environ.setdefault("XDG_RUNTIME_DIR", tempfile.gettempdir())
    # Whoever asks for one of these by its name then gets it, as from the library path. They need
    # each other, in no order that is known.
    waiting = list((DRIVERS / "lib").iterdir())
    while waiting:
        waiting, tried = [path for path in waiting if not can_load(path)], len(waiting)
        assert len(waiting) < tried, f"cannot load {waiting}"


def can_load(path):
    try:
        ctypes.CDLL(str(path))
    except OSError:
        return False
    return True
