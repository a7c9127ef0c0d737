"""A depth picture, in the words of Open3D; Open3D itself is not needed."""

import numpy as np

import kdray
from kdray.open3d import RaycastingScene

scene = RaycastingScene()
vertices, faces = kdray.generate.torus_knot()
knot = scene.add_triangles(vertices, faces)

rays = RaycastingScene.create_rays_pinhole(
    fov_deg=50, center=[0, 0, 0], eye=[2, 3, 2], up=[0, 0, 1], width_px=320, height_px=240
)
ans = scene.cast_rays(rays)
hit = ans["geometry_ids"] == knot
print(f"{hit.mean():.1%} of the picture; depth {ans['t_hit'][hit].min():.3f} to", end=" ")
print(f"{ans['t_hit'][hit].max():.3f}")
print("inside:", scene.compute_occupancy(np.array([[1.4, 0, 0], [0, 0, 0]])).tolist())
