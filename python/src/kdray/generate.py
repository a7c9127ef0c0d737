"""Meshes of any size to try things with: the same, bit for bit, on every machine."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from . import _kdray
from ._arrays import whole

__all__ = ["showcase", "sphere", "torus_knot"]

Mesh = tuple[NDArray[np.float64], NDArray[np.int32]]


def sphere(subdivisions: int = 4) -> Mesh:
    """A closed sphere of radius 1 around the origin, of `20 * 4**subdivisions` triangles.

    >>> sphere(2)[1].shape
    (320, 3)
    """
    return _kdray.sphere(whole("subdivisions", subdivisions, 0, 10))


def torus_knot(windings: tuple[int, int] = (2, 3), segments: int = 400, sides: int = 32) -> Mesh:
    """A closed tube along a knot that winds around a torus, of `2 * segments * sides` triangles.

    >>> torus_knot(segments=100, sides=10)[1].shape
    (2000, 3)
    """
    p, q = (whole("windings", winding, 1, 99) for winding in windings)
    tube = whole("segments", segments, 3, 1 << 14), whole("sides", sides, 3, 1 << 12)
    return _kdray.torus_knot((p, q), *tube)


def showcase(triangles: int = 100_000) -> Mesh:
    """A still life of knots, spheres and a gear on a floor, of about that many triangles.

    >>> showcase(50_000)[1].shape
    (50000, 3)
    """
    return _kdray.showcase(whole("triangles", triangles, 1, 100_000_000))
