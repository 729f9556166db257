"""Set-up: the chosen Python, reported obstacles, and repeated work."""

import ast
import importlib.util
import subprocess
import sys
import sysconfig
import venv
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from tests.house.wheel import copied

ROOT = Path(__file__).resolve().parents[2]


def _load(name: str, root: Path = ROOT) -> ModuleType:
    """Return a fresh copy of a set-up file; it is in a hidden folder and cannot be imported by name."""
    spec = importlib.util.spec_from_file_location(name, root / ".setup" / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _fake_python(path: Path, script: str) -> str:
    """Write an executable file that replaces an interpreter, and return its path."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!/bin/sh\n{script}\n", encoding="utf-8")
    path.chmod(0o755)
    return str(path)


choose_python = _load("choose_python")
OLD = ("old", (3, 10, 13), list[str]())
NEW = ("new", (3, 14, 0), list[str]())
BARE = ("bare", (3, 11, 2), ["venv", "ensurepip"])


@pytest.mark.parametrize(
    ("found", "path", "named"),
    [
        ([("a", (3, 11, 0), [])], "a", []),
        ([OLD, NEW, ("c", (3, 13, 9), [])], "c", []),
        ([BARE, ("b", (3, 12, 1), [])], "b", []),
        ([("first", (3, 12, 1), []), ("second", (3, 11, 1), [])], "first", []),
        ([], "", ["3.11", "3.13"]),
        ([OLD], "", ["old", "3.10.13"]),
        ([NEW], "", ["new", "3.14.0"]),
        ([OLD, BARE], "", ["bare", "ensurepip", "python3.11-venv"]),
    ],
)
def test_first_usable_python_is_chosen_or_the_obstacle_is_named(found: list[Any], path: str, named: list[str]) -> None:
    chosen, sentence = choose_python.choose(found)
    assert chosen == path and bool(sentence) == (not path)
    assert [word for word in named if word not in sentence] == []


def test_names_come_before_folders_and_3_11_first(tmp_path: Path) -> None:
    for place in ("one/python3", "two/python3.11", "two/python3", "three/python3.13"):
        _fake_python(tmp_path / place, "")
    (tmp_path / "one" / "python3.12").write_text("not executable", encoding="utf-8")
    search = ":".join(str(tmp_path / folder) for folder in ("one", "two", "three"))
    places = choose_python.on_path(choose_python.NAMES, search)
    expected = ["two/python3.11", "one/python3", "two/python3", "three/python3.13"]
    assert [str(Path(place).relative_to(tmp_path)) for place in places] == expected


def test_probe_sees_through_shims_that_fail(tmp_path: Path) -> None:
    assert choose_python.probe(_fake_python(tmp_path / "python3.11", "echo not set up >&2; exit 127")) is None
    assert choose_python.probe(_fake_python(tmp_path / "silent", "exit 0")) is None
    assert choose_python.probe(str(tmp_path / "absent")) is None
    path, version, lacking = choose_python.probe(sys.executable, ("venv", "no_such_module"))
    assert (path, version, lacking) == (sys.executable, tuple(sys.version_info[:3]), ["no_such_module"])


@pytest.mark.parametrize(
    ("script", "named"),
    [
        ("echo 3.10.13", "3.10.13"), ("echo 2.7.18", "2.7.18"), ("echo 3.12.3 ensurepip", "python3.12-venv"),
        ("exit 1", "Python"),
    ],
)
def test_an_unusable_python_ends_the_set_up(tmp_path: Path, script: str, named: str) -> None:
    asked = _fake_python(tmp_path / "asked", script)
    command = [sys.executable, str(ROOT / ".setup" / "choose_python.py")]
    ended = subprocess.run(command, env={"PYTHON": asked}, capture_output=True, text=True, check=False)
    assert ended.returncode == 1 and ended.stdout == ""
    assert named in ended.stderr and "Traceback" not in ended.stderr


def test_make_fails_where_there_is_no_python(tmp_path: Path) -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    recipe = makefile[makefile.index("SET_UP = @") :].split("\n\n")[0]
    (tmp_path / "Makefile").write_text(f"{recipe}\nsetup:\n\t$(SET_UP)\n", encoding="utf-8")
    _fake_python(tmp_path / "python3", "exit 127")
    make = subprocess.run(["which", "make"], capture_output=True, text=True, check=True).stdout.strip()
    command = [make, "-C", str(tmp_path), "SHELL=/bin/sh", "setup"]
    ended = subprocess.run(command, env={"PATH": str(tmp_path)}, capture_output=True, text=True, check=False)
    assert ended.returncode != 0 and "python3" in ended.stderr


PINS = ("numpy==2", "pybullet==3", "scipy==1")
LOCK = "".join(f"{pin} \\\n    --hash=sha256:{number}\n" for number, pin in enumerate(PINS))
NO_WHEEL = "ERROR: No matching distribution found for pybullet==3"


class _House:
    """install.py with its folder moved to an empty one and pip replaced by a list of answers."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self.install = _load("install")
        self.asked: list[tuple[str, tuple[str, ...]]] = []
        self.answers: dict[str, str] = {}
        self.lock, self.stamp = folder / "requirements.lock", folder / ".venv" / "set-up-stamp"
        self.project, self.command, self.installs = folder / "pyproject.toml", folder / ".venv" / "bin" / "avatarsim", 0
        self.lock.write_text(LOCK, encoding="utf-8")
        self.project.write_text("", encoding="utf-8")
        for name, value in (("LOCK", self.lock), ("VENV", self.stamp.parent), ("STAMP", self.stamp), ("PROJECT", self.project),
                            ("COMMAND", self.command)):
            monkeypatch.setattr(self.install, name, value)
        monkeypatch.setattr(self.install, "install_project", self._project)
        monkeypatch.setattr(self.install, "make_venv", lambda: self.stamp.parent.mkdir(exist_ok=True))
        monkeypatch.setattr(self.install, "pip_install", self._pip)
        monkeypatch.setattr(self.install, "compiler_obstacle", lambda: "")
        monkeypatch.setattr(self.install, "extract_pybullet_data", lambda pin: False)

    def _project(self) -> None:
        self.installs += 1
        _fake_python(self.command, "")

    def _pip(self, pins: str, *options: str) -> str | None:
        self.asked.append((pins, options))
        return self.answers.get("pybullet" if "pybullet" in pins else "others")


@pytest.fixture
def house(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> _House:
    return _House(tmp_path, monkeypatch)


def test_chooser_is_readable_by_an_old_python() -> None:
    tree = ast.parse((ROOT / ".setup" / "choose_python.py").read_text(encoding="utf-8"))
    too_new = (ast.JoinedStr, ast.AnnAssign, ast.NamedExpr, ast.AsyncFunctionDef, ast.Match, ast.Starred)
    for node in ast.walk(tree):
        assert not isinstance(node, too_new), f"line {node.lineno}"
        if isinstance(node, ast.FunctionDef):
            assert node.returns is None and not node.args.kwonlyargs, node.name
            assert [argument.arg for argument in node.args.args if argument.annotation] == []


def test_work_is_repeated_only_where_inputs_changed(house: _House) -> None:
    def repeated() -> tuple[int, int]:
        before = len(house.asked), house.installs
        assert house.install.main() == 0
        return len(house.asked) - before[0], house.installs - before[1]

    assert repeated() == (2, 1)
    assert sorted(line for pins, _ in house.asked for line in pins.splitlines()) == sorted(LOCK.splitlines())
    assert repeated() == (0, 0)
    house.command.unlink()
    assert repeated() == (0, 1)
    house.project.write_text("[project]", encoding="utf-8")
    assert repeated() == (0, 1)
    house.lock.write_text(LOCK.replace("numpy==2", "numpy==3"), encoding="utf-8")
    assert repeated()[0] == 2


def test_the_command_and_packages_work_from_any_folder(tmp_path: Path) -> None:
    """Installed for real: into an environment that sees the packages of this one, from a copy of this checkout."""
    source = copied(tmp_path)
    venv.create(source / ".venv", with_pip=False)
    [packages] = (source / ".venv" / "lib").glob("python*/site-packages")
    (packages / "of_this_environment.pth").write_text(sysconfig.get_path("purelib"), encoding="utf-8")
    install = _load("install", source)
    install.install_project()
    run: dict[str, Any] = {"cwd": tmp_path, "env": {"PATH": ""}, "capture_output": True, "text": True}
    said = subprocess.run([source / ".venv" / "bin" / "avatarsim", "--help"], check=True, **run).stdout
    assert "compile" in said and "replay" in said
    where = "import avatarsim, reference, scenarios; print(avatarsim.__file__, reference.__file__, scenarios.__file__)"
    found = subprocess.run([source / ".venv" / "bin" / "python", "-c", where], check=True, **run).stdout.split()
    assert [Path(file).parent.parent for file in found] == [source] * 3
    assert not (source / "avatarsim.egg-info").exists()


def test_failed_set_up_leaves_no_stamp(house: _House) -> None:
    house.answers["others"] = "WARNING: NewConnectionError(...)\nERROR: No matching distribution found for x"
    assert house.install.main() == 1 and not house.stamp.exists()


@pytest.mark.parametrize("answer", [NO_WHEEL, f"{NO_WHEEL}\nBuilding wheel for pybullet", f"NameResolutionError\n{NO_WHEEL}"])
@pytest.mark.parametrize("obstacle", ["there is no C++ compiler.", ""])
def test_missing_pybullet_stops_nothing_and_is_tried_again(
    house: _House, monkeypatch: pytest.MonkeyPatch, answer: str, obstacle: str
) -> None:
    house.answers["pybullet"] = answer
    monkeypatch.setattr(house.install, "compiler_obstacle", lambda: obstacle)
    monkeypatch.setattr(house.install, "build_obstacle", lambda pin: "no build here")
    assert house.install.main() == 0 and house.stamp.exists()
    tries = len(house.asked)
    house.answers.clear()
    assert house.install.main() == 0 and len(house.asked) > tries


def test_other_python_than_in_venv_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    install = _load("install")
    monkeypatch.setattr(install, "venv_version", lambda: "3.9")
    with pytest.raises(install.SetUpStopped, match=r"\.venv has Python 3\.9; remove \.venv"):
        install.make_venv()


def test_compiler_is_looked_for_on_path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    install = _load("install")
    monkeypatch.delenv("CXX", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    assert "C++" in install.compiler_obstacle()
    _fake_python(tmp_path / "g++", "")
    monkeypatch.setenv("CC", "my-cc -pthread")
    assert "my-cc" in install.compiler_obstacle()


@pytest.mark.parametrize(
    ("output", "named"),
    [
        ("ERROR: THESE PACKAGES DO NOT MATCH THE HASHES FROM ...", "hash"),
        ("OSError: [Errno 28] No space left on device", "disk"),
        ("Temporary failure in name resolution", "network"),
        ("ERROR: No matching distribution found for coal==3.0.3", "coal==3.0.3"),
        ("ERROR: something else\nnoise", "something else"),
        ("", ""),
    ],
)
def test_a_failure_of_pip_is_named_on_one_line(output: str, named: str) -> None:
    sentence = _load("install").pip_sentence(output)
    assert sentence and named in sentence and "\n" not in sentence
