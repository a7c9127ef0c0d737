"""An X-ray picture: how much of each ray is inside. `python xray.py [MESH [PICTURE]]`."""

import sys

import numpy as np

import kdray


def inside_length(tree, origins, directions):
    """By ray, the length that lies inside a closed mesh: every other stretch between crossings."""
    hits = tree.all_hits(origins, directions)
    place = np.arange(len(hits.t)) - hits.offsets[hits.ray]
    signed = np.where(place % 2 == 0, -hits.t, hits.t)
    lengths = np.bincount(hits.ray, signed, minlength=origins[..., 0].size)
    return lengths.reshape(origins.shape[:-1]) * np.linalg.norm(directions)


if __name__ == "__main__":
    mesh = kdray.load(sys.argv[1]) if len(sys.argv) > 1 else kdray.generate.torus_knot()
    tree = kdray.build(*mesh)
    lower, upper = tree.bounds
    x, y = (np.linspace(lower[axis], upper[axis], 400) for axis in (0, 1))
    origins = np.stack(np.meshgrid(x, y[::-1], [upper[2] + 1]), axis=-1)[:, :, 0]
    length = inside_length(tree, origins, np.array([0, 0, -1.0]))
    print(f"at most {length.max():.4g} inside, {length.mean():.4g} on average")
    if len(sys.argv) > 2:
        import matplotlib.image

        matplotlib.image.imsave(sys.argv[2], np.exp(-length / length.max() * 3), cmap="gray")
