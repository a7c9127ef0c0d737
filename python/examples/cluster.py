"""Ten million rays on a cluster of processes: `python cluster.py [RAYS]`."""

import sys
import tempfile
from pathlib import Path

import dask.array as da
from distributed import Client, LocalCluster

import kdray
import kdray.dask

if __name__ == "__main__":
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000_000
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "knot.kdray")
        kdray.build(*kdray.generate.torus_knot()).save(path)

        with LocalCluster(n_workers=2, threads_per_worker=1) as cluster, Client(cluster) as client:
            print("dashboard:", client.dashboard_link)
            origins = da.random.uniform(-1.6, 1.6, (count, 3), chunks=(1_000_000, 3))
            hits = kdray.dask.closest_hit(path, origins, [0.0, 0.0, 1.0])
            share = (hits.triangle >= 0).mean().compute()
    print(f"{share:.2%} of {count:,} rays hit")
