"""Queries on dask arrays: blocks go to workers, which open the tree's file once each.

>>> import dask.array as da
>>> import kdray, kdray.dask, os, tempfile
>>> path = os.path.join(tempfile.mkdtemp(), "triangle.kdray")
>>> kdray.build([[0., 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).save(path)
>>> origins = da.random.uniform(0, 1, (1000, 3), chunks=(100, 3)) * [1, 1, 0] + [0, 0, 1]
>>> hits = kdray.dask.closest_hit(path, origins, [0.0, 0, -1])
>>> hits.t.shape, float(hits.t.min().compute())
((1000,), 1.0)

A tree is given by the path of a file of `Tree.save`, which every worker must be able to read and
maps into its memory, so that the workers of a machine share it; or as a `Tree`, which is sent to
the workers. Nothing is computed until dask is asked; a block whose worker is lost is asked again
elsewhere, and gives the same answers.

Queries run on as many threads as their worker has for them (`threads=1`, unless said otherwise):
dask runs several blocks at a time.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import lru_cache
from typing import Any, NamedTuple, Union

import numpy as np

try:
    import dask.array as da
    from dask.base import tokenize
    from dask.delayed import delayed
except ModuleNotFoundError as error:
    message = f"kdray.dask needs {error.name}: pip install kdray[dask]"
    raise ModuleNotFoundError(message, name=error.name) from error

from ._results import AllHits, ClosestPoints, Hits
from ._tree import Tree

__all__ = [
    "all_hits",
    "any_hit",
    "closest_hit",
    "closest_point",
    "contains",
    "count_hits",
    "signed_distance",
    "winding_number",
    "within_box",
    "within_sphere",
]

TreeOrPath = Union[Tree, str, "os.PathLike[str]"]

_HIT = np.dtype([("t", "f4"), ("triangle", "i4"), ("u", "f4"), ("v", "f4")])
_CLOSEST = np.dtype(
    [("point", "f8", (3,)), ("distance", "f8"), ("triangle", "i4"), ("u", "f4"), ("v", "f4")]
)


class DaskHits(NamedTuple):
    """`Hits`, as dask arrays of the rays' shape."""

    t: Any
    triangle: Any
    u: Any
    v: Any


class DaskClosestPoints(NamedTuple):
    """`ClosestPoints`, as dask arrays: `point` `(…, 3)`, and the others `(…)`."""

    point: Any
    distance: Any
    triangle: Any
    u: Any
    v: Any


def closest_hit(tree: TreeOrPath, origins: Any, directions: Any, **options: Any) -> DaskHits:
    """`Tree.closest_hit` of rays in blocks: four arrays of the rays' shape.

    >>> import dask.array as da
    >>> import kdray.dask
    >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
    >>> points = da.from_array([[1., 1, 2], [5, 5, 2]], chunks=(1, 3))
    >>> closest_hit(tree, points, [0.0, 0, -1]).t.compute()
    array([ 2., inf], dtype=float32)
    """
    records = _ask(_closest_hit, _HIT, tree, (origins, directions), options)
    return DaskHits(*(records[name] for name in _HIT.names or ()))


def any_hit(tree: TreeOrPath, origins: Any, directions: Any, **options: Any) -> Any:
    """`Tree.any_hit` of rays in blocks.

    >>> import dask.array as da
    >>> import kdray.dask
    >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
    >>> points = da.from_array([[1., 1, 2], [5, 5, 2]], chunks=(1, 3))
    >>> any_hit(tree, points, [0.0, 0, -1]).compute()
    array([ True, False])
    """
    return _ask(Tree.any_hit, np.dtype(bool), tree, (origins, directions), options)


def count_hits(tree: TreeOrPath, origins: Any, directions: Any, **options: Any) -> Any:
    """`Tree.count_hits` of rays in blocks.

    >>> import dask.array as da
    >>> import kdray.dask
    >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
    >>> points = da.from_array([[1., 1, 2], [5, 5, 2]], chunks=(1, 3))
    >>> count_hits(tree, points, [0.0, 0, -1]).compute()
    array([1, 0], dtype=int32)
    """
    return _ask(Tree.count_hits, np.dtype(np.int32), tree, (origins, directions), options)


def all_hits(tree: TreeOrPath, origins: Any, directions: Any, **options: Any) -> list[Any]:
    """`Tree.all_hits` of rays in blocks: a delayed `AllHits` for each block, in order.

    They come without the tree, and so without `points` and `normals`.

    >>> import dask.array as da
    >>> import kdray.dask
    >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
    >>> points = da.from_array([[1., 1, 2], [5, 5, 2]], chunks=(1, 3))
    >>> [block.compute().offsets for block in all_hits(tree, points, [0.0, 0, -1])]
    [array([0, 1]), array([0, 0])]
    """
    return _lists(_all_hits, tree, (origins, directions), options)


def contains(tree: TreeOrPath, points: Any, **options: Any) -> Any:
    """`Tree.contains` of points in blocks.

    >>> import dask.array as da
    >>> import kdray.dask
    >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
    >>> points = da.from_array([[1., 1, 2], [5, 5, 2]], chunks=(1, 3))
    >>> contains(tree, points).compute()
    array([False, False])
    """
    return _ask(Tree.contains, np.dtype(bool), tree, (points,), options)


def signed_distance(tree: TreeOrPath, points: Any, **options: Any) -> Any:
    """`Tree.signed_distance` of points in blocks, in float64.

    >>> import dask.array as da
    >>> import kdray.dask
    >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
    >>> points = da.from_array([[1., 1, 2], [5, 5, 2]], chunks=(1, 3))
    >>> abs(signed_distance(tree, points)).compute()[0]
    np.float64(2.0)
    """
    return _ask(_signed_distance, np.dtype(np.float64), tree, (points,), options)


def winding_number(tree: TreeOrPath, points: Any, **options: Any) -> Any:
    """`Tree.winding_number` of points in blocks.

    >>> import dask.array as da
    >>> import kdray.dask
    >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
    >>> points = da.from_array([[1., 1, 2], [5, 5, 2]], chunks=(1, 3))
    >>> winding_number(tree, points).compute().shape
    (2,)
    """
    return _ask(Tree.winding_number, np.dtype(np.float64), tree, (points,), options)


def closest_point(tree: TreeOrPath, points: Any, **options: Any) -> DaskClosestPoints:
    """`Tree.closest_point` of points in blocks, in float64.

    >>> import dask.array as da
    >>> import kdray.dask
    >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
    >>> points = da.from_array([[1., 1, 2], [5, 5, 2]], chunks=(1, 3))
    >>> closest_point(tree, points).point.compute()[0]
    array([1., 1., 0.])
    """
    records = _ask(_closest_point, _CLOSEST, tree, (points,), options)
    place = records.map_blocks(
        _places, dtype=np.float64, new_axis=records.ndim, chunks=(*records.chunks, (3,))
    )
    return DaskClosestPoints(place, *(records[name] for name in ("distance", "triangle", "u", "v")))


def within_sphere(tree: TreeOrPath, centers: Any, radius: float, **options: Any) -> list[Any]:
    """`Tree.within_sphere` of points in blocks: a delayed `Within` for each block, in order.

    >>> import dask.array as da
    >>> import kdray.dask
    >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
    >>> points = da.from_array([[1., 1, 2], [5, 5, 2]], chunks=(1, 3))
    >>> [block.compute().offsets for block in within_sphere(tree, points, 2.5)]
    [array([0, 1]), array([0, 0])]
    """
    return _lists(Tree.within_sphere, tree, (centers,), {"radius": radius, **options})


def within_box(tree: TreeOrPath, lower: Any, upper: Any, **options: Any) -> list[Any]:
    """`Tree.within_box` of boxes in blocks: a delayed `Within` for each block, in order.

    >>> import dask.array as da
    >>> import kdray.dask
    >>> tree = kdray.build([[0., 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
    >>> points = da.from_array([[1., 1, 2], [5, 5, 2]], chunks=(1, 3))
    >>> [block.compute().offsets for block in within_box(tree, points - 2, points + 2)]
    [array([0, 1]), array([0, 0])]
    """
    return _lists(Tree.within_box, tree, (lower, upper), options)


# How blocks are asked.

Ask = Callable[..., Any]


def _ask(
    ask: Ask,
    dtype: np.dtype[Any],
    tree: TreeOrPath,
    vectors: tuple[Any, ...],
    options: dict[str, Any],
) -> Any:
    """What `ask` says of each block, as one array of the vectors' leading shape."""
    blocks = _together(vectors)
    given = {"ask": ask, "tree": _sent(tree), "options": {"threads": 1, **options}}
    return da.map_blocks(
        _of_block,
        *blocks,
        dtype=dtype,
        drop_axis=blocks[0].ndim - 1,
        meta=np.empty((0,) * (blocks[0].ndim - 1), dtype),
        # What the dashboard shows.
        name=f"kdray-{ask.__name__.lstrip('_')}-{tokenize(blocks, given)}",
        **given,
    )


def _of_block(*vectors: Any, ask: Ask, tree: TreeOrPath, options: dict[str, Any]) -> Any:
    return ask(_opened(tree), *vectors, **options)


def _lists(
    ask: Ask, tree: TreeOrPath, vectors: tuple[Any, ...], options: dict[str, Any]
) -> list[Any]:
    """Delayed answers, block by block in C order."""
    blocks = _together(vectors)
    of_block = delayed(_of_block, pure=True)
    given = {"ask": ask, "tree": _sent(tree), "options": {"threads": 1, **options}}
    return [
        of_block(*block, **given) for block in zip(*(b.to_delayed().reshape(-1) for b in blocks))
    ]


def _together(vectors: tuple[Any, ...]) -> list[Any]:
    """Dask arrays of one shape `(…, 3)` and of the same blocks, each with all three columns."""
    arrays = [da.asarray(value) for value in vectors]
    for value in arrays:
        if value.ndim == 0 or value.shape[-1] != 3:
            raise ValueError(f"an array has shape {value.shape}; (…, 3) is expected")
    arrays = da.broadcast_arrays(*(value.rechunk({-1: 3}) for value in arrays))
    if arrays[0].ndim == 1:
        raise ValueError("a single ray or point has no blocks: ask the tree itself")
    _, arrays = da.core.unify_chunks(
        *(x for value in arrays for x in (value, tuple(range(value.ndim))))
    )
    return list(arrays)


def _sent(tree: TreeOrPath) -> TreeOrPath:
    """A path as workers understand it; a tree as it is."""
    return tree if isinstance(tree, Tree) else os.path.abspath(os.fspath(tree))


def _opened(tree: TreeOrPath) -> Tree:
    if isinstance(tree, Tree):
        return tree
    path = os.fspath(tree)
    status = os.stat(path)
    return _open(path, (status.st_mtime_ns, status.st_size, status.st_ino))


@lru_cache(maxsize=4)
def _open(path: str, version: tuple[int, ...]) -> Tree:
    """The tree in a file, once a process and version of the file."""
    return Tree.open(path)


def _signed_distance(tree: Tree, points: Any, **options: Any) -> Any:
    return tree.signed_distance(points, **options).astype(np.float64, copy=False)


def _all_hits(tree: Tree, origins: Any, directions: Any, **options: Any) -> AllHits:
    # Without the tree, which would come along with every block.
    return AllHits(*tree.all_hits(origins, directions, **options))


def _closest_hit(tree: Tree, origins: Any, directions: Any, **options: Any) -> Any:
    return _records(tree.closest_hit(origins, directions, **options), _HIT)


def _closest_point(tree: Tree, points: Any, **options: Any) -> Any:
    return _records(tree.closest_point(points, **options), _CLOSEST)


def _records(answer: Hits | ClosestPoints, dtype: np.dtype[Any]) -> Any:
    records = np.empty(answer.triangle.shape, dtype)
    for name, column in zip(dtype.names or (), answer):
        records[name] = column
    return records


def _places(records: Any) -> Any:
    return records["point"]
