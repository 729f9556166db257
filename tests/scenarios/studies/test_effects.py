"""Effects: the runs of the study, and that its rows equal the measurements."""

from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path

import pytest

from avatarsim.scene.effects import Effects
from reports.tables.effects import effects
from runfiles.table import Row
from scenarios import catalog
from scenarios.run.accuracy import prepare
from scenarios.studies import effects as study
from scenarios.studies.study import Request


def request(folder: Path, *names: str, engine: str = "avatarsim") -> Request:
    return Request(folder, {name: catalog.get(name) for name in names}, {engine: ("default",)}, 0)


def test_every_effect_is_left_out_once_others_are_forced(tmp_path: Path) -> None:
    scene = catalog.get("ball_drop").build()
    made = study.jobs("ball_drop", scene, request(tmp_path))
    on = [effect.name for effect in fields(Effects) if getattr(scene.effects, effect.name)]
    assert list(made) == ["", *(f"without {name}" for name in on), study.FORCED]
    assert set(made[study.FORCED].force) | set(on) == {effect.name for effect in fields(Effects)}
    assert len({job.stem for job in made.values()}) == len(made)
    for job in made.values():
        built = prepare(job).scene
        assert built.narrow == job.narrow and built.force == job.force


def test_kinematics_cannot_be_left_out(tmp_path: Path) -> None:
    made = study.jobs("avatar_into_wall", catalog.get("avatar_into_wall").build(), request(tmp_path))
    assert ("kinematics",) not in [job.narrow for job in made.values()]


def figure(rows: Sequence[Row], change: str, metric: str) -> float | None:
    [found] = [row.value for row in rows if (row.change, row.metric) == (change, metric)]
    return found


def test_leaving_out_an_effect_breaks_the_bounds_that_need_it(tmp_path: Path) -> None:
    rows, troubles = study.STUDY.carry_out(request(tmp_path, "ball_drop", "stack_ten"))
    assert troubles == [] and {row.scenario for row in rows} == {"ball_drop"}, "a pile is no everyday scene"
    assert figure(rows, "without friction", "pose_distance_max") == 0.0
    assert figure(rows, study.FORCED, "pose_distance_max") == pytest.approx(0.0, abs=1e-12)
    assert figure(rows, "without dynamics", "frame_time_p50") == 0.0, "unused stages take no time"
    table = effects(tmp_path)
    assert table is not None
    broken = dict(zip(table.effect, table.broken, strict=True))
    assert "restitution_error_max" in broken["restitution"] and "residual_overlap_max" in broken["continuous"]
    assert broken["friction"] == [] and study.FORCED not in broken
    assert table.set_index("effect").share["dynamics"] == pytest.approx(1.0), "all of the frame is dynamics"
    assert [path.name for path in tmp_path.iterdir()] == ["effects.csv"]


@pytest.mark.parametrize(("name", "engine"), [("stack_ten", "avatarsim"), ("ball_drop", "mujoco")])
def test_nothing_is_written_without_everyday_scene_or_our_engine(tmp_path: Path, name: str, engine: str) -> None:
    assert study.STUDY.carry_out(request(tmp_path, name, engine=engine)) == ([], []) and list(tmp_path.iterdir()) == []


def test_a_run_that_ends_early_has_its_state_and_no_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def figures(job: object) -> dict[str, object]:
        return {"state": "crashed", "note": "in frame 3", "frames": 3, "values": {}, "moved": None}

    monkeypatch.setattr(study, "figures", figures)
    rows, _ = study.ask(request(tmp_path, "ball_drop"))
    assert {(row.metric, row.status, row.note) for row in rows} == {("run", "crashed", "in frame 3")}
