"""Threads, processes, signals and memory."""

import gc
import multiprocessing
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import kdray
from conftest import icosphere, random_rays, soup

linux = pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")


def resident():
    """Bytes of the process in memory."""
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def growth_of_peak(work):
    """Bytes by which the process was largest during `work` above what it was before."""
    with open("/proc/self/clear_refs", "w") as file:
        file.write("5")
    before = resident()
    work()
    with open("/proc/self/status") as file:
        peak = next(int(line.split()[1]) for line in file if line.startswith("VmHWM"))
    return peak * 1024 - before


@linux
def test_a_million_contiguous_rays_are_not_copied(sphere):
    origins, directions = random_rays(1_000_000)
    sphere.closest_hit(origins[:1000], directions[:1000])
    answers = 4 * 4 * len(origins)
    rays = np.concatenate([origins, directions], axis=1)
    assert growth_of_peak(lambda: sphere.closest_hit(origins, directions)) < answers + (4 << 20)
    assert growth_of_peak(lambda: sphere.any_hit(origins, directions)) < len(origins) + (4 << 20)
    beside = growth_of_peak(lambda: sphere.any_hit(rays[:, :3], rays[:, 3:]))
    assert beside < len(origins) + (4 << 20)
    # The measurement does see copies: two, of which at most one finds room in memory that is there.
    slow = origins.astype(">f4"), directions.astype(">f4")
    assert growth_of_peak(lambda: sphere.any_hit(*slow)) > 12 * len(origins)


@linux
def test_a_thousand_builds_and_queries_leave_nothing_behind():
    vertices, faces = icosphere(2)
    origins, directions = random_rays(100)

    def round_trip():
        tree = kdray.build(vertices, faces)
        tree.closest_hit(origins, directions).points  # noqa: B018
        tree.all_hits(origins, directions)
        tree.closest_point(origins)
        tree.contains(origins.repeat(8, axis=0))
        with pytest.raises(ValueError):
            kdray.build(vertices, faces + 1000)

    for _ in range(200):
        round_trip()
    gc.collect()
    before = resident()
    for _ in range(1000):
        round_trip()
    gc.collect()
    assert resident() - before < 8 << 20


def test_many_threads_share_a_tree(sphere):
    origins, directions = random_rays(20_000)
    expected = sphere.closest_hit(origins, directions).t

    def ask(part):
        return sphere.closest_hit(origins[part::8], directions[part::8]).t

    with ThreadPoolExecutor(8) as pool:
        for part, t in enumerate(pool.map(ask, range(8))):
            np.testing.assert_array_equal(t, expected[part::8])


def test_other_threads_run_meanwhile():
    """The interpreter's lock is free during a long call."""
    mesh = soup(60_000)
    ticks, done = [], threading.Event()

    def tick():
        while not done.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.005)

    thread = threading.Thread(target=tick)
    thread.start()
    start = time.perf_counter()
    kdray.build(*mesh, threads=1)
    end = time.perf_counter()
    done.set()
    thread.join()
    during = [tick for tick in ticks if start < tick < end]
    assert len(during) > 5 and np.diff([start, *during, end]).max() < 0.5 * (end - start)


def answer(queue, tree, origins, directions):
    queue.put(tree.closest_hit(origins, directions).t)


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
@pytest.mark.parametrize("method", multiprocessing.get_all_start_methods())
def test_children_ask_on(sphere, method):
    """A forked child has none of the parent's threads; a spawned one none of its memory."""
    origins, directions = random_rays(5000)
    expected = sphere.closest_hit(origins, directions).t
    context = multiprocessing.get_context(method)
    queue = context.Queue()
    children = [
        context.Process(target=answer, args=(queue, sphere, origins, directions)) for _ in range(2)
    ]
    for child in children:
        child.start()
    for _ in children:
        np.testing.assert_array_equal(queue.get(timeout=60), expected)
    for child in children:
        child.join(timeout=60)
        assert child.exitcode == 0
    np.testing.assert_array_equal(sphere.closest_hit(origins, directions).t, expected)


LONG = {
    "build": "kdray.build(vertices, faces)",
    "other build": "kdray.build(vertices, faces, builder='resort')",
    "load": "while True: kdray.load(path)",
    "generate": "while True: kdray.generate.showcase(1_000_000)",
    "closest_hit": "while True: tree.closest_hit(many, many)",
    "any_hit": "while True: tree.any_hit(many, many, exclude=0)",
    "count_hits": "while True: tree.count_hits(many, many)",
    "all_hits": "while True: tree.all_hits(origins, directions)",
    "contains": "while True: tree.contains(many)",
    "contains, winding": "while True: tree.contains(many, sign='winding')",
    "winding_number": "while True: tree.winding_number(many, tolerance=1e-9)",
    "closest_point": "tree.closest_point(many)",
    "signed_distance": "tree.signed_distance(many)",
    "within_sphere": "while True: tree.within_sphere(origins, 0.5)",
    "within_box": "while True: tree.within_box(origins - 0.5, origins + 0.5)",
    "points": "while True: tree.closest_hit(many, many).points",
    "stats": "while True: tree.stats",
    "validate": "kdray.build(vertices[:300_000], faces[:100_000], max_depth=30).validate()",
    "save": "while True: tree.save(path + '.kdray')",
    "open": "while True: kdray.Tree.open(path + '.kdray')",
    "pickle": "while True: pickle.loads(pickle.dumps(tree))",
    "render": "tree.render(2000, 2000, samples=64)",
}


@pytest.mark.skipif(os.name == "nt", reason="sends a signal")
@pytest.mark.parametrize("call", LONG)
def test_ctrl_c_is_heard_within_a_second(tmp_path, call):
    script = f"""
        import pickle, sys
        sys.path.insert(0, {os.path.dirname(__file__)!r})
        import kdray
        from conftest import icosphere, random_rays, soup
        vertices, faces = soup(400_000)
        origins, directions = random_rays(100_000)
        many = origins.repeat(50, 0)
        tree = kdray.build(*icosphere(4))
        path = {str(tmp_path / "mesh.obj")!r}
        tree.save(path + ".kdray")
        with open(path, "w") as file:
            file.writelines(f"v {{x}} {{y}} {{z}}\\n" for x, y, z in vertices[:90_000])
            file.writelines(f"f {{a}} {{b}} {{c}}\\n" for a, b, c in faces[:30_000] + 1)
        try:
            print("ready", flush=True)
            {LONG[call]}
        except KeyboardInterrupt:
            print("interrupted", flush=True)
        """
    child = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(script)], stdout=subprocess.PIPE, text=True
    )
    assert child.stdout.readline() == "ready\n"
    time.sleep(0.3)
    assert child.poll() is None, "it was too quick to be interrupted"
    start = time.perf_counter()
    child.send_signal(signal.SIGINT)
    assert child.stdout.readline() == "interrupted\n"
    assert time.perf_counter() - start < 1
    assert child.wait(timeout=60) == 0
    child.stdout.close()
