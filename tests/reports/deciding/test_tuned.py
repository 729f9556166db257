"""Where tuned settings are worse than default parameters, and that nothing worse is left out."""

import math
from dataclasses import replace

import pytest

from reports.deciding.columns import COLUMNS, Column
from reports.deciding.tables import blocks
from reports.deciding.tuned import BY_KIND, Tuning, aims, sentence, tunings
from reports.reading.load import EngineNote, Results, Row

OURS = "avatarsim/default"
OVERLAP = "residual_overlap_max"
RANKED = (OVERLAP, "overlap_frames", "wrong_side_frames", "velocity_error_max", "tracker_offset_rms_free", "chatter_frames",
          "jitter_rms", "joint_limit_excess_max", "reach_cone_excess_max")


def row(run: str, metric: str, value: float | None, scene: str = "s", status: str = "info") -> Row:
    engine, preset = run.split("/")
    unit = next((column.unit for column in COLUMNS if column.takes(metric)), "")
    return Row(scene, engine, preset, 0, 1, metric, value, unit, None, None, status, "")


def found(*rows: Row) -> tuple[Tuning, ...]:
    made = Results(rows=(row(OURS, OVERLAP, 0.0), *rows), series={}, engines=(), provenance={}, exit_code=0, titles={}, notes=())
    return tunings(blocks(made), OURS)


@pytest.mark.parametrize("column", [column for column in COLUMNS if column.unit != "us"], ids=lambda column: column.key)
@pytest.mark.parametrize(("more", "better", "worse"), [(-2.0, 1, 0), (-0.5, 0, 0), (0.5, 0, 0), (2.0, 0, 1)])
def test_a_figure_is_worse_by_more_than_counts_as_equal(column: Column, more: float, better: int, worse: int) -> None:
    metric, start = next(filter(column.takes, RANKED)), 3.0 * column.same
    one = row("a/default", metric, start), row("a/tuned", metric, start * (1.0 + more / 3.0))
    (tuning,) = found(*one)
    assert (tuning.engine, tuning.compared, tuning.better, len(tuning.worse)) == ("a", 1, better, worse)


def test_what_is_no_number_is_worse_than_any_and_of_a_run_that_left_the_room_nothing_else_is_told() -> None:
    (tuning,) = found(
        row("a/default", OVERLAP, 1e-3), row("a/tuned", OVERLAP, math.nan),
        row("a/default", OVERLAP, 1e-3, "gone"), row("a/tuned", "run", None, "gone", "crashed"),
        row("a/default", OVERLAP, 1e-3, "ended"), replace(row("a/tuned", OVERLAP, None, "ended"), note="never came to rest"),
        row("a/default", OVERLAP, 1e-3, "out"), row("a/tuned", OVERLAP, 0.0, "out"),
        row("a/default", "wrong_side_frames", 0.0, "out"), row("a/tuned", "wrong_side_frames", 3.0, "out"),
    )
    told = {(figure.scene, figure.measure): (figure.tuned, figure.factor) for figure in tuning.worse}
    assert told["s", "deepest overlap shown"] == ("NaN", math.inf)
    assert told["gone", "deepest overlap shown"] == ("crashed", math.inf)
    assert told["ended", "deepest overlap shown"] == ("never came to rest", math.inf)
    assert told["out", "on the wrong side"] == ("3", math.inf) and len(told) == 4 and tuning.better == 0


def test_a_crash_of_the_defaults_is_no_reproach_to_what_is_tuned() -> None:
    (tuning,) = found(row("a/default", "run", None, status="crashed"), row("a/tuned", OVERLAP, 1.0))
    assert tuning.worse == () and tuning.better == 1


def test_the_largest_factor_comes_first() -> None:
    (tuning,) = found(*(
        row(f"a/{preset}", OVERLAP, value, scene)
        for scene, values in (("x", (1e-3, 2e-3)), ("y", (1e-3, 9e-3)), ("z", (1e-3, 4e-3)))
        for preset, value in zip(("default", "tuned"), values, strict=True)
    ))
    assert [figure.scene for figure in tuning.worse] == ["y", "z", "x"]


def test_the_measure_that_is_worse_most_often_is_named_with_its_number() -> None:
    metrics = (("x", "jitter_rms"), ("y", "jitter_rms"), ("z", OVERLAP))
    rows = [row(f"a/{preset}", metric, value, scene) for scene, metric in metrics
            for preset, value in (("default", 1e-3), ("tuned", 2e-3))]
    (tuning,) = found(*rows)
    assert sentence(tuning) == "a: tuned is worse than default in 3 of 3 figures (2 of them jitter in contact) and better in 0."


def test_time_is_told_apart_and_ours_and_the_tracker_are_none_of_them() -> None:
    presets = ("default", 2.0), ("tuned", 5.0)
    times = [row(f"a/{preset}", "frame_time_p50", value, scene) for scene in "xyz" for preset, value in presets]
    others = [row(f"{engine}/{preset}", OVERLAP, 1.0) for engine in ("avatarsim", "tracker") for preset in ("default", "tuned")]
    assert found(*others) == ()
    (tuning,) = found(*times, row("a/default", OVERLAP, 1.0), row("a/tuned", OVERLAP, 1.0))
    assert tuning.times == 2.5 and tuning.worse == ()
    assert sentence(tuning) == (
        "a: tuned is worse than default in 0 of 1 figure and better in 0; its median frame takes 2.5 times as long."
    )


def test_an_engine_without_both_presets_is_not_compared() -> None:
    assert found(row("a/tuned", OVERLAP, 1.0), row("b/default", OVERLAP, 1.0)) == ()


def test_what_tuned_optimises_is_told_as_the_engine_said_it() -> None:
    said = {"optimises": ("the least overlap", "a reason"), "better elsewhere": ("dt = 1/240: faster", "a reason")}
    notes = [EngineNote("a/default", "s", "1", {}, {"optimises": ("nothing", "")}), EngineNote("a/tuned", "s", "1", {}, said)]
    assert aims(notes, "a") == f"a/tuned optimises the least overlap. {BY_KIND} Better in something else: dt = 1/240: faster."
    assert aims(notes, "b") == ""
