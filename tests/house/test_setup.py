"""The set-up: which Python is taken, what is said when something is in the way, when work is repeated."""

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
    """A fresh copy of a set-up file, which lives in a hidden folder and so is not importable by name."""
    spec = importlib.util.spec_from_file_location(name, root / ".setup" / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _fake_python(path: Path, script: str) -> str:
    """An executable file that stands in for an interpreter."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!/bin/sh\n{script}\n", encoding="utf-8")
    path.chmod(0o755)
    return str(path)


choose_python = _load("choose_python")
OLD = ("old", (3, 10, 13), [])
NEW = ("new", (3, 14, 0), [])
BARE = ("bare", (3, 11, 2), ["venv", "ensurepip"])


@pytest.mark.parametrize(
    ("found", "path"),
    [
        ([("a", (3, 11, 0), [])], "a"),
        ([OLD, NEW, ("c", (3, 13, 9), [])], "c"),
        ([BARE, ("b", (3, 12, 1), [])], "b"),
        ([("first", (3, 12, 1), []), ("second", (3, 11, 1), [])], "first"),
    ],
)
def test_first_usable_python_is_chosen(found: list[Any], path: str) -> None:
    assert choose_python.choose(found) == (path, "")


@pytest.mark.parametrize(
    ("found", "words"),
    [
        ([], ["3.11, 3.12 or 3.13", "no Python that runs"]),
        ([OLD], ["3.11, 3.12 or 3.13", "old is Python 3.10.13"]),
        ([NEW], ["new is Python 3.14.0"]),
        ([OLD, BARE], ["bare (Python 3.11.2)", "ensurepip", "python3.11-venv"]),
    ],
)
def test_sentence_names_what_is_in_the_way(found: list[Any], words: list[str]) -> None:
    path, sentence = choose_python.choose(found)
    assert path == "" and "\n" not in sentence
    assert [word for word in words if word not in sentence] == []


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
    ("script", "words"),
    [
        ("echo 3.10.13", "is Python 3.10.13"),
        ("echo 2.7.18", "is Python 2.7.18"),
        ("echo 3.12.3 ensurepip", "python3.12-venv"),
        ("exit 1", "no Python that runs"),
    ],
)
def test_unusable_python_is_one_plain_sentence(tmp_path: Path, script: str, words: str) -> None:
    asked = _fake_python(tmp_path / "asked", script)
    command = [sys.executable, str(ROOT / ".setup" / "choose_python.py")]
    ended = subprocess.run(command, env={"PYTHON": asked}, capture_output=True, text=True, check=False)
    assert ended.returncode == 1 and ended.stdout == ""
    assert ended.stderr.startswith("Set-up stopped: ") and ended.stderr.count("\n") == 1
    assert words in ended.stderr


def test_make_says_so_when_there_is_no_python(tmp_path: Path) -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    recipe = makefile[makefile.index("SET_UP = @") :].split("\n\n")[0]
    (tmp_path / "Makefile").write_text(f"{recipe}\nsetup:\n\t$(SET_UP)\n", encoding="utf-8")
    _fake_python(tmp_path / "python3", "exit 127")
    make = subprocess.run(["which", "make"], capture_output=True, text=True, check=True).stdout.strip()
    command = [make, "-C", str(tmp_path), "SHELL=/bin/sh", "setup"]
    ended = subprocess.run(command, env={"PATH": str(tmp_path)}, capture_output=True, text=True, check=False)
    assert ended.returncode != 0
    assert ended.stderr.startswith("Set-up stopped: no working python3")


def test_chooser_is_readable_by_an_old_python() -> None:
    tree = ast.parse((ROOT / ".setup" / "choose_python.py").read_text(encoding="utf-8"))
    too_new = (ast.JoinedStr, ast.AnnAssign, ast.NamedExpr, ast.AsyncFunctionDef, ast.Match, ast.Starred)
    for node in ast.walk(tree):
        assert not isinstance(node, too_new), f"line {node.lineno}"
        if isinstance(node, ast.FunctionDef):
            assert node.returns is None and not node.args.kwonlyargs, node.name
            assert [argument.arg for argument in node.args.args if argument.annotation] == []


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

    def _project(self) -> None:
        self.installs += 1
        _fake_python(self.command, "")

    def _pip(self, pins: str, *options: str) -> str | None:
        self.asked.append((pins, options))
        return self.answers.get("pybullet" if "pybullet" in pins else "others")


@pytest.fixture
def house(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> _House:
    return _House(tmp_path, monkeypatch)


def test_pybullet_is_split_off_and_nothing_is_lost() -> None:
    others, pybullet = _load("install").split_lock(LOCK)
    assert pybullet == "pybullet==3 \\\n    --hash=sha256:1\n"
    assert others == LOCK.replace(pybullet, "")


def test_second_run_does_nothing_until_the_lock_changes(house: _House) -> None:
    assert house.install.main() == 0 and len(house.asked) == 2
    assert house.install.main() == 0 and len(house.asked) == 2
    house.lock.write_text(LOCK.replace("numpy==2", "numpy==3"), encoding="utf-8")
    assert house.install.main() == 0 and len(house.asked) == 4


def test_the_project_is_installed_again_where_its_command_is_missing_or_its_metadata_changed(house: _House) -> None:
    assert house.install.main() == 0 and house.installs == 1
    house.command.unlink()
    assert house.install.main() == 0 and house.installs == 2
    house.project.write_text("[project]", encoding="utf-8")
    assert house.install.main() == 0 and house.installs == 3
    assert house.install.main() == 0 and house.installs == 3 and len(house.asked) == 2


def test_the_command_and_all_packages_of_the_checkout_work_from_any_folder(tmp_path: Path) -> None:
    """Installed for real: into an environment that sees the packages of this one, from a copy of this checkout."""
    source = copied(tmp_path)
    venv.create(source / ".venv", with_pip=False)
    [packages] = (source / ".venv" / "lib").glob("python*/site-packages")
    (packages / "of_this_environment.pth").write_text(sysconfig.get_path("purelib"), encoding="utf-8")
    install = _load("install", source)
    install.install_project()
    run = {"cwd": tmp_path, "env": {"PATH": ""}, "capture_output": True, "text": True}
    said = subprocess.run([source / ".venv" / "bin" / "avatarsim", "--help"], check=True, **run).stdout
    assert "compile" in said and "replay" in said
    where = "import avatarsim, reference, scenarios; print(avatarsim.__file__, reference.__file__, scenarios.__file__)"
    found = subprocess.run([source / ".venv" / "bin" / "python", "-c", where], check=True, **run).stdout.split()
    assert [Path(file).parent.parent for file in found] == [source] * 3
    assert not (source / "avatarsim.egg-info").exists()


def test_failed_set_up_leaves_no_stamp(house: _House, capfd: pytest.CaptureFixture[str]) -> None:
    house.answers["others"] = "WARNING: NewConnectionError(...)\nERROR: No matching distribution found for x"
    assert house.install.main() == 1 and not house.stamp.exists()
    said = capfd.readouterr().err
    assert said.count("\n") == 1 and "there is no network" in said


@pytest.mark.parametrize(
    ("answer", "obstacle", "words"),
    [
        (NO_WHEEL, "there is no C++ compiler.", "no C++ compiler"),
        (f"{NO_WHEEL}\nBuilding wheel for pybullet", "", "does not compile here"),
        (f"NameResolutionError\n{NO_WHEEL}", "", "there is no network"),
    ],
)
def test_missing_pybullet_stops_nothing(
    house: _House,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
    answer: str,
    obstacle: str,
    words: str,
) -> None:
    house.answers["pybullet"] = answer
    monkeypatch.setattr(house.install, "compiler_obstacle", lambda: obstacle)
    assert house.install.main() == 0 and house.stamp.exists()
    said = capfd.readouterr().out
    assert words in said and "not-measured" in said
    tries = len(house.asked)
    house.answers.clear()
    assert house.install.main() == 0 and len(house.asked) > tries, "an explicit set-up tries pybullet again"


def test_build_is_announced_before_it_starts(
    house: _House, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    heard: list[str] = []

    def build(pin: str) -> str:
        heard.append(capfd.readouterr().out)
        return ""

    house.answers["pybullet"] = NO_WHEEL
    monkeypatch.setattr(house.install, "build_obstacle", build)
    assert house.install.main() == 0
    assert "about 4 minutes" in heard[0] and "C++ compiler" in heard[0]


def test_other_python_than_in_venv_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    install = _load("install")
    monkeypatch.setattr(install, "venv_version", lambda: "3.9")
    with pytest.raises(install.SetUpStopped, match=r"\.venv has Python 3\.9; remove \.venv"):
        install.make_venv()


def test_compiler_is_looked_for_on_path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    install = _load("install")
    monkeypatch.delenv("CXX", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    assert "C++ compiler" in install.compiler_obstacle()
    _fake_python(tmp_path / "g++", "")
    monkeypatch.setenv("CC", "my-cc -pthread")
    assert "my-cc" in install.compiler_obstacle()


@pytest.mark.parametrize(
    ("output", "words"),
    [
        ("ERROR: THESE PACKAGES DO NOT MATCH THE HASHES FROM ...", "differs from its hash"),
        ("OSError: [Errno 28] No space left on device", "disk is full"),
        ("Temporary failure in name resolution", "there is no network"),
        ("ERROR: No matching distribution found for coal==3.0.3", "has no coal==3.0.3"),
        ("ERROR: something else\nnoise", "ERROR: something else"),
        ("", "no reason"),
    ],
)
def test_pip_failure_becomes_one_sentence(output: str, words: str) -> None:
    sentence = _load("install").pip_sentence(output)
    assert words in sentence and sentence.endswith(".") and "\n" not in sentence
