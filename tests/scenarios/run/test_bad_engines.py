"""Every scene separates good from bad: four bad engines, each fails each scene, at the gate, with exit code 1."""

import json
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from avatarsim.scene.tracker import link_poses_each
from reference.judging.judge import Judge
from scenarios.__main__ import main
from scenarios.catalog import scenarios
from tests.scenarios.bad_engines import DEPTH, joined
from tests.scenarios.conftest import without_reports

AFTER_CONTACT = 4
"""Frames after the first one in which the raw tracker is clearly inside something: enough for every fault to appear."""
AT_ONCE = 60
"""Frames of the raw tracker that are judged together; one by one takes ten times as long."""
WITHOUT_AVATAR = 0.7
"""Length [s] of a scene without avatar: a ball that falls 1 m lands after 0.45 s, and its bounce is checked 0.1 s later."""

METRICS = {
    "frozen": None, "tunnels": "residual_overlap_max", "two_millimetres": "residual_overlap_max",
    "not_a_number": "not_finite_frames",
}
"""Bad engines, and the bound that has to catch each of them; None: any bound."""


@pytest.fixture(autouse=True, scope="module")
def _strangers(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(joined(tmp_path_factory.mktemp("site")))
        without_reports(patch)
        yield


@cache
def frames(name: str) -> int:
    """Return the frames of a run after which the raw tracker has been deeper in something than DEPTH."""
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
    if all(avatar.moves for avatar in scene.avatars):
        return min(AT_ONCE, scenario.frames)
    raise AssertionError(f"the raw tracker of {name} never overlaps: the scene judges nothing")


@pytest.mark.parametrize("name", list(scenarios()))
def test_bad_engines_fail_the_scene(name: str, tmp_path: Path) -> None:
    """All engines in one run: the start of a run would take as long as the engines."""
    words = ["check", "--engine", *METRICS, "--filter", name, "--out", str(tmp_path / "out"), "--jobs", "0"]
    assert main([*words, "--frames", str(frames(name))]) == 1
    results = json.loads((tmp_path / "out" / "latest-check" / "results.json").read_text())
    assert results["exit_code"] == 1
    for engine, metric in METRICS.items():
        rows = [row for row in results["rows"] if row["engine"] == engine]
        failed = {row["metric"]: row["value"] for row in rows if row["status"] == "fail"}
        # one failed row is enough for exit code 1
        assert failed, engine
        assert_caught(name, engine, metric, failed)


def assert_caught(name: str, engine: str, metric: str | None, failed: dict[str, float]) -> None:
    """Assert that an engine fails a scene by its own fault."""
    # where nothing can touch, an engine without contact is caught by its free motion
    touches = not scenarios()[name].expects.get("nothing_touches")
    if metric is not None and (touches or engine == "not_a_number"):
        assert metric in failed, engine
    if scenarios()[name].expects.get("refusal"):
        # the scene begins with overlap on purpose: an engine that shows it at all is found to overlap
        assert {"residual_overlap_max", "not_finite_frames"} & set(failed), engine
        return
    if engine == "two_millimetres" and touches:
        assert failed["residual_overlap_max"] == pytest.approx(DEPTH, abs=2e-5)
    if engine == "frozen":
        # it is caught for freezing, and not because of a bad start of the scene
        assert not {"residual_overlap_max", "wrong_side_frames", "not_finite_frames"} & set(failed)
