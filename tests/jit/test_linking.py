"""A large kernel is compiled once, called by name, never missing from disk; a stage lets threads run; numba alone agrees."""

import json
import os
import pickle
import shutil
import subprocess
import sys
from pathlib import Path
from threading import Thread

import numpy as np
import pytest

from avatarsim.collision.support import support
from avatarsim.jit import linking
from avatarsim.jit.kernel import STOCK, WITHOUT_LOCK, entry_kernel, kernel
from avatarsim.jit.linking import KernelDispatcher
from tests.house import yardstick
from tests.jit.kernel_package import make_package, plain_environment

LARGE = """from avatarsim.jit.kernel import kernel


@kernel
def large(x: float, n: int) -> float:
    y = x
{}
    return y + n
"""
CALLER = """from avatarsim.jit.kernel import kernel
from avatarsim.large import large


@kernel
def small(x: float) -> float:
    return large(x, 1) + large(x, 2)


@kernel
def top(x: float) -> float:
    return small(x) + large(x, 3)
"""
ASK = """
import json
from avatarsim.jit import linking
from avatarsim.caller import {names}
from avatarsim.caller import small
from avatarsim.large import large

values = [f(0.25) for f in ({names},)]
called = large.called
print(json.dumps({{
    "values": values,
    "compiled": sum(sum(k.stats.cache_misses.values()) for f in ({names}, large) for k in (f, f.called)),
    "specialisations": len(called.overloads),
    "inlined": [k.library.only_inlined for k in small.called.overloads.values()],
    "by name": [list(linking.called(k.library)) for f in ({names},) for k in f.overloads.values()],
}}))
"""


@pytest.fixture
def package(tmp_path):
    """A package with a kernel of some hundred instructions and two that call it."""
    root = make_package(tmp_path / "installed")
    steps = "\n".join(f"    y = y * {1.0 + 1.0 / k} + x / (y + {k}.0)" for k in range(1, 90))
    (root / "large.py").write_text(LARGE.format(steps))
    (root / "caller.py").write_text(CALLER)
    return root


def process(package, names, cache):
    kept = plain_environment(package, NUMBA_CACHE_DIR=str(cache))
    command = [sys.executable, "-c", ASK.format(names=", ".join(names))]
    return subprocess.Popen(command, env=kept, cwd=package.parent, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def ask(package, names, cache):
    """Return the report of a process of its own on kernels that it calls."""
    child = process(package, names, cache)
    said, trouble = child.communicate()
    assert child.returncode == 0, trouble
    return json.loads(said)


def plainly(x):
    """The same, without a compiler."""
    y = x
    for k in range(1, 90):
        y = y * (1.0 + 1.0 / k) + x / (y + k)
    return 3 * y + 6.0


def test_a_large_kernel_is_called_by_name_for_any_constant(package, tmp_path):
    said = ask(package, ["top"], tmp_path / "cache")
    assert said["values"][0] == pytest.approx(plainly(0.25), rel=1e-13)
    assert said["specialisations"] == 1
    assert said["by name"][0][0].startswith(linking.PREFIX + "avatarsim.large.large:")


def test_entries_and_called_kernels_live_together_on_disk(package, tmp_path):
    cache = tmp_path / "cache"
    first = ask(package, ["top", "small"], cache)
    for names in (["small", "top"], ["top", "small"], ["small"], ["top"]):
        again = ask(package, names, cache)
        assert again["values"] == [first["values"][("top", "small").index(name)] for name in names]
        assert again["compiled"] == 0


def test_a_small_kernel_is_kept_as_ir_and_inlined_from_disk(package, tmp_path):
    cache = tmp_path / "cache"
    first = ask(package, ["top"], cache)
    assert first["inlined"] == [True] and ask(package, ["top"], cache)["inlined"] == []
    gone = list(cache.rglob("top-*.kernel"))
    for file in gone:
        file.unlink()
    again = ask(package, ["top"], cache)
    assert gone and again["values"] == first["values"]
    assert again["inlined"] == [True] and again["compiled"] == 1


def test_a_callee_that_is_gone_from_disk_is_compiled_again(package, tmp_path):
    cache = tmp_path / "cache"
    before = ask(package, ["top"], cache)
    (gone,) = (folder for folder in (cache / "avatarsim-kernels").iterdir() if folder.name.endswith("large"))
    shutil.rmtree(gone)
    after = ask(package, ["top"], cache)
    assert after["values"] == before["values"]
    assert after["compiled"] == 1


def test_a_changed_callee_is_never_called_under_its_old_name(package, tmp_path):
    cache = tmp_path / "cache"
    before = ask(package, ["top"], cache)["values"][0]
    text = (package / "large.py").read_text()
    (package / "large.py").write_text(text.replace("return y + n", "return y + n + 1.0"))
    assert ask(package, ["top"], cache)["values"][0] == pytest.approx(before + 3.0, rel=1e-13)


def test_processes_that_start_at_once_compile_each_kernel_once(package, tmp_path):
    children = [process(package, ["top"], tmp_path / "cache") for _ in range(3)]
    said = [json.loads(child.communicate()[0]) for child in children]
    assert sum(one["compiled"] for one in said) == 2  # `large` and `top`; `small` is not counted
    assert len({tuple(one["values"]) for one in said}) == 1


def test_a_folder_gone_in_mid_run_costs_compiling_only(package, tmp_path):
    cache = tmp_path / "cache"
    gone = f"import shutil; from avatarsim.caller import small, top; small(0.5); shutil.rmtree({str(cache)!r})\n"
    kept = plain_environment(package, NUMBA_CACHE_DIR=str(cache))
    command = [sys.executable, "-c", gone + "print(top(0.25))"]
    done = subprocess.run(command, env=kept, cwd=package.parent, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert float(done.stdout) == pytest.approx(plainly(0.25), rel=1e-13)


def test_a_kernel_is_pickled_by_name():
    assert pickle.loads(pickle.dumps(support)) is support


MOST = 10**9
"""Looks of a kernel at a flag: a second or so. Another thread sets the flag within milliseconds, or never."""


@entry_kernel
def seen(flags: np.ndarray, where: np.ndarray) -> bool:
    """Return whether a thread sets a flag while this looks at it; by an index hidden from compilers, or it is read once."""
    for k in range(MOST):
        if flags[where[k % where.shape[0]]] == 1:
            return True
    return False


def test_another_thread_runs_while_an_entry_kernel_does() -> None:
    flags, where = np.zeros(1, dtype=np.int64), np.zeros(1024, dtype=np.int64)
    flags[0] = 1
    assert seen(flags, where)
    flags[0] = 0
    other = Thread(target=flags.__setitem__, args=(0, 1))
    other.start()
    assert seen(flags, where)
    other.join()


def test_only_entry_kernels_let_go_of_the_lock() -> None:
    options = [one.targetoptions for one in (seen, total) if isinstance(one, KernelDispatcher)]
    assert [WITHOUT_LOCK.items() <= one.items() for one in options] == [True, False]


@kernel
def total(numbers: np.ndarray) -> float:
    """A kernel that is called by others."""
    return numbers.sum()


ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("name", ["pairs plates", "impacts"])
def test_numba_alone_gives_the_same_bits(name: str, tmp_path: Path) -> None:
    found = tmp_path / "found.json"
    command = [sys.executable, "-m", "tests.house.yardstick", "--jobs", "1", "--filter", name, "-o", str(found)]
    environment = {**os.environ, STOCK: "1", "NUMBA_CACHE_DIR": str(tmp_path / "kernels")}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert json.loads(found.read_text()) == {name: yardstick.slices()[name]()}
    # numba's own cache, not the engine's
    assert any((tmp_path / "kernels").rglob("*.nbi")) and not (tmp_path / "kernels" / "avatarsim-kernels").exists()
