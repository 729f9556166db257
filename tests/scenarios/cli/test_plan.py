"""Scenes of each command, with their seeds."""

import json
import subprocess
from pathlib import Path

import pytest

from avatarsim.errors import UnknownName
from scenarios import catalog, drawn_crowds, unseen
from scenarios.__main__ import main, parser
from scenarios.cli.plan import catalogue_of, get, origin, plan, scenarios
from scenarios.job import CATALOGUE, Job
from scenarios.run.accuracy import prepare
from scenarios.unseen import seeds

UNSEEN = {"unseen_corridor", "unseen_door", "unseen_door_90hz", "unseen_floor", "unseen_gallery", "unseen_wall"}
CROWDS = set(drawn_crowds.scenarios())


def planned(*words: str) -> list[Job]:
    options = parser().parse_args([*words, "--engine", "tracker", "--jobs", "0"])
    return plan(options, options.engine, False).jobs


@pytest.mark.parametrize(("command", "patterns", "taken"), [
    ("compare", None, UNSEEN | CROWDS), ("run", "*", UNSEEN | CROWDS), ("list", None, UNSEEN | CROWDS), ("check", None, set()),
    ("bench", "*", set()), ("check", "mocap_*,unseen_wall", UNSEEN), ("bench", "unseen_*", UNSEEN), ("study", "unseen_*", set()),
    ("check", "crowd_*", CROWDS), ("bench", "crowd_*,unseen_wall", UNSEEN | CROWDS),
])
def test_unseen_scenes_are_gated_and_timed_only_by_name(command: str, patterns: str | None, taken: set[str]) -> None:
    found = set(scenarios(command, patterns))
    assert found - set(catalog.scenarios()) == taken and set(catalog.scenarios()) <= found
    assert not (UNSEEN | CROWDS) & set(catalog.scenarios())


def test_a_plan_has_the_catalogue_and_the_seed_of_each_scene() -> None:
    jobs = {job.scenario: job for job in planned("compare", "--filter", "ball_drop,unseen_wall")}
    assert (jobs["ball_drop"].catalogue, jobs["ball_drop"].seed) == (CATALOGUE, 0)
    assert (jobs["unseen_wall"].catalogue, jobs["unseen_wall"].seed) == (unseen.NAME, seeds.draw().seed)
    assert prepare(jobs["unseen_wall"]).scenario.name == "unseen_wall" and origin(jobs.values()) == {"unseen": seeds.draw().text}
    chosen = planned("run", "unseen_wall", "--seed", "3", "4")
    assert [job.seed for job in chosen] == [3, 4] and origin(chosen) == {}
    crowds = planned("compare", "--filter", "crowd_*")
    assert {job.scenario for job in crowds} == CROWDS == {prepare(job).scenario.name for job in crowds}


def test_a_scene_of_any_kind_is_found_by_name() -> None:
    assert get("ball_drop").name == "ball_drop" and get("unseen_door").name == "unseen_door"
    assert get("crowd_swept_8") is drawn_crowds.draw(8) and catalogue_of("crowd_swept_8") == drawn_crowds.NAME
    for wrong in (get, unseen.get):
        with pytest.raises(UnknownName, match="unseen_dor.*unseen_door"):
            wrong("unseen_dor")


def test_the_seed_follows_the_commit_or_the_code(tmp_path: Path) -> None:
    (tmp_path / "avatarsim").mkdir()
    (tmp_path / "avatarsim" / "a.py").write_text("x = 1\n")
    plain = seeds.draw_from(tmp_path)
    assert plain.kind == "code" and plain.seed == int(plain.digits[:7], 16)
    (tmp_path / "avatarsim" / "a.py").write_text("x = 2\n")
    found = {plain.seed, seeds.draw_from(tmp_path).seed}
    git = ["git", "-c", "user.name=n", "-c", "user.email=e@x", "-c", "commit.gpgsign=false"]
    subprocess.run([*git, "init", "-q", "."], cwd=tmp_path, check=True)
    for message in ("one", "two"):
        subprocess.run([*git, "commit", "-q", "--allow-empty", "-m", message], cwd=tmp_path, check=True)
        drawn = seeds.draw_from(tmp_path)
        assert drawn.kind == "commit" and len(drawn.digits) == 40 and drawn.digits in drawn.text
        found.add(drawn.seed)
    assert len(found) == 4


@pytest.mark.usefixtures("no_reports")
def test_a_comparison_has_rows_and_times_with_the_seed_of_each(tmp_path: Path) -> None:
    words = ["compare", "--filter", "ball_drop,unseen_floor", "--engine", "mujoco", "--preset", "default"]
    main([*words, "--jobs", "0", "--frames", "5", "--out", str(tmp_path)])
    found = json.loads((tmp_path / "latest" / "results.json").read_text())
    drawn = seeds.draw()
    timed = {(row["scenario"], row["seed"]) for row in found["rows"] if row["metric"] == "frame_time_p50"}
    assert {(row["scenario"], row["seed"]) for row in found["rows"]} == timed == {("ball_drop", 0), ("unseen_floor", drawn.seed)}
    assert found["provenance"]["unseen"] == drawn.text
