"""Trees on a GPU: built there, asked there, and everywhere the same bits."""

import copy
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import textwrap
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import kdray
from conftest import cube, icosphere, random_rays, soup
from test_tree import same_tree


@pytest.fixture(scope="module")
def ball(gpu):
    return kdray.build(*icosphere(3), device=gpu)


def same_answers(tree, other, origins, directions, **options):
    """All queries with rays on both, bit by bit."""
    for query in ("closest_hit", "all_hits"):
        answers = (getattr(one, query)(origins, directions, **options) for one in (tree, other))
        for column, same in zip(*answers):
            assert column.dtype == same.dtype
            np.testing.assert_array_equal(column, same)
    for query in ("any_hit", "count_hits"):
        answers = (getattr(one, query)(origins, directions, **options) for one in (tree, other))
        np.testing.assert_array_equal(*answers)


def test_devices(gpu, ball):
    cpu, *gpus = kdray.devices()
    assert cpu == kdray.Device("cpu", "cpu") and len(gpus) > 0
    assert [one.index for one in gpus] == list(range(len(gpus)))
    assert all(one.name and one.backend and one.kind != "cpu" for one in gpus)
    (mine,) = (one for one in gpus if one.name == ball.device)
    for name in (mine, mine.index, str(mine.index), mine.name):
        assert ball.to(name) is ball
    assert repr(ball).endswith(f"bounds [-1 -1 -1] to [1 1 1], on {mine.name})")
    assert ball.to("gpu").device in [one.name for one in gpus]


def test_auto_takes_a_real_gpu_and_says_so(gpu):
    real = [one.name for one in kdray.devices() if one.kind not in ("cpu", "software")]
    # In a process of its own: what there is, is found out once.
    script = """
        import kdray
        from conftest import cube
        tree = kdray.build(*cube())
        print(tree.device, tree.to("auto") is tree, sep="|")
        print(kdray.build(*cube(), builder="naive").device)
    """
    ran = child(script, stdout=subprocess.PIPE).communicate(timeout=100)[0].split("\n")
    device, is_there = ran[0].split("|")
    assert (device in real if real else device == "cpu") and is_there == "True"
    assert ran[1] == "cpu"


def child(script, **options):
    lines = ["import sys", f"sys.path.insert(0, {os.path.dirname(__file__)!r})"]
    if "KDRAY_TEST_GPU" not in os.environ:
        lines += ["from conftest import use_drivers", "use_drivers()"]
    script = "\n".join([*lines, textwrap.dedent(script)])
    return subprocess.Popen([sys.executable, "-c", script], text=True, **options)


@pytest.mark.parametrize("mesh", ["sphere", "soup", "cube", "flat", "nothing", "far"])
def test_the_same_tree_and_the_same_answers(gpu, mesh):
    vertices, faces = {
        "sphere": lambda: icosphere(3),
        "soup": lambda: soup(500),
        "cube": cube,
        "flat": lambda: (np.eye(3)[[0, 0, 1, 2]], np.array([[0, 1, 2], [0, 2, 3], [2, 2, 2]])),
        "nothing": lambda: (np.zeros((0, 3)), np.zeros((0, 3), int)),
        "far": lambda: (icosphere(2)[0] + [4.5e6, 5.4e6, 300], icosphere(2)[1]),
    }[mesh]()
    tree, other = (kdray.build(vertices, faces, device=device) for device in (gpu, "cpu"))
    assert tree.device != "cpu" and same_tree(tree, other)
    tree.validate()
    shift = vertices[:1].reshape(-1, 3) if mesh == "far" else 0
    for dtype in (np.float32, np.float64):
        origins, directions = random_rays(700, dtype=dtype)
        same_answers(tree, other, origins + shift, directions)


@pytest.mark.parametrize(
    "options",
    [
        {"max_depth": 4},
        {"max_leaf": 20},
        {"clip": False},
        {"cost_traversal": 2.0, "cost_intersect": 1.0, "empty_bonus": 0.5},
        {"memory_budget": 1 << 24},
    ],
)
def test_options_mean_the_same(gpu, options):
    mesh = soup(400)
    assert same_tree(*(kdray.build(*mesh, device=device, **options) for device in (gpu, "cpu")))


def test_rays_of_every_kind(ball):
    cpu = ball.to("cpu")
    assert cpu.device == "cpu"
    origins, directions = random_rays(800)
    first = cpu.closest_hit(origins, directions)
    same_answers(ball, cpu, origins, directions, t_min=0.3, t_max=np.linspace(0, 2, 800))
    same_answers(ball, cpu, origins, directions, exclude=first.triangle)
    same_answers(ball, cpu, origins, directions, mask=np.arange(1280) % 3 > 0)
    same_answers(ball, cpu, origins.reshape(20, 40, 3), directions[:40])
    same_answers(ball, cpu, origins[0], directions[0])
    same_answers(ball, cpu, origins[:0], directions[:0])
    few, same = (tree.all_hits(origins, directions, max_hits=1) for tree in (ball, cpu))
    for column, other in zip(few, same):
        np.testing.assert_array_equal(column, other)
    origins[:3, 0], directions[3:6, 1], directions[6] = np.nan, np.inf, 0
    assert not ball.any_hit(origins, directions)[:7].any()
    same_answers(ball, cpu, origins, directions)
    hits = ball.closest_hit(origins, directions)
    np.testing.assert_array_equal(hits.points, cpu.closest_hit(origins, directions).points)


def test_more_rays_than_are_brought_at_a_time(ball):
    origins, directions = random_rays(20_000)
    found = ball.closest_hit(origins, directions)
    for column, same in zip(found, ball.to("cpu").closest_hit(origins, directions)):
        np.testing.assert_array_equal(column, same)


def test_what_the_cpu_answers_for_it(ball):
    cpu, points = ball.to("cpu"), random_rays(500)[0]
    np.testing.assert_array_equal(ball.contains(points), cpu.contains(points))
    np.testing.assert_array_equal(ball.signed_distance(points), cpu.signed_distance(points))
    assert ball.stats == cpu.stats
    for shading in ("normals", "cost"):
        pictures = (tree.render(24, 16, samples=1, shading=shading) for tree in (ball, cpu))
        np.testing.assert_array_equal(*pictures)


def test_a_tree_goes_there_and_back(gpu, sphere):
    there = sphere.to(gpu)
    assert there is not sphere and same_tree(there, sphere)
    assert there.to("cpu").device == "cpu" and there.to(gpu) is there
    same_answers(there, sphere, *random_rays(300))


def test_pickles_copies_and_files(ball, tmp_path):
    assert copy.copy(ball) is ball and copy.deepcopy(ball) is ball
    again = pickle.loads(pickle.dumps(ball))
    ball.save(tmp_path / "tree")
    opened = kdray.Tree.open(tmp_path / "tree")
    for other in (again, opened):
        assert other.device == "cpu" and same_tree(ball, other)
    same_answers(opened.to(ball.device), ball, *random_rays(100))


@pytest.mark.parametrize(
    ("device", "error", "message"),
    [
        ("no such card", ValueError, 'device: no single GPU is called "no such card"'),
        ("", ValueError, "device: no single GPU"),
        (99, ValueError, 'device: no single GPU is called "99"'),
        (-1, ValueError, "device is -1"),
        (None, TypeError, "device is None"),
        (1.5, TypeError, "device is 1.5"),
    ],
)
def test_devices_that_there_are_not(gpu, sphere, device, error, message):
    with pytest.raises(error, match=message):
        kdray.build(*cube(), device=device)
    with pytest.raises(error, match=message):
        sphere.to(device)


def test_builds_that_cannot_be(gpu):
    with pytest.raises(ValueError, match='builder is "naive", which is for the CPU'):
        kdray.build(*cube(), device=gpu, builder="naive")
    with pytest.raises(MemoryError, match="memory budget of 1000 bytes"):
        kdray.build(*soup(1000), device=gpu, memory_budget=1000)
    with pytest.raises(ValueError, match="max_depth is 256"):
        kdray.build(*cube(), device=gpu, max_depth=256)


def test_progress_is_told_and_can_end_the_build(gpu):
    told = []
    kdray.build(*soup(20_000), device=gpu, progress=told.append)
    assert told[-1] == 1.0 and told == sorted(told)

    def stop(fraction):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        kdray.build(*soup(20_000), device=gpu, progress=stop)


def test_many_threads_share_a_tree(ball):
    origins, directions = random_rays(4000)
    expected = ball.to("cpu").closest_hit(origins, directions).t

    def ask(part):
        kdray.build(*cube(), device=ball.device)
        return ball.closest_hit(origins[part::4], directions[part::4]).t

    with ThreadPoolExecutor(4) as pool:
        for part, t in enumerate(pool.map(ask, range(4))):
            np.testing.assert_array_equal(t, expected[part::4])


def answer(queue, tree, origins, directions):
    queue.put((tree.device, tree.closest_hit(origins, directions).t))


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
@pytest.mark.parametrize("method", multiprocessing.get_all_start_methods())
def test_children_answer_on_the_cpu(ball, method):
    origins, directions = random_rays(1000)
    context = multiprocessing.get_context(method)
    queue = context.Queue()
    process = context.Process(target=answer, args=(queue, ball, origins, directions))
    process.start()
    device, t = queue.get(timeout=60)
    process.join(timeout=60)
    assert process.exitcode == 0 and device == "cpu"
    np.testing.assert_array_equal(t, ball.closest_hit(origins, directions).t)


LONG = {
    "build": "kdray.build(vertices, faces, device=name)",
    "closest_hit": "tree.closest_hit(many, many)",
    "all_hits": "tree.all_hits(many, many)",
}


@pytest.mark.skipif(os.name == "nt", reason="sends a signal")
@pytest.mark.parametrize("call", LONG)
def test_ctrl_c_is_heard_within_a_second(gpu, call):
    # Once before: the kernels are compiled then.
    script = f"""
        import kdray
        from conftest import icosphere, random_rays, soup
        name = {gpu!r}
        vertices, faces = soup(60_000)
        origins, _ = random_rays(1000)
        tree = kdray.build(*icosphere(3), device=name)
        tree.closest_hit(origins, origins)
        {"tree.all_hits(origins, origins)" if call == "all_hits" else ""}
        many = origins.repeat(5000, 0)
        print("ready", flush=True)
        try:
            {LONG[call]}
        except KeyboardInterrupt:
            print("interrupted", flush=True)
        """
    process = child(script, stdout=subprocess.PIPE)
    assert process.stdout.readline() == "ready\n"
    time.sleep(0.3)
    assert process.poll() is None, "it was too quick to be interrupted"
    start = time.perf_counter()
    process.send_signal(signal.SIGINT)
    assert process.stdout.readline() == "interrupted\n"
    assert time.perf_counter() - start < 1
    assert process.wait(timeout=60) == 0
    process.stdout.close()
