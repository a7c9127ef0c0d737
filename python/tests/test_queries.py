"""Answers, against every triangle in numpy; and the shapes and dtypes they come in."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

import kdray
from conftest import crossings, cube, icosphere, random_rays, soup


@pytest.fixture(scope="module")
def scene():
    vertices, faces = soup()
    return vertices, faces, kdray.build(vertices, faces)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_hits_are_those_of_every_triangle(scene, dtype):
    vertices, faces, tree = scene
    origins, directions = random_rays(2000, dtype=dtype)
    t = crossings(vertices, faces, origins, directions)
    hits = tree.closest_hit(origins, directions)
    np.testing.assert_array_equal(hits.triangle, np.where(np.isfinite(t.min(1)), t.argmin(1), -1))
    np.testing.assert_allclose(hits.t, t.min(1), rtol=1e-5)
    np.testing.assert_array_equal(hits.mask, np.isfinite(hits.t))
    np.testing.assert_array_equal(tree.any_hit(origins, directions), hits.mask)
    np.testing.assert_array_equal(tree.count_hits(origins, directions), np.isfinite(t).sum(1))
    expected = (origins + hits.t[:, None] * directions)[hits.mask]
    np.testing.assert_allclose(hits.points[hits.mask], expected, atol=1e-5)
    assert hits.points.dtype == hits.normals.dtype == dtype
    assert np.isnan(hits.points[~hits.mask]).all() and np.isnan(hits.normals[~hits.mask]).all()


def test_all_hits_come_in_order_and_once(scene):
    vertices, faces, tree = scene
    origins, directions = random_rays(500)
    t = crossings(vertices, faces, origins, directions)
    hits = tree.all_hits(origins, directions)
    np.testing.assert_array_equal(np.diff(hits.offsets), np.isfinite(t).sum(1))
    assert len(hits.t) > 700
    order = t.argsort(1)
    expected = np.concatenate([row[: np.isfinite(t[ray]).sum()] for ray, row in enumerate(order)])
    np.testing.assert_array_equal(hits.triangle, expected)
    np.testing.assert_array_equal(hits.ray, np.repeat(np.arange(500), np.diff(hits.offsets)))
    np.testing.assert_allclose(hits.t, t[hits.ray, hits.triangle], rtol=1e-4)
    np.testing.assert_allclose(
        hits.points, origins[hits.ray] + hits.t[:, None] * directions[hits.ray], atol=1e-5
    )
    few = tree.all_hits(origins, directions, max_hits=2)
    np.testing.assert_array_equal(np.diff(few.offsets), np.minimum(np.isfinite(t).sum(1), 2))
    first = few.offsets[:-1][np.diff(few.offsets) > 0]
    closest = tree.closest_hit(origins, directions)
    np.testing.assert_array_equal(few.triangle[first], closest.triangle[closest.mask])


def test_intervals_exclusion_and_mask(scene):
    vertices, faces, tree = scene
    origins, directions = random_rays(500)
    t = crossings(vertices, faces, origins, directions)
    first = tree.closest_hit(origins, directions)
    second = tree.closest_hit(origins, directions, exclude=first.triangle)
    t[first.mask, first.triangle[first.mask]] = np.inf
    np.testing.assert_array_equal(second.triangle, np.where(np.isfinite(t.min(1)), t.argmin(1), -1))
    beyond = tree.closest_hit(origins, directions, t_min=np.nextafter(first.t, np.float32(np.inf)))
    np.testing.assert_array_equal(beyond.triangle, second.triangle)
    upto = tree.any_hit(origins, directions, t_max=np.nextafter(first.t, np.float32(0)))
    assert not upto[first.mask].any()
    mask = np.arange(len(faces)) % 2 == 0
    visible = crossings(vertices, faces[mask], origins, directions)
    count = tree.count_hits(origins, directions, mask=mask)
    np.testing.assert_array_equal(count, np.isfinite(visible).sum(1))
    assert (tree.all_hits(origins, directions, mask=mask).triangle % 2 == 0).all()


def test_points_inside_and_closest(sphere):
    vertices, faces = sphere.vertices, sphere.faces
    random = np.random.default_rng(5)
    points = random.uniform(-1.5, 1.5, (2000, 3))
    radius = np.linalg.norm(points, axis=1)
    inside = sphere.contains(points)
    clear = np.abs(radius - 1) > 0.02
    np.testing.assert_array_equal(inside[clear], (radius < 1)[clear])
    found = sphere.closest_point(points)
    signed = sphere.signed_distance(points)
    np.testing.assert_allclose(np.abs(signed), found.distance, rtol=1e-6)
    np.testing.assert_array_equal(signed < 0, inside)
    weights = np.stack([1 - found.u - found.v, found.u, found.v], axis=1)
    there = (weights[:, :, None] * vertices[faces[found.triangle]]).sum(1)
    np.testing.assert_allclose(there, found.point, atol=1e-6)
    np.testing.assert_allclose(
        np.linalg.norm(points - found.point, axis=1), found.distance, atol=1e-6
    )
    nearest_vertex = np.linalg.norm(points[:, None] - vertices, axis=2).min(1)
    assert (found.distance <= nearest_vertex + 1e-6).all()
    assert (found.distance >= np.abs(radius - 1) - 0.02).all()
    near = sphere.closest_point(points, max_distance=0.1)
    np.testing.assert_array_equal(
        near.triangle, np.where(found.distance <= 0.1, found.triangle, -1)
    )
    assert np.isinf(near.distance[near.triangle < 0]).all()
    assert np.isnan(near.point[near.triangle < 0]).all()


def test_a_mesh_with_a_hole_has_an_inside_by_its_winding_number(sphere):
    faces = sphere.faces[np.abs(sphere.vertices[sphere.faces[:, 0]] - [0, 0, 1]).max(1) > 0.2]
    assert 0 < len(sphere.faces) - len(faces) < 60
    tree = kdray.build(sphere.vertices, faces)
    points = np.random.default_rng(4).uniform(-1.5, 1.5, (3000, 3))
    radius = np.linalg.norm(points, axis=1)
    clear = (np.abs(radius - 1) > 0.02) & (np.abs(points - [0, 0, 1]).max(1) > 0.5)
    np.testing.assert_array_equal(tree.contains(points, sign="winding")[clear], (radius < 1)[clear])
    signed = tree.signed_distance(points, sign="winding")
    np.testing.assert_array_equal((signed < 0)[clear], (radius < 1)[clear])
    # Exactly, triangle by triangle: twice the arctangent of the solid angle's half.
    a, b, c = (tree.vertices[faces][:, corner] - points[:50, None] for corner in range(3))
    la, lb, lc = (np.linalg.norm(corner, axis=2) for corner in (a, b, c))
    volume = (a * np.cross(b, c)).sum(2)
    dots = (a * b).sum(2) * lc + (b * c).sum(2) * la + (c * a).sum(2) * lb
    exact = 2 * np.arctan2(volume, la * lb * lc + dots).sum(1) / (4 * np.pi)
    for tolerance in (1e-2, 1e-6):
        numbers = tree.winding_number(points[:50], tolerance=tolerance)
        np.testing.assert_allclose(numbers, exact, rtol=0, atol=tolerance)


def test_within(sphere):
    centers = np.random.default_rng(6).uniform(-1.2, 1.2, (50, 3))
    near = sphere.within_sphere(centers, 0.25)
    corners = sphere.vertices[sphere.faces]
    for index, center in enumerate(centers):
        found = near.triangle[near.offsets[index] : near.offsets[index + 1]]
        touched = (np.linalg.norm(corners - center, axis=2) <= 0.25).any(1)
        assert set(np.flatnonzero(touched)) <= set(found)
        assert (np.diff(found) > 0).all()
        boxed = sphere.within_box(center - 0.25, center + 0.25)
        assert set(found) <= set(boxed.triangle)
        inside = (np.abs(corners - center) <= 0.25).all(2).any(1)
        assert set(np.flatnonzero(inside)) <= set(boxed.triangle)
        apart = (corners.min(1) > center + 0.25).any(1) | (corners.max(1) < center - 0.25).any(1)
        assert not set(np.flatnonzero(apart)) & set(boxed.triangle)
    radii = np.linspace(0.1, 0.5, 50)
    each = sphere.within_sphere(centers, radii)
    for index in (0, 49):
        one = sphere.within_sphere(centers[index], radii[index])
        found = each.triangle[each.offsets[index] : each.offsets[index + 1]]
        np.testing.assert_array_equal(found, one.triangle)


SHAPES = hnp.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=4)


@settings(max_examples=60, deadline=None)
@given(shape=SHAPES, dtype=st.sampled_from([np.float32, np.float64]), seed=st.integers(0, 99))
def test_every_shape_answers_in_that_shape(sphere, shape, dtype, seed):
    random = np.random.default_rng(seed)
    origins = random.uniform(-2, 2, (*shape, 3)).astype(dtype)
    directions = random.uniform(-1, 1, (*shape, 3)).astype(dtype)
    flat = origins.reshape(-1, 3), directions.reshape(-1, 3)
    hits, one_row = sphere.closest_hit(origins, directions), sphere.closest_hit(*flat)
    for column, row in zip(hits, one_row):
        assert column.shape == shape
        np.testing.assert_array_equal(column.reshape(-1), row)
    assert hits.points.shape == hits.normals.shape == (*shape, 3)
    assert sphere.any_hit(origins, directions).shape == shape
    assert sphere.count_hits(origins, directions).shape == shape
    assert len(sphere.all_hits(origins, directions).offsets) == len(flat[0]) + 1
    assert sphere.contains(origins).shape == sphere.winding_number(origins).shape == shape
    assert sphere.signed_distance(origins).shape == shape
    assert sphere.signed_distance(origins).dtype == dtype
    found = sphere.closest_point(origins)
    assert found.point.shape == (*shape, 3) and found.distance.shape == shape
    assert found.point.dtype == found.distance.dtype == dtype


LAYOUTS = {
    "fortran": np.asfortranarray,
    "slice": lambda array: np.repeat(array, 2, axis=0)[::2],
    "reversed": lambda array: array[::-1].copy()[::-1],
    "columns": lambda array: np.concatenate([array, array], axis=1)[:, 3:],
    "swapped": lambda array: array.astype(array.dtype.newbyteorder()),
    "frozen": lambda array: np.frombuffer(array.tobytes(), array.dtype).reshape(array.shape),
    "misaligned": lambda array: np.frombuffer(
        b"x" + array.tobytes(), array.dtype, offset=1
    ).reshape(array.shape),
    "list": np.ndarray.tolist,
}


def arrays(answer):
    return answer if isinstance(answer, tuple) else (answer,)


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize(
    "query",
    [
        *("closest_hit", "any_hit", "count_hits", "all_hits", "within_box"),
        *("contains", "closest_point", "signed_distance", "winding_number", "within_sphere"),
    ],
)
def test_any_layout_gives_the_same_answers(sphere, query, layout):
    """Sliced, reversed, transposed, byte-swapped, read-only, misaligned: all the same numbers."""
    first, second = random_rays(16)
    given = {
        "within_box": (first, first + 1),
        "within_sphere": (first, np.linspace(0, 1, 16, dtype=np.float32)),
    }.get(query, (first, second)[: 1 + ("hit" in query)])
    other = [
        LAYOUTS[layout](array) if array.ndim == 2 or layout != "columns" else array
        for array in given
    ]
    answers = (arrays(getattr(sphere, query)(*rows)) for rows in (given, other))
    for column, same in zip(*answers):
        np.testing.assert_allclose(column, same, rtol=1e-6 if layout == "list" else 0)


@pytest.mark.parametrize("layout", LAYOUTS)
def test_any_layout_gives_the_same_tree(layout):
    vertices, faces = (array.copy() for array in cube())
    tree = kdray.build(LAYOUTS[layout](vertices), LAYOUTS[layout](faces))
    assert tree._tree.to_bytes() == kdray.build(vertices, faces)._tree.to_bytes()
    assert (vertices == cube()[0]).all() and (faces == cube()[1]).all()


def test_one_origin_for_many_directions_and_the_other_way_round(sphere):
    _, directions = random_rays(20)
    together = sphere.closest_hit([3.0, 0, 0], directions)
    apart = sphere.closest_hit(np.tile([3.0, 0, 0], (20, 1)), directions)
    np.testing.assert_array_equal(together.triangle, apart.triangle)
    assert sphere.closest_hit(directions, [0, 0, 1.0]).t.shape == (20,)
    grid = sphere.any_hit(np.zeros((4, 1, 3)), directions[:5])
    assert grid.shape == (4, 5) and grid.all()


def test_batches_answer_like_single_rays(sphere):
    origins, directions = random_rays(700)
    batch = sphere.closest_hit(origins, directions)
    for ray in range(0, 700, 37):
        single = sphere.closest_hit(origins[ray], directions[ray])
        assert all(a[ray] == b for a, b in zip(batch, single))
    for threads in (1, 2, 3):
        again = sphere.closest_hit(origins, directions, threads=threads)
        assert all((a == b).all() for a, b in zip(batch, again))


def test_normals_point_outward_from_a_closed_mesh():
    tree = kdray.build(*cube())
    directions = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1.0]])
    hits = tree.closest_hit([0.4, 0.45, 0.55], directions)
    np.testing.assert_array_equal(hits.normals, directions)


@pytest.mark.parametrize("scale", [1e-30, 1e-6, 1.0, 1e6, 1e30])
@pytest.mark.parametrize("offset", [0.0, 1e6])
def test_scale_and_distance_do_not_matter(scale, offset):
    vertices, faces = icosphere(2)
    shift = offset * scale * np.array([1.0, -2.0, 3.0])
    tree = kdray.build(vertices * scale + shift, faces)
    origins, directions = random_rays(300, dtype=np.float64)
    near = kdray.build(vertices, faces)
    expected = near.closest_hit(origins, directions)
    hits = tree.closest_hit(origins * scale + shift, directions * scale)
    same = hits.triangle == expected.triangle
    assert same.mean() > 0.98
    np.testing.assert_allclose(hits.t[same], expected.t[same], rtol=1e-4)
    points = np.random.default_rng(3).uniform(-1.5, 1.5, (300, 3))
    np.testing.assert_array_equal(tree.contains(points * scale + shift), near.contains(points))
    distance = tree.closest_point(points * scale + shift).distance / scale
    np.testing.assert_allclose(distance, near.closest_point(points).distance, atol=1e-5)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("offset", [0.0, 1e6])
def test_many_rays_to_one_light_answer_like_a_few(sphere, dtype, offset):
    """So many are asked in another order, and answered in the one that they have."""
    vertices, faces = icosphere(1)  # So large triangles that sorting pays.
    tree = kdray.build(vertices + offset, faces)
    random = np.random.default_rng(11)
    starts = random.normal(0, 1, (100_003, 3))
    light = np.array([0.3, 4.0, 0.5])
    for origins, directions in (
        (starts, light - starts),
        (starts * 1.5, np.broadcast_to([0.0, -4.0, 1.0], starts.shape)),
    ):
        rays = (origins + offset).astype(dtype), directions.astype(dtype)
        found, hits = tree.any_hit(*rays, t_max=1.0), tree.closest_hit(*rays, t_min=0.01)
        assert 0.01 < found.mean() < 0.99
        for start in range(0, len(starts), 10_000):
            part = slice(start, start + 10_000)
            few = rays[0][part], rays[1][part]
            np.testing.assert_array_equal(tree.any_hit(*few, t_max=1.0), found[part])
            for column, same in zip(tree.closest_hit(*few, t_min=0.01), hits):
                np.testing.assert_array_equal(column, same[part])


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_some_rays_without_meaning_among_many(sphere, bad):
    origins = np.random.default_rng(12).normal(0, 1, (50_000, 3)).astype(np.float32)
    directions = np.float32([0, 3, 0]) - origins
    origins[::7, 0], directions[1::7, 1], directions[2::7] = bad, bad, 0
    found = sphere.any_hit(origins, directions)
    assert not (found[::7].any() or found[1::7].any() or found[2::7].any())
    few = slice(20_000, 22_000)
    np.testing.assert_array_equal(found[few], sphere.any_hit(origins[few], directions[few]))
    assert found[few].any()


def test_many_threads_make_what_a_tree_makes_when_first_asked():
    """One that waited for another could wait for itself: threads of a pool take up other work."""
    points = random_rays(2000, dtype=np.float64)[0]
    for _ in range(20):
        tree = kdray.build(*icosphere(4))
        for query in (tree.winding_number, tree.contains, tree.signed_distance):
            with ThreadPoolExecutor(8) as pool:
                answers = list(pool.map(query, [points] * 8))
            for answer in answers:
                np.testing.assert_array_equal(answer, answers[0])
