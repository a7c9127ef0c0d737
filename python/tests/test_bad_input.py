"""Bad input gets an error that names the argument, or the answer that the documentation states."""

import numpy as np
import pytest

import kdray
from conftest import cube

RAY_QUERIES = ["closest_hit", "any_hit", "count_hits", "all_hits"]
POINT_QUERIES = ["contains", "closest_point", "signed_distance", "winding_number"]
CORNERS = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])


@pytest.mark.parametrize("query", RAY_QUERIES)
class TestRays:
    @pytest.mark.parametrize("origins", [[[0.0, 0]], 1.0, np.zeros((3, 4)), np.zeros((0, 2)), []])
    def test_wrong_shapes_are_named(self, sphere, query, origins):
        with pytest.raises(ValueError, match=r"origins has shape .*\(…, 3\) is expected"):
            getattr(sphere, query)(origins, [0, 0, 1])
        with pytest.raises(ValueError, match="directions has shape"):
            getattr(sphere, query)([0, 0, 1], origins)

    def test_shapes_that_do_not_go_together(self, sphere, query):
        with pytest.raises(
            ValueError, match=r"do not go together: origins \(2, 3\) and directions"
        ):
            getattr(sphere, query)(np.zeros((2, 3)), np.ones((3, 3)))

    @pytest.mark.parametrize("origins", ["abc", [1j, 0, 0], [True, False, True], [None] * 3, {}])
    def test_what_is_not_numbers_is_named(self, sphere, query, origins):
        with pytest.raises(TypeError, match="origins"):
            getattr(sphere, query)(origins, [0, 0, 1])

    @pytest.mark.parametrize("origins", [[[1.0, 2], [3]], [[0, 0, 0], "x"]])
    def test_ragged_lists_are_named(self, sphere, query, origins):
        with pytest.raises((TypeError, ValueError), match="origins"):
            getattr(sphere, query)(origins, [0, 0, 1])

    @pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
    @pytest.mark.parametrize("dtype", [np.float32, np.float64])
    def test_rays_that_are_not_finite_hit_nothing(self, sphere, query, bad, dtype):
        origins = np.zeros((9, 3), dtype)
        directions = np.ones((9, 3), dtype)
        origins[[0, 1, 2], [0, 1, 2]] = bad
        directions[[3, 4, 5], [0, 1, 2]] = bad
        directions[6] = 0
        hits = getattr(sphere, query)(origins, directions)
        if query == "closest_hit":
            hits = hits.mask
        elif query == "all_hits":
            hits = np.diff(hits.offsets)
        np.testing.assert_array_equal(np.asarray(hits, int), [0] * 7 + [1] * 2)

    def test_nothing_is_asked(self, sphere, query):
        answer = getattr(sphere, query)(np.zeros((0, 3)), np.zeros((0, 3)))
        if query == "all_hits":
            assert answer.offsets.tolist() == [0] and len(answer.t) == 0
        else:
            assert np.shape(answer[0] if query == "closest_hit" else answer) == (0,)

    @pytest.mark.parametrize("limit", ["t_min", "t_max"])
    def test_limits(self, sphere, query, limit):
        ask = getattr(sphere, query)
        with pytest.raises(ValueError, match=f"{limit} is NaN"):
            ask([0, 0, 0], [0, 0, 1], **{limit: np.nan})
        with pytest.raises(ValueError, match=f"{limit} has a NaN"):
            ask(np.zeros((2, 3)), [0, 0, 1], **{limit: [0, np.nan]})
        with pytest.raises(ValueError, match=rf"{limit} has shape \(3,\); \(2,\) is expected"):
            ask(np.zeros((2, 3)), [0, 0, 1], **{limit: [0, 0, 0]})
        with pytest.raises(TypeError, match=limit):
            ask([0, 0, 0], [0, 0, 1], **{limit: "far"})
        ask([0, 0, 0], [0, 0, 1], **{limit: 1e300})

    def test_exclude_and_mask(self, sphere, query):
        ask = getattr(sphere, query)
        with pytest.raises(TypeError, match="exclude has dtype float64; integers are expected"):
            ask([0, 0, 0], [0, 0, 1], exclude=1.5)
        with pytest.raises(ValueError, match="exclude has shape"):
            ask(np.zeros((2, 3)), [0, 0, 1], exclude=[1, 2, 3])
        for mask in ([0, 1], np.ones((2, 2), bool), True):
            with pytest.raises(TypeError, match="mask"):
                ask([0, 0, 0], [0, 0, 1], mask=mask)
        with pytest.raises(ValueError, match="mask has 3 values for 1280 triangles"):
            ask([0, 0, 0], [0, 0, 1], mask=[True, False, True])
        for there_is_none in (-1, 10**6, -5, 2**40):
            ask([0, 0, 0], [0, 0, 1], exclude=there_is_none)

    @pytest.mark.parametrize(
        ("threads", "error"),
        [
            (0, ValueError),
            (-1, ValueError),
            (10**6, ValueError),
            (1.5, TypeError),
            ("2", TypeError),
            (True, TypeError),
        ],
    )
    def test_threads(self, sphere, query, threads, error):
        with pytest.raises(error, match="threads"):
            getattr(sphere, query)([0, 0, 0], [0, 0, 1], threads=threads)


@pytest.mark.parametrize(("limit", "error"), [(0, ValueError), (-1, ValueError), (2.0, TypeError)])
def test_max_hits(sphere, limit, error):
    with pytest.raises(error, match="max_hits"):
        sphere.all_hits([0, 0, 0], [0, 0, 1], max_hits=limit)


@pytest.mark.parametrize("query", POINT_QUERIES)
class TestPoints:
    @pytest.mark.parametrize("points", [[[0.0, 0]], 1.0, np.zeros((3, 4)), []])
    def test_wrong_shapes_are_named(self, sphere, query, points):
        with pytest.raises(ValueError, match="points has shape"):
            getattr(sphere, query)(points)

    @pytest.mark.parametrize("points", ["abc", [1j, 0, 0], [None] * 3])
    def test_what_is_not_numbers_is_named(self, sphere, query, points):
        with pytest.raises(TypeError, match="points"):
            getattr(sphere, query)(points)

    @pytest.mark.parametrize("bad", [np.nan, np.inf])
    def test_points_that_are_not_finite_are_nowhere(self, sphere, query, bad):
        points = np.zeros((4, 3))
        points[[0, 1, 2], [0, 1, 2]] = bad
        answer = getattr(sphere, query)(points)
        if query == "closest_point":
            answer = answer.triangle >= 0
        found = np.isfinite(answer) if query == "signed_distance" else answer
        np.testing.assert_allclose(np.asarray(found, float), [0, 0, 0, 1], atol=1e-3)

    def test_nothing_is_asked(self, sphere, query):
        answer = getattr(sphere, query)(np.zeros((0, 3)))
        assert (answer.distance if query == "closest_point" else answer).shape == (0,)


HUGE = np.broadcast_to(np.float64(0), (1 << 58, 3))
ASKED = {
    **{query: (HUGE, [0.0, 0, 1]) for query in RAY_QUERIES},
    **dict.fromkeys(POINT_QUERIES, (HUGE,)),
    "within_sphere": (HUGE, 1.0),
    "within_box": (HUGE, HUGE),
}


@pytest.mark.parametrize("query", ASKED)
def test_more_than_there_is_memory_for(sphere, query):
    """The question takes none; the answer must not end the process."""
    with pytest.raises(MemoryError):
        getattr(sphere, query)(*ASKED[query])


def test_distances_and_radii(sphere):
    for bad in (-1.0, np.nan):
        with pytest.raises(ValueError, match="max_distance"):
            sphere.closest_point([0, 0, 0], max_distance=bad)
        with pytest.raises(ValueError, match="radius"):
            sphere.within_sphere([0, 0, 0], bad)
        with pytest.raises(ValueError, match="tolerance"):
            sphere.winding_number([0, 0, 0], tolerance=bad)
    for query in (sphere.contains, sphere.signed_distance):
        with pytest.raises(ValueError, match="sign is 'both'"):
            query([0, 0, 0], sign="both")
    with pytest.raises(ValueError, match=r"radius has shape \(3,\)"):
        sphere.within_sphere(np.zeros((2, 3)), [1, 2, 3])
    with pytest.raises(ValueError, match="centers has shape"):
        sphere.within_sphere([0, 0], 1)
    with pytest.raises(ValueError, match="upper has shape"):
        sphere.within_box([0, 0, 0], [0, 0])
    with pytest.raises(TypeError, match="lower"):
        sphere.within_box("a", [0, 0, 0])
    assert len(sphere.within_sphere([np.nan, 0, 0], 9).triangle) == 0
    assert len(sphere.within_sphere([0, 0, 0], np.inf).triangle) == 1280
    assert len(sphere.within_box([1, 1, 1], [-1, -1, -1]).triangle) == 0
    assert len(sphere.within_box([np.nan] * 3, [1, 1, 1]).triangle) == 0


class TestBuild:
    @pytest.mark.parametrize("vertices", [[[0.0, 0]], np.zeros((2, 3, 3)), [1.0, 2, 3], 1.0])
    def test_vertices_of_a_wrong_shape(self, vertices):
        with pytest.raises(ValueError, match="vertices has shape"):
            kdray.build(vertices, [[0, 0, 0]])

    @pytest.mark.parametrize("faces", [[[0, 1]], np.zeros((1, 4), int), np.zeros(3, int), 1])
    def test_faces_of_a_wrong_shape(self, faces):
        with pytest.raises(ValueError, match=r"faces has shape .*\(n, 3\) is expected"):
            kdray.build(CORNERS, faces)

    @pytest.mark.parametrize("faces", [[[0.0, 1, 2]], "abc", [[True, False, True]]])
    def test_faces_that_are_not_integers(self, faces):
        with pytest.raises(TypeError, match="faces has dtype"):
            kdray.build(CORNERS, faces)

    @pytest.mark.parametrize("dtype", [np.int8, np.int32, np.uint32, np.int64, np.uint64])
    @pytest.mark.parametrize("index", [3, 100, -1])
    def test_an_index_out_of_range_is_named(self, dtype, index):
        if index < 0 and np.dtype(dtype).kind == "u":
            index = np.iinfo(dtype).max
        faces = np.array([[0, 1, 2], [0, 1, index]], dtype)
        with pytest.raises(ValueError, match=r"faces\[1\] is \[0, 1, .*\]; there are 3 vertices"):
            kdray.build(CORNERS, faces)

    @pytest.mark.parametrize("bad", [np.nan, np.inf])
    @pytest.mark.parametrize("dtype", [np.float32, np.float64])
    def test_a_vertex_that_is_not_finite_is_named(self, bad, dtype):
        vertices = CORNERS.astype(dtype)
        vertices[1, 2] = bad
        with pytest.raises(ValueError, match=r"vertices\[1\] is not finite"):
            kdray.build(vertices, [[0, 1, 2]])

    @pytest.mark.parametrize(
        ("options", "error", "message"),
        [
            ({"builder": "fast"}, ValueError, 'builder is "fast"'),
            ({"device": "no such card"}, ValueError, "device: "),
            ({"device": 1.5}, TypeError, "device is 1.5"),
            ({"cost_traversal": -1.0}, ValueError, "cost_traversal is -1"),
            ({"cost_intersect": np.nan}, ValueError, "cost_intersect is NaN"),
            ({"empty_bonus": 1.0}, ValueError, "empty_bonus is 1"),
            ({"max_depth": 256}, ValueError, "max_depth is 256"),
            ({"max_depth": -1}, ValueError, "max_depth is -1"),
            ({"max_depth": 1.5}, TypeError, "max_depth is 1.5"),
            ({"max_leaf": -1}, ValueError, "max_leaf"),
            ({"threads": 0}, ValueError, "threads"),
            ({"memory_budget": -1}, ValueError, "memory_budget"),
            ({"memory_budget": 10}, MemoryError, "memory budget of 10 bytes"),
            ({"colour": "red"}, TypeError, "colour"),
        ],
    )
    def test_options(self, options, error, message):
        with pytest.raises(error, match=message):
            kdray.build(*cube(), **options)

    def test_nothing_to_build(self):
        for faces in ([], np.zeros((0, 3), np.int64)):
            tree = kdray.build(np.zeros((0, 3)), faces)
            assert tree.triangle_count == 0 and not tree.any_hit([0, 0, 0], [0, 0, 1])
            assert tree.closest_point([0, 0, 0]).triangle == -1 and not tree.contains([0, 0, 0])

    def test_triangles_without_area(self):
        vertices = np.zeros((4, 3))
        vertices[1:, 0] = 1, 2, 2
        tree = kdray.build(vertices, [[0, 0, 0], [0, 1, 2], [2, 3, 2]])
        tree.validate()
        assert not tree.any_hit([1, 0, 1], [0, 0, -1])
        assert tree.closest_point([1, 0, 1]).distance == 1
        assert (tree._normals(np.arange(3, dtype=np.int32)) == 0).all()


class TestRender:
    @pytest.mark.parametrize(
        ("options", "error", "name"),
        [
            ({"width": 0}, ValueError, "width"),
            ({"height": -1}, ValueError, "height"),
            ({"width": 1 << 20, "height": 1 << 20}, ValueError, "too many pixels"),
            ({"width": 8.5}, TypeError, "width"),
            ({"shading": "toon"}, ValueError, "shading"),
            ({"samples": 0}, ValueError, "samples"),
            ({"eye": [0, 0]}, ValueError, "eye"),
            ({"target": [np.nan, 0, 0]}, ValueError, "target"),
            ({"up": "z"}, TypeError, "up"),
            ({"fov": 180.0}, ValueError, "fov"),
        ],
    )
    def test_options(self, triangle, options, error, name):
        with pytest.raises(error, match=name):
            triangle.render(**{"width": 16, "height": 16, **options})


class TestFiles:
    def test_missing(self, tmp_path):
        for read in (kdray.load, kdray.Tree.open):
            with pytest.raises(FileNotFoundError, match="missing") as raised:
                read(tmp_path / "missing.ply")
            assert str(raised.value.filename) == str(tmp_path / "missing.ply")

    def test_folders_are_no_files(self, tmp_path, triangle):
        for act in (kdray.load, kdray.Tree.open, triangle.save):
            with pytest.raises(OSError):
                act(tmp_path)
        with pytest.raises(FileNotFoundError):
            triangle.save(tmp_path / "missing" / "tree")
        assert list(tmp_path.iterdir()) == []

    @pytest.mark.parametrize("content", [b"", b"hello", b"ply\nformat ascii 1.0\n", b"v 0 0\n"])
    def test_broken_meshes_are_named(self, tmp_path, content):
        path = tmp_path / "broken.obj"
        path.write_bytes(content)
        with pytest.raises(ValueError, match=r"broken\.obj: "):
            kdray.load(path)

    def test_damaged_trees_are_refused(self, tmp_path, triangle):
        path = tmp_path / "tree.kdray"
        triangle.save(path)
        content = path.read_bytes()
        for length in range(0, len(content), 7):
            path.write_bytes(content[:length])
            with pytest.raises((ValueError, OSError), match=r"tree\.kdray"):
                kdray.Tree.open(path)
        for place in range(0, len(content), 3):
            damaged = bytearray(content)
            damaged[place] ^= 0x10
            path.write_bytes(damaged)
            with pytest.raises(ValueError):
                kdray.Tree.open(path)

    @pytest.mark.parametrize("read", [kdray.load, kdray.Tree.open])
    def test_what_is_no_path(self, read):
        with pytest.raises(TypeError):
            read(1.5)


class TestGenerate:
    @pytest.mark.parametrize(
        ("call", "error", "name"),
        [
            (lambda: kdray.generate.sphere(11), ValueError, "subdivisions is 11"),
            (lambda: kdray.generate.sphere(1.5), TypeError, "subdivisions"),
            (lambda: kdray.generate.torus_knot((0, 3)), ValueError, "windings is 0"),
            (lambda: kdray.generate.torus_knot(segments=2), ValueError, "segments is 2"),
            (lambda: kdray.generate.torus_knot(sides=10**6), ValueError, "sides"),
            (lambda: kdray.generate.showcase(0), ValueError, "triangles is 0"),
            (lambda: kdray.generate.showcase("many"), TypeError, "triangles"),
        ],
    )
    def test_sizes(self, call, error, name):
        with pytest.raises(error, match=name):
            call()

    def test_closed_meshes_are_closed(self):
        for mesh in (kdray.generate.sphere(2), kdray.generate.torus_knot(segments=60, sides=8)):
            edges = np.sort(mesh[1][:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
            assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
