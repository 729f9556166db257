"""The search for settings: it takes better settings on the draws, stops without any, and rejects ones that it cannot search."""

from collections.abc import Sequence
from pathlib import Path

import pandas as pd
import pytest

from scenarios import __main__ as command
from scenarios.cli import tune
from scenarios.job import Job

SCENE = ("--filter", "crowd_poured*", "--count", "1", "--frames", "3", "--jobs", "0", "--seed", "6")


def called(*words: str) -> int:
    return command.main(["tune", *words])


@pytest.fixture
def valley(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Install an overlap that falls as the iterations approach 16, and return the list of changes tried."""
    changes: list[str] = []

    def tried(jobs: Sequence[Job], candidates: Sequence[tune.Candidate], workers: int) -> pd.DataFrame:
        changes.extend(one.change for one in candidates)
        iterations = [float(str(one.options.get("pgs_iterations", 2))) for one in candidates]
        return pd.DataFrame([
            {"change": one.change, "candidate": one, "residual_overlap_max": 1e-3 * abs(at - 16.0) + 1e-6,
             "tracker_offset_rms_free": 1e-3, "frame_ms": 1.0}
            for one, at in zip(candidates, iterations, strict=True)
        ])

    monkeypatch.setattr(tune, "tried", tried)
    return changes


def test_the_best_change_is_taken_until_none_is_better(valley: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert called("rapier", *SCENE, "--rounds", "9") == 0
    assert "best: pgs_iterations = 16" in capsys.readouterr().out
    assert valley.count("pgs_iterations = 32") == 1


def test_flags_are_switched_and_numbers_halved_and_doubled(valley: list[str]) -> None:
    called("rapier", *SCENE)
    assert {"sleep = True", "contact_recycling = True", "solver_iterations = 8", "weld_frequency = 50"} <= set(valley)
    assert not any(change.startswith(("optimises", "better", "dt as run", "version")) for change in valley)
    # and entries of the sweep reach zero
    assert "tuned skins=0" in valley and not any("dt=" in change for change in valley)


def test_draws_are_run_and_their_figures_told(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    few = [tune.Candidate("sleep = False", {"sleep": False})]
    monkeypatch.setattr(tune, "neighbours", lambda job, options: iter(few))
    assert called("rapier", *SCENE) == 0
    told = capsys.readouterr().out
    assert "sleep = False" in told and "residual_overlap_max" in told and "best:" in told


@pytest.mark.parametrize("words", [
    ("rapeir",), ("rapier", "--count", "0"), ("rapier", "--rounds", "0"), ("rapier", "--filter", "x"),
])
def test_what_cannot_be_searched_is_refused(words: tuple[str, ...], tmp_path: Path) -> None:
    assert called(*words, "--out", str(tmp_path)) != 0
