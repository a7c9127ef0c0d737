"""The trimesh classes beside trimesh's own, method by method."""

import copy
import inspect
import pickle

import numpy as np
import pytest
import trimesh
from trimesh import proximity

import kdray.trimesh
from kdray.trimesh import ray_pyembree, ray_triangle

OURS = {"pyembree": ray_pyembree, "triangle": ray_triangle}
THEIRS = {"pyembree": trimesh.ray.ray_pyembree, "triangle": trimesh.ray.ray_triangle}


def torus():
    return trimesh.creation.torus(2.0, 0.7, major_sections=24, minor_sections=16)


@pytest.fixture(scope="module", params=["ball", "torus", "annulus"])
def mesh(request):
    made = {"ball": trimesh.creation.icosphere(3), "torus": torus()}
    made["annulus"] = trimesh.creation.annulus(0.5, 1.0, 1.0)
    return made[request.param]


@pytest.fixture(params=list(OURS))
def pair(request, mesh):
    """Our intersector of the mesh, and trimesh's."""
    return (module[request.param].RayMeshIntersector(mesh) for module in (OURS, THEIRS))


def rays(count=300, seed=1):
    random = np.random.default_rng(seed)
    origins = random.uniform(-4, 4, (count, 3))
    return origins, random.uniform(-0.8, 0.8, (count, 3)) - origins


def in_order(triangle, ray, places=None):
    order = np.lexsort((triangle, ray))
    return [column[order] for column in (triangle, ray, places) if column is not None]


def parameters(method):
    """Those of a method that trimesh may have wrapped to log its time."""
    method = inspect.getclosurevars(method).nonlocals.get("method", method)
    return inspect.signature(method).parameters


@pytest.mark.parametrize("kind", OURS)
@pytest.mark.parametrize(
    "method",
    [
        "intersects_id",
        "intersects_location",
        "intersects_first",
        "intersects_any",
        "contains_points",
    ],
)
def test_arguments_have_trimeshs_names_and_places(kind, method):
    ours, theirs = (
        parameters(getattr(module[kind].RayMeshIntersector, method)) for module in (OURS, THEIRS)
    )
    assert [name for name in ours if name != "kwargs"] == [n for n in theirs if n != "kwargs"]
    for name in ours:
        if name in theirs and name != "max_hits":
            assert ours[name].default == theirs[name].default


def test_all_hits_are_theirs(pair):
    ours, theirs = (one.intersects_id(*rays(), return_locations=True) for one in pair)
    assert len(ours[0]) > 50
    for column, same in zip(in_order(*ours), in_order(*theirs)):
        assert column.dtype == same.dtype
        np.testing.assert_allclose(column, same, atol=1e-8)


def test_locations_are_theirs_and_in_order_along_the_ray(pair):
    ours, theirs = (one.intersects_location(*rays()) for one in pair)
    (places, ray, triangle), (their_places, their_ray, their_triangle) = ours, theirs
    np.testing.assert_allclose(
        in_order(triangle, ray, places)[2], in_order(their_triangle, their_ray, their_places)[2],
        atol=1e-8,
    )  # fmt: skip
    origins, _ = rays()
    distance = np.linalg.norm(places - origins[ray], axis=1)
    assert (np.diff(ray) >= 0).all()
    assert (np.diff(distance)[np.diff(ray) == 0] >= 0).all()


def test_first_hits_are_theirs(pair):
    ours, theirs = pair
    np.testing.assert_array_equal(ours.intersects_first(*rays()), theirs.intersects_first(*rays()))
    assert ours.intersects_first(*rays()).dtype == theirs.intersects_first(*rays()).dtype
    np.testing.assert_array_equal(ours.intersects_any(*rays()), theirs.intersects_any(*rays()))
    first, their_first = (
        one.intersects_id(*rays(), multiple_hits=False, return_locations=True)
        for one in (ours, theirs)
    )
    for column, same in zip(in_order(*first), in_order(*their_first)):
        np.testing.assert_allclose(column, same, atol=1e-8)


def test_inside_is_theirs(pair):
    points = np.random.default_rng(2).uniform(-2.5, 2.5, (400, 3))
    ours, theirs = (one.contains_points(points) for one in pair)
    np.testing.assert_array_equal(ours, theirs)
    assert 0 < ours.sum() < 400


def test_both_argument_orders(mesh):
    triangle, ray, places = ray_triangle.RayMeshIntersector(mesh).intersects_id(*rays(), True, True)
    again = ray_pyembree.RayMeshIntersector(mesh).intersects_id(*rays(), True, None, True)
    for column, same in zip((triangle, ray, places), again):
        np.testing.assert_array_equal(column, same)


@pytest.mark.parametrize("kind", OURS)
def test_no_hits_and_no_rays(mesh, kind):
    ray = OURS[kind].RayMeshIntersector(mesh)
    for origins in ([[9, 9, 9]], np.zeros((0, 3))):
        directions = np.ones_like(origins)
        places, index_ray, triangle = ray.intersects_location(origins, directions)
        assert places.shape == (0, 3)
        assert index_ray.shape == triangle.shape == (0,)
        assert ray.intersects_first(origins, directions).shape == (len(origins),)
        assert not ray.intersects_any(origins, directions).any()


@pytest.mark.parametrize("kind", OURS)
def test_bad_input_is_a_value_error(mesh, kind):
    ray = OURS[kind].RayMeshIntersector(mesh)
    for method in (
        ray.intersects_id,
        ray.intersects_location,
        ray.intersects_first,
        ray.intersects_any,
    ):
        with pytest.raises(ValueError, match="don't match"):
            method(np.zeros((2, 3)), np.ones((3, 3)))
        with pytest.raises(ValueError, match=r"ray_origins must be \(n,3\)"):
            method([0, 0, 0], [0, 0, 1])
    for points in ([0, 0, 0], np.zeros((3, 2)), np.zeros((2, 3, 3))):
        with pytest.raises(ValueError, match=r"points must be \(n,3\)"):
            ray.contains_points(points)


def test_hits_can_be_limited(mesh):
    ray = ray_pyembree.RayMeshIntersector(mesh)
    _, all_rays = ray.intersects_id(*rays())
    _, few_rays = ray.intersects_id(*rays(), max_hits=1)
    assert len(few_rays) < len(all_rays)
    np.testing.assert_array_equal(few_rays, np.unique(all_rays))


def test_a_mesh_that_changes_is_built_anew():
    mesh = trimesh.creation.box()
    ray, nearest = ray_pyembree.RayMeshIntersector(mesh), kdray.trimesh.ProximityQuery(mesh)
    assert ray.intersects_any([[3, 0, 3]], [[0, 0, -1]]).tolist() == [False]
    assert nearest.on_surface([[3, 0, 0]])[1].tolist() == [2.5]
    mesh.apply_translation([3, 0, 0])
    assert ray.intersects_any([[3, 0, 3]], [[0, 0, -1]]).tolist() == [True]
    assert nearest.signed_distance([[3, 0, 0]]).tolist() == [0.5]


@pytest.mark.parametrize("kind", OURS)
def test_pickles_and_copies(mesh, kind):
    ray = OURS[kind].RayMeshIntersector(mesh)
    expected = ray.intersects_first(*rays())
    for other in (pickle.loads(pickle.dumps(ray)), copy.copy(ray), copy.deepcopy(ray)):
        np.testing.assert_array_equal(other.intersects_first(*rays()), expected)


def test_closest_points_are_theirs(mesh):
    points = np.random.default_rng(3).uniform(-3, 3, (400, 3))
    ours, theirs = kdray.trimesh.ProximityQuery(mesh), proximity.ProximityQuery(mesh)
    (place, distance, triangle), (their_place, their_distance, _) = (
        one.on_surface(points) for one in (ours, theirs)
    )
    np.testing.assert_allclose(distance, their_distance, atol=1e-6)
    assert (distance <= their_distance + 1e-6).all()
    same = np.isclose(distance, their_distance, atol=1e-12)
    np.testing.assert_allclose(place[same], their_place[same], atol=1e-5)
    assert same.mean() > 0.95
    assert triangle.dtype == np.int64
    np.testing.assert_allclose(
        ours.signed_distance(points), theirs.signed_distance(points), atol=1e-6
    )
    np.testing.assert_array_equal(ours.vertex(points)[1], theirs.vertex(points)[1])
    np.testing.assert_allclose(
        kdray.trimesh.signed_distance(mesh, points[:9]), ours.signed_distance(points[:9])
    )
    np.testing.assert_array_equal(kdray.trimesh.closest_point(mesh, points[:9])[0], place[:9])


def test_proximity_refuses_bad_points(mesh):
    nearest = kdray.trimesh.ProximityQuery(mesh)
    for method in (nearest.on_surface, nearest.signed_distance):
        for bad in ([0, 0, 0], np.zeros((2, 2)), [[np.nan, 0, 0]]):
            with pytest.raises(ValueError, match="points must be"):
                method(bad)


@pytest.fixture
def installed():
    kdray.trimesh.install()
    kdray.trimesh.install()
    yield
    kdray.trimesh.uninstall()


def test_install(installed):
    mesh = torus()
    assert isinstance(mesh.ray, ray_pyembree.RayMeshIntersector)
    assert isinstance(mesh.nearest, kdray.trimesh.ProximityQuery)
    assert mesh.contains([[2, 0, 0], [0, 0, 0]]).tolist() == [True, False]
    points = mesh.triangles_center[::20]
    thick = proximity.thickness(mesh, points, method="ray")
    assert (thick > 0.5).all()
    same = pickle.loads(pickle.dumps(mesh))
    assert same.ray.intersects_any([[2, 0, 5]], [[0, 0, -1]]).all()
    native = trimesh.Trimesh(mesh.vertices, mesh.faces, use_embree=False)
    assert isinstance(native.ray, ray_triangle.RayMeshIntersector)
    kdray.trimesh.uninstall()
    assert type(torus().ray).__module__ == "trimesh.ray.ray_pyembree"


class TestDocumentedExamples:
    """What trimesh's documentation and examples do with rays, with the import changed."""

    def test_ray_example(self):
        mesh = trimesh.primitives.Sphere().to_mesh()
        mesh.ray = kdray.trimesh.RayMeshIntersector(mesh)
        origins, directions = np.array([[0, 0, -5], [2, 2, -10]]), np.array([[0, 0, 1], [0, 0, 1]])
        locations, index_ray, _ = mesh.ray.intersects_location(
            ray_origins=origins, ray_directions=directions
        )
        np.testing.assert_allclose(locations, [[0, 0, -1], [0, 0, 1]], atol=1e-2)
        assert index_ray.tolist() == [0, 0]

    def test_depth_image_example(self):
        """`scene.camera_rays()`, first hits, distances along the view."""
        mesh = trimesh.creation.icosphere(3)
        scene = mesh.scene()
        scene.camera.resolution = [40, 30]
        origins, vectors, pixels = scene.camera_rays()
        ours, theirs = (
            module.RayMeshIntersector(mesh).intersects_location(
                origins, vectors, multiple_hits=False
            )
            for module in (ray_pyembree, trimesh.ray.ray_pyembree)
        )
        np.testing.assert_array_equal(ours[1], np.sort(theirs[1]))
        np.testing.assert_allclose(ours[0], theirs[0][np.argsort(theirs[1])], atol=1e-8)
        assert len(pixels[ours[1]]) > 100

    def test_nearest_example(self):
        mesh = trimesh.creation.icosphere(3)
        points = mesh.bounding_box_oriented.sample_volume(count=50)
        ours, theirs = kdray.trimesh.ProximityQuery(mesh), proximity.ProximityQuery(mesh)
        for column, same in zip(ours.on_surface(points)[:2], theirs.on_surface(points)[:2]):
            np.testing.assert_allclose(column, same, atol=1e-6)
