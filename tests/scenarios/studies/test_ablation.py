"""Ablation: which runs it takes, and that what it reports is what was measured."""

import json
from dataclasses import fields, replace
from pathlib import Path

import pytest

from avatarsim.scene.effects import Effects
from reports.reading.load import load
from scenarios import catalog
from scenarios.__main__ import main
from scenarios.job import Job, Outcome
from scenarios.running.run import accuracy
from scenarios.studies import ablation
from scenarios.studies.study import Request


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
    (folder,) = [path for path in out.iterdir() if not path.is_symlink()]
    kept = json.loads((folder / ablation.FILE).read_text())
    assert [line["effect"] for line in kept["lines"]] == list(told)
    assert kept["lines"][0]["share"] == pytest.approx(1.0), "all of the frame is dynamics"
    assert kept["form"] == ablation.LONG and set(kept["idle"]["ball_drop"]) == {"coupling", "posture"}
    assert all((line["repeats"], line["frames"]) == (3, 180) for line in kept["lines"])
    assert (out / "latest-ablate").resolve() == folder and not (out / "latest").exists()
    assert load(out / "latest-ablate").scenes() == ("ball_drop",)


def request(folder: Path, names: tuple[str, ...], **presets: tuple[str, ...]) -> Request:
    return Request(folder, folder, {name: catalog.get(name) for name in names}, presets, 0, 0, False)


def test_a_comparison_asks_it_of_its_everyday_scenes(tmp_path: Path) -> None:
    recorded = accuracy(Job("ball_drop", "avatarsim", "default"), tmp_path).recording
    assert recorded is not None
    written = recorded.stat().st_mtime_ns
    assert ablation.ask(request(tmp_path, ("ball_drop", "stack_ten"), avatarsim=("default",))) == []
    kept = json.loads((tmp_path / ablation.FILE).read_text())
    assert kept["form"] == ablation.SHORT and kept["idle"] == {"ball_drop": ["coupling", "posture"]}
    told = {line["effect"]: line for line in kept["lines"]}
    assert {line["scenario"] for line in kept["lines"]} == {"ball_drop"}, "a pile is no everyday scene"
    assert {name for name, *_ in told["continuous"]["broken"]} >= {"residual_overlap_max"}
    assert told["dynamics"]["without_us"] == 0.0 and told["forced"]["moved"] == 0.0
    assert (told["forced"]["repeats"], told["forced"]["frames"]) == (3, 180)
    assert recorded.stat().st_mtime_ns == written, "the comparison's own recording is read again"
    assert [path.name for path in (tmp_path / "recordings").iterdir()] == [recorded.name], "the others leave nothing behind"
    assert not [path for path in tmp_path.iterdir() if path.name.startswith("tmp")]


def test_without_an_everyday_scene_or_our_engine_nothing_is_written(tmp_path: Path) -> None:
    assert ablation.ask(request(tmp_path, ("stack_ten",), avatarsim=("default",))) == []
    assert ablation.ask(request(tmp_path, ("ball_drop",), mujoco=("default",))) == []
    assert list(tmp_path.iterdir()) == []


def test_a_run_that_ends_early_has_no_time_and_says_why() -> None:
    planned = [Job("ball_drop", "avatarsim", "default"), Job("ball_drop", "avatarsim", "without-friction", narrow=("friction",))]
    done = {planned[0].stem: Outcome(planned[0], "measured"), planned[1].stem: Outcome(planned[1], "crashed", "in frame 3")}
    scenario = catalog.get("ball_drop")
    [line] = ablation.lines(planned, done, {}, {"ball_drop": scenario.build()}, {"ball_drop": replace(scenario, bounds=())})
    assert (line.without_us, line.share, line.moved, line.note) == (None, None, None, "crashed: in frame 3")
    assert (line.repeats, line.frames) == (0, 0)
