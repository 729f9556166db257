"""Small runs made by hand: rows for tables, and the files that other commands add to a folder."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType

import numpy as np

from reports.reading.load import EngineNote, Results, Series
from reports.tables.run import Run
from runfiles.metrics import unit
from runfiles.table import STUDIED, Row, Status, csv_text
from scenarios.studies.study import Head

HOST: Mapping[str, object] = {"cpu": "Abacus 9", "cpus": 2, "platform": "Linux", "python": "3.11"}
"""Provenance of a run whose times may be compared."""

OVERLAP = "residual_overlap_max"
OURS, MUJOCO, BULLET, RAW = "avatarsim/default", "mujoco/tuned", "pybullet/tuned", "tracker/default"
"""A metric and names of runs."""


def figure(
    scene: str, run: str, metric: str, value: float | None, status: Status = "info", bound: float | None = None,
    ceiling: float | None = None, seed: int = 0, note: str = "",
) -> Row:
    """Return one figure, with the unit of its metric."""
    engine, _, preset = run.partition("/")
    return Row(scene, engine, preset, seed, 200, metric, value, unit(metric), bound, ceiling, status, note)


def run_of(
    rows: Iterable[Row], series: Mapping[str, Mapping[str, Series]] | None = None, exit_code: int | None = 0,
    provenance: Mapping[str, object] = HOST, notes: Sequence[EngineNote] = (), name: str = "run",
    frame_times: Mapping[str, float] = MappingProxyType({}),
) -> Run:
    """Return a run of these rows, without a folder."""
    found = Results(tuple(rows), series or {}, tuple(notes), provenance, exit_code, {}, (), frame_times=frame_times)
    return Run(Path(name), found)


def timed(times: Iterable[float]) -> Series:
    """Return a series of frame times [us]."""
    return Series(np.zeros(1), np.array(list(times), dtype=np.float64))


SETTING: Mapping[str, float] = {OVERLAP: 1e-4, "frame_time_p50": 20.0, "frame_time_p95": 30.0, "frame_time_max": 40.0}
TRIAL: Mapping[str, float] = {OVERLAP: 0.0, "energy_added_max": 0.0, "not_finite_frames": 0.0, "wrong_side_frames": 0.0,
                              "end_distance": 0.0}
"""Figures of a plain setting, and of a plain trial."""


@dataclass(frozen=True)
class Part:
    """One run of a study: its figures, or its status if it has none."""

    scenario: str
    run: str
    change: str = ""
    figures: Mapping[str, float | None] = field(default_factory=dict)
    options: str = ""
    status: Status = "info"
    bounds: Mapping[str, float] = field(default_factory=dict)

    def rows(self, study: str) -> list[Row]:
        """Return the rows of the table."""
        engine, _, preset = self.run.partition("/")
        head = Head(study, self.scenario, engine, preset, self.change, self.options)
        if self.status != "info":
            return [head.without(self.status, "a reason")]
        return [head.row(name, value, bound=self.bounds.get(name)) for name, value in self.figures.items()]


def write_study(folder: Path, study: str, *parts: Part) -> None:
    """Write the file of a study."""
    (folder / f"{study}.csv").write_text(csv_text([row for part in parts for row in part.rows(study)], STUDIED))


def effect(scene: str, name: str, share: float, broken: Sequence[str] = ("course_error_max",)) -> list[Part]:
    """Return a scene with and without an effect that takes a share of its frame of 10 us."""
    bounds = dict.fromkeys(broken, 1e-6)
    there = {"frame_time_p50": 10.0, **dict.fromkeys(broken, 0.0)}
    gone = {"frame_time_p50": 10.0 * (1.0 - share), **dict.fromkeys(broken)}
    return [Part(scene, OURS, "", there, bounds=bounds), Part(scene, OURS, f"without {name}", gone, bounds=bounds)]


FINE = "[mujoco.fine]\npreset = 'tuned'\ndt = 0.001\n"


def write_all(folder: Path) -> None:
    """Write one of each file that other commands add."""
    write_study(
        folder, "settings",
        Part("arm_wall", OURS, "", SETTING), Part("arm_wall", MUJOCO, "", SETTING),
        Part("arm_wall", MUJOCO, "tuned dt 1/1000", {**SETTING, "frame_time_p50": 70.0}, FINE),
        Part("arm_wall", BULLET, status="not-measured"),
    )
    write_study(
        folder, "hard_cases",
        Part("stack", OURS, "", TRIAL), Part("stack", OURS, "size 10", {**TRIAL, "end_distance": 1e-3}),
        Part("stack", MUJOCO, "", {"not_finite_frames": 3.0}), Part("stack", BULLET, status="cannot-say"),
    )
    switched = (("arm_wall", "coupling", 0.6), ("ball_drop", "sleeping", -0.5), ("stack", "gyroscopic", 0.01))
    write_study(folder, "effects", *(part for one in switched for part in effect(*one)))
    (folder / "growth.csv").write_text("grows,mode,run,p50,note\nchain,held,mujoco/default,2.5,\nchain,held,a/b,,slow\n")
