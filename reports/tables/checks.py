"""Checks of the gated engine: passed, waived, failed and not measured."""

from dataclasses import dataclass

import pandas as pd

from reports.tables.run import Run

ROOM = 3
"""Rows of the list of checks that pass with the least room."""


@dataclass(frozen=True, eq=False)
class Checks:
    """Rows of a run's table by outcome.

    passed, waived, failed   checks of the gated engine; waived ones are above their bound and within their waiver
    crashed, unmeasured      runs without figures, one row each, of all engines
    refused                  scenes that the gated engine refused, as they expect
    finished                 flag: the run ended
    """

    passed: pd.DataFrame
    waived: pd.DataFrame
    failed: pd.DataFrame
    crashed: pd.DataFrame
    unmeasured: pd.DataFrame
    refused: pd.DataFrame
    finished: bool

    @property
    def total(self) -> int:
        """Number of checks."""
        return len(self.passed) + len(self.waived) + len(self.failed)

    @property
    def missing(self) -> int:
        """Number of runs and figures that were not measured."""
        return len(self.crashed) + len(self.unmeasured)

    @property
    def is_sound(self) -> bool:
        """True if no check failed and none is missing."""
        return self.finished and not (len(self.failed) or self.missing) and self.total > 0


def checks(run: Run) -> Checks:
    """Judge a run by its rows alone: a pass needs a finite value within the bound."""
    rows = run.rows
    gated = rows.status.isin(("pass", "waived", "fail")) | ((rows.status == "info") & rows.bound.notna())
    own = rows[(rows.run == run.gated) & gated]
    measured = own[own.measured]
    finite = measured.value.abs() < float("inf")
    within = finite & (measured.value <= measured.bound)
    waived = finite & ~within & (measured.value <= measured.waiver.fillna(measured.bound))
    lost = ~within & ~waived & measured.bound.notna()
    failed = pd.concat([measured[lost], own[~own.measured & (own.status == "fail")]])
    order = (failed.value / failed.bound.where(failed.bound > 0.0)).fillna(float("inf")).sort_values(ascending=False)
    unmeasured = rows[rows.status == "not-measured"].drop_duplicates(["scenario", "run", "seed", "metric"])
    return Checks(
        passed=measured[within & measured.bound.notna()],
        waived=measured[waived],
        failed=failed.loc[order.index],
        crashed=rows[rows.status == "crashed"].drop_duplicates(["scenario", "run", "seed"]),
        unmeasured=pd.concat([unmeasured, own[~own.measured & (own.status != "fail")], _gaps(run)]),
        refused=rows[(rows.run == run.gated) & rows.status.isin(("refused", "cannot-say"))],
        finished=run.results.exit_code is not None,
    )


def _gaps(run: Run) -> pd.DataFrame:
    """Return a row for each scene without any row of the gated engine, which took part elsewhere."""
    present = run.rows.scenario[run.rows.run == run.gated]
    scenes = run.rows.scenario.drop_duplicates()
    absent = scenes[~scenes.isin(present) & bool(len(present))]
    gaps = pd.DataFrame({"scenario": absent}, columns=run.rows.columns)
    return gaps.assign(run=run.gated, seed=0, metric="run", status="not-measured", note="no row in results.json")


def least_room(checks: Checks, count: int = ROOM) -> pd.DataFrame:
    """Return the checks that pass nearest to their bound, with the share of it in the column room."""
    tight = checks.passed[checks.passed.bound > 0.0]
    return tight.assign(room=tight.value / tight.bound).nlargest(count, "room")
