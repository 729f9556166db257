"""Which engines may win a column, in which order lines stand, and what replaces a number that is not there."""

from collections.abc import Callable, Mapping
from pathlib import Path

from reports.deciding.columns import COLUMNS
from reports.deciding.marked import cell_note
from reports.deciding.tables import Block, Cell, blocks
from reports.reading.load import load

Json = dict[str, object]
Write = Callable[[object], Path]
INDEX = {column.key: index for index, column in enumerate(COLUMNS)}


def table(folder: Path, first: tuple[str, ...] = ()) -> Mapping[str, Block]:
    return {block.scene: block for block in blocks(load(folder), first)}


def cell(block: Block, run: str, column: str) -> Cell:
    return next(line for line in block.lines if line.run == run).cells[INDEX[column]]


def with_row(results: Json, **change: object) -> Json:
    rows = results["rows"]
    assert isinstance(rows, list)
    return results | {"rows": [*rows, rows[0] | {"bound": None, "ceiling": None, "status": "info"} | change]}


def test_ours_first_and_the_raw_tracker_last(run_dir: Write, results: Json) -> None:
    runs = [line.run for line in table(run_dir(results))["arm_wall"].lines]
    assert runs == ["avatarsim/default", "mujoco/default", "mujoco/tuned", "pybullet/default", "tracker/default"]


def test_scenes_asked_for_come_first(run_dir: Write, results: Json) -> None:
    assert list(table(run_dir(results), ("ball_drop", "unknown"))) == ["ball_drop", "arm_wall", "hand_over_table"]


def test_ratios_are_to_the_best(run_dir: Write, results: Json) -> None:
    block = table(run_dir(results))["arm_wall"]
    assert cell(block, "avatarsim/default", "overlap").best
    found = cell(block, "mujoco/tuned", "overlap").ratio
    assert found is not None and abs(found - 200.0) < 1e-6


def test_the_raw_tracker_wins_nothing(run_dir: Write, results: Json) -> None:
    block = table(run_dir(results))["arm_wall"]
    raw = cell(block, "tracker/default", "offset")
    assert raw.value == 0.0 and raw.ratio is None and not raw.best
    assert cell(block, "avatarsim/default", "offset").best


def test_whoever_passes_through_the_wall_wins_no_overlap(run_dir: Write, results: Json) -> None:
    through = {"engine": "mujoco", "preset": "tunnel", "frames": 200}
    rows = results["rows"]
    assert isinstance(rows, list)
    data = with_row(results | {"rows": [rows[0] | {"value": 3e-6}, *rows[1:]]}, **through, value=0.0)
    assert not cell(table(run_dir(data))["arm_wall"], "avatarsim/default", "overlap").best
    data = with_row(data, **through, metric="wrong_side_frames", value=39.0, unit="frames")
    block = table(run_dir(data))["arm_wall"]
    assert cell(block, "avatarsim/default", "overlap").best
    assert not cell(block, "mujoco/tunnel", "overlap").best


def test_a_crash_says_so_instead_of_a_number(run_dir: Write, results: Json) -> None:
    lines = {line.run: line for line in table(run_dir(results))["ball_drop"].lines}
    assert lines["mujoco/default"].nothing == "crashed: ValueError: <mesh> & volume"
    assert lines["mujoco/default"].trouble == "crashed"
    assert all(c.value is None and c.word == "crashed" for c in lines["mujoco/default"].cells)
    assert lines["avatarsim/default"].nothing == ""


def test_frames_that_are_not_finite_are_named(run_dir: Write, results: Json) -> None:
    for value in (3.0, "NaN"):
        data = with_row(results, metric="not_finite_frames", value=value, unit="frames")
        assert table(run_dir(data))["arm_wall"].lines[0].trouble == "shows NaN"


def test_alone_nobody_is_best(run_dir: Write, results: Json) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    alone = results | {"rows": [row for row in rows if row["engine"] in ("avatarsim", "tracker")]}
    found = cell(table(run_dir(alone))["arm_wall"], "avatarsim/default", "overlap")
    assert found.value == 3e-7 and found.ratio is None and not found.best


def test_our_other_preset_takes_no_best_from_us(run_dir: Write, results: Json) -> None:
    data = with_row(results, preset="paper", metric="frame_time_p50", value=3.0, unit="us")
    block = table(run_dir(data))["arm_wall"]
    assert cell(block, "avatarsim/default", "p50").best
    assert not cell(block, "avatarsim/paper", "p50").best


def test_a_figure_that_an_engine_has_no_words_for_ranks_it_nowhere(run_dir: Write, results: Json) -> None:
    """It stays on the page, says why it is not ranked, and is not what others are held against."""
    data = results
    for engine, value in (("avatarsim", 2.0), ("mujoco", 1.0), ("pybullet", 3.0)):
        data = with_row(data, scenario="arm_wall", engine=engine, metric="reach_cone_excess_max", unit="deg", value=value)
    assert cell(table(run_dir(data))["arm_wall"], "mujoco/default", "cone").best
    engines = [{"name": "mujoco", "preset": "default", "scenario": "arm_wall", "cannot_say": {"reach cones": "no such limit"}}]
    block = table(run_dir(data | {"engines": engines}))["arm_wall"]
    silent = cell(block, "mujoco/default", "cone")
    assert (silent.value, silent.ratio, silent.best) == (1.0, None, False)
    assert cell_note(silent, "avatarsim/default") == ("how", "not ranked: cannot say reach cones")
    assert cell(block, "avatarsim/default", "cone").best and cell(block, "pybullet/default", "cone").ratio == 1.5


def test_time_in_an_adapter_is_shown_and_has_no_best(run_dir: Write, results: Json) -> None:
    data = results
    for engine, value in (("avatarsim", 2.0), ("mujoco", 1.0)):
        data = with_row(data, scenario="arm_wall", engine=engine, metric="frame_time_python_p50", unit="us", value=value)
    block = table(run_dir(data))["arm_wall"]
    shown = [cell(block, run, "python") for run in ("avatarsim/default", "mujoco/default")]
    assert [(one.value, one.ratio, one.best) for one in shown] == [(2.0, None, False), (1.0, None, False)]
