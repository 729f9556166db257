"""Every example runs in a short form, states its subject, and shows it."""

import ast
import importlib
import math
import os
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from tests.live.ports.opened import Opened, until

FOLDER = Path(__file__).resolve().parents[2] / "examples"
NAMES = ("rigid_hand", "jointed_hand", "humanoid_on_a_clip", "two_hands_and_a_mug", "many_worlds", "own_loop",
         "shield_for_an_arm")
CLIENTS = ("drive_from_a_tracker",)
"""Examples of programs that speak to avatarsim over its ports, and need nothing of it."""
ENGINES = ("engine_of_your_own",)
"""Examples of engines that join the comparison, which need more names of the package."""
MOST_LINES = 95


@pytest.fixture
def example(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """A module of the folder by name, as Python finds it when one of its files is run."""
    monkeypatch.syspath_prepend(str(FOLDER))
    return importlib.import_module(request.param)


def test_all_examples_are_tested() -> None:
    assert {file.stem for file in FOLDER.glob("*.py")} == {*NAMES, *CLIENTS, *ENGINES}


def needed(name: str) -> set[str]:
    """Return the modules outside the standard library that an example of at most MOST_LINES lines imports, subject stated."""
    text = (FOLDER / f"{name}.py").read_text(encoding="utf-8")
    tree = ast.parse(text)
    assert len(text.splitlines()) <= MOST_LINES and "Shows: " in str(ast.get_docstring(tree))
    modules = {alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names}
    modules |= {str(node.module) for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    return {module for module in modules if module.partition(".")[0] not in sys.stdlib_module_names}


@pytest.mark.parametrize("name", NAMES)
def test_an_example_uses_the_public_names_alone(name: str) -> None:
    modules = needed(name)
    assert "avatarsim" in modules and not [module for module in modules if module.startswith("avatarsim.")]


@pytest.mark.parametrize(("name", "packages"), [("engine_of_your_own", {"avatarsim", "numpy"}),
                                                ("drive_from_a_tracker", {"websockets"})])
def test_an_engine_or_client_needs_few_packages(name: str, packages: set[str]) -> None:
    assert {module.partition(".")[0] for module in needed(name)} == packages


@pytest.mark.parametrize("way", ["udp", "ws"])
@pytest.mark.parametrize("example", ["drive_from_a_tracker"], indirect=True)
def test_a_tracker_of_ones_own_leads_a_link(example: ModuleType, way: str) -> None:
    live = Opened()
    with live.ports:
        _, port = live.udp if way == "udp" else live.web
        example.main(["hand", f"--{way}", str(port)], frames=3)
        until(lambda: len(live.targets) == 3)
        assert not live.ports.refusals.counts
    goals = [target[0].links["hand"].position for target in live.targets]
    assert np.linalg.norm(np.array(goals) - example.CENTRE, axis=1) == pytest.approx(0.2)
    assert goals[0][1] == 0.0 and goals[2][1] > goals[1][1] > 0.0


@pytest.mark.parametrize("example", ["rigid_hand"], indirect=True)
def test_a_hand_stops_on_the_table_and_pushes_the_ball(example: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    record = example.main(frames=150)
    said = capsys.readouterr().out.splitlines()
    assert len(said) == 6 and "table-hand" in said[1] and said[-1].startswith("the ball is at")
    # half the palm's thickness and the stand-off
    assert record.shown.positions[2, 2] == pytest.approx(0.015 + 2e-4, abs=2e-4)
    assert record.shown.positions[1, 0] > 0.22 and record.shown.positions[1, 2] >= 0.05 - 1e-6


@pytest.mark.parametrize("example", ["jointed_hand"], indirect=True)
def test_fingers_stop_at_the_bar(example: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    record = example.main()
    said = capsys.readouterr().out
    assert "the user bends every joint by 80 degrees" in said and "links touch the bar: hand/" in said
    fingers = record.angles.reshape(4, 3)
    assert (fingers.min(axis=1) < math.radians(70.0)).all(), "each finger is held off its user's fist"
    assert np.ptp(fingers, axis=0).max() < 0.2, "fingers alike in all but their place bend alike"


@pytest.mark.parametrize("example", ["humanoid_on_a_clip"], indirect=True)
def test_a_body_stays_before_the_wall(example: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    record = example.main(frames=120)
    said = capsys.readouterr().out.splitlines()
    assert len(said) == 4 and said[0].endswith("free") and "user at x = 2.00 m" in said[-1]
    assert record.shown.positions[1:, 0].max() < 1.45


@pytest.mark.parametrize("example", ["two_hands_and_a_mug"], indirect=True)
def test_a_mug_is_pushed_and_stopped_and_gives_way_to_a_bowl(example: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    record = example.main(frames=120)
    said = capsys.readouterr().out.splitlines()
    assert "touches left, right, table" in said[-2] and "bowl is at x = 0.3 m" in said[-1]
    # the mug's radius and half a palm before the right hand, which gave way a little
    assert float(said[-2].split()[4]) == pytest.approx(-0.15 + 0.01 + 0.04, abs=0.005)
    assert record.shown.time > 1.9 and record.shown.positions[2, 1] == pytest.approx(-0.055, abs=0.01)


@pytest.mark.parametrize("hands", [False, True])
@pytest.mark.parametrize("example", ["many_worlds"], indirect=True)
def test_many_worlds_are_timed_three_ways(example: ModuleType, hands: bool, capsys: pytest.CaptureFixture[str]) -> None:
    found = example.main(frames=3, worlds=5, threads=2, hands=hands)
    said = capsys.readouterr().out
    assert list(found) == ["one by one", "together, 1 thread", "together, 2 threads"] and min(found.values()) > 0.0
    assert "5 worlds of" in said and said.count("frames of avatars a second") == 3


@pytest.mark.parametrize("example", ["shield_for_an_arm"], indirect=True)
def test_an_arm_stops_above_its_table_within_its_limits(example: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    q = np.array(example.main(seconds=1.5))
    said = capsys.readouterr().out.splitlines()
    assert len(said) == 3 and "down to -200 mm" in said[0]
    # the tool's radius above the table, and at most the margin of 1 mm and a little more
    assert 30.0 <= float(said[0].split()[-4]) < 35.0
    speed, change = np.diff(q, axis=0) * example.RATE, np.diff(q, n=2, axis=0) * example.RATE**2
    assert np.abs(speed).max() <= example.SPEED and np.abs(change).max() <= example.ACCELERATION * (1.0 + 1e-6)
    assert np.abs(speed).max() > 0.2, "it moves at all"


@pytest.mark.parametrize("example", ["own_loop"], indirect=True)
def test_a_loop_of_ones_own_topples_a_tower(example: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    record = example.main(frames=120, port=0, opens_browser=False)
    fallen = int(capsys.readouterr().out.splitlines()[-1].split()[3])
    assert record.shown.time == pytest.approx(2.0) and 1 < fallen <= 5


def test_a_cell_is_checked_by_pytest(tmp_path: Path) -> None:
    folder = tmp_path / "ci"
    shutil.copytree(FOLDER / "ci", folder, ignore=shutil.ignore_patterns("__pycache__"))
    environment = {**os.environ, "PYTHONPATH": str(FOLDER.parent), "PYTEST_ADDOPTS": "", "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
    words = [sys.executable, "-P", "-m", "pytest", "-q", "-p", "avatarsim.pytest_plugin", "-p", "no:cacheprovider", str(folder)]
    done = subprocess.run(words, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0 and "4 passed" in done.stdout
