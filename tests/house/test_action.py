"""The composite action: its steps, run as by a shell of the runner."""

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from tests.own_cache import around_kernels

yaml = pytest.importorskip("yaml")

ROOT = Path(__file__).resolve().parents[2]
ACTION: dict[str, Any] = yaml.safe_load((ROOT / "action.yml").read_text(encoding="utf-8"))
BOX = """<mujoco><worldbody><geom name="ground" type="plane" size="5 5 .1"/>
<body name="a" pos="0 0 0.3"><freejoint/><geom type="box" size=".1 .1 .1" mass="1"/></body></worldbody></mujoco>"""
QUICK = "--engine tracker avatarsim --frames 20 --jobs 0"


def ran(name: str, folder: Path, **inputs: str) -> subprocess.CompletedProcess[str]:
    """Run a step in the folder of a repository, with inputs by their names with underscores."""
    [step] = [step for step in ACTION["runs"]["steps"] if step.get("name") == name]
    given = {key: entry.get("default", "") for key, entry in ACTION["inputs"].items()}
    given |= {key.replace("_", "-"): value for key, value in inputs.items()}
    values = {f"inputs.{key}": value for key, value in given.items()}
    values |= {"github.action_path": str(ROOT), "runner.temp": str(folder / "temp")}
    expression = re.compile(r"\$\{\{ ([\w.-]+) \}\}")
    environment = {key: expression.sub(lambda found: values[found[1]], text) for key, text in step["env"].items()}
    if "AVATARSIM_CACHE_DIR" in environment:
        # with the kernels that are compiled already
        environment["AVATARSIM_CACHE_DIR"] = str(around_kernels())
    known = {**os.environ, **environment, "GITHUB_STEP_SUMMARY": str(folder / "summary.md"), "PYTHONPATH": str(ROOT)}
    assert step["shell"] == "bash"
    shell = ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", step["run"]]
    return subprocess.run(shell, cwd=folder, env=known, capture_output=True, text=True, check=False)


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    (tmp_path / "my cell.xml").write_text(BOX)
    return tmp_path


def test_no_input_is_put_into_a_script() -> None:
    scripts = [step["run"] for step in ACTION["runs"]["steps"] if "run" in step]
    assert len(scripts) == 2 and not any("${{" in script for script in scripts)


@pytest.mark.parametrize(("package", "asked"), [("", f"{ROOT}[compare]"), ("avatarsim[compare]==1", "avatarsim[compare]==1")])
def test_pip_installs_the_actions_checkout_or_a_package(repository: Path, package: str, asked: str) -> None:
    stand_in = repository / "stand_in"
    stand_in.write_text('#!/bin/sh\nprintf "%s\\n" "$@" > calls\n')
    stand_in.chmod(0o755)
    assert ran("install", repository, package=package, python=str(stand_in)).returncode == 0
    assert (repository / "calls").read_text().splitlines() == ["-m", "pip", "install", "--quiet", asked]


def test_the_job_ends_with_the_code_of_the_comparison(repository: Path) -> None:
    done = ran("compare", repository, scene="my cell.xml", gate="avatarsim avatarsim/default", max_overlap="1mm",
               max="frame_time_p50=1e-6us not_finite_frames=0", options=QUICK, python=sys.executable)
    assert done.returncode == 1, done.stderr
    suite = ElementTree.parse(repository / "avatarsim.xml").getroot()
    assert (suite.get("failures"), len(suite) > 1) == ("1", True)
    assert "tracker/default" in done.stdout and done.stdout in (repository / "summary.md").read_text()


@pytest.mark.parametrize("path", sorted((ROOT / ".github").rglob("*.yml")), ids=lambda path: path.name)
def test_forms_and_workflows_can_be_read(path: Path) -> None:
    read = yaml.safe_load(path.read_text(encoding="utf-8"))
    assert "body" in read if path.parent.name == "ISSUE_TEMPLATE" else "jobs" in read


def test_wrong_input_ends_the_job(repository: Path) -> None:
    done = ran("compare", repository, scene="none; touch here", options=QUICK, python=sys.executable)
    assert done.returncode == 2 and "none; touch here" in done.stderr and not (repository / "here").exists()
