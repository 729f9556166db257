"""A large kernel is compiled once, called by name from everywhere, and never missing when its caller comes from disk."""

import json
import pickle
import shutil
import subprocess
import sys

import pytest

from avatarsim.collision.support import support
from avatarsim.jit import linking
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
    """What a process of its own says about kernels that it calls."""
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


def test_a_large_kernel_is_called_by_name_and_compiled_for_no_constant_in_particular(package, tmp_path):
    said = ask(package, ["top"], tmp_path / "cache")
    assert said["values"][0] == pytest.approx(plainly(0.25), rel=1e-13)
    assert said["specialisations"] == 1
    assert said["by name"][0][0].startswith(linking.PREFIX + "avatarsim.large.large:")


def test_what_python_calls_and_what_kernels_call_live_together_on_disk(package, tmp_path):
    cache = tmp_path / "cache"
    first = ask(package, ["top", "small"], cache)
    for names in (["small", "top"], ["top", "small"], ["small"], ["top"]):
        again = ask(package, names, cache)
        assert again["values"] == [first["values"][("top", "small").index(name)] for name in names]
        assert again["compiled"] == 0


def test_a_small_kernel_is_kept_without_machine_code_and_inlined_from_disk(package, tmp_path):
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


def test_a_folder_that_is_gone_while_a_process_runs_costs_no_more_than_compiling(package, tmp_path):
    cache = tmp_path / "cache"
    gone = f"import shutil; from avatarsim.caller import small, top; small(0.5); shutil.rmtree({str(cache)!r})\n"
    kept = plain_environment(package, NUMBA_CACHE_DIR=str(cache))
    command = [sys.executable, "-c", gone + "print(top(0.25))"]
    done = subprocess.run(command, env=kept, cwd=package.parent, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert float(done.stdout) == pytest.approx(plainly(0.25), rel=1e-13)


def test_a_kernel_is_pickled_by_name():
    assert pickle.loads(pickle.dumps(support)) is support
