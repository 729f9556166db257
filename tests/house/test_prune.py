"""`make prune` removes runs that are older than the last one of their command, and nothing else."""

import shutil
import subprocess
from pathlib import Path

import pytest

MAKEFILE = Path(__file__).parents[2] / "Makefile"
OLD, LAST, RUNNING = "20250101-120000-compare", "20250102-080000-compare", "20250102-080000-compare-1"
OLD_CHECK, LAST_CHECK = "20250101-130000-check", "20250103-080000-check"
BENCH = "20250101-140000-bench"


def pruned(folder: Path) -> tuple[str, list[str]]:
    """What it says in a project whose runs are in `folder`, and what is left."""
    recipe = MAKEFILE.read_text(encoding="utf-8")
    recipe = recipe[recipe.index("prune:") :].split("\n\n")[0]
    (folder / "Makefile").write_text(f"{recipe}\n", encoding="utf-8")
    make = shutil.which("make")
    if make is None:
        pytest.skip("no make")
    said = subprocess.run([make, "-s", "-C", str(folder), "prune"], capture_output=True, text=True, check=True)
    assert said.stderr == ""
    return said.stdout, sorted(path.name for path in (folder / "reports" / "out").iterdir())


def a_project(folder: Path, *runs: str) -> Path:
    out = folder / "reports" / "out"
    for name in (*runs, "stability", "found"):
        (out / name / "recordings").mkdir(parents=True)
    (out / "notes.csv").write_text("kept", encoding="utf-8")
    return out


def test_older_runs_go_and_all_else_stays(tmp_path: Path) -> None:
    out = a_project(tmp_path, OLD, LAST, RUNNING)
    (out / "latest").symlink_to(LAST)
    said, left = pruned(tmp_path)
    assert said == f"removed reports/out/{OLD}\n"
    assert left == [LAST, RUNNING, "found", "latest", "notes.csv", "stability"]
    assert pruned(tmp_path) == ("", left)


@pytest.mark.parametrize("by_hand", [False, True])
def test_without_a_last_run_nothing_goes(tmp_path: Path, by_hand: bool) -> None:
    out = a_project(tmp_path, OLD, LAST)
    if by_hand:
        (out / "latest").mkdir()
    said, left = pruned(tmp_path)
    assert said == "reports/out has no last run; nothing removed\n" and {OLD, LAST} <= set(left)


def test_each_command_has_a_last_run_of_its_own(tmp_path: Path) -> None:
    """A comparison that runs while a check ends stays; a command without a link goes by the last comparison."""
    out = a_project(tmp_path, OLD, LAST, RUNNING, OLD_CHECK, LAST_CHECK, BENCH)
    (out / "latest").symlink_to(LAST)
    (out / "latest-check").symlink_to(LAST_CHECK)
    said, left = pruned(tmp_path)
    assert set(said.split()) == {"removed", *(f"reports/out/{name}" for name in (OLD, OLD_CHECK, BENCH))}
    assert {LAST, RUNNING, LAST_CHECK, "latest", "latest-check"} <= set(left)


def test_what_a_link_leads_to_stays_whatever_its_age(tmp_path: Path) -> None:
    """`latest` may lead to a run of another command, made by an earlier version."""
    out = a_project(tmp_path, OLD, LAST, OLD_CHECK, LAST_CHECK)
    (out / "latest").symlink_to(OLD_CHECK)
    (out / "latest-check").symlink_to(LAST_CHECK)
    assert pruned(tmp_path) == (f"removed reports/out/{OLD}\n", sorted([LAST, OLD_CHECK, LAST_CHECK, "latest", "latest-check",
                                                                       "found", "notes.csv", "stability"]))


def test_without_a_comparison_the_runs_of_a_check_alone_go(tmp_path: Path) -> None:
    out = a_project(tmp_path, OLD, OLD_CHECK, LAST_CHECK)
    (out / "latest-check").symlink_to(LAST_CHECK)
    assert pruned(tmp_path)[0] == f"removed reports/out/{OLD_CHECK}\n" and (out / OLD).is_dir()


def test_without_runs_nothing_is_wrong(tmp_path: Path) -> None:
    (tmp_path / "reports" / "out").mkdir(parents=True)
    assert pruned(tmp_path) == ("reports/out has no last run; nothing removed\n", [])
