"""Every scene proves that it can tell good from bad: four bad engines, each fails each scene, at the gate, with exit code 1."""

import json
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from avatarsim.scene.tracker import link_poses_each
from reference.judge import Judge
from scenarios.__main__ import main
from scenarios.catalog import scenarios
from tests.scenarios.bad_engines import DEPTH, joined

AFTER_CONTACT = 4
"""Frames beyond the first one in which the raw tracker is well inside something: enough for every badness to show."""
AT_ONCE = 60
"""Frames of the raw tracker that are judged at once; one by one takes ten times as long."""
WITHOUT_AVATAR = 0.7
"""Length [s] of a scene without avatar: a ball that falls 1 m lands after 0.45 s, and its bounce is asked for 0.1 s later."""


@pytest.fixture(autouse=True)
def _strangers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    folder = tmp_path / "site"
    folder.mkdir()
    monkeypatch.syspath_prepend(joined(folder))
    # the pages have their own tests, and take longer than these runs
    monkeypatch.setattr("reports.write_report", lambda run_dir: None)
    yield


@cache
def frames(name: str) -> int:
    """How long a run must be for the raw tracker to have been deeper in something than DEPTH."""
    scenario = scenarios()[name].as_run(False)
    scene = scenario.build()
    if not scene.avatars:
        return min(max(round(WITHOUT_AVATAR / scenario.dt), AFTER_CONTACT), scenario.frames)
    judge, motion = Judge(scene), scenario.motion(scene, 0)
    bodies = np.array([body.position for body in scene.bodies]).reshape(-1, 3)
    turned = np.array([body.orientation for body in scene.bodies]).reshape(-1, 4)
    for start in range(0, scenario.frames, AT_ONCE):
        samples = [motion(k) for k in range(start, min(start + AT_ONCE, scenario.frames))]
        links, turns = link_poses_each(scene.avatars, samples)
        positions = np.concatenate([np.broadcast_to(bodies, (len(samples), *bodies.shape)), links], axis=1)
        orientations = np.concatenate([np.broadcast_to(turned, (len(samples), *turned.shape)), turns], axis=1)
        inside = np.flatnonzero(judge.depths(positions, orientations) > 2.0 * DEPTH)
        if len(inside):
            return min(start + int(inside[0]) + AFTER_CONTACT, scenario.frames)
    raise AssertionError(f"the raw tracker of {name} never overlaps: the scene judges nothing")


@pytest.mark.parametrize("name", list(scenarios()))
@pytest.mark.parametrize(("engine", "metric"), [
    ("frozen", None), ("tunnels", "residual_overlap_max"), ("two_millimetres", "residual_overlap_max"),
    ("not_a_number", "not_finite_frames"),
])
def test_a_bad_engine_fails_the_scene(name: str, engine: str, metric: str | None, tmp_path: Path) -> None:
    words = ["check", "--engine", engine, "--filter", name, "--out", str(tmp_path / "out"), "--jobs", "0"]
    assert main([*words, "--frames", str(frames(name))]) == 1
    results = json.loads((tmp_path / "out" / "latest" / "results.json").read_text())
    assert results["exit_code"] == 1
    failed = {row["metric"]: row["value"] for row in results["rows"] if row["status"] == "fail"}
    assert failed
    # where nothing can touch, an engine without contact is caught by how it flies or turns
    touches = not scenarios()[name].expects.get("nothing_touches")
    if metric is not None and (touches or engine == "not_a_number"):
        assert metric in failed
    if scenarios()[name].expects.get("refusal"):
        # it begins badly on purpose: whoever shows it at all is seen inside
        assert {"residual_overlap_max", "not_finite_frames"} & set(failed)
        return
    if engine == "two_millimetres" and touches:
        assert failed[metric] == pytest.approx(DEPTH, abs=2e-5)
    if engine == "frozen":
        # it is caught for what it is, and not because the scene begins badly
        assert not {"residual_overlap_max", "wrong_side_frames", "not_finite_frames"} & set(failed)
