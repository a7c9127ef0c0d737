"""kdray beside Open3D and trimesh with embreex: identical queries, in one process, in turns.

python compare.py run MESH... -o RECORD.json    measures and writes a record
python compare.py table RECORD.json             prints a record as Markdown tables
"""

from __future__ import annotations

import argparse
import datetime
import json
import os
import platform
import sys
from importlib import metadata
from pathlib import Path
from time import perf_counter, process_time

import numpy as np
from engines import ENGINES, QUERIES, Queries
from report import table

import kdray


def queries(tree: kdray.Tree, rays: int, points: int) -> Queries:
    """Queries around a mesh, the same for every engine.

    First: from a sphere around the mesh to points in its box. Bounce: from where those hit,
    anywhere. Shadow: from there to a light above. Points: in the box and a little beyond.
    """
    random = np.random.default_rng(20)
    lower, upper = tree.bounds
    center, size = (lower + upper) / 2, np.linalg.norm(upper - lower)
    outward = random.normal(size=(rays, 3))
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    origins = (center + size * outward).astype(np.float32)
    first = (random.uniform(lower, upper, (rays, 3)) - origins).astype(np.float32)
    hits = tree.closest_hit(origins, first)
    # Somewhat before the surface, lest rays start on either side of it by a rounding.
    t = np.where(hits.mask, hits.t * np.float32(1 - 1e-4), np.float32(0.5))
    starts = origins + t[:, None] * first
    anywhere = random.normal(size=(rays, 3)).astype(np.float32)
    light = (center + np.array([0.3, 2.0, 0.5]) * size).astype(np.float32)
    margin = 0.1 * (upper - lower)
    near = random.uniform(lower - margin, upper + margin, (points, 3)).astype(np.float32)
    return Queries((origins, first), (starts, light - starts), (starts, anywhere), near)


def measure(path: Path | None, counts: dict[str, int], passes: int, seconds: float) -> dict:
    """One mesh, all queries on all engines: the seconds of every pass."""
    vertices, faces = kdray.load(path) if path else kdray.generate.torus_knot(segments=60)
    vertices = vertices.astype(np.float32)
    asked = queries(kdray.build(vertices, faces), counts["rays"], counts["points"])
    engines = {name: engine(vertices, faces) for name, engine in ENGINES.items()}
    rows = []
    for query, divisor in QUERIES.items():
        row: dict = {"query": query, "count": asked.count(query, divisor), "seconds": {}, "cpu": {}}
        answers = {}
        for _ in range(passes):
            for name, engine in engines.items():
                spent = row["seconds"].setdefault(name, [])
                # An engine that took long is asked once.
                if not spent or sum(spent) < seconds:
                    start, start_cpu = perf_counter(), process_time()
                    answers[name] = engine.ask(query, asked, divisor)
                    spent.append(perf_counter() - start)
                    row["cpu"].setdefault(name, []).append(process_time() - start_cpu)
        ours = answers["kdray"]
        row["differ"] = {
            name: float(np.mean(~np.isclose(ours, other, rtol=1e-3, atol=1e-5)))
            for name, other in answers.items()
            if name != "kdray" and ours is not None
        }
        rows.append(row)
        best = {name: f"{min(spent):.3f} s" for name, spent in row["seconds"].items()}
        print(path.name if path else "knot", query, best, file=sys.stderr)
    name = path.stem if path else "knot"
    return {"mesh": name, "triangles": len(faces), "rows": rows}


def processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        return next(line.split(": ")[1] for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor()


def run(arguments: argparse.Namespace) -> None:
    counts = {"rays": arguments.rays, "points": arguments.points}
    record = {
        "date": datetime.datetime.now(datetime.timezone.utc).date().isoformat(),
        "processor": processor(),
        "cores": os.cpu_count(),
        "load": os.getloadavg() if hasattr(os, "getloadavg") else None,
        "versions": {
            "python": platform.python_version(),
            **{name: metadata.version(name) for name in ("kdray", "numpy", "trimesh", "embreex")},
            "open3d": sys.modules["open3d"].__version__,
        },
        "counts": counts,
        "passes": arguments.passes,
        "scenes": [
            measure(path, counts, arguments.passes, arguments.patience)
            for path in arguments.meshes or [None]
        ],
    }
    arguments.output.write_text(json.dumps(record, indent=1) + "\n")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    commands = parser.add_subparsers(required=True, dest="command")
    runs = commands.add_parser("run")
    runs.add_argument("meshes", nargs="*", type=Path, help="without any, a generated knot")
    runs.add_argument("-o", "--output", type=Path, required=True)
    runs.add_argument("--rays", type=int, default=1_000_000)
    runs.add_argument("--points", type=int, default=1_000_000)
    runs.add_argument("--passes", type=int, default=5)
    runs.add_argument("--patience", type=float, default=20.0, help="seconds an engine may take")
    tables = commands.add_parser("table")
    tables.add_argument("record", type=Path)
    arguments = parser.parse_args()
    if arguments.command == "run":
        run(arguments)
    else:
        print(table(json.loads(arguments.record.read_text())), end="")


if __name__ == "__main__":
    main()
