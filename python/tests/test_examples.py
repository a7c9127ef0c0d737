"""The examples and the notebook run, and stay short; so do those of the README."""

import re
import subprocess
import sys
from pathlib import Path

import nbformat
import numpy as np
import pytest
from nbclient import NotebookClient

HERE = Path(__file__).parent
EXAMPLES = sorted((HERE.parent / "examples").glob("*.py"))
ARGUMENTS = {"cluster.py": ["200000"]}


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.name)
def test_example(example, tmp_path):
    assert len(example.read_text().splitlines()) < 40
    command = [sys.executable, str(example), *ARGUMENTS.get(example.name, [])]
    ran = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert ran.returncode == 0, ran.stderr
    assert re.search(r"\d", ran.stdout)


def test_an_x_ray_of_a_sphere_is_as_thick_as_the_sphere(monkeypatch):
    monkeypatch.syspath_prepend(str(HERE.parent / "examples"))
    from xray import inside_length

    import kdray

    tree = kdray.build(*kdray.generate.sphere(6))
    origins = np.stack([np.linspace(-0.9, 0.9, 50), np.zeros(50), np.full(50, 3.0)], axis=1)
    length = inside_length(tree, origins, np.array([0, 0, -1.0]))
    np.testing.assert_allclose(length, 2 * np.sqrt(1 - origins[:, 0] ** 2), atol=1e-2)


@pytest.mark.filterwarnings("ignore")
def test_the_notebook_runs():
    notebook = nbformat.read(HERE.parent / "examples" / "tour.ipynb", as_version=4)
    assert not any(cell.get("outputs") for cell in notebook.cells), "outputs are not kept"
    NotebookClient(notebook, timeout=300, kernel_name="python3").execute()
    pictures = [
        output
        for cell in notebook.cells
        for output in cell.get("outputs", [])
        if "image/png" in output.get("data", {})
    ]
    assert len(pictures) >= 7


@pytest.mark.parametrize("readme", [HERE.parent / "README.md", HERE.parent.parent / "README.md"])
def test_the_readme_does_what_it_says(readme, capsys):
    (example,) = re.findall(r"```python\n(.*?)```", readme.read_text(), re.DOTALL)
    exec(example, {})
    said = re.search(r"print\(.*\)\s+# (.*)", example)[1]
    assert capsys.readouterr().out.strip() == said
