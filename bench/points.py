#!/usr/bin/env python3
"""All hits, closest points and signed distances: kdray beside Open3D and fcpw on the same files.

    pip install numpy open3d-cpu fcpw
    bench/points.py run --kdray target/release/kdray --meshes ../shared/meshes -o RECORD.json
    bench/points.py table RECORD.json

Engines take turns within a pass, on one thread each, and the best pass counts. Times are the CPU
seconds of the queries alone, arrays in and arrays out, so that a busy machine still ranks. kdray's
are the difference between commands that repeat the queries and one that does not. Inside is told by
parity, as Open3D does. fcpw lists all hits for one ray a call only, so its rate holds the calls
from Python.
"""

import argparse
import datetime
import importlib.metadata
import json
import os
import pathlib
import platform
import resource
import subprocess
import tempfile
import time

import numpy as np

KINDS = ["all", "closest-point", "signed-distance"]

# Times that kdray repeats queries, so that what it does once drops out.
REPEATS = 10


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    run = commands.add_parser("run", help="measure, and write a record")
    run.add_argument("--kdray", required=True, help="the command")
    run.add_argument("--meshes", required=True, type=pathlib.Path, help="the folder of the scenes")
    run.add_argument("--scenes", default="bunny,armadillo_86k", help="names of .ply files")
    run.add_argument("--queries", type=int, default=50_000)
    run.add_argument("--passes", type=int, default=3)
    run.add_argument("-o", "--output", required=True, type=pathlib.Path)
    table = commands.add_parser("table", help="print a record as Markdown")
    table.add_argument("record", type=pathlib.Path)
    arguments = parser.parse_args()
    if arguments.command == "run":
        arguments.output.write_text(json.dumps(measure(arguments), indent=1) + "\n")
    else:
        print_table(json.loads(arguments.record.read_text()))


def measure(arguments):
    rows = []
    for scene in arguments.scenes.split(","):
        path = arguments.meshes / f"{scene}.ply"
        with tempfile.TemporaryDirectory() as folder:
            rows += measure_scene(path, arguments, pathlib.Path(folder))
    return {
        "date": datetime.date.today().isoformat(),
        "cpu": cpu_name(),
        "cores": os.cpu_count(),
        "versions": {name: importlib.metadata.version(name) for name in ["open3d-cpu", "fcpw", "numpy"]},
        "queries": arguments.queries,
        "passes": arguments.passes,
        "rows": rows,
    }


def measure_scene(path, arguments, folder):
    vertices, triangles = load(path)
    write_queries(vertices[triangles].reshape(-1, 3), arguments.queries, folder)
    engines = [Kdray(arguments.kdray, path, folder)]
    engines += [engine(vertices, triangles, folder) for engine in [Open3d, Fcpw]]
    rows = []
    for kind in KINDS:
        able = [engine for engine in engines if hasattr(engine, name_of(kind))]
        best = {engine.name: float("inf") for engine in able}
        answers = {}
        for _ in range(arguments.passes):
            for engine in able:
                seconds, answers[engine.name] = getattr(engine, name_of(kind))()
                best[engine.name] = min(best[engine.name], seconds)
        for engine in able:
            row = {"scene": path.stem, "triangles": len(triangles), "kind": kind}
            row |= {"engine": engine.name, "cpu_s": best[engine.name]}
            row["differ"] = differ(kind, answers["kdray"], answers[engine.name])
            rows.append(row)
            print(row, flush=True)
    return rows


def name_of(kind):
    return kind.replace("-", "_")


def write_queries(corners, count, folder):
    """Lines through the box from a sphere around it, and points in a box a fifth larger."""
    random = np.random.default_rng(2011)
    lower, upper = corners.min(axis=0), corners.max(axis=0)
    center, half = (lower + upper) / 2, (upper - lower) / 2
    points = center + 1.2 * half * random.uniform(-1, 1, (count, 3))
    np.save(folder / "points.npy", points.astype(np.float32))
    outward = random.normal(size=(count, 3))
    origins = center + np.linalg.norm(half) * outward / np.linalg.norm(outward, axis=1)[:, None]
    targets = center + half * random.uniform(-1, 1, (count, 3))
    np.save(folder / "rays.npy", np.hstack([origins, targets - origins]).astype(np.float32))


class Kdray:
    name = "kdray"

    def __init__(self, command, mesh, folder):
        self.command = [command, "query", mesh, "--threads", "1", "--json"]
        self.folder = folder

    def ask(self, kind, file, *more):
        flag = "--rays" if file == "rays.npy" else "--points"
        out = self.folder / "kdray.npz"
        command = self.command + [flag, self.folder / file, "--kind", kind, "-o", out, *more]

        def cpu_seconds(repeat):
            before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
            subprocess.run(command + ["--repeat", str(repeat)], check=True, capture_output=True)
            return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before

        return (cpu_seconds(1 + REPEATS) - cpu_seconds(1)) / REPEATS, dict(np.load(out))

    def all(self):
        seconds, found = self.ask("all", "rays.npy")
        return seconds, np.diff(found["offsets"].astype(np.int64))

    def closest_point(self):
        seconds, found = self.ask("closest-point", "points.npy")
        return seconds, found["distance"]

    def signed_distance(self):
        seconds, found = self.ask("signed-distance", "points.npy", "--sign", "parity")
        return seconds, found["distance"]


class Open3d:
    """All hits come in no order, so sorting them is part of the work."""

    name = "open3d"

    def __init__(self, vertices, triangles, folder):
        import open3d

        self.scene = open3d.t.geometry.RaycastingScene(nthreads=1)
        tensor = open3d.core.Tensor
        self.scene.add_triangles(tensor(vertices), tensor(triangles.astype(np.uint32)))
        self.points = tensor(np.load(folder / "points.npy"))
        self.rays = tensor(np.load(folder / "rays.npy"))

    def all(self):
        def ask():
            found = self.scene.list_intersections(self.rays, nthreads=1)
            ray, t = found["ray_ids"].numpy(), found["t_hit"].numpy()
            order = np.lexsort((t, ray))
            return found["ray_splits"].numpy(), t[order], found["primitive_ids"].numpy()[order]

        seconds, (splits, _, _) = timed(ask)
        return seconds, np.diff(splits.astype(np.int64))

    def closest_point(self):
        seconds, found = timed(lambda: self.scene.compute_closest_points(self.points, nthreads=1))
        return seconds, np.linalg.norm(found["points"].numpy() - self.points.numpy(), axis=1)

    def signed_distance(self):
        ask = lambda: self.scene.compute_signed_distance(self.points, nthreads=1)
        seconds, found = timed(ask)
        return seconds, found.numpy()


class Fcpw:
    name = "fcpw"

    def __init__(self, vertices, triangles, folder):
        import fcpw

        self.fcpw = fcpw
        self.scene = fcpw.scene_3D()
        self.scene.set_object_count(1)
        self.scene.set_object_vertices(np.asfortranarray(vertices, dtype=np.float32), 0)
        self.scene.set_object_triangles(np.asfortranarray(triangles, dtype=np.int32), 0)
        self.scene.build(fcpw.aggregate_type.bvh_surface_area, True)
        self.points = np.asfortranarray(np.load(folder / "points.npy"))
        rays = np.load(folder / "rays.npy")
        self.lengths = np.linalg.norm(rays[:, 3:], axis=1)
        directions = rays[:, 3:] / self.lengths[:, None]
        self.rays = [fcpw.ray_3D(rays[i, :3], directions[i]) for i in range(len(rays))]

    def all(self):
        def ask():
            counts = np.empty(len(self.rays), dtype=np.int64)
            for index, ray in enumerate(self.rays):
                found = self.fcpw.interaction_3D_list()
                counts[index] = self.scene.intersect(ray, found, False, True)
            return counts

        # The call shortens a ray to its hits.
        fresh = [self.fcpw.ray_3D(ray.o, ray.d) for ray in self.rays]
        self.rays = fresh
        return timed(ask)

    def closest_point(self):
        found = self.fcpw.interaction_3D_list()
        radii = np.full(len(self.points), np.inf, dtype=np.float32)
        seconds, _ = timed(lambda: self.scene.find_closest_points(self.points, radii, found))
        return seconds, np.array([it.d for it in found])


def timed(work):
    start = time.process_time()
    result = work()
    return time.process_time() - start, result


def differ(kind, ours, theirs):
    """The share of queries with another number of hits, or a distance that is off by 1e-4."""
    if kind == "all":
        return float(np.mean(ours != theirs))
    return float(np.mean(np.abs(ours - theirs) > 1e-4 * np.abs(ours).max()))


def load(path):
    """A binary PLY file of float32 positions and triangles."""
    import open3d

    mesh = open3d.io.read_triangle_mesh(str(path))
    return np.asarray(mesh.vertices, dtype=np.float32), np.asarray(mesh.triangles)


def cpu_name():
    for line in open("/proc/cpuinfo"):
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.processor()


def print_table(record):
    versions = ", ".join(f"{name} {version}" for name, version in record["versions"].items())
    print(f"{record['date']}, {record['cpu']} ({record['cores']} cores); {versions}.\n")
    print("Thousands of queries a CPU second, best of", record["passes"], "passes, one thread; in brackets kdray's")
    print("rate over it. Differ: the largest share of queries with another number of hits than kdray's, or a")
    print("distance off by 1e-4 of the largest.\n")
    print("| scene | triangles | engine | all hits in order | closest point | signed distance | differ |")
    print("|---|--:|---|--:|--:|--:|--:|")
    keys = ["scene", "triangles", "engine"]
    lines = {}
    for row in record["rows"]:
        lines.setdefault(tuple(row[key] for key in keys), {})[row["kind"]] = row
    for (scene, triangles, engine), kinds in lines.items():
        ours = lines[scene, triangles, "kdray"]
        cells = []
        for kind in KINDS:
            if kind not in kinds:
                cells.append("")
                continue
            rate = record["queries"] / kinds[kind]["cpu_s"] * 1e-3
            ratio = kinds[kind]["cpu_s"] / ours[kind]["cpu_s"]
            cells.append(f"{rate:,.0f}" + (f" ({ratio:.1f})" if engine != "kdray" else ""))
        worst = max(row["differ"] for row in kinds.values())
        cells.append(f"{worst:.1e}" if worst else "0")
        print(f"| {scene} | {triangles:,} | {engine} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
