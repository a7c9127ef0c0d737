"""What trimesh has for rays and distances, answered by kdray.

>>> import trimesh
>>> from kdray.trimesh import RayMeshIntersector
>>> ray = RayMeshIntersector(trimesh.creation.box())
>>> ray.intersects_any([[0, 0, 2], [2, 0, 2]], [[0, 0, -1], [0, 0, -1]])
array([ True, False])

`kdray.trimesh.ray_pyembree` and `kdray.trimesh.ray_triangle` have the argument orders and dtypes of
trimesh's modules of these names, so that changing the import is all there is to change;
`RayMeshIntersector` here is the first of them, as in a `mesh.ray` with embreex. After `install()`
every new mesh uses them.

Where answers differ from trimesh's: hits are sorted by ray and then by distance; each crossing
comes once and none is lost, whatever edge or vertex the ray passes through; there are as many as
there are, unless `max_hits` says otherwise; no hits are an array of shape `(0, 3)`. Of several
closest triangles it is the one with the lowest index.
"""

from __future__ import annotations

from typing import Any

try:
    import trimesh
    from trimesh import proximity
except ModuleNotFoundError as error:
    message = f"kdray.trimesh needs {error.name}: pip install kdray[trimesh]"
    raise ModuleNotFoundError(message, name=error.name) from error

from . import ray_pyembree, ray_triangle
from ._proximity import ProximityQuery, closest_point, signed_distance
from .ray_pyembree import RayMeshIntersector

__all__ = [
    "ProximityQuery",
    "RayMeshIntersector",
    "closest_point",
    "install",
    "ray_pyembree",
    "ray_triangle",
    "signed_distance",
    "uninstall",
]

# Where trimesh looks for what a new mesh gets.
_PLACES: tuple[tuple[Any, str, Any], ...] = (
    (trimesh.ray, "has_embree", True),
    (trimesh.ray, "ray_pyembree", ray_pyembree),
    (trimesh.ray, "ray_triangle", ray_triangle),
    (proximity, "ProximityQuery", ProximityQuery),
)

_before: dict[tuple[Any, str], Any] = {}


def install() -> None:
    """Makes `mesh.ray` and `mesh.nearest` of meshes that are made from now on use kdray.

    >>> import kdray.trimesh, trimesh
    >>> kdray.trimesh.install()
    >>> mesh = trimesh.creation.icosphere()
    >>> type(mesh.ray).__module__
    'kdray.trimesh.ray_pyembree'
    >>> kdray.trimesh.uninstall()
    """
    for holder, name, ours in _PLACES:
        _before.setdefault((holder, name), getattr(holder, name))
        setattr(holder, name, ours)


def uninstall() -> None:
    """Undoes `install`, for meshes that are made from now on."""
    for (holder, name), theirs in _before.items():
        setattr(holder, name, theirs)
    _before.clear()
