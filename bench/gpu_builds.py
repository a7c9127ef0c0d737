"""Builds on the GPU beside those on the CPU, by the command `kdray`, into a record.

    cargo build --release
    python3 bench/gpu_builds.py --device llvmpipe -o bench/records/DATE-MACHINE-gpu.json

Both run by turns, on all threads; the best time of each counts. Dispatches, bytes and memory come from
a build with a profile, and one with a budget of half of the peak memory. Every tree is compared with
the CPU's, byte for byte. The floor is the time that the bytes moved take at the bandwidth of the GPU in
the paper, whose build times stand beside it. Nothing else should run meanwhile.
"""

import argparse
import json
import os
import pathlib
import platform
import subprocess
import tempfile
import time

# Build times in seconds [WZL11].
PAPER = {
    "bunny": 0.059,
    "fairy_forest": 0.142,
    "angel_substitute": 0.311,
    "dragon": 0.511,
    "happy_substitute": 0.645,
}


def build(kdray, mesh, tree, *options):
    command = [kdray, "build", mesh, "--json", "-o", tree, *options]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


def best(kdray, mesh, tree, passes, *options):
    return min(build(kdray, mesh, tree, *options)["build_s"] for _ in range(passes))


def scene(arguments, name, folder):
    """What one scene takes, on both."""
    mesh = arguments.meshes / f"{name}.ply"
    cpu_tree, gpu_tree = folder / "cpu.tree", folder / "gpu.tree"
    device = ["--device", arguments.device]

    def is_same():
        return cpu_tree.read_bytes() == gpu_tree.read_bytes()

    cpu_s = best(arguments.kdray, mesh, cpu_tree, 2 * arguments.passes)
    gpu_s = best(arguments.kdray, mesh, gpu_tree, arguments.passes, *device)
    same = [is_same()]
    profiled = build(arguments.kdray, mesh, gpu_tree, *device, "--profile")
    same.append(is_same())
    budget = profiled["peak_bytes"] // 2
    tight = build(arguments.kdray, mesh, gpu_tree, *device, "--memory-budget", str(budget))
    same.append(is_same())
    triangles, profile = profiled["triangles"], profiled["profile"]
    of_levels = {}
    for stage in profile["stages"]:
        if stage["stage"] not in ("events", "part", "pack"):
            level = of_levels.setdefault(stage["level"], 0)
            of_levels[stage["level"]] = level + stage["dispatches"]
    batches = {level: 0 for level in of_levels}
    for level in profile["levels"]:
        batches[level["level"]] = batches.get(level["level"], 0) + 1
    a_level = max(of_levels[level] / max(batches[level], 1) for level in of_levels)
    return {
        "scene": name,
        "triangles": triangles,
        "cpu_s": cpu_s,
        "gpu_s": gpu_s,
        "ratio": gpu_s / cpu_s,
        "gpu_us_a_triangle": gpu_s / triangles * 1e6,
        "peak_bytes_a_triangle": profiled["peak_bytes"] / triangles,
        "halved_peak_bytes_a_triangle": tight["peak_bytes"] / triangles,
        "halved_s": tight["build_s"],
        "tree_bytes_a_triangle": profiled["tree_bytes"] / triangles,
        "dispatches": profile["dispatches"],
        "dispatches_a_level": a_level,
        "readbacks": profile["readbacks"],
        "levels": len(profile["levels"]),
        "bytes_moved": profile["bytes_moved"],
        "floor_s": profile["floor_s"],
        "paper_build_s": PAPER.get(name),
        "same_trees": all(same),
        "adapter": profiled["adapter"],
        "driver": profiled["driver"],
    }


def processor():
    """The name of the processor, where the system tells it."""
    names = pathlib.Path("/proc/cpuinfo")
    lines = names.read_text().splitlines() if names.exists() else []
    known = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return known[0] if known else platform.machine()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kdray", default="target/release/kdray")
    parser.add_argument("--device", default="gpu")
    parser.add_argument("--meshes", type=pathlib.Path, default=pathlib.Path("../shared/meshes"))
    parser.add_argument("--scenes", default="bunny,fairy_forest,dragon,happy_substitute")
    parser.add_argument("--passes", type=int, default=2)
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    record = {
        "command": f"bench/gpu_builds.py --device {arguments.device} --passes {arguments.passes}"
        f" --scenes {arguments.scenes}",
        "date": time.strftime("%Y-%m-%d"),
        "machine": f"{processor()}, {os.cpu_count()} threads",
        "scenes": [],
    }
    with tempfile.TemporaryDirectory() as folder:
        for name in arguments.scenes.split(","):
            row = scene(arguments, name, pathlib.Path(folder))
            record["scenes"].append(row)
            print(
                f"{name}: {row['gpu_s']:.3f} s, {row['ratio']:.1f} times the CPU's;"
                f" {row['peak_bytes_a_triangle']:.0f} bytes a triangle, with a budget"
                f" {row['halved_peak_bytes_a_triangle']:.0f}; floor {row['floor_s']:.4f} s;"
                f" {'the same trees' if row['same_trees'] else 'ANOTHER TREE'}",
                flush=True,
            )
    arguments.output.write_text(json.dumps(record, indent=2) + "\n")


if __name__ == "__main__":
    main()
