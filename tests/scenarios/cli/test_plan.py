"""Which commands take the unseen scenes, with which seeds, and where these come from."""

import json
import subprocess
from pathlib import Path

import pytest

from avatarsim.errors import UnknownName
from scenarios import catalog, drawn_crowds, unseen
from scenarios.__main__ import main, parser
from scenarios.cli import plan as offered
from scenarios.cli.plan import plan
from scenarios.job import CATALOGUE
from scenarios.run.accuracy import prepare
from scenarios.unseen import seeds

OURS = {"unseen_corridor", "unseen_door", "unseen_door_90hz", "unseen_floor", "unseen_gallery", "unseen_wall"}
CROWDS = set(drawn_crowds.scenarios())


@pytest.mark.parametrize(("command", "patterns", "taken"), [
    ("compare", None, OURS | CROWDS), ("run", "*", OURS | CROWDS), ("list", None, OURS | CROWDS), ("check", None, set()),
    ("bench", "*", set()), ("check", "mocap_*,unseen_wall", OURS), ("bench", "unseen_*", OURS), ("ablate", "unseen_*", set()),
    ("sweep", None, set()), ("check", "crowd_*", CROWDS), ("bench", "crowd_*,unseen_wall", OURS | CROWDS),
])
def test_the_gate_and_the_clock_take_them_only_by_name(command: str, patterns: str | None, taken: set[str]) -> None:
    found = set(offered.scenarios(command, patterns))
    assert found - set(catalog.scenarios()) == taken
    assert set(catalog.scenarios()) <= found and not (OURS | CROWDS) & set(catalog.scenarios())


def test_a_plan_mixes_both_and_names_the_catalogue_and_the_seed_of_each() -> None:
    asked = parser().parse_args(["compare", "--filter", "ball_drop,unseen_wall", "--engine", "tracker", "--jobs", "0"])
    jobs = {job.scenario: job for job in plan(asked, asked.engine, False).jobs}
    assert (jobs["ball_drop"].catalogue, jobs["ball_drop"].seed) == (CATALOGUE, 0)
    assert (jobs["unseen_wall"].catalogue, jobs["unseen_wall"].seed) == (unseen.NAME, seeds.drawn().seed)
    assert prepare(jobs["unseen_wall"]).scenario.name == "unseen_wall"
    assert offered.origin(jobs.values()) == {"unseen": seeds.drawn().said}
    others = parser().parse_args(["run", "unseen_wall", "--engine", "tracker", "--jobs", "0", "--seed", "3", "4"])
    chosen = plan(others, others.engine, True).jobs
    assert [job.seed for job in chosen] == [3, 4] and offered.origin(chosen) == {}


def test_a_drawn_crowd_is_offered_by_name_whatever_its_seed() -> None:
    assert offered.get("crowd_swept_8") is drawn_crowds.draw(8) and offered.catalogue_of("crowd_swept_8") == drawn_crowds.NAME
    asked = parser().parse_args(["compare", "--filter", "crowd_*", "--engine", "tracker", "--jobs", "0"])
    jobs = plan(asked, asked.engine, False).jobs
    assert {job.scenario for job in jobs} == CROWDS and {prepare(job).scenario.name for job in jobs} == CROWDS


def test_a_name_of_neither_kind_is_refused() -> None:
    assert offered.get("ball_drop").name == "ball_drop" and offered.get("unseen_door").name == "unseen_door"
    for get in (offered.get, unseen.get):
        with pytest.raises(UnknownName, match="unseen_dor.*unseen_door"):
            get("unseen_dor")


def test_the_seed_follows_the_commit_and_without_a_repository_the_code(tmp_path: Path) -> None:
    (tmp_path / "avatarsim").mkdir()
    (tmp_path / "avatarsim" / "a.py").write_text("x = 1\n")
    plain = seeds.drawn_from(tmp_path)
    assert plain.kind == "code" and plain.seed == int(plain.digits[:7], 16)
    (tmp_path / "avatarsim" / "a.py").write_text("x = 2\n")
    assert seeds.drawn_from(tmp_path).seed != plain.seed
    found = set()
    git = ["git", "-c", "user.name=n", "-c", "user.email=e@x", "-c", "commit.gpgsign=false"]
    subprocess.run([*git, "init", "-q", "."], cwd=tmp_path, check=True)
    for message in ("one", "two"):
        subprocess.run([*git, "commit", "-q", "--allow-empty", "-m", message], cwd=tmp_path, check=True)
        drawn = seeds.drawn_from(tmp_path)
        assert drawn.kind == "commit" and len(drawn.digits) == 40 and drawn.digits in drawn.said
        found.add(drawn.seed)
    assert len(found) == 2


def test_a_comparison_of_both_kinds_has_a_row_per_scene_with_its_own_seed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr("reports.write_report", lambda *_: None)
    words = ["compare", "--filter", "ball_drop,unseen_floor", "--engine", "tracker", "avatarsim", "--preset", "default"]
    main([*words, "--jobs", "0", "--frames", "5", "--out", str(tmp_path)])
    found = json.loads((tmp_path / "latest" / "results.json").read_text())
    drawn = seeds.drawn()
    timed = {(row["scenario"], row["seed"]) for row in found["rows"] if row["metric"] == "frame_time_p50"}
    assert {(row["scenario"], row["seed"]) for row in found["rows"]} == timed == {("ball_drop", 0), ("unseen_floor", drawn.seed)}
    assert found["provenance"]["unseen"] == drawn.said and "#" not in capsys.readouterr().out
