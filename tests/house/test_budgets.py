"""No package has more lines of code than its budget."""

import subprocess
import tomllib
from collections import Counter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
BUDGETS: dict[str, int] = tomllib.loads((ROOT / "budgets.toml").read_text(encoding="utf-8"))
CODE = {".py", ".js", ".css", ".j2"}
"""File name endings of code."""


def counted() -> Counter[str]:
    """Return the lines of code of each package, of files tracked by git; of all files where there is no repository."""
    try:
        listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split("\n")
        files = [ROOT / name for name in listed if name]
    except (OSError, subprocess.CalledProcessError):
        files = [path for name in BUDGETS for path in (ROOT / name).rglob("*") if path.is_file()]
    lines: Counter[str] = Counter()
    for path in files:
        if path.suffix in CODE and path.exists():
            lines[path.relative_to(ROOT).parts[0]] += len(path.read_text(encoding="utf-8").splitlines())
    return lines


@pytest.mark.parametrize("package", BUDGETS)
def test_a_package_keeps_to_its_budget(package: str) -> None:
    lines = counted()[package]
    assert 0 < lines <= BUDGETS[package], f"{package} has {lines} lines of code"


def test_every_package_has_a_budget() -> None:
    packages = {path.parent.name for path in ROOT.glob("*/__init__.py")}
    assert packages <= set(BUDGETS)
