"""The thickness of a closed mesh, along rays into it: `python thickness.py [MESH]`."""

import sys

import numpy as np

import kdray

mesh = kdray.load(sys.argv[1]) if len(sys.argv) > 1 else kdray.generate.torus_knot()
tree = kdray.build(*mesh)

# Into the mesh from the middle of every triangle, which itself does not count as a hit.
corners = tree.vertices[tree.faces]
normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
length = np.linalg.norm(normals, axis=1, keepdims=True)
inward = -normals / np.where(length > 0, length, 1)
hits = tree.closest_hit(corners.mean(axis=1), inward, exclude=np.arange(len(corners)))

thickness = hits.t[hits.mask]
print(f"{hits.mask.mean():.1%} of the triangles have something opposite")
print(
    f"thickness: {thickness.min():.4g} to {thickness.max():.4g}, median {np.median(thickness):.4g}"
)
