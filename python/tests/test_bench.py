"""The benchmark runs, its engines agree, and its table says what the record says."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

COMPARE = Path(__file__).parents[1] / "bench" / "compare.py"
RECORDS = sorted((COMPARE.parent / "records").glob("*.json"))


def call(*arguments):
    command = [sys.executable, str(COMPARE), *map(str, arguments)]
    ran = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert ran.returncode == 0, ran.stderr
    return ran.stdout


def test_a_small_run(tmp_path):
    path = tmp_path / "record.json"
    call("run", "-o", path, "--rays", 2000, "--points", 2000, "--passes", 1)
    (scene,) = json.loads(path.read_text())["scenes"]
    assert (scene["mesh"], scene["triangles"]) == ("knot", 3840)
    for row in scene["rows"]:
        assert set(row["seconds"]) == {"kdray", "open3d", "trimesh"}
        assert all(share < 0.01 for share in row["differ"].values()), row
    table = call("table", path)
    assert "**knot**, 3,840 triangles" in table
    assert table.count("\n|") == 10


@pytest.mark.parametrize("record", RECORDS, ids=lambda path: path.stem)
def test_records_have_tables(record):
    assert call("table", record).count("**") >= 2
