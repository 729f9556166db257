"""Compiled kernels are never stale, and a machine that can keep none still runs."""

import importlib.util
import os
import shutil
import subprocess
import sys

import pytest

from avatarsim import compiler_passes, kernel_library, linking
from avatarsim import kernel as real

CALLEE = (
    "from avatarsim.kernel import kernel\n\n\n@kernel\ndef twice(x: float) -> float:\n    return {} * x\n"
)
CALLER = """from avatarsim.kernel import kernel
from avatarsim.{} import twice


@kernel
def answer(x: float) -> float:
    return twice(x) + 1.0
"""
ASK = "from avatarsim.caller import answer; print(answer(10.0), sum(answer.stats.cache_hits.values()))"


@pytest.fixture
def package(tmp_path):
    """A package of two kernels in two files, with our decorator."""
    root = tmp_path / "installed" / "avatarsim"
    root.mkdir(parents=True)
    shutil.copy(real.__file__, root / "kernel.py")
    shutil.copy(linking.__file__, root / "linking.py")
    shutil.copy(compiler_passes.__file__, root / "compiler_passes.py")
    shutil.copy(kernel_library.__file__, root / "kernel_library.py")
    (root / "__init__.py").write_text("")
    (root / "callee.py").write_text(CALLEE.format("2.0"))
    (root / "caller.py").write_text(CALLER.format("callee"))
    (root / "bystander.py").write_text("x = 1\n")
    return root


def run(package, **environment):
    """The answer and the number of cache hits, from a process of its own."""
    kept = {k: v for k, v in os.environ.items() if not k.startswith(("NUMBA_", "XDG_", "PYTHON"))}
    kept |= {"PYTHONPATH": str(package.parent), "PYTHONDONTWRITEBYTECODE": "1", **environment}
    command = [sys.executable, "-c", ASK]
    done = subprocess.run(command, env=kept, cwd=package.parent, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    answer, hits = done.stdout.split()
    return float(answer), int(hits)


def loaded(package):
    """The copied kernel.py as a module of its own."""
    spec = importlib.util.spec_from_file_location("copied_kernel", package / "kernel.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_an_edited_callee_in_another_file_is_never_stale(package, tmp_path):
    cache = {"XDG_CACHE_HOME": str(tmp_path / "cache")}
    assert run(package, **cache) == (21.0, 0)
    assert run(package, **cache) == (21.0, 1)
    (package / "callee.py").write_text(CALLEE.format("5.0"))
    assert run(package, **cache) == (51.0, 0)
    (package / "bystander.py").write_text("x = 2\n")
    assert run(package, **cache) == (51.0, 1)


def test_flags_do_not_share_compiled_code(package, tmp_path):
    cache = {"NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    assert run(package, **cache) == (21.0, 0)
    assert run(package, NUMBA_BOUNDSCHECK="1", **cache) == (21.0, 0)


def test_nowhere_to_write_but_the_temporary_folder(package, tmp_path):
    blocked, temporary = tmp_path / "a_file", tmp_path / "tmp"
    blocked.write_text("")
    temporary.mkdir()
    places = {"XDG_CACHE_HOME": str(blocked), "HOME": str(blocked), "TMPDIR": str(temporary)}
    assert run(package, **places) == (21.0, 0)
    assert run(package, **places) == (21.0, 1)


def test_nowhere_to_write_at_all_compiles_each_time_and_leaves_the_install_alone(
    package, tmp_path, monkeypatch
):
    monkeypatch.setattr(real.tempfile, "tempdir", None)
    module = loaded(package)
    blocked = tmp_path / "a_file"
    blocked.write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(blocked))
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(blocked))
    monkeypatch.setenv("HOME", str(blocked))
    monkeypatch.setattr(real.tempfile, "tempdir", str(blocked))
    assert module.cache_folder(str(package / "caller.py")) is None

    def plus_one(x: float) -> float:
        return x + 1.0

    assert module.kernel(plus_one)(1.0) == 2.0
    assert sorted(p.name for p in package.iterdir() if p.is_dir()) in ([], ["__pycache__"])
    assert not list(package.rglob("*.nb?"))


def test_the_hash_covers_what_is_imported_and_nothing_else(package):
    module = loaded(package)
    caller = str(package / "caller.py")

    def now():
        module._imported.cache_clear()
        module._content.cache_clear()
        return module.source_hash(caller)

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


def test_an_import_of_a_folder_covers_all_in_it(package):
    room = package / "room"
    room.mkdir()
    (room / "__init__.py").write_text("")
    (room / "wall.py").write_text("x = 1\n")
    (package / "caller.py").write_text("from avatarsim.room import wall\n")
    before = loaded(package).source_hash(str(package / "caller.py"))
    (room / "wall.py").write_text("x = 2\n")
    assert loaded(package).source_hash(str(package / "caller.py")) != before


def test_only_the_newest_versions_are_kept(package, tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))
    made = []
    for k in range(6):
        (package / "caller.py").write_text(f"x = {k}\n")
        folder = loaded(package).cache_folder(str(package / "caller.py"))
        os.utime(folder, (k, k))
        made.append(folder)
    assert [f.exists() for f in made] == [False] * 3 + [True] * 3


def test_other_users_of_numba_keep_their_own_folder():
    import numba

    before = numba.config.CACHE_DIR
    real.kernel(same)
    assert numba.config.CACHE_DIR == before


def same(x: float) -> float:
    """Something to decorate."""
    return x
