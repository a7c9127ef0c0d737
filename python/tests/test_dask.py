"""Queries on dask arrays, on a cluster of processes."""

import os
import time

import dask.array as da
import numpy as np
import pytest
from distributed import Client, LocalCluster

import kdray
import kdray.dask
from conftest import cube, icosphere, random_rays

pytestmark = pytest.mark.filterwarnings("ignore")


@pytest.fixture(scope="module")
def client():
    with (
        LocalCluster(2, threads_per_worker=1, processes=True, dashboard_address=":0") as cluster,
        Client(cluster) as client,
    ):
        yield client


@pytest.fixture(scope="module")
def path(tmp_path_factory, sphere):
    path = tmp_path_factory.mktemp("trees") / "sphere.kdray"
    sphere.save(path)
    return path


def blocks(array, rows=250):
    return da.from_array(array, chunks=(rows, *array.shape[1:]))


@pytest.mark.parametrize("given", ["path", "tree"])
def test_answers_are_those_of_the_tree(client, sphere, path, given):
    tree = path if given == "path" else sphere
    origins, directions = random_rays(1000)
    o, d = blocks(origins), blocks(directions, 400)
    hits = kdray.dask.closest_hit(tree, o, d)
    for name, column in sphere.closest_hit(origins, directions)._asdict().items():
        lazy = getattr(hits, name)
        assert (lazy.dtype, lazy.shape) == (column.dtype, column.shape)
        np.testing.assert_array_equal(lazy.compute(), column)
    for name in ("any_hit", "count_hits"):
        lazy = getattr(kdray.dask, name)(tree, o, d, t_max=0.9)
        expected = getattr(sphere, name)(origins, directions, t_max=0.9)
        assert lazy.dtype == expected.dtype
        np.testing.assert_array_equal(lazy.compute(), expected)
    for name in ("contains", "signed_distance", "winding_number"):
        lazy = getattr(kdray.dask, name)(tree, o)
        expected = getattr(sphere, name)(origins)
        np.testing.assert_array_equal(lazy.compute(), expected)
    closest = kdray.dask.closest_point(tree, o, max_distance=0.5)
    for name, column in sphere.closest_point(origins, max_distance=0.5)._asdict().items():
        lazy = getattr(closest, name)
        assert lazy.shape == column.shape
        np.testing.assert_array_equal(lazy.compute(), column)


def test_lists_come_block_by_block(client, sphere, path):
    origins, directions = random_rays(1000)
    o, d = blocks(origins), blocks(directions)
    parts = client.gather(client.compute(kdray.dask.all_hits(path, o, d, max_hits=1)))
    expected = sphere.all_hits(origins, directions, max_hits=1)
    assert len(parts) == 4
    np.testing.assert_array_equal(np.concatenate([part.t for part in parts]), expected.t)
    with pytest.raises(ValueError, match="without their tree"):
        parts[0].points  # noqa: B018
    near = client.gather(client.compute(kdray.dask.within_sphere(path, o, 0.3)))
    boxed = client.gather(client.compute(kdray.dask.within_box(path, o - 0.1, o + 0.1)))
    for parts, whole in (
        (near, sphere.within_sphere(origins, 0.3)),
        (boxed, sphere.within_box(origins - np.float32(0.1), origins + np.float32(0.1))),
    ):
        np.testing.assert_array_equal(np.concatenate([p.triangle for p in parts]), whole.triangle)


def test_other_shapes_and_one_direction_for_all(client, sphere, path):
    origins = random_rays(1200)[0].reshape(30, 40, 3)
    o = da.from_array(origins, chunks=(7, 40, 2))
    expected = sphere.closest_hit(origins, [0, 0, 1.0])
    hits = kdray.dask.closest_hit(path, o, [0, 0, 1.0])
    assert hits.t.shape == (30, 40)
    np.testing.assert_array_equal(hits.triangle.compute(), expected.triangle)
    np.testing.assert_array_equal(
        kdray.dask.closest_point(path, o).point.compute(), sphere.closest_point(origins).point
    )


def opened(block, path):
    """How often this worker has opened the file, and from where its tree's memory is."""
    kdray.dask._opened(path)
    with open("/proc/self/maps") as file:
        mapped = sum(os.path.basename(path) in line for line in file)
    info = kdray.dask._open.cache_info()
    return np.array([[info.misses, mapped]])


@pytest.mark.skipif(not os.path.exists("/proc/self/maps"), reason="reads /proc")
def test_workers_open_the_file_once_and_map_it(client, path):
    o = blocks(random_rays(2000)[0], 20)
    client.restart()
    kdray.dask.contains(path, o).compute()
    counts = da.map_blocks(opened, o, path=str(path), dtype=int, chunks=(1, 2)).compute()
    assert (counts == 1).all()


def slowly(block):
    time.sleep(0.02)
    return block


def worker_pid(block):
    return np.array([[os.getpid()]])


def test_a_worker_that_is_killed_loses_nothing(client, sphere, path):
    origins, directions = random_rays(4000)
    o = blocks(origins, 40).map_blocks(slowly, dtype=np.float32)
    future = client.compute(kdray.dask.closest_hit(path, o, blocks(directions, 40)).triangle)
    pids = list(client.run(os.getpid).values())
    time.sleep(0.5)
    assert not future.done()
    os.kill(pids[0], 9)
    expected = sphere.closest_hit(origins, directions).triangle
    np.testing.assert_array_equal(future.result(timeout=120), expected)
    assert pids[0] not in client.run(os.getpid).values()


def test_a_file_that_is_replaced_is_opened_anew(client, tmp_path):
    path = tmp_path / "tree"
    points = da.from_array(np.array([[2.0, 2, 2], [0.5, 0.5, 0.5]]), chunks=(1, 3))
    kdray.build(*cube()).save(path)
    assert kdray.dask.contains(path, points).compute().tolist() == [False, True]
    kdray.build(*cube(1.0, 3.0)).save(path)
    assert kdray.dask.contains(path, points + 0).compute().tolist() == [True, False]


def test_progress_is_dasks(client, path):
    """Tasks are named after the query, for the dashboard."""
    o = blocks(random_rays(100)[0], 10)
    lazy = kdray.dask.contains(path, o)
    assert lazy.numblocks == (10,)
    assert any(str(key[0]).startswith("kdray-contains-") for key in lazy.dask)


def test_bad_input_is_refused_before_anything_is_computed(path):
    o = blocks(random_rays(10)[0])
    with pytest.raises(ValueError, match=r"\(…, 3\) is expected"):
        kdray.dask.closest_hit(path, o[:, :2], o)
    with pytest.raises(ValueError, match="no blocks"):
        kdray.dask.contains(path, np.zeros(3))
    with pytest.raises(ValueError):
        kdray.dask.closest_hit(path, o, o[:7])
    with pytest.raises(TypeError):
        kdray.dask.contains(1.5, o)


def test_without_a_cluster_too(path):
    vertices, _ = icosphere(1)
    inside = kdray.dask.contains(path, da.from_array(0.9 * vertices, chunks=10))
    assert inside.compute(scheduler="threads").all()
    with pytest.raises(FileNotFoundError):
        kdray.dask.contains(path.with_name("missing"), blocks(vertices)).compute(scheduler="sync")
