"""A run folder as one table: a row per scene, engine, preset, seed and metric."""

import re
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path

import pandas as pd

from avatarsim.errors import InvalidFile
from reports.reading.load import Results, load
from runfiles.comparable import AVATAR_METRIC, TIME, reasons
from runfiles.engines import about, main_runs
from runfiles.naming import GATED
from runfiles.table import Row

PLAIN = re.compile(r"\w[\w.-]{0,199}")
"""Valid names of scenes, which are file names of their pages."""


@dataclass(frozen=True, eq=False)
class Run:
    """A run.

    folder   of its files
    results  the contents of results.json
    """

    folder: Path
    results: Results

    @cached_property
    def rows(self) -> pd.DataFrame:
        """The table.

        scenario, engine, preset, run, seed, frames, metric, unit, status, note   as in results.csv; run is engine/preset
        value          float, NaN where nothing was measured or the number was not finite
        measured       flag: a number was measured, finite or not
        bound, waiver  float, NaN without; a value above the bound passes up to the waiver
        why            reason why the figure does not compare engines, "" where it does
        even           flag: it does, for short
        """
        listed = [{**vars(row), "run": row.run, "measured": row.value is not None} for row in self.results.rows]
        # a run may have no rows yet, and still has columns
        rows = pd.DataFrame(listed, columns=[*(one.name for one in fields(Row)), "run", "measured"])
        rows = rows.rename(columns={"ceiling": "waiver"})
        rows = rows.astype(dict.fromkeys(("value", "bound", "waiver"), float))
        rows["why"] = reasons(rows, self.results.engines)
        rows["even"] = rows.why == ""
        return rows

    @cached_property
    def gated(self) -> str:
        """Engine and preset that carry bounds."""
        carrying = self.rows.run[self.rows.status.isin(("pass", "waived", "fail"))]
        return str(carrying.iloc[0]) if len(carrying) else "/".join(GATED)

    @cached_property
    def avatars(self) -> frozenset[str]:
        """Scenes with an avatar."""
        return frozenset(self.rows.scenario[self.rows.metric == AVATAR_METRIC])

    @cached_property
    def runs(self) -> tuple[str, ...]:
        """Rows of short tables that this run has, in their order: the gated one, the main presets, baselines."""
        engines = [run.partition("/")[0] for run in main_runs()]
        extra = sorted(run for run in set(self.rows.run) if run.partition("/")[0] not in engines)
        baselines = [run for run, engine in zip(main_runs(), engines, strict=True) if about(engine).baseline]
        listed = [self.gated, *(run for run in main_runs() if run not in baselines), *extra, *baselines]
        return tuple(run for run in dict.fromkeys(listed) if run in set(self.rows.run))

    @cached_property
    def rivals(self) -> tuple[str, ...]:
        """All rows of engines that are compared with the gated one."""
        own = self.gated.partition("/")[0]
        names = {run: run.partition("/")[0] for run in dict.fromkeys(self.rows.run)}
        return tuple(run for run, name in names.items() if name != own and not about(name).baseline)

    @cached_property
    def versions(self) -> dict[str, str]:
        """Version of each engine of short tables, by its name in words; those of the first scene."""
        by_label = dict[str, str]()
        for note in self.results.engines:
            one = about(note.run.partition("/")[0])
            if note.run in self.runs and note.version and not one.baseline:
                by_label.setdefault(one.label, note.version)
        return by_label

    def main_rows(self, metric: str) -> pd.DataFrame:
        """Return the measured rows of a metric of the runs of short tables.

        A variant replaces a preset whose own figure does not compare (`runfiles.engines.Variant`), whether its own does or not:
        the row has the run of the preset, and the variant in its column `by`.
        """
        rows = self.rows[(self.rows.metric == metric) & self.rows.measured].assign(by="")
        main, parts, gone = rows[rows.run.isin(self.runs)], list[pd.DataFrame](), set[tuple[str, str]]()
        for engine in dict.fromkeys(rows.engine):
            for name, one in about(engine).variants.items():
                if metric in one.metrics:
                    other = rows[rows.run == f"{engine}/{name}"].assign(run=f"{engine}/{one.of}", by=name)
                    parts.append(other)
                    gone |= set(zip(other.run, other.scenario, strict=True))
        is_left = [key not in gone for key in zip(main.run, main.scenario, strict=True)]
        joined = pd.concat([main[pd.Series(is_left, index=main.index, dtype=bool) | main.even], *parts])
        return joined[~joined.duplicated(["run", "scenario", "seed"])]

    @cached_property
    def frame_time(self) -> str:
        """Metric of frame times in short tables: the tail, or the median where the tail compares engines in too few scenes."""
        counts = self.rows.metric[self.rows.even & self.rows.measured & self.rows.run.isin(self.runs)].value_counts()
        tail, median = TIME + "p95", TIME + "p50"
        return tail if 2 * counts.get(tail, 0) >= counts.get(median, 0) else median

    def typical(self, metric: str) -> pd.DataFrame:
        """Return the main rows of a metric that a median is taken over: times without those of avatar scenes.

        The column `counted` says whether at least half of the figures of a run compare engines: else it has no median.
        """
        rows = self.main_rows(metric)
        if metric.startswith(TIME):
            rows = rows[~rows.scenario.isin(self.avatars)]
        return rows.assign(counted=rows.groupby("run").even.transform("mean") >= 0.5)

    @property
    def name(self) -> str:
        """Name of the folder."""
        return self.folder.resolve().name


def read(folder: Path) -> Run:
    """Read a run folder. Raises InvalidFile."""
    run = Run(folder, load(folder))
    for scene in dict.fromkeys(row.scenario for row in run.results.rows):
        if not PLAIN.fullmatch(scene):
            valid = "at most 200 letters and digits, and . _ - after the first"
            raise InvalidFile("name of a scene in results.json", scene, valid)
    return run
