"""The Open3D scene beside Open3D's own, method by method."""

import pickle

import numpy as np
import open3d
import pytest

from conftest import cube, icosphere, soup
from kdray.open3d import RaycastingScene

Tensor = open3d.core.Tensor


def meshes():
    """Vertices and triangles in Open3D's dtypes: two closed meshes apart."""
    (ball, ball_faces), (box, box_faces) = icosphere(3), cube(1.5, 2.5)
    return [
        (ball.astype(np.float32), ball_faces.astype(np.uint32)),
        (box.astype(np.float32), box_faces.astype(np.uint32)),
    ]


@pytest.fixture(scope="module")
def pair():
    """Our scene and Open3D's, of the same meshes."""
    scenes = RaycastingScene(), open3d.t.geometry.RaycastingScene()
    for vertices, faces in meshes():
        ours, theirs = (scene.add_triangles(vertices, faces) for scene in scenes)
        assert ours == theirs
    return scenes


def rays(*shape, seed=1):
    random = np.random.default_rng(seed)
    origins = random.uniform(-4, 4, (*shape, 3))
    targets = random.uniform(-1, 2.5, (*shape, 3))
    return np.concatenate([origins, targets - origins], axis=-1).astype(np.float32)


def points(*shape, seed=2):
    return np.random.default_rng(seed).uniform(-1.5, 3, (*shape, 3)).astype(np.float32)


def agree(ours, theirs, share=1.0, **tolerance):
    """Same names, dtypes and shapes, and the same numbers in at least that share of places."""
    if isinstance(ours, dict):
        assert set(ours) == set(theirs)
        for name in ours:
            agree(ours[name], theirs[name], share, **tolerance)
        return
    ours, theirs = ours.numpy(), theirs.numpy()
    assert (ours.dtype, ours.shape) == (theirs.dtype, theirs.shape)
    assert np.isclose(ours, theirs, **tolerance).sum() >= share * ours.size


@pytest.mark.parametrize("shape", [(2000,), (20, 30), (2, 3, 4), (1,), (0,)])
def test_first_hits_are_theirs(pair, shape):
    ours, theirs = (scene.cast_rays(rays(*shape)) for scene in pair)
    agree(ours, theirs, atol=2e-5)
    if shape == (2000,):
        assert set(np.unique(ours["geometry_ids"])) == {0, 1, RaycastingScene.INVALID_ID}


@pytest.mark.parametrize("shape", [(2000,), (20, 30)])
def test_occlusions_and_counts_are_theirs(pair, shape):
    agree(*(scene.test_occlusions(rays(*shape)) for scene in pair))
    near, far = (scene.test_occlusions(rays(*shape), tnear=0.3, tfar=0.8) for scene in pair)
    agree(near, far)
    assert 0 < near.mean() < 1
    agree(*(scene.test_occlusions(rays(*shape), 0.3, 0.8, 1) for scene in pair))
    agree(*(scene.count_intersections(rays(*shape)) for scene in pair))


def test_listed_intersections_are_theirs_but_in_order(pair):
    ours, theirs = (
        {name: value.numpy() for name, value in scene.list_intersections(rays(3000)).items()}
        for scene in pair
    )
    assert set(ours) == set(theirs)
    np.testing.assert_array_equal(ours["ray_splits"], theirs["ray_splits"])
    assert (np.diff(ours["t_hit"])[np.diff(ours["ray_ids"]) == 0] >= 0).all()
    order = np.lexsort((theirs["primitive_ids"], theirs["t_hit"], theirs["ray_ids"]))
    for name in set(ours) - {"ray_splits"}:
        assert ours[name].dtype == theirs[name].dtype
        np.testing.assert_allclose(ours[name], theirs[name][order], atol=5e-5)


@pytest.mark.parametrize("shape", [(2000,), (20, 30), (2, 3, 4), (1,)])
def test_closest_points_are_theirs(pair, shape):
    queries = points(*shape)
    ours, theirs = (scene.compute_closest_points(queries) for scene in pair)
    # Where several are as close, ours is on the triangle with the lowest index, theirs on any.
    agree({"points": ours["points"]}, {"points": theirs["points"]}, share=0.99, atol=1e-5)
    agree(ours, theirs, share=0.7, atol=1e-4)
    there = (
        np.linalg.norm(queries - answer["points"].numpy(), axis=-1) for answer in (ours, theirs)
    )
    np.testing.assert_allclose(*there, atol=1e-5)
    for method in ("compute_distance", "compute_signed_distance", "compute_occupancy"):
        agree(*(getattr(scene, method)(queries) for scene in pair), atol=1e-5)
    agree(*(scene.compute_signed_distance(queries, nsamples=3) for scene in pair), atol=1e-5)


MATRICES = (
    np.array([[40.0, 0, 16], [0, 50, 12], [0, 0, 1]]),
    np.array([[0.0, 1, 0, 3], [0, 0, 1, -2], [1, 0, 0, 1], [0, 0, 0, 1]]),
    32,
    24,
)
VIEW = {
    "fov_deg": 60,
    "center": [0, 0, 0],
    "eye": [3, 1, 2],
    "up": [0, 1, 0],
    "width_px": 32,
    "height_px": 24,
}


def test_cameras_are_theirs():
    theirs = open3d.t.geometry.RaycastingScene.create_rays_pinhole
    ours = RaycastingScene.create_rays_pinhole
    agree(ours(*MATRICES), theirs(*(Tensor(m) for m in MATRICES[:2]), *MATRICES[2:]), atol=1e-6)
    agree(ours(**VIEW), theirs(**VIEW), atol=1e-6)
    agree(ours(*VIEW.values()), theirs(*VIEW.values()), atol=1e-6)
    for bad in (
        {"fov_deg": 0},
        {"up": [3, 1, 2]},
        {"eye": [0, 0, 0]},
        {"center": [0, 0]},
        {"width_px": 0},
    ):
        with pytest.raises(ValueError, match=next(iter(bad))):
            ours(**{**VIEW, **bad})
    with pytest.raises(ValueError, match="inverse"):
        ours(np.zeros((3, 3)), np.eye(4), 4, 4)


def test_tensors_give_tensors(pair):
    ours, theirs = pair
    scene = RaycastingScene()
    ball = open3d.t.geometry.TriangleMesh.create_sphere(1.0)
    assert scene.add_triangles(ball) == 0
    assert scene.add_triangles(mesh=ball) == 1
    assert scene.add_triangles(ball.vertex.positions, ball.triangle.indices) == 2
    assert scene.tree.triangle_count == 3 * len(ball.triangle.indices)
    for method in ("cast_rays", "list_intersections", "compute_closest_points"):
        queries = Tensor(points(50) if "points" in method else rays(50))
        answers = getattr(ours, method)(queries)
        assert all(isinstance(answer, Tensor) for answer in answers.values())
        if method == "cast_rays":
            agree(answers, theirs.cast_rays(queries), atol=2e-5)
    assert isinstance(ours.compute_occupancy(Tensor(points(5))), Tensor)
    assert isinstance(
        RaycastingScene.create_rays_pinhole(*(Tensor(m) for m in MATRICES[:2]), 3, 2), Tensor
    )


def test_float64_is_taken_and_kept():
    corner = np.array([4_512_345.678, 5_412_345.125, 312.5])
    scene = RaycastingScene()
    vertices, faces = cube()
    scene.add_triangles(corner + 1e-3 * vertices, faces)
    hit = scene.cast_rays([np.concatenate([corner + [5e-4, 5e-4, 1], [0, 0, -1.0]])])
    np.testing.assert_allclose(hit["t_hit"], 0.999, rtol=1e-6)
    assert scene.compute_occupancy([corner + 5e-4]).tolist() == [1]


def test_meshes_can_be_added_later_and_scenes_pickled(pair):
    scene = RaycastingScene()
    assert scene.cast_rays(rays(5))["t_hit"].isinf().all()
    for vertices, faces in meshes():
        scene.add_triangles(vertices, faces)
        vertices[:] = faces[:] = 0
        scene.compute_distance(points(3))
    expected = pair[0].cast_rays(rays(100))
    for other in (scene, pickle.loads(pickle.dumps(scene))):
        agree(other.cast_rays(rays(100)), expected)


def test_edges_do_not_turn_the_inside_out():
    """Rays through edges and vertices are what more samples are for."""
    scene = RaycastingScene()
    scene.add_triangles(*cube(-1.0, 1.0))
    line = np.linspace(-0.9, 0.9, 200)
    # From here, the diagonal (1, 1, 1) runs through a vertex.
    diagonal = np.stack([line, line, line], axis=1)
    assert (scene.compute_occupancy(diagonal) == 1).all()
    assert (scene.compute_signed_distance(diagonal) < 0).all()
    assert (scene.compute_occupancy(diagonal + 2) == 0).all()


@pytest.mark.parametrize("bad", [np.zeros(3), np.zeros((2, 5)), 1.0, np.zeros((2, 7))])
def test_rays_of_a_wrong_shape(pair, bad):
    scene = pair[0]
    for method in (
        scene.cast_rays,
        scene.test_occlusions,
        scene.count_intersections,
        scene.list_intersections,
    ):
        with pytest.raises(ValueError, match=r"rays has shape .*\(…, 6\) is expected"):
            method(bad)
        with pytest.raises(TypeError, match="rays"):
            method([["a"] * 6])


@pytest.mark.parametrize("bad", [np.zeros(2), np.zeros((2, 6)), 1.0])
def test_points_of_a_wrong_shape(pair, bad):
    for method in (
        "compute_closest_points",
        "compute_distance",
        "compute_signed_distance",
        "compute_occupancy",
    ):
        with pytest.raises(ValueError, match=r"query_points has shape .*\(…, 3\) is expected"):
            getattr(pair[0], method)(bad)


def test_other_bad_input(pair):
    scene = RaycastingScene()
    vertices, faces = cube()
    for arguments in ((), (vertices,), (vertices, faces, 1), ("mesh",)):
        with pytest.raises(TypeError, match="add_triangles takes"):
            scene.add_triangles(*arguments)
    with pytest.raises(TypeError, match="add_triangles takes"):
        scene.add_triangles(vertices, vertex_positions=vertices)
    with pytest.raises(ValueError, match=r"faces\[0\]"):
        scene.add_triangles(vertices, faces + 8)
    with pytest.raises(ValueError, match=r"vertex_positions\[0\] is not finite"):
        scene.add_triangles(vertices * np.nan, faces)
    with pytest.raises(ValueError, match="vertex_positions has shape"):
        scene.add_triangles(vertices[:, :2], faces)
    for nsamples in (0, 2):
        with pytest.raises(ValueError, match="nsamples"):
            pair[0].compute_occupancy(points(1), nsamples=nsamples)
    with pytest.raises(ValueError, match="nthreads"):
        pair[0].cast_rays(rays(1), nthreads=-1)
    missed = pair[0].cast_rays([[np.nan] * 6, [0] * 6, [np.inf] * 6])
    assert (missed["primitive_ids"] == RaycastingScene.INVALID_ID).all()
    assert np.isfinite(missed["primitive_normals"]).all()


class TestDocumentedExamples:
    """What Open3D's documentation does with scenes, with the import changed."""

    def test_first_steps(self):
        box = open3d.t.geometry.TriangleMesh.create_box()
        scene = RaycastingScene()
        box_id = scene.add_triangles(box)
        rays = Tensor(
            [[0.5, 0.5, 10, 0, 0, -1], [-1, -1, -1, 0, 0, -1]], dtype=open3d.core.Dtype.Float32
        )
        ans = scene.cast_rays(rays)
        assert box_id == 0
        assert ans["t_hit"].numpy().tolist() == [9, np.inf]
        assert ans["geometry_ids"].numpy().tolist() == [0, scene.INVALID_ID]

    def test_point_cloud_of_a_picture(self):
        scene, theirs = RaycastingScene(), open3d.t.geometry.RaycastingScene()
        ball = open3d.t.geometry.TriangleMesh.create_sphere(0.5)
        for one in (scene, theirs):
            one.add_triangles(ball)
        view = {**VIEW, "center": Tensor([0.0, 0, 0])}
        rays = RaycastingScene.create_rays_pinhole(**view)
        ans = scene.cast_rays(rays)
        hit = ans["t_hit"].isfinite()
        found = rays[hit][:, :3] + rays[hit][:, 3:] * ans["t_hit"][hit].reshape((-1, 1))
        cloud = open3d.t.geometry.PointCloud(found)
        np.testing.assert_allclose(
            np.linalg.norm(cloud.point.positions.numpy(), axis=1), 0.5, atol=0.02
        )
        agree(ans, theirs.cast_rays(rays), share=0.99, atol=1e-5)

    def test_list_of_intersections(self):
        """The example in the method's own documentation, with numpy."""
        scene = RaycastingScene()
        v, t = icosphere(2, np.float32)
        scene.add_triangles(v, t.astype(np.uint32))
        rays_ = rays(200)
        lx = {k: x.numpy() for k, x in scene.list_intersections(rays_).items()}
        tidx, uv = lx["primitive_ids"], lx["primitive_uvs"]
        w = 1 - np.sum(uv, axis=1)
        c = (
            v[t[tidx, 1].flatten(), :] * uv[:, 0][:, None]
            + v[t[tidx, 2].flatten(), :] * uv[:, 1][:, None]
            + v[t[tidx, 0].flatten(), :] * w[:, None]
        )
        again = rays_[lx["ray_ids"]][:, :3] + rays_[lx["ray_ids"]][:, 3:] * lx["t_hit"][..., None]
        assert len(c) > 100
        np.testing.assert_allclose(c, again, atol=1e-5)

    def test_distance_field(self):
        scene, theirs = RaycastingScene(), open3d.t.geometry.RaycastingScene()
        for one in (scene, theirs):
            one.add_triangles(*meshes()[0])
        x = np.linspace(-1.2, 1.2, 20)
        grid = np.stack(np.meshgrid(x, x, x), axis=-1).astype(np.float32)
        agree(*(one.compute_signed_distance(grid) for one in (scene, theirs)), atol=1e-5)


def test_a_soup_is_answered_like_theirs():
    scenes = RaycastingScene(), open3d.t.geometry.RaycastingScene()
    vertices, faces = soup(500)
    for scene in scenes:
        scene.add_triangles(vertices, faces.astype(np.uint32))
    agree(*(scene.cast_rays(rays(3000)) for scene in scenes), share=0.999, atol=1e-4)
    agree(*(scene.count_intersections(rays(3000)) for scene in scenes), share=0.999)
    agree(*(scene.compute_distance(points(2000)) for scene in scenes), atol=1e-5)
