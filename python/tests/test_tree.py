"""Building, keeping and looking at trees."""

import copy
import pickle

import numpy as np
import pytest

import kdray
from conftest import cube, icosphere, random_rays, soup


def same_tree(a, b):
    return a._tree.to_bytes() == b._tree.to_bytes()


@pytest.mark.parametrize(
    "dtype", [np.int8, np.uint8, np.int16, np.int32, np.uint32, np.int64, np.uint64]
)
def test_any_integer_faces(dtype):
    vertices, faces = cube()
    assert same_tree(kdray.build(vertices, faces.astype(dtype)), kdray.build(vertices, faces))


@pytest.mark.parametrize("dtype", [np.float16, np.int32, ">f4", ">f8", np.float32])
def test_any_real_vertices(dtype):
    vertices, faces = cube()
    assert same_tree(kdray.build(vertices.astype(dtype), faces), kdray.build(vertices, faces))


def test_arrays_of_others():
    class Tensor:
        """What torch, jax and others have in common."""

        def __init__(self, array):
            self.array = array

        def __dlpack__(self, **options):
            return self.array.__dlpack__(**options)

        def __dlpack_device__(self):
            return self.array.__dlpack_device__()

    class Interface:
        def __init__(self, array):
            self.array = array
            self.__array_interface__ = array.__array_interface__

    vertices, faces = cube()
    expected = kdray.build(vertices, faces)
    for wrap in (Tensor, Interface, memoryview, np.ndarray.tolist):
        assert same_tree(kdray.build(wrap(vertices), wrap(faces)), expected)


@pytest.mark.parametrize(
    "options", [{"threads": 1}, {"threads": 2}, {"builder": "resort"}, {"builder": "naive"}]
)
def test_one_tree_whatever_builds_it(options):
    mesh = soup(100)
    assert same_tree(kdray.build(*mesh, **options), kdray.build(*mesh))


def test_options_shape_the_tree():
    mesh = icosphere(3)
    tree = kdray.build(*mesh)
    assert kdray.build(*mesh, max_depth=3).stats.depth == 3
    assert kdray.build(*mesh, max_leaf=50).stats.nodes < tree.stats.nodes
    assert (
        kdray.build(*mesh, cost_traversal=100.0, cost_intersect=1.0).stats.nodes < tree.stats.nodes
    )
    assert kdray.build(*mesh, clip=False).stats.references > tree.stats.references
    assert kdray.build(*mesh, empty_bonus=0.9).stats.empty_leaves > tree.stats.empty_leaves


def test_progress_is_told_and_can_end_the_build():
    told = []
    kdray.build(*soup(20_000), progress=told.append)
    assert told[-1] == 1.0 and told == sorted(told) and all(0 <= part <= 1 for part in told)

    def stop(fraction):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        kdray.build(*soup(20_000), progress=stop)


def test_stats_and_validate(sphere):
    sphere.validate()
    stats = sphere.stats
    assert stats.leaves * 2 - 1 == stats.nodes
    assert sum(stats.leaf_histogram) == stats.leaves
    assert sum(n * count for n, count in enumerate(stats.leaf_histogram)) == stats.references
    assert stats.leaf_histogram[0] == stats.empty_leaves
    assert stats.tree_bytes == 8 * stats.nodes + 4 * stats.references
    assert stats.sah_cost > stats.e_prim > 1 and stats.tracer_bytes > 0


def test_the_mesh_can_be_had_back():
    for dtype in (np.float32, np.float64):
        vertices, faces = icosphere(1, dtype)
        tree = kdray.build(vertices, faces)
        np.testing.assert_array_equal(tree.vertices, vertices.astype(np.float32))
        np.testing.assert_array_equal(tree.faces, faces)
    far = vertices + [4.5e6, 5.4e6, 300]
    tree = kdray.build(far, faces)
    np.testing.assert_allclose(tree.vertices, far, rtol=0, atol=1e-6)
    np.testing.assert_allclose(tree.bounds, [far.min(0), far.max(0)], rtol=0, atol=1e-6)


def again(tree, how, path):
    if how == "file":
        tree.save(path)
        return kdray.Tree.open(path)
    if how == "pickle":
        return pickle.loads(pickle.dumps(tree))
    return {"copy": copy.copy, "deepcopy": copy.deepcopy}[how](tree)


@pytest.mark.parametrize("how", ["file", "pickle", "copy", "deepcopy"])
@pytest.mark.parametrize("offset", [0, 1e7])
def test_a_tree_comes_back_as_it_was(tmp_path, how, offset):
    vertices, faces = icosphere(2)
    tree = kdray.build(vertices + offset, faces)
    other = again(tree, how, tmp_path / "tree")
    assert same_tree(tree, other) and repr(tree) == repr(other)
    origins, directions = random_rays(200, dtype=np.float64)
    for column, same in zip(
        tree.closest_hit(origins + offset, directions),
        other.closest_hit(origins + offset, directions),
    ):
        np.testing.assert_array_equal(column, same)
    other.validate()


def test_saving_replaces_and_keeps_what_is_open(tmp_path, sphere):
    path = tmp_path / "tree"
    sphere.save(path)
    opened = kdray.Tree.open(path)
    kdray.build(*cube()).save(path)
    assert same_tree(opened, sphere) and kdray.Tree.open(str(path)).triangle_count == 12
    assert [file.name for file in tmp_path.iterdir()] == ["tree"]


def test_a_tree_file_of_another_program_needs_its_mesh(tmp_path, sphere):
    content = sphere._tree.to_bytes()
    bare = content[content.index(b"kdray-kd") :]
    path = tmp_path / "bare.kdray"
    path.write_bytes(bare)
    assert same_tree(kdray.Tree.open(path, sphere.vertices, sphere.faces), sphere)
    with pytest.raises(ValueError, match="another mesh"):
        kdray.Tree.open(path, *cube())
    with pytest.raises(ValueError, match="not a mesh"):
        kdray.Tree.open(path)
    with pytest.raises(ValueError, match="go together"):
        kdray.Tree.open(path, sphere.vertices)


def test_repr_and_devices(sphere):
    assert repr(sphere).startswith("kdray.Tree(1,280 triangles, 642 vertices, ")
    assert repr(sphere).endswith("bounds [-1 -1 -1] to [1 1 1])")
    assert kdray.devices()[0] == kdray.Device("cpu", "cpu")
    assert sphere.device == "cpu" and sphere.to("cpu") is sphere
    assert sphere.to(kdray.devices()[0]) is sphere


def test_load_reads_meshes_and_warns_of_what_it_left_out(tmp_path):
    path = tmp_path / "cube.obj"
    vertices, faces = cube()
    lines = [f"v {x} {y} {z}" for x, y, z in vertices] + [
        f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces
    ]
    path.write_text("\n".join(lines))
    loaded = kdray.load(path)
    np.testing.assert_array_equal(loaded[0], vertices)
    np.testing.assert_array_equal(loaded[1], faces)
    assert loaded[0].dtype == np.float64 and loaded[1].dtype == np.int32
    assert kdray.build(*loaded).contains([0.5, 0.5, 0.5])
    path.write_text("\n".join([*lines, "f 1 2"]))
    with pytest.warns(UserWarning, match=r"cube\.obj"):
        kdray.load(path)


def test_pictures(sphere):
    picture = sphere.render(64, 48, shading="normals")
    assert picture.shape == (48, 64, 3) and picture.dtype == np.uint8
    assert picture[24, 32].tolist() != picture[0, 0].tolist()
    again = sphere.render(64, 48, shading="normals", threads=1)
    np.testing.assert_array_equal(picture, again)
    close = sphere.render(64, 48, shading="normals", eye=[0, 0, 1.5], target=[0, 0, 0], fov=20)
    assert (close != picture).any() and (close == close[0, 0]).all(axis=2).mean() < 0.1
    told = []
    sphere.render(16, 16, shading="ao", samples=1, ground=False, progress=told.append)
    assert told[-1] == 1.0
