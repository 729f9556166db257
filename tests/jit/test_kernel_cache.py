"""Compiled kernels are never stale and never run from another user's files, damage is found, and a machine that keeps none still
runs."""

import importlib.util
import pickle
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import llvmlite
import numba
import numpy as np
import pytest

from avatarsim.files import write_entry
from avatarsim.jit import source_hash as real
from avatarsim.jit.baseline import LISTED, NAME, runs_baseline
from avatarsim.jit.kernel import kernel
from tests.jit.kernel_package import make_package, run_in

CALLEE = (
    "from avatarsim.jit.kernel import kernel\n\n\n@kernel\ndef twice(x: float) -> float:\n    return {} * x\n"
)
CALLER = """from avatarsim.jit.kernel import kernel
from avatarsim.{} import twice


@kernel
def answer(x: float) -> float:
    return twice(x) + 1.0
"""
ASK = "from avatarsim.caller import answer\n{}\nprint(answer(10.0), sum(answer.stats.cache_hits.values()))"


@pytest.fixture
def package(tmp_path: Path) -> Path:
    return make_two(tmp_path / "installed")


def make_two(folder: Path) -> Path:
    """Return a package of two kernels in two files, with our decorator."""
    root = make_package(folder)
    (root / "callee.py").write_text(CALLEE.format("2.0"))
    (root / "caller.py").write_text(CALLER.format("callee"))
    (root / "bystander.py").write_text("x = 1\n")
    return root


@pytest.fixture(scope="module")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The cache of a process that has compiled such a package."""
    folder = tmp_path_factory.mktemp("compiled")
    assert run(make_two(folder / "installed"), NUMBA_CACHE_DIR=str(folder / "cache")) == (21.0, 0)
    return folder / "cache"


@pytest.fixture
def cache(compiled: Path, tmp_path: Path) -> dict[str, str]:
    """The environment in which the package has been compiled once."""
    shutil.copytree(compiled, tmp_path / "cache")
    return {"NUMBA_CACHE_DIR": str(tmp_path / "cache")}


def told(package: Path, before: str = "", **environment: str) -> tuple[float, int, str]:
    """Return the answer, the number of cache hits and the text on standard error, from a process of its own that runs `before`
    when the kernels are imported and not yet called."""
    said, trouble = run_in(package, ASK.format(before), **environment)
    answer, hits = said.split()
    return float(answer), int(hits), trouble


def run(package: Path, before: str = "", **environment: str) -> tuple[float, int]:
    """Return the answer and the number of cache hits."""
    return told(package, before, **environment)[:2]


def loaded(package: Path) -> ModuleType:
    """Return the copied source_hash.py as a module of its own."""
    spec = importlib.util.spec_from_file_location("copied_hash", package / "jit" / "source_hash.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_an_edited_callee_in_another_file_is_never_stale(package: Path, tmp_path: Path) -> None:
    cache = {"XDG_CACHE_HOME": str(tmp_path / "cache")}
    assert run(package, **cache) == (21.0, 0)
    assert run(package, **cache) == (21.0, 1)
    (package / "callee.py").write_text(CALLEE.format("5.0"))
    assert run(package, **cache) == (51.0, 0)
    (package / "bystander.py").write_text("x = 2\n")
    assert run(package, **cache) == (51.0, 1)


def test_an_edited_callee_of_another_package_is_not_stale(package: Path, tmp_path: Path) -> None:
    cache = {"XDG_CACHE_HOME": str(tmp_path / "cache")}
    harness = package.parent / "harness"
    harness.mkdir()
    (harness / "__init__.py").write_text("")
    (harness / "caller.py").write_text(CALLER.format("callee").replace("avatarsim.callee", "harness.callee"))
    for factor, answer in (("2.0", 21.0), ("5.0", 51.0)):
        (harness / "callee.py").write_text(CALLEE.format(factor))
        said, _ = run_in(package, ASK.format("").replace("avatarsim.caller", "harness.caller"), **cache)
        assert said.split() == [str(answer), "0"]


SETTINGS = ("BOUNDSCHECK", "LOOP_VECTORIZE", "SLP_VECTORIZE", "USING_SVML", "EXTEND_VARIABLE_LIFETIMES")


@pytest.mark.parametrize(("of", "name"), [
    *((numba.config, name) for name in SETTINGS),
    *((module, "__version__") for module in (np, numba, llvmlite)),
])
def test_the_key_has_the_settings_and_versions_that_change_code(of: object, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    before = real.source_hash.__wrapped__(__file__)
    monkeypatch.setattr(of, name, "1.26.4" if name == "__version__" else not getattr(of, name))
    assert real.source_hash.__wrapped__(__file__) != before


def test_nowhere_to_write_but_the_temporary_folder(package: Path, tmp_path: Path) -> None:
    blocked, temporary = tmp_path / "a_file", tmp_path / "tmp"
    blocked.write_text("")
    temporary.mkdir()
    places = {"XDG_CACHE_HOME": str(blocked), "HOME": str(blocked), "TMPDIR": str(temporary)}
    assert run(package, **places) == (21.0, 0)
    assert run(package, **places) == (21.0, 1)


def test_without_a_folder_to_write_it_compiles_and_says_so_once(package: Path, tmp_path: Path) -> None:
    blocked = tmp_path / "a_file"
    blocked.write_text("")
    nowhere = "import tempfile\ndef none():\n    raise FileNotFoundError(2, 'no temporary directory')\ntempfile.gettempdir = none"
    answer, hits, said = told(package, nowhere, XDG_CACHE_HOME=str(blocked), HOME=str(blocked), NUMBA_CACHE_DIR=str(blocked))
    assert (answer, hits) == (21.0, 0)
    assert said.count("cannot be kept") == 1 and str(blocked) in said and "Traceback" not in said
    assert not list(package.rglob("*.kernel"))


DAMAGE: dict[str, Callable[[bytes], bytes]] = {
    "cut": lambda data: data[: len(data) // 2],
    "emptied": lambda data: b"",
    "garbled": lambda data: data[:400] + bytes(byte ^ 0x55 for byte in data[400:]),
    "foreign": lambda data: b"\x80\x04garbage.",
}


def test_damaged_files_are_said_once_removed_and_compiled_anew(package: Path, cache: dict[str, str], tmp_path: Path) -> None:
    whole = {path: path.read_bytes() for path in (tmp_path / "cache").rglob("*.kernel")}
    assert len(whole) == 2
    for kinds in (("cut", "emptied"), ("garbled", "foreign")):
        for kind, (path, data) in zip(kinds, whole.items(), strict=True):
            path.write_bytes(DAMAGE[kind](data))
        answer, hits, said = told(package, **cache)
        assert (answer, hits) == (21.0, 0)
        assert said.count("compiled anew") == 1 and "Traceback" not in said
        assert {path for path in (tmp_path / "cache").rglob("*") if path.is_file()} == set(whole), "no leftovers"
    answer, hits, said = told(package, **cache)
    assert (answer, hits, said) == (21.0, 1, "")


UNLOADABLE = """
import pickle
from pathlib import Path
import avatarsim.caller
from avatarsim.files import read_entry
data = read_entry(Path({path!r}))
arguments, payload = pickle.loads(data)
Path({out!r}).write_bytes(pickle.dumps({{
    "a module that is gone": b"cnumpy.no_such_module\\ndtype\\n.", "half": data[: len(data) // 2], "empty": b"",
    "no pair": pickle.dumps(arguments), "no code": pickle.dumps((arguments, None)),
    "another layout": pickle.dumps((arguments, payload[:-1])),
    "another layout of numba": pickle.dumps((arguments, (*payload[:-1], payload[-1][:-1]))),
    "no bitcode": pickle.dumps((arguments, (payload[0], True, payload[2], (("name", b"none"), *payload[-1][1:])))),
}}))
"""
"""Program that writes contents which another version of a package might have written into an entry."""


def test_entries_that_cannot_be_loaded_are_compiled_anew(package: Path, cache: dict[str, str], tmp_path: Path) -> None:
    [path] = (tmp_path / "cache").rglob("answer-*.kernel")
    contents = tmp_path / "contents"
    run_in(package, UNLOADABLE.format(path=str(path), out=str(contents)), **cache)
    for kind, content in pickle.loads(contents.read_bytes()).items():
        write_entry(path, content)
        answer, hits, said = told(package, **cache)
        assert (answer, hits) == (21.0, 0), kind
        assert said.count("compiled anew") == 1 and str(path) in said and "Traceback" not in said, kind
    assert told(package, **cache) == (21.0, 1, "")


def test_a_full_disk_is_said_once_and_stops_nothing(package: Path, tmp_path: Path) -> None:
    """A file that may not grow refuses as a full disk does."""
    full = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (0, resource.RLIM_INFINITY))"
    answer, hits, said = told(package, full, NUMBA_CACHE_DIR=str(tmp_path / "cache"))
    assert (answer, hits) == (21.0, 0)
    assert said.count("cannot be kept") == 1 and "cannot be written to" in said and "Traceback" not in said
    assert [path for path in (tmp_path / "cache").rglob("*") if path.is_file()] == []
    assert run(package, NUMBA_CACHE_DIR=str(tmp_path / "cache")) == (21.0, 0)


def test_too_many_open_files_stop_nothing(package: Path, cache: dict[str, str]) -> None:
    # From here on no file can be opened; modules that numba imports late have to be in memory.
    none = "answer.py_func(1.0); import resource; resource.setrlimit(resource.RLIMIT_NOFILE, (0, 4096))"
    answer, hits, said = told(package, f"from numba import njit; njit(lambda x: x)(1.0); {none}", **cache)
    assert (answer, hits) == (21.0, 0)
    assert said.count("Too many open files") >= 1 and said.count("cannot be kept") == 1 and "Traceback" not in said
    assert run(package, **cache) == (21.0, 1)


def test_a_moved_read_only_cache_serves_a_moved_install(package: Path, tmp_path: Path) -> None:
    assert run(package, AVATARSIM_CACHE_DIR=str(tmp_path / "made")) == (21.0, 0)
    shutil.move(tmp_path / "made", tmp_path / "carried")
    elsewhere = tmp_path / "another" / "place" / "avatarsim"
    shutil.copytree(package, elsewhere)
    read_only = "from avatarsim.jit import places; places.is_writable = lambda folder: False"
    carried = {"AVATARSIM_CACHE_DIR": str(tmp_path / "carried"), "HOME": str(tmp_path / "home")}
    assert told(elsewhere, read_only, **carried) == (21.0, 1, "")


def test_kernels_inside_the_installed_package_are_used(package: Path, tmp_path: Path) -> None:
    assert run(package, AVATARSIM_CACHE_DIR=str(package)) == (21.0, 0)
    assert told(package, HOME=str(tmp_path / "home")) == (21.0, 1, "")


def test_baseline_kernels_run_where_the_processor_has_it_only(package: Path, tmp_path: Path) -> None:
    cache = {"NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    assert run(package, NUMBA_CPU_NAME=NAME, NUMBA_CPU_FEATURES=LISTED, **cache) == (21.0, 0)
    assert run(package, NUMBA_CPU_NAME="generic", **cache) == (21.0, 0)
    lacking = "from avatarsim.jit import baseline; baseline.runs_baseline = lambda: False"
    other = {"NUMBA_CACHE_DIR": str(tmp_path / "other")}
    shutil.copytree(tmp_path / "cache", tmp_path / "other")
    assert run(package, lacking, **other) == (21.0, 0)
    assert run(package, **cache) == (21.0, 1 if runs_baseline() else 0)


def test_a_file_that_others_may_write_to_is_never_unpickled(package: Path, cache: dict[str, str], tmp_path: Path) -> None:
    for path in (tmp_path / "cache").rglob("*.kernel"):
        path.chmod(0o666)
    answer, hits, said = told(package, **cache)
    assert (answer, hits) == (21.0, 0) and "other users may write to it" in said
    assert {path.stat().st_mode & 0o777 for path in (tmp_path / "cache").rglob("*.kernel")} == {0o600}
    assert {path.stat().st_mode & 0o777 for path in (tmp_path / "cache").rglob("*") if path.is_dir()} == {0o700}
    assert run(package, **cache) == (21.0, 1)


def test_announces_a_first_compile_and_no_cached_start(package: Path, tmp_path: Path) -> None:
    cache = {"NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    said = told(package, **cache)[2]
    assert said.count("\n") == 1 and re.findall(r"\d+", said) == ["2", "1"], "two kernels, a second"
    assert told(package, **cache)[2] == ""


def test_the_hash_covers_what_is_imported_and_nothing_else(package: Path) -> None:
    module = loaded(package)
    caller = str(package / "caller.py")

    def now() -> str:
        for remembered in (module._imported, module._content, module._files_of, module.source_hash):
            remembered.cache_clear()
        found: str = module.source_hash(caller)
        return found

    before = now()
    (package / "bystander.py").write_text("x = 3\n")
    assert now() == before
    (package / "callee.py").write_text(CALLEE.format("3.0"))
    after = now()
    assert after != before
    (package / "callee.py").write_text("from avatarsim.bystander import x\n" + CALLEE.format("3.0"))
    through = now()
    assert through != after
    (package / "bystander.py").write_text("x = 4\n")
    assert now() != through
    (package / "caller.py").write_text("from .callee import twice\n")
    relative = now()
    (package / "bystander.py").write_text("x = 5\n")
    assert now() != relative


def test_an_import_of_a_folder_covers_all_in_it(package: Path) -> None:
    room = package / "room"
    room.mkdir()
    (room / "__init__.py").write_text("")
    (room / "wall.py").write_text("x = 1\n")
    (package / "caller.py").write_text("from avatarsim.room import wall\n")
    before = loaded(package).source_hash(str(package / "caller.py"))
    (room / "wall.py").write_text("x = 2\n")
    assert loaded(package).source_hash(str(package / "caller.py")) != before


def test_other_users_of_numba_keep_their_own_folder() -> None:
    before = numba.config.CACHE_DIR
    kernel(same)
    assert numba.config.CACHE_DIR == before


def same(x: float) -> float:
    """Return something to decorate."""
    return x


def test_other_cache_folders_come_after_our_own(package: Path, tmp_path: Path) -> None:
    first = {"AVATARSIM_CACHE_DIR": str(tmp_path / "ours"), "NUMBA_CACHE_DIR": str(tmp_path / "numba")}
    assert run(package, **first) == (21.0, 0)
    assert list((tmp_path / "ours").rglob("*.kernel")) and not (tmp_path / "numba").exists()
