"""Ablation: which runs it takes, and that what it reports is what was measured."""

import json
from dataclasses import fields
from pathlib import Path

import pytest

from avatarsim.scene.effects import Effects
from reports.load import load
from scenarios import ablation, catalog
from scenarios.__main__ import main
from scenarios.measure.protocol import REPEATS


def test_every_effect_is_left_out_once_and_all_others_are_forced_together() -> None:
    scene = catalog.get("ball_drop").build()
    made = ablation.jobs("ball_drop", scene, 0, False, 5)
    on = [effect.name for effect in fields(Effects) if getattr(scene.effects, effect.name)]
    assert [job.narrow for job in made] == [(), *((name,) for name in on), ()]
    assert set(made[-1].force) | set(on) == {effect.name for effect in fields(Effects)}
    assert len({job.stem for job in made}) == len(made)
    for job in made:
        _, built, _ = job.asked()
        assert built.narrow == job.narrow and built.force == job.force


def test_what_cannot_be_left_out_is_not() -> None:
    made = ablation.jobs("avatar_into_wall", catalog.get("avatar_into_wall").build(), 0, False, 5)
    assert ("kinematics",) not in [job.narrow for job in made]


@pytest.mark.usefixtures("site")
def test_leaving_out_bounce_or_continuous_detection_breaks_what_rests_on_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    out.mkdir()
    asked = ["ablate", "--filter", "ball_drop", "--out", str(out), "--jobs", "0", "--json"]
    assert main(asked) == 0
    told = {line["effect"]: line for line in json.loads(capsys.readouterr().out)}
    assert {name for name, *_ in told["restitution"]["broken"]} >= {"restitution_error_max"}
    assert {name for name, *_ in told["continuous"]["broken"]} >= {"residual_overlap_max"}
    assert told["friction"]["broken"] == [] and told["friction"]["moved"] == 0.0
    forced = told[ablation.FORCED]
    assert forced["broken"] == [] and forced["moved"] <= 1e-12 and "overlap_removal" in forced["called_by"]
    assert told["dynamics"]["without_us"] == 0.0, "what is not called for takes no time"
    (folder,) = [path for path in out.iterdir() if path.name.endswith("ablate")]
    kept = json.loads((folder / ablation.FILE).read_text())
    assert [line["effect"] for line in kept["lines"]] == list(told)
    assert {line["timed"].partition(",")[0] for line in kept["lines"]} == {f"{REPEATS} x 180 frames"}
    assert kept["lines"][0]["share"] == pytest.approx(1.0), "all of the frame is dynamics"
    assert (out / "latest").resolve() == folder, "where nothing was compared before, the report is that of this run"
    assert load(out / "latest").scenes() == ("ball_drop",)
