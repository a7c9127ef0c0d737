"""Brings arguments into the forms that the extension module expects; copies only where it must."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Shape = tuple[int, ...]
Floats = NDArray[Any]

_FLOATS = (np.dtype(np.float32), np.dtype(np.float64))


def array(name: str, value: Any) -> NDArray[Any]:
    """`value` as an array; shares memory with arrays, tensors on the CPU and the like."""
    if isinstance(value, np.ndarray):
        return value
    try:
        if hasattr(value, "__dlpack__"):
            return np.from_dlpack(value)
        return np.asarray(value)
    except (BufferError, RuntimeError, TypeError, ValueError) as error:
        raise TypeError(f"{name} is not an array that numpy can read: {error}") from error


def floats(name: str, value: ArrayLike) -> Floats:
    """`value` as aligned float32 or float64."""
    numbers = array(name, value)
    if numbers.dtype.kind not in "fiu":
        raise TypeError(f"{name} has dtype {numbers.dtype}; numbers are expected")
    dtype = numbers.dtype.newbyteorder("=")
    if dtype not in _FLOATS:
        dtype = np.dtype(np.float32 if dtype == np.float16 else np.float64)
    return np.require(numbers, dtype, "A")


def vectors(name: str, value: ArrayLike) -> Floats:
    """`value` as floats of the shape `(…, 3)`."""
    numbers = floats(name, value)
    if numbers.ndim == 0 or numbers.shape[-1] != 3:
        raise ValueError(f"{name} has shape {numbers.shape}; (…, 3) is expected")
    return numbers


def rows(numbers: Floats) -> Floats:
    """Vectors of any leading shape as rows."""
    return numbers.reshape(-1, 3)


def together(*named: tuple[str, Floats]) -> tuple[Shape, list[Floats]]:
    """Vectors of one dtype, broadcast to one leading shape; and that shape."""
    dtype = np.result_type(*(value for _, value in named))
    try:
        shape = np.broadcast_shapes(*(value.shape[:-1] for _, value in named))
    except ValueError:
        shapes = " and ".join(f"{name} {value.shape}" for name, value in named)
        raise ValueError(f"the shapes do not go together: {shapes}") from None
    full = (np.broadcast_to(value, (*shape, 3)) for _, value in named)
    return shape, [value.astype(dtype, copy=False) for value in full]


def scalars(name: str, value: ArrayLike, shape: Shape) -> float | Floats:
    """One float32, or one for each of `shape`, flat. NaN is refused."""
    numbers = floats(name, value)
    if np.isnan(numbers).any():
        raise ValueError(f"{name} is NaN" if numbers.ndim == 0 else f"{name} has a NaN")
    if numbers.ndim == 0:
        return float(numbers)
    with np.errstate(over="ignore"):
        return spread(name, numbers, shape, np.float32)


def indices(name: str, value: ArrayLike) -> NDArray[Any]:
    """`value` as an array of integers."""
    numbers = array(name, value)
    if numbers.dtype.kind not in "iu" and numbers.size > 0:
        raise TypeError(f"{name} has dtype {numbers.dtype}; integers are expected")
    return numbers


def spread(name: str, values: NDArray[Any], shape: Shape, dtype: Any) -> NDArray[Any]:
    """`values` of a dtype, broadcast to a shape and flat."""
    try:
        full = np.broadcast_to(values, shape)
    except ValueError:
        raise ValueError(f"{name} has shape {values.shape}; {shape} is expected") from None
    return np.require(full, dtype, ["C", "A"]).reshape(-1)


def vertex_rows(value: ArrayLike) -> Floats:
    """`value` as contiguous rows of three."""
    numbers = vectors("vertices", value)
    if numbers.ndim != 2:
        raise ValueError(f"vertices has shape {numbers.shape}; (n, 3) is expected")
    return np.ascontiguousarray(numbers)


def face_rows(value: ArrayLike, vertices: int) -> NDArray[np.uint32]:
    """`value` as rows of three vertex indices, all in range."""
    index = indices("faces", value)
    if index.ndim == 1 and index.size == 0:
        index = index.reshape(0, 3)
    if index.ndim != 2 or index.shape[1] != 3:
        raise ValueError(f"faces has shape {index.shape}; (n, 3) is expected")
    if index.size and (index.min() < 0 or index.max() >= vertices):
        place = int(np.flatnonzero(((index < 0) | (index >= vertices)).any(axis=1))[0])
        raise ValueError(
            f"faces[{place}] is {index[place].tolist()}; there are {vertices} vertices"
        )
    if index.dtype == np.int32:
        index = index.view(np.uint32)
    return np.require(index, np.uint32, ["C", "A"])


def whole(name: str, value: int, least: int, most: int = 2**32 - 1) -> int:
    """A whole number from `least` to `most`."""
    if isinstance(value, bool) or not hasattr(value, "__index__"):
        raise TypeError(f"{name} is {value!r}; a whole number is expected")
    if not least <= value <= most:
        raise ValueError(f"{name} is {value}; a number from {least} to {most} is expected")
    return int(value)


def positive(name: str, value: int) -> int:
    """A whole number of at least one."""
    return whole(name, value, 1)


def thread_count(value: int | None) -> int:
    """A number of threads; 0 for one a core."""
    return 0 if value is None else positive("threads", value)


class Rays(NamedTuple):
    """What a query with rays is asked, as the extension module takes it."""

    origins: Floats
    directions: Floats
    t_min: float | Floats
    t_max: float | Floats
    exclude: NDArray[np.int32] | None
    mask: NDArray[np.bool_] | None
    threads: int


def ray_arguments(
    origins: ArrayLike,
    directions: ArrayLike,
    t_min: ArrayLike,
    t_max: ArrayLike,
    exclude: ArrayLike | None,
    mask: ArrayLike | None,
    threads: int | None,
) -> tuple[Shape, Rays]:
    """The rays, and their leading shape."""
    named = (
        ("origins", vectors("origins", origins)),
        ("directions", vectors("directions", directions)),
    )
    shape, (starts, ways) = together(*named)
    excluded = None
    if exclude is not None:
        excluded = spread("exclude", indices("exclude", exclude), shape, np.int32)
    visible = None
    if mask is not None:
        visible = np.require(array("mask", mask), requirements=["C", "A"])
        if visible.dtype != np.bool_ or visible.ndim != 1:
            raise TypeError("mask must be one bool for each triangle")
    return shape, Rays(
        rows(starts),
        rows(ways),
        scalars("t_min", t_min, shape),
        scalars("t_max", t_max, shape),
        excluded,
        visible,
        thread_count(threads),
    )
