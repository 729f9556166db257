"""A valid file is read number for number; an invalid one is rejected with its name, before anything is written."""

import math
from collections.abc import Callable
from pathlib import Path

import pytest

from avatarsim.errors import InvalidFile
from reports.reading.load import load

Json = dict[str, object]
Write = Callable[[object], Path]


def test_numbers_survive(run_dir: Write, results: Json) -> None:
    found = load(run_dir(results))
    first = found.rows[0]
    assert (first.scenario, first.run, first.value) == ("arm_wall", "avatarsim/default", 3e-7)
    assert (first.bound, first.ceiling, first.limit) == (1e-6, None, 1e-6)
    assert found.series["arm_wall"]["mujoco/tuned"].overlap.shape == (200,)
    row = next(r for r in found.rows if r.scenario == "hand_over_table" and r.ceiling is not None)
    assert row.limit == 1e-3 and row.bound == 1e-6
    settings = found.engines[0].settings
    assert settings["timestep"][1] == "quarter of a frame" and settings["solref"] == ("[0.02, 1.0]", "")


def test_nan_is_read_as_nan_and_a_gap_as_nan(run_dir: Write, results: Json) -> None:
    series = {"overlap_m": [0.0, "NaN", None], "frame_time_us": None}
    found = load(run_dir(results | {"series": {"arm_wall": {"a/b": series}}})).series["arm_wall"]["a/b"]
    assert found.overlap[0] == 0.0 and math.isnan(found.overlap[1]) and math.isnan(found.overlap[2])
    assert found.frame_time.size == 0


def test_unsupported_features_of_earlier_runs_are_read(run_dir: Write, results: Json) -> None:
    features = {"restitution": "no coefficient"}
    engines = [{"name": "mujoco", "scenario": "arm_wall", name: features} for name in ("unsupported", "cannot_say")]
    assert [note.unsupported for note in load(run_dir(results | {"engines": engines})).engines] == [features, features]


DAMAGED = (None, "", "{", "[]", "{}", '{"rows": 3, "schema_version": 1}', "half a file", "a number too large")


@pytest.mark.parametrize("text", DAMAGED)
def test_a_file_that_is_missing_or_damaged_is_refused(run_dir: Write, results: Json, text: str | None) -> None:
    folder = run_dir(results)
    path = folder / "results.json"
    whole = path.read_text(encoding="utf-8")
    texts = {"half a file": whole[:-40], "a number too large": whole.replace('"seed": 0', '"seed": 1e400', 1)}
    path.unlink() if text is None else path.write_text(texts.get(text, text), encoding="utf-8")
    with pytest.raises(InvalidFile, match=r"results(-1)?\.json"):
        load(folder)


@pytest.mark.parametrize("version", [0, 2, None, "1"])
def test_another_schema_is_refused(run_dir: Write, results: Json, version: object) -> None:
    with pytest.raises(InvalidFile, match="schema_version"):
        load(run_dir(results | {"schema_version": version}))


@pytest.mark.parametrize(("change", "where"), [
    *(({"value": number}, "JSON") for number in (math.nan, math.inf, -math.inf)),
    *(({"value": value}, "value") for value in ("high", True)),
    *(({name: value}, name) for name, value in (("status", "passed"), ("scenario", None), ("seed", 0.5))),
])
def test_a_malformed_row_is_refused_and_its_place_named(run_dir: Write, results: Json, change: Json, where: str) -> None:
    rows = results["rows"]
    assert isinstance(rows, list)
    place = where if where == "JSON" else rf"rows\[{len(rows)}\]\.{where}"
    with pytest.raises(InvalidFile, match=place):
        load(run_dir(results | {"rows": [*rows, rows[0] | change]}))
