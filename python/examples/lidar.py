"""A lidar that drives past a scene: echoes and point cloud. `python lidar.py [MESH]`."""

import sys

import numpy as np

import kdray

mesh = kdray.load(sys.argv[1]) if len(sys.argv) > 1 else kdray.generate.showcase(50_000)
tree = kdray.build(*mesh)
lower, upper = tree.bounds
size = np.linalg.norm(upper - lower)

# 20 places, 32 beams, a turn of 720 steps each.
places = np.linspace(lower, upper, 20)
places[:, 1] = upper[1] + 0.1 * size
turn = np.linspace(0, 2 * np.pi, 720, endpoint=False)
tilt = np.radians(np.linspace(-60, -5, 32))[:, None]
beams = np.stack(
    [np.cos(tilt) * np.cos(turn), np.sin(tilt) + 0 * turn, np.cos(tilt) * np.sin(turn)], -1
)

hits = tree.closest_hit(places[:, None, None], beams, t_max=2 * size)
echoes = tree.count_hits(places[:, None, None], beams, t_max=2 * size)
cloud = hits.points[hits.mask]
print(f"{hits.mask.size:,} beams, {len(cloud):,} first echoes, {echoes.sum():,} in all")
print(f"ranges from {hits.t[hits.mask].min():.3f} to {hits.t[hits.mask].max():.3f}")
