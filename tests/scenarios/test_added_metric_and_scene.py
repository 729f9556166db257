"""A metric added by one entry and one function, and a scene by one file: both appear in table, gate and pages."""

import csv
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

HOUSE = Path(__file__).parents[2]
ROOMS = ("runfiles", "scenarios")
ENTRY = """
[highest]
unit = "m"
label = "greatest height"
definition = "largest height of a simulated body"
kind = "bodies"
level = 1e-3
"""
FUNCTION = '''"""Height of bodies."""

from avatarsim.scene.body import Role
from avatarsim.scene.scene import Scene
from runfiles.record import Recording
from scenarios.measure.value import Values, measure


@measure
def highest(recording: Recording, scene: Scene) -> Values:
    """Return the largest height of a simulated body."""
    bodies = [k for k, role in enumerate(scene.roles) if role is Role.SIMULATED]
    return {"highest": float(recording.positions[:, bodies, 2].max())} if bodies else {}
'''
SCENE = '''"""A ball that falls."""

from avatarsim.scene.body import simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Piece, Sphere
from scenarios.motion.untracked import untracked
from scenarios.scenario import Bound, Scenario


def build() -> Scene:
    """A ball 2 m above the ground, which is not there."""
    pieces = (Piece(Sphere(0.1)),)
    return Scene("toy_fall", (simulated("ball", pieces, "wood", solid(pieces, 1.0), (0.0, 0.0, 2.0)),))


SCENARIO = Scenario(
    "toy_fall", "A ball falls.", "It never rises.", build, untracked(), 30, bounds=(Bound("highest", 2.0, "it falls"),),
)
'''


def test_they_are_in_table_gate_and_pages(tmp_path: Path) -> None:
    for room in ROOMS:
        shutil.copytree(HOUSE / room, tmp_path / room, ignore=shutil.ignore_patterns("out", "__pycache__"))
    with (tmp_path / "runfiles" / "metrics.toml").open("a") as file:
        file.write(ENTRY)
    (tmp_path / "scenarios" / "measure" / "heights.py").write_text(FUNCTION)
    (tmp_path / "scenarios" / "catalog" / "toy_fall.py").write_text(SCENE)
    # a run of a given length has no studies
    words = ["compare", "--filter", "toy_fall", "--engine", "avatarsim", "--frames", "30", "--out", "out"]
    line = [sys.executable, "-m", "scenarios", *words]
    # the rooms of this folder are first
    done = subprocess.run(line, cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(HOUSE)}, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    run = tmp_path / "out" / "latest"
    rows = list(csv.DictReader((run / "results.csv").read_text().splitlines()))
    [own] = [row for row in rows if (row["metric"], row["engine"], row["preset"]) == ("highest", "avatarsim", "default")]
    assert (own["status"], float(own["value"]), own["unit"], float(own["bound"])) == ("pass", 2.0, "m", 2.0)
    for page in ("glossary.html", "scenes/toy_fall.html"):
        assert "greatest height" in (run / page).read_text()
    assert json.loads((run / "results.json").read_text())["scenes"]["toy_fall"]["title"] == "A ball falls."
    assert "toy_fall" in (run / "index.html").read_text()
