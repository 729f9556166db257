"""Plan of settings: its scenes and order, figures taken from the run, and its budget."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from runfiles import ladder
from runfiles.timing_protocol import REPEATS
from scenarios import catalog
from scenarios.job import Job, Outcome
from scenarios.measure.timing import Round, Timed, frame_times
from scenarios.run import sweep_scenes as phenomena
from scenarios.run.timing import MOST_FRAMES, Clocked
from scenarios.studies.checkpoint import Entry
from scenarios.studies.settings import ask, plan
from scenarios.studies.settings.cell import Cell
from scenarios.studies.study import Request
from tests.scenarios.studies.settings.fakes import VALUES, Fakes
from tests.scenarios.studies.settings.grids import GRIDS

PRESETS = {"mujoco": ("default", "tuned"), "tracker": ("default",)}


def outcome(scenario: str, preset: str, seconds: float = 1e-3, **more: object) -> Outcome:
    """Return the result of the accuracy pass of a run for one preset of MuJoCo."""
    job = Job(scenario, "mujoco", preset, base=str(more.pop("base", "")), options={"dt": 0.5} if "row" in preset else {})
    return Outcome(job, "measured", values=VALUES, frame_seconds=seconds, about={"settings": {"dt": [0.01, "a reason"]}})


def request(
    folder: Path, scenes: Sequence[str] = ("stop_distance",), outcomes: Sequence[Outcome] = (),
    clocked: Mapping[str, Clocked] | None = None,
) -> Request:
    """Return a run of these scenes by MuJoCo and the tracker, measured in this process."""
    return Request(
        folder, {name: catalog.get(name) for name in scenes}, PRESETS, 0, 0, False,
        {outcome.job.stem: outcome for outcome in outcomes}, clocked or {},
    )


def test_sweep_takes_everyday_scenes_and_one_per_phenomenon() -> None:
    scenes = catalog.scenarios()
    taken = {name for name, scenario in scenes.items() if phenomena.short_errors_of(name, scenario)}
    everyday = {name for name, scenario in scenes.items() if scenario.everyday}
    assert taken == everyday | set(phenomena.SHORT_SWEEP_SCENES) and len(everyday) == 5 and len(phenomena.SHORT_SWEEP_SCENES) == 6


def test_cells_are_of_engines_presets_and_rows_of_the_run(tmp_path: Path) -> None:
    ran = request(tmp_path, ("stop_distance", "free_flight"), [outcome("stop_distance", "my_row", base="tuned")])
    cells = plan.cells_of(ran)
    assert {cell.scenario for cell in cells} == {"stop_distance"} and {cell.setting.engine for cell in cells} == {"mujoco"}
    assert "my_row" in [cell.setting.name for cell in cells[:2]]
    without = Request(tmp_path, ran.scenarios, {"mujoco": ("default",)}, 0, 0, False)
    assert {cell.setting.base for cell in plan.cells_of(without)} == {"default"}


def test_the_cost_of_a_setting_goes_with_its_steps(tmp_path: Path) -> None:
    ran = request(tmp_path, outcomes=[outcome("stop_distance", "tuned", 1e-3)])
    by_name = {cell.setting.name: cell for cell in plan.cells_of(ran)}
    # the preset steps by 0.01 s
    assert plan.frame_cost(by_name["tuned dt=1/480"], ran) == pytest.approx((4.8e-3, 4.8e-3))
    assert plan.frame_cost(by_name["tuned dt=1/60"], ran) == pytest.approx((6e-4, 6e-4))
    assert plan.frame_cost(by_name["tuned iterations=10"], ran) == pytest.approx((1e-3, 1e-3))
    known = outcome("stop_distance", "tuned", 1e-3)
    timed = {known.job.stem: Clocked(known.job, Timed(np.full((1, 20), 250_000, dtype=np.int64)))}
    both = request(tmp_path, outcomes=[known], clocked=timed)
    assert plan.frame_cost(by_name["tuned dt=1/480"], both) == pytest.approx((4.8e-3, 1.2e-3))
    assert plan.frame_cost(by_name["tuned"], request(tmp_path)) == (plan.UNKNOWN, plan.UNKNOWN)


def test_settings_beyond_the_budget_are_left_out(tmp_path: Path) -> None:
    ran = request(tmp_path, outcomes=[outcome("stop_distance", name, 0.02) for name in ("default", "tuned")])
    cells = plan.cells_of(ran)
    for budget in (0.0, 3.0, 20.0, 60.0, 1e6):
        choice = plan.chosen(cells, ran, budget)
        assert choice.estimated <= budget and len(choice.requested) + len(choice.left) == len(cells)
        assert sum(plan.cost(cell, ran) for cell in choice.requested) == pytest.approx(choice.estimated)
        # each omitted setting would not have fitted in its turn, so none fits now
        assert all(choice.estimated + each > budget for _, each in choice.left)
    assert not plan.chosen(cells, ran, 0.0).requested and not plan.chosen(cells, ran, 1e6).left
    # the budget is enough for the first cheap setting, and not for a more expensive one before it
    costs = [plan.cost(cell, ran) for cell in cells]
    dear = next(k for k, each in enumerate(costs) if each > min(costs[k + 1 :]))
    cheap = next(k for k in range(dear + 1, len(costs)) if costs[k] < costs[dear])
    some = plan.chosen(cells, ran, sum(costs[:dear]) + costs[cheap])
    assert cells[cheap] in some.requested and cells[dear] in [cell for cell, _ in some.left]


def test_what_the_run_measured_is_not_asked_again(tmp_path: Path, fakes: Fakes) -> None:
    frames = catalog.get("stop_distance").as_run(False).frames
    known = [outcome("stop_distance", name) for name in ("default", "tuned")]
    # a faster repeat that other engines of the scene did not have: it does not count, as in the run's own table
    every = np.full((REPEATS + 1, frames), 7000, dtype=np.int64)
    every[-1] = 1000
    whole = Timed(every, shared=Round(REPEATS, 0, frames))
    timed = {
        known[0].job.stem: Clocked(known[0].job, whole),
        known[1].job.stem: Clocked(known[1].job, Timed(np.full((2, frames - 1), 7000, dtype=np.int64))),
    }
    rows, troubles = ask.Sweep(request(tmp_path, outcomes=known, clocked=timed), now=lambda: 0.0).ask()
    assert troubles == []
    assert not {"stop_distance default", "stop_distance tuned"} & set(fakes.requested) and len(fakes.requested) >= 8
    # the second preset was timed over different frames than all the others
    assert "stop_distance default" not in fakes.timed and "stop_distance tuned" in fakes.timed
    found = {row.preset: row.value for row in rows if row.metric == "frame_time_p50" and not row.change}
    assert found == {"default": frame_times(whole)["frame_time_p50"], "tuned": 5.0}


def test_preset_beside_the_grid_takes_part_where_it_ran(tmp_path: Path, fakes: Fakes) -> None:
    known, frames = outcome("stack_ten", "sleeping"), catalog.get("stack_ten").as_run(False).frames
    repeats = phenomena.repeats_of(frames)
    timed = {known.job.stem: Clocked(known.job, Timed(np.full((repeats, frames), 7000, dtype=np.int64)))}
    scenes = ("stop_distance", "stack_ten")
    ran = replace(request(tmp_path, scenes, [known], timed), presets={"mujoco": ("default", "tuned", "sleeping")})
    assert "sleeping" in [cell.setting.name for cell in plan.cells_of(ran)[:6]], "among the presets, which come first"
    rows, _ = ask.Sweep(ran, now=lambda: 0.0).ask()
    found = [row for row in rows if row.preset == "sleeping" and row.metric == "frame_time_p50"]
    assert [(row.scenario, row.value, row.options) for row in found] == [
        ("stack_ten", 7.0, "--engine mujoco --preset sleeping")]
    assert "stack_ten sleeping" not in fakes.requested + fakes.timed


def test_what_was_left_out_is_a_row_that_says_so(tmp_path: Path, fakes: Fakes) -> None:
    known = [outcome("stop_distance", name, 0.02) for name in ("default", "tuned")]
    rows, _ = ask.Sweep(request(tmp_path, outcomes=known), budget=20.0, now=lambda: 0.0).ask()
    left = [row for row in rows if row.status == "not-measured"]
    assert left and {row.metric for row in left} == {"run"}
    assert not {row.change.replace("/", "_").replace(" ", ".") for row in left} & {
        one.partition(" ")[2] for one in fakes.requested}


def test_what_the_estimate_left_of_the_budget_is_spent(tmp_path: Path, fakes: Fakes) -> None:
    known = [outcome("stop_distance", name, 0.02) for name in ("default", "tuned")]
    fakes.each = 0.1
    ran = ask.Sweep(request(tmp_path, outcomes=known), budget=20.0, now=lambda: fakes.time)
    ran.ask()
    first = plan.chosen(plan.cells_of(ran.request), ran.request, ask.FIRST * ran.budget)
    assert ran.rounds > 1 and len(ran.errors) > len(first.requested)
    assert fakes.time <= ran.budget


def test_finer_steps_come_first_where_an_engine_misses(tmp_path: Path) -> None:
    presets = {"mujoco": ("default", "tuned"), "avatarsim": ("default",)}
    ran = replace(request(tmp_path, outcomes=[outcome("stop_distance", "tuned")]), presets=presets)
    cells = plan.cells_of(ran)
    by_name = {cell.setting.run: cell for cell in cells}

    def found(error: float) -> Entry:
        return {"state": "measured", "values": {"stop_distance_error_max": error, "residual_overlap_max": 0.0}}

    errors = {by_name["avatarsim/default"]: found(0.0), by_name["mujoco/tuned dt=1/240"]: found(1.0)}
    left = [cell for cell in cells if cell not in errors]
    refined = plan.refined(left, errors, ran)
    names, costs = [cell.setting.name for cell in refined], [plan.cost(cell, ran) for cell in refined[4:8]]
    finer = {"tuned dt=1/1920", "default dt=1/1920", "tuned dt=1/3840", "tuned dt=1/7680"}
    margins = [f"tuned loose_margin={margin:g}" for margin in (0.0, 2e-4, 4e-4, 1e-3)]
    coarse = ["default", "tuned", "tuned dt=1/120", "tuned dt=1/480"]
    solver = ["tuned sleep=true", "tuned iterations=10"]
    assert costs == sorted(costs) and set(names[4:8]) == finer
    assert names[:4] == coarse and names[8:10] == solver and names[10:14] == margins
    silent = replace(ran, outcomes={known.job.stem: replace(known, about={"settings": {"loose_margin": [4e-4, ""]}})
                                    for known in ran.outcomes.values()})
    assert "tuned loose_margin=0.0004" not in [cell.setting.name for cell in plan.cells_of(silent)]
    as_good = {**errors, by_name["mujoco/tuned dt=1/240"]: found(0.0)}
    assert [cell.setting.name for cell in plan.refined(left, as_good, ran)] == [cell.setting.name for cell in left]


def test_the_ladder_is_asked_first_and_the_solver_after_it(tmp_path: Path) -> None:
    presets = {engine: ("default", "tuned") for engine in ("mujoco", "pybullet")} | {"avatarsim": ("default",)}
    scenes = ("stop_distance", "hand_over_table", "driven_10cm_wall")
    cells = plan.cells_of(replace(request(tmp_path, scenes, [outcome("stop_distance", "tuned")]), presets=presets))
    rungs = [cell for cell in cells if ladder.is_rung(cell.setting.name)]
    first = next(k for k, cell in enumerate(cells) if not cell.setting.is_preset)
    solver = [cell for cell in cells if plan.turns_solver(cell)]
    assert {cell.scenario for cell in solver} == {"stop_distance"}, "with an avatar it is no case"
    assert {cell.setting.name for cell in solver} == {
        "tuned sleep=true", "tuned iterations=10", "tuned solver_iterations=10", "tuned solver_iterations=200"}
    assert cells[first : first + len(rungs) + len(solver)] == [*rungs, *solver], "all else comes later"
    coarse = [ladder.NAMES[cell.setting.name] for cell in rungs if ladder.is_coarse(cell.setting.name)]
    assert coarse == sorted(coarse) and len(coarse) < len(rungs)
    by_engine = {engine: {(cell.scenario, cell.setting.name) for cell in rungs if cell.setting.engine == engine}
                 for engine in ("mujoco", "pybullet")}
    # a preset that already has this step is the rung itself
    missing = {("driven_10cm_wall", "tuned dt=1/480")}
    assert by_engine["mujoco"] - missing == by_engine["pybullet"] and by_engine["pybullet"]


def test_silent_or_repeated_settings_are_not_asked(tmp_path: Path) -> None:
    silent = replace(outcome("slide_to_roll", "default"), about={"unsupported": {"virtual coupling": "none"}})
    same = replace(outcome("slide_to_roll", "tuned"), about={"settings": {"dt": [1 / 240, ""]}})
    names = [cell.setting.name for cell in plan.cells_of(request(tmp_path, ("slide_to_roll",), [silent, same]))]
    assert [name for name in names if name.startswith("default")] == ["default"]
    assert "tuned dt=1/240" not in names and "tuned dt=1/480" in names


def test_no_scene_is_timed_once_twice_the_budget_has_passed(tmp_path: Path, fakes: Fakes) -> None:
    fakes.each = 20.0
    scenes = ("stop_distance", "slide_to_roll")
    ran = ask.Sweep(request(tmp_path, scenes), budget=50.0, now=lambda: fakes.time)
    rows, _ = ran.ask()
    assert {said.partition(" ")[0] for said in fakes.timed} == {"stop_distance"} and ran.late == ["slide_to_roll"]
    late = [row for row in rows if row.scenario == "slide_to_roll" and row.metric == "frame_time_p50"]
    assert late and all(row.value is None for row in late)


def test_a_time_that_could_not_be_taken_is_said(tmp_path: Path, fakes: Fakes) -> None:
    fakes.dead = "tuned"
    _, troubles = ask.Sweep(request(tmp_path), now=lambda: 0.0).ask()
    assert len(troubles) == 1 and "stop_distance mujoco/tuned" in troubles[0] and "it died" in troubles[0]


def test_a_run_without_its_scenes_has_no_sweep(tmp_path: Path) -> None:
    assert ask.STUDY.carry_out(request(tmp_path, ("free_flight",))) == ([], []) and not list(tmp_path.iterdir())


def test_cut_frames_are_timed_over_the_same_rendered_frames() -> None:
    whole = Cell("stop_distance", GRIDS["avatarsim"][0], most=MOST_FRAMES)
    cut = next(s for s in GRIDS["avatarsim"] if s.cut == 2)
    assert Cell("stop_distance", cut, most=MOST_FRAMES).timed_frames == 2 * whole.timed_frames
