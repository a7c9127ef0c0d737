"""The first hit of a million rays, and how fast: `python hits.py [MESH]`."""

import sys
import time

import numpy as np

import kdray

mesh = kdray.load(sys.argv[1]) if len(sys.argv) > 1 else kdray.generate.torus_knot()
tree = kdray.build(*mesh)
print(tree)

# From a sphere around the mesh to points within it.
random = np.random.default_rng(1)
lower, upper = tree.bounds
outward = random.normal(size=(1_000_000, 3))
outward /= np.linalg.norm(outward, axis=1, keepdims=True)
origins = (lower + upper) / 2 + np.linalg.norm(upper - lower) * outward
targets = random.uniform(lower, upper, origins.shape)

start = time.perf_counter()
hits = tree.closest_hit(origins, targets - origins)
seconds = time.perf_counter() - start
print(
    f"{hits.mask.mean():.1%} of the rays hit; {len(origins) / seconds / 1e6:.2f} million a second"
)
print("mean of the points:", hits.points[hits.mask].mean(axis=0).round(3))
