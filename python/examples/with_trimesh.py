"""trimesh, with kdray behind `mesh.ray` and `mesh.nearest`."""

import trimesh

import kdray.trimesh

kdray.trimesh.install()

mesh = trimesh.creation.torus(2.0, 0.7)
locations, index_ray, index_tri = mesh.ray.intersects_location(
    [[2, 0, 5], [0, 0, 5]], [[0, 0, -1]] * 2
)
print("hits at", locations.round(3).tolist(), "of rays", index_ray.tolist())
print("inside:", mesh.contains([[2, 0, 0], [0, 0, 0]]).tolist())
print("signed distance:", mesh.nearest.signed_distance([[2, 0, 0]]).round(3).tolist())
