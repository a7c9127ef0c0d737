"""Slices through a mesh, of inside and of distance: `python slices.py [MESH [PICTURE]]`."""

import sys

import numpy as np

import kdray

mesh = kdray.load(sys.argv[1]) if len(sys.argv) > 1 else kdray.generate.torus_knot()
tree = kdray.build(*mesh)

lower, upper = tree.bounds
x, y = (np.linspace(lower[axis], upper[axis], 300) for axis in (0, 1))
middle = (lower[2] + upper[2]) / 2
points = np.stack(np.meshgrid(x, y[::-1], [middle]), axis=-1)[:, :, 0]

inside = tree.contains(points)
distance = tree.signed_distance(points)
assert (inside == (distance < 0)).all()
print(f"{inside.mean():.1%} of the slice is inside; the deepest point {-distance.min():.4g} deep")

if len(sys.argv) > 2:
    import matplotlib.image

    reach = np.abs(distance).max()
    matplotlib.image.imsave(sys.argv[2], distance, cmap="RdBu", vmin=-reach, vmax=reach)
