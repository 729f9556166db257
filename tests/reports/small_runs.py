"""Runs of a few figures, made by hand: rows for tables, and the files that other commands add to a folder."""

import csv
import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np

from reports.reading.load import EngineNote, Results, Row, Series
from reports.tables.run import Run
from runfiles.metrics import unit

HOST: Mapping[str, object] = {"cpu": "Abacus 9", "cpus": 2, "platform": "Linux", "python": "3.11"}
"""Provenance of a run whose times may be compared."""

OVERLAP = "residual_overlap_max"
OURS, MUJOCO, BULLET, RAW = "avatarsim/default", "mujoco/tuned", "pybullet/tuned", "tracker/default"
"""A metric and runs."""


def figure(
    scene: str,
    run: str,
    metric: str,
    value: float | None,
    status: str = "info",
    bound: float | None = None,
    ceiling: float | None = None,
    seed: int = 0,
    note: str = "",
) -> Row:
    """Return one figure, with the unit of its metric."""
    engine, _, preset = run.partition("/")
    return Row(scene, engine, preset, seed, 200, metric, value, unit(metric), bound, ceiling, status, note)


def run_of(
    rows: Iterable[Row],
    series: Mapping[str, Mapping[str, Series]] | None = None,
    exit_code: int | None = 0,
    provenance: Mapping[str, object] = HOST,
    notes: Sequence[EngineNote] = (),
    name: str = "run",
) -> Run:
    """Return a run of these rows, without a folder."""
    return Run(Path(name), Results(tuple(rows), series or {}, tuple(notes), provenance, exit_code, {}, ()))


def timed(times: Iterable[float]) -> Series:
    """Return a series of frame times [us]."""
    return Series(np.zeros(1), np.array(list(times), dtype=np.float64))


def _write(path: Path, columns: Sequence[str], rows: Iterable[Mapping[str, object]], plain: Mapping[str, object]) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns, restval="")
        writer.writeheader()
        writer.writerows({**plain, **row} for row in rows)


SETTING = (
    "scenario,engine,setting,metric,unit,error,p50,p99,state,front,reached,note,base,options,repeats,frames,settable,p95,rests,"
    "moving,at_rest,sleeps,step,avatar,slowest,gap"
).split(",")
PLAIN_SETTING: Mapping[str, object] = {
    "scenario": "arm_wall", "metric": OVERLAP, "unit": "m", "error": 1e-4, "p50": 20.0, "p95": 30.0, "slowest": 40.0,
    "state": "measured", "base": "tuned", "rests": 0.0, "sleeps": 0, "avatar": 0,
}


def write_settings(folder: Path, *rows: Mapping[str, object]) -> None:
    """Write sweep.csv: a row per setting and metric, those columns that differ from a plain one."""
    _write(folder / "sweep.csv", SETTING, rows, PLAIN_SETTING)


TRIAL = ("case,run,kind,level,start,seed,user,dt,scale,far,state,frames,overlap,energy,bad,moved,seconds,note,form").split(",")
PLAIN_TRIAL: Mapping[str, object] = {
    "case": "stack", "run": OURS, "kind": "dt", "level": "small", "state": "survived", "overlap": 0.0, "energy": 0.0, "bad": 0,
    "moved": 0.0,
}


def write_trials(folder: Path, *rows: Mapping[str, object]) -> None:
    """Write stability.csv: a row per trial."""
    _write(folder / "stability.csv", TRIAL, rows, PLAIN_TRIAL)


def effect(scene: str, name: str, share: object, **more: object) -> dict[str, object]:
    """Return one line of ablation.json."""
    plain = {"scenario": scene, "effect": name, "share": share, "with_us": 10.0, "without_us": 4.0}
    return {**plain, "broken": [["course_error_max", 1e-3, None, 1e-6]], **more}


def write_effects(folder: Path, *lines: Mapping[str, object]) -> None:
    """Write ablation.json."""
    (folder / "ablation.json").write_text(json.dumps({"schema_version": 2, "lines": lines}), encoding="utf-8")


def write_all(folder: Path) -> None:
    """Write one of each file that other commands add."""
    options = "[mujoco.fine]\npreset = 'tuned'\ndt = 0.001\n"
    write_settings(
        folder,
        {"engine": "avatarsim", "setting": "default", "base": "default"},
        {"engine": "mujoco", "setting": "tuned"},
        {"engine": "mujoco", "setting": "tuned dt 1/1000", "options": options, "p50": 70.0},
        {"engine": "pybullet", "setting": "tuned", "state": "not-measured", "error": "", "p50": "", "note": "no time left"},
    )
    write_trials(
        folder,
        {"kind": "plain"},
        {"moved": 1e-3},
        {"run": MUJOCO, "kind": "plain", "state": "lost", "bad": 3},
        {"run": BULLET, "state": "cannot-say"},
    )
    write_effects(
        folder, effect("arm_wall", "coupling", 0.6), effect("arm_wall", "sleeping", -0.5), effect("ball_drop", "gyroscopic", 0.01)
    )
    (folder / "growth.csv").write_text("grows,mode,run,p50,note\nchain,held,mujoco/default,2.5,\nchain,held,a/b,,slow\n")
