"""What works, and what is said, where trimesh, Open3D and dask are not installed."""

import subprocess
import sys
import textwrap

BLOCK = """
    import importlib, sys

    class Missing:
        def find_spec(self, name, path=None, target=None):
            if name.partition(".")[0] in ("trimesh", "open3d", "dask", "distributed", "embreex"):
                raise ModuleNotFoundError(f"No module named {name!r}", name=name)

    sys.meta_path.insert(0, Missing())
    """


def run(script):
    code = textwrap.dedent(BLOCK) + textwrap.dedent(script)
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)
    assert ran.returncode == 0, ran.stderr
    return ran.stdout


def test_kdray_needs_none_of_them():
    run("""
        import kdray
        vertices, faces = kdray.generate.sphere(2)
        tree = kdray.build(vertices, faces)
        assert tree.any_hit([0, 0, 9], [0, 0, -1]) and tree.contains([0, 0, 0])
        assert not any(name in sys.modules for name in ("trimesh", "open3d", "dask"))
        """)


def test_the_open3d_class_gives_arrays():
    run("""
        import numpy as np
        import kdray
        from kdray.open3d import RaycastingScene
        scene = RaycastingScene()
        vertices, faces = kdray.generate.sphere(2)
        assert scene.add_triangles(vertices.astype(np.float32), faces.astype(np.uint32)) == 0
        rays = RaycastingScene.create_rays_pinhole(60, [0, 0, 0], [0, 0, 4], [0, 1, 0], 8, 6)
        hits = scene.cast_rays(rays)
        assert isinstance(hits["t_hit"], np.ndarray) and hits["t_hit"].shape == (6, 8)
        assert np.isfinite(hits["t_hit"].numpy()).any()
        assert scene.compute_signed_distance(np.zeros((1, 3), np.float32)) < 0
        """)


def test_the_others_say_what_they_need():
    said = run("""
        for name in ("trimesh", "dask"):
            try:
                importlib.import_module(f"kdray.{name}")
            except ImportError as error:
                print(error.name, error, sep=": ")
        """)
    assert said.splitlines() == [
        "trimesh: kdray.trimesh needs trimesh: pip install kdray[trimesh]",
        "dask: kdray.dask needs dask: pip install kdray[dask]",
    ]
