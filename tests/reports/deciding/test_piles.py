"""Which engine for stacks of boxes: at rest and in motion, the fastest that leaves at most so much; ours where it is slow."""

from collections.abc import Callable
from pathlib import Path

from reports.deciding.piles import in_motion, paces, which
from reports.reading.load import Results, load
from reports.sections.your_project import stacks
from tests.reports.conftest import row

Json = dict[str, object]
Write = Callable[[object], Path]
OURS = "avatarsim/default"


def run_of(run_dir: Write, results: Json, scene: str, **figures: tuple[float, float]) -> Results:
    """One scene with (median [us], overlap [m]) of each run, named engine_preset."""
    rows = []
    for name, (time, overlap) in figures.items():
        run = name.replace("_", "/")
        rows += [row(scene, run, "frame_time_p50", time, "us"), row(scene, run, "residual_overlap_max", overlap, "m")]
    return load(run_dir(results | {"rows": rows}))


def test_a_pile_in_motion_names_the_factor_and_what_either_leaves(run_dir: Write, results: Json) -> None:
    found = run_of(run_dir, results, "stack_struck", avatarsim_default=(1120.0, 3e-7), pybullet_default=(88.0, 1.2e-2),
                   mujoco_tuned=(230.0, 1.2e-3), avatarsim_paper=(10.0, 3e-7))
    assert in_motion(found, OURS) == (
        "Piles of bodies in motion: stack_struck takes ours ×13 the time of the fastest (median 1.12 ms, leaves 300 nm; "
        "pybullet/default 88.0 µs, leaves 12.0 mm).")
    assert which(found, OURS) == (
        "In motion (stack_struck), fastest median with an overlap of at most 10 mm: mujoco/tuned 230 µs, leaves 1.20 mm; at most "
        "1 mm or 1 µm: avatarsim/default 1.12 ms, leaves 300 nm.")
    assert [one.run for one in paces(found, "stack_struck")][0] == "avatarsim/paper"


def test_where_ours_is_fastest_that_is_said_and_nothing_of_a_run_without_piles(run_dir: Write, results: Json) -> None:
    fast = run_of(run_dir, results, "balls_216", avatarsim_default=(800.0, 1e-8), mujoco_tuned=(9000.0, 2e-3))
    assert "balls_216 takes ours less time than any other" in in_motion(fast, OURS)
    assert in_motion(load(run_dir(results)), OURS) == "" and stacks(load(run_dir(results)), OURS).startswith("Stacks are not")


def test_an_engine_that_sleeps_at_rest_is_said_to(run_dir: Write, results: Json) -> None:
    found = run_of(run_dir, results, "stack_ten", avatarsim_default=(0.5, 2e-7), mujoco_tuned=(700.0, 1e-4))
    more = [row("stack_ten", OURS, "resting_frames", 98.0, "%"), row("stack_ten", OURS, "frame_time_max", 4000.0, "us"),
            row("stack_ten", "mujoco/tuned", "frame_time_max", 900.0, "us")]
    resting = [*found.rows, *load(run_dir(results | {"rows": more})).rows]
    rested = load(run_dir(results | {"rows": [vars(one) for one in resting]}))
    assert stacks(rested, OURS).startswith(
        "At rest (stack_ten), least slowest frame with an overlap of at most 10 mm or 1 mm: mujoco/tuned 900 µs, leaves 100 µm; "
        "at most 1 µm: avatarsim/default 4.00 ms, leaves 200 nm; median asleep: avatarsim/default 500 ns.")
