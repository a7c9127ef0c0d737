"""What users of other libraries complain of, most often first; each with the right answer."""

import numpy as np
import pytest

import kdray
from conftest import cube, icosphere, soup

CLOSED = {
    "cube": cube(),
    "sphere": icosphere(2),
    "far sphere": (icosphere(2)[0] + 1e6, icosphere(2)[1]),
}


@pytest.fixture(scope="module", params=CLOSED)
def closed(request):
    """Vertices, faces and tree of a closed mesh, and a point well inside."""
    vertices, faces = CLOSED[request.param]
    return vertices, faces, kdray.build(vertices, faces)


def edges(faces):
    return np.unique(np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)


class TestWrongHitsAtEdgesAndCorners:
    """Rays through edges, corners and along axes miss, or hit twice."""

    def aimed(self, vertices, faces):
        """Lines from outside that pass through each vertex and each middle of an edge."""
        targets = np.concatenate([vertices, vertices[edges(faces)].mean(axis=1)])
        center, size = vertices.mean(0), np.ptp(vertices)
        steps = np.array(
            [[1.0, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [1, 1, 1], [0.3, -0.7, 0.2]]
        )
        origins = targets[:, None] - 4 * size * steps
        toward = np.broadcast_to(steps, origins.shape)
        through = targets[:, None] - center
        return [
            (origins, toward),
            (center + 3 * through, -through),
            (np.tile(center, (len(targets), 1)), through[:, 0]),
        ]

    def test_lines_cross_a_closed_surface_an_even_number_of_times(self, closed):
        vertices, faces, tree = closed
        through, across, outward = self.aimed(vertices, faces)
        for origins, directions in (through, across):
            assert (tree.count_hits(origins, directions) % 2 == 0).all()
        assert (tree.count_hits(*outward) == 1).all()
        assert tree.closest_hit(*outward).mask.all() and tree.closest_hit(*across).mask.all()

    def test_all_queries_agree(self, closed):
        vertices, faces, tree = closed
        for origins, directions in self.aimed(vertices, faces):
            hits = tree.closest_hit(origins, directions)
            counts = tree.count_hits(origins, directions)
            offsets, t, triangle, *_ = tree.all_hits(origins, directions)
            np.testing.assert_array_equal(hits.mask, tree.any_hit(origins, directions))
            np.testing.assert_array_equal(hits.mask, counts > 0)
            np.testing.assert_array_equal(np.diff(offsets), counts.reshape(-1))
            first = offsets[:-1][hits.mask.reshape(-1)]
            np.testing.assert_array_equal(triangle[first], hits.triangle[hits.mask])
            np.testing.assert_array_equal(t[first], hits.t[hits.mask])

    def test_rays_in_the_plane_of_a_face_do_not_end_up_inside(self):
        tree = kdray.build(*cube())
        along = np.array([[-1.0, 0.5, z] for z in (0, 1)])
        assert (tree.count_hits(along, [1.0, 0, 0]) % 2 == 0).all()


class TestRepeatedHits:
    """One crossing is reported several times, or surfaces close together as one."""

    def test_each_triangle_once(self):
        vertices, faces = soup(400)
        tree = kdray.build(vertices, faces)
        random = np.random.default_rng(7)
        origins = random.uniform(-2, 2, (3000, 3))
        hits = tree.all_hits(origins, random.uniform(-1, 1, (3000, 3)) - origins)
        pairs = np.stack([hits.ray, hits.triangle], axis=1)
        assert len(pairs) > 3000 and len(np.unique(pairs, axis=0)) == len(pairs)

    @pytest.mark.parametrize("gap", [1e-3, 1e-6, 0.0])
    def test_sheets_close_together_are_all_there(self, gap):
        sheet = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
        vertices = np.concatenate([sheet + [0, 0, gap * layer] for layer in range(100)])
        tree = kdray.build(vertices, np.arange(300).reshape(-1, 3))
        hits = tree.all_hits([0.25, 0.25, -1], [0, 0, 1])
        np.testing.assert_array_equal(hits.triangle, np.arange(100))
        assert (np.diff(hits.t) >= 0).all()

    def test_more_than_a_hundred_hits(self):
        sheet = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
        vertices = np.concatenate([sheet + [0, 0, layer] for layer in range(5000)])
        tree = kdray.build(vertices, np.arange(15_000).reshape(-1, 3))
        hits = tree.all_hits([[0.25, 0.25, -1], [0.25, 0.25, 5001]], [[0, 0, 1], [0, 0, -1]])
        np.testing.assert_array_equal(hits.triangle[:5000], hits.triangle[:4999:-1])


class TestAllHitsInOneCall:
    """All hits, with their rays and triangles, in order."""

    def test_sorted_by_ray_and_distance(self, closed):
        vertices, _, tree = closed
        random = np.random.default_rng(8)
        origins = vertices.mean(0) + random.normal(0, 3, (1000, 3))
        hits = tree.all_hits(origins, vertices.mean(0) - origins)
        assert (np.diff(hits.ray) >= 0).all() and len(hits.t) > 1000
        assert (np.diff(hits.t)[np.diff(hits.ray) == 0] >= 0).all()
        for column in hits[1:]:
            assert len(column) == hits.offsets[-1] == len(hits.points)


class TestSelfHits:
    """A ray that starts on a surface hits that surface."""

    def test_the_triangle_it_starts_on_can_be_left_out(self, closed):
        vertices, faces, tree = closed
        starts = vertices[faces].mean(axis=1)
        inward = vertices.mean(0) - starts
        own = np.arange(len(faces))
        hits = tree.closest_hit(starts, inward, exclude=own)
        assert hits.mask.all() and (hits.triangle != own).all()
        np.testing.assert_allclose(hits.t, 2, atol=0.1)
        assert not tree.any_hit(starts, -inward, exclude=own).any()

    def test_or_passed_by_a_distance_of_its_own(self, closed):
        vertices, faces, tree = closed
        starts = vertices[faces].mean(axis=1)
        inward = vertices.mean(0) - starts
        t_min = np.linspace(1e-3, 1e-2, len(faces))
        np.testing.assert_allclose(tree.closest_hit(starts, inward, t_min=t_min).t, 2, atol=0.1)


class TestPrecision:
    """Double precision, large coordinates, small parts."""

    def test_a_millimetre_on_the_map(self):
        corner = np.array([4_512_345.678, 5_412_345.125, 312.5])
        vertices, faces = cube()
        tree = kdray.build(corner + 1e-3 * vertices, faces)
        hits = tree.closest_hit(corner + [5e-4, 5e-4, 1], [0, 0, -1.0])
        np.testing.assert_allclose(hits.points[2], corner[2] + 1e-3, rtol=0, atol=1e-7)
        points = corner + 1e-3 * np.array([[0.5, 0.5, 0.5], [1.5, 0.5, 0.5]])
        assert tree.contains(points).tolist() == [True, False]

    def test_hits_lie_on_their_triangles_and_rays(self):
        vertices, faces = icosphere(3)
        tree = kdray.build(1e-3 * vertices, faces)
        origins = np.random.default_rng(9).normal(0, 1, (1000, 3))
        hits = tree.closest_hit(origins, -origins)
        assert hits.mask.all()
        np.testing.assert_allclose(np.linalg.norm(hits.points, axis=1), 1e-3, rtol=0.01)
        np.testing.assert_allclose(hits.points, origins * (1 - hits.t)[:, None], atol=3e-7)


class TestInside:
    """Inside tests that are unstable, or blind to cavities."""

    def test_the_answer_is_the_same_every_time(self, closed):
        vertices, _, tree = closed
        points = vertices.mean(0) + np.random.default_rng(10).uniform(-1.2, 1.2, (5000, 3))
        first = tree.contains(points)
        for threads in (1, 2):
            np.testing.assert_array_equal(first, tree.contains(points, threads=threads))

    def test_many_points_are_told_what_few_are_told(self, closed):
        """Many are looked up in cells, few ask rays."""
        vertices, faces, tree = closed
        points = vertices.mean(0) + np.random.default_rng(11).uniform(-1.2, 1.2, (20_000, 3))
        many = tree.contains(points)
        for few in np.split(np.arange(len(points)), 1000)[::50]:
            fresh = kdray.build(vertices, faces)
            np.testing.assert_array_equal(fresh.contains(points[few]), many[few])
        assert 0 < many.sum() < len(many)

    def test_a_cavity_is_outside(self):
        outer, inner = cube(), cube(0.25, 0.75)
        vertices = np.concatenate([outer[0], inner[0]])
        tree = kdray.build(vertices, np.concatenate([outer[1], inner[1] + 8]))
        assert tree.contains([[0.5, 0.5, 0.5], [0.1, 0.1, 0.1], [2, 2, 2]]).tolist() == [
            False,
            True,
            False,
        ]

    def test_points_level_with_vertices_and_edges(self, closed):
        vertices, _, tree = closed
        center, size = vertices.mean(0), np.ptp(vertices, axis=0).max()
        for axis in range(3):
            points = vertices.copy()
            points[:, axis] = center[axis] + size
            assert not tree.contains(points).any()
        assert tree.contains(center + 0.1 * (vertices - center)).all()
