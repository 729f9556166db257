"""The study of the judge within a comparison: its pairs are this version's, and its file is the one read by the report."""

import json
import sys
from pathlib import Path

import pytest

from avatarsim.errors import MissingPackage
from reference import judge_trust as examination
from reference.judging.known_pairs import KINDS, REGIMES
from reports.pages import articles
from scenarios.run import provenance
from scenarios.studies import judge_trust as study
from scenarios.studies.study import Request


def test_it_leaves_the_file_that_the_report_reads(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pairs = len(KINDS) * len(REGIMES)
    monkeypatch.setattr(examination, "PAIRS", pairs)
    assert study.ask(Request(tmp_path, {}, {}, 0)) == ([], [])
    found = json.loads((tmp_path / articles.JUDGE).read_text(encoding="utf-8"))
    assert found["all"]["pairs"] == pairs and [kind["kind"] for kind in found["kinds"]] == list(KINDS)
    assert found["command"] == f"python -m reference.judge_trust --pairs {pairs} --seed {study.seed()}"


def test_other_sources_draw_other_pairs(monkeypatch: pytest.MonkeyPatch) -> None:
    before = study.seed()
    monkeypatch.setattr(study, "code_hash", lambda: f"{int(provenance.code_hash(), 16) ^ 1:016x}")
    assert study.seed() != before and 0 <= study.seed() < study.SEEDS


def test_without_the_judges_packages_it_says_which_is_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, "reference.judge_trust")
    monkeypatch.delitem(sys.modules, "reference.judging.in_fcl")
    monkeypatch.setitem(sys.modules, "fcl", None)
    with pytest.raises(MissingPackage, match="fcl"):
        study.ask(Request(tmp_path, {}, {}, 0))
    assert list(tmp_path.iterdir()) == []
