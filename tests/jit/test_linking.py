"""A large kernel is compiled once, called by name, never missing from disk; a stage lets threads run; numba alone agrees."""

import json
import os
import pickle
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Thread

import numpy as np
import pytest

from avatarsim.collision.epa import epa
from avatarsim.collision.gjk import gjk
from avatarsim.collision.support import support
from avatarsim.jit import linking
from avatarsim.jit.kernel import STOCK, WITHOUT_LOCK, entry_kernel, kernel
from avatarsim.jit.linking import KernelDispatcher
from tests.collision.solids import SCRATCH
from tests.collision.strata import BATCH, draw
from tests.jit.kernel_package import make_package, run_in

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


@pytest.fixture(scope="module")
def compiled(tmp_path_factory):
    """The folder of a package with a kernel of some hundred instructions and two that call it, compiled, and what that said."""
    folder = tmp_path_factory.mktemp("compiled")
    root = make_package(folder / "installed")
    steps = "\n".join(f"    y = y * {1.0 + 1.0 / k} + x / (y + {k}.0)" for k in range(1, 90))
    (root / "large.py").write_text(LARGE.format(steps))
    (root / "caller.py").write_text(CALLER)
    return folder, ask(root, ["top"], folder / "cache")


@pytest.fixture
def package(compiled, tmp_path):
    """A copy of the package, and of its cache."""
    shutil.copytree(compiled[0], tmp_path, dirs_exist_ok=True)
    return tmp_path / "installed" / "avatarsim"


@pytest.fixture
def cache(package, tmp_path):
    """The cache in which `top` has been compiled once."""
    return tmp_path / "cache"


def ask(package, names, cache):
    """Return the report of a process of its own on kernels that it calls."""
    return json.loads(run_in(package, ASK.format(names=", ".join(names)), NUMBA_CACHE_DIR=str(cache))[0])


def plainly(x):
    """The same, without a compiler."""
    y = x
    for k in range(1, 90):
        y = y * (1.0 + 1.0 / k) + x / (y + k)
    return 3 * y + 6.0


def test_a_large_kernel_is_called_by_name_for_any_constant(compiled):
    said = compiled[1]
    assert said["values"][0] == pytest.approx(plainly(0.25), rel=1e-13)
    assert said["specialisations"] == 1
    assert said["by name"][0][0].startswith(linking.PREFIX + "avatarsim.large.large:")


def test_entries_and_called_kernels_live_together_on_disk(package, tmp_path):
    cache = tmp_path / "empty"
    first = ask(package, ["top", "small"], cache)
    for names in (["small", "top"], ["small"], ["top"]):
        again = ask(package, names, cache)
        assert again["values"] == [first["values"][("top", "small").index(name)] for name in names]
        assert again["compiled"] == 0


def test_a_small_kernel_is_kept_as_ir_and_inlined_from_disk(package, cache, compiled):
    first = compiled[1]
    assert first["inlined"] == [True] and ask(package, ["top"], cache)["inlined"] == []
    gone = list(cache.rglob("top-*.kernel"))
    for file in gone:
        file.unlink()
    again = ask(package, ["top"], cache)
    assert gone and again["values"] == first["values"]
    assert again["inlined"] == [True] and again["compiled"] == 1


def test_a_callee_that_is_gone_from_disk_is_compiled_again(package, cache, compiled):
    (gone,) = (folder for folder in (cache / "avatarsim-kernels").iterdir() if folder.name.endswith("large"))
    shutil.rmtree(gone)
    after = ask(package, ["top"], cache)
    assert after["values"] == compiled[1]["values"]
    assert after["compiled"] == 1


def test_a_changed_callee_is_never_called_under_its_old_name(package, cache, compiled):
    text = (package / "large.py").read_text()
    (package / "large.py").write_text(text.replace("return y + n", "return y + n + 1.0"))
    assert ask(package, ["top"], cache)["values"][0] == pytest.approx(compiled[1]["values"][0] + 3.0, rel=1e-13)


def test_processes_that_start_at_once_compile_each_kernel_once(package, tmp_path):
    with ThreadPoolExecutor() as pool:
        said = list(pool.map(ask, [package] * 3, [["top"]] * 3, [tmp_path / "empty"] * 3))
    assert sum(one["compiled"] for one in said) == 2  # `large` and `top`; `small` is not counted
    assert len({tuple(one["values"]) for one in said}) == 1


def test_a_folder_gone_in_mid_run_costs_compiling_only(package, tmp_path):
    cache = tmp_path / "empty"
    gone = f"import shutil; from avatarsim.caller import small, top; small(0.5); shutil.rmtree({str(cache)!r})\n"
    said, _ = run_in(package, gone + "print(top(0.25))", NUMBA_CACHE_DIR=str(cache))
    assert float(said) == pytest.approx(plainly(0.25), rel=1e-13)


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


def answers() -> str:
    """Return the answers of GJK and EPA for drawn pairs, to the last bit."""
    batch, found = draw("shallow", 1, 0), list[object]()
    for k in range(BATCH):
        pair, seed = (batch.vertices, batch.shapes, 2 * k, 2 * k + 1), (0.0, 0.0, 0.0)
        first = gjk(*pair, seed, np.inf, SCRATCH)
        found += first, epa(*pair, seed, first[3], SCRATCH)
    return repr(found)


def test_numba_alone_gives_the_same_bits(tmp_path: Path) -> None:
    program = "from tests.jit.test_linking import answers; print(answers())"
    environment = {**os.environ, STOCK: "1", "NUMBA_CACHE_DIR": str(tmp_path / "kernels")}
    done = subprocess.run([sys.executable, "-c", program], cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == answers()
    # numba's own cache, not the engine's
    assert any((tmp_path / "kernels").rglob("*.nbi")) and not (tmp_path / "kernels" / "avatarsim-kernels").exists()
