"""What is left out of calls and loops changes neither answers nor who raises."""

import json
import os
import subprocess
import sys

KERNELS = """from avatarsim.kernel import kernel


@kernel
def picked(values: tuple[float, float, float], k: int) -> float:
    return values[k]


@kernel
def doubled(x: float) -> float:
    return 2.0 * x


@kernel
def pair(x: float, sure: bool) -> tuple[float, bool]:
    return doubled(x), sure


@kernel
def total(values: tuple[float, float, float], n: int) -> float:
    found = 0.0
    for k in range(n):
        twice, sure = pair(picked(values, k), k >= 0)
        if sure:
            found += twice
    return found


@kernel
def counted(start: int, end: int, step: int) -> tuple[int, int, int]:
    many = places = last = 0
    for i in range(start, end):
        many += 1
        places = 10 * places + i
    for i in range(start, end, step):
        last = i
    for _ in range(end):
        many += 100
    return many, places, last
"""
ASK = """
import json
from avatarsim.kernel_library import NEVER_RAISE
from avatarsim.quick_compiler import quicken
quicken()
from calling import counted, total

try:
    total((1.0, 2.0, 3.0), 4)
    raised = "nothing"
except IndexError as error:
    raised = str(error)
asked = [(a, b, c) for a in (-2, 0, 3) for b in (-3, 0, 5) for c in (-2, 1, 2)]
print(json.dumps({
    "raised": raised,
    "total": total((1.0, 2.0, 3.0), 3),
    "as python": [counted(*one) == counted.py_func(*one) for one in asked],
    "safe": sorted({name for name in ("picked", "doubled", "pair", "total") for one in NEVER_RAISE if name in one}),
    "compiled": sum(sum(k.stats.cache_misses.values()) for f in (total, counted) for k in (f, f.called)),
}))
"""


def test_lean_calls_and_loops_answer_and_raise_as_python_does_fresh_and_from_disk(tmp_path):
    (tmp_path / "calling.py").write_text(KERNELS)
    path = os.pathsep.join((str(tmp_path), os.getcwd()))
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path / "cache"), "PYTHONPATH": path}
    for compiled in (2, 0):
        done = subprocess.run([sys.executable, "-c", ASK], env=environment, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        answer = json.loads(done.stdout)
        assert answer["raised"] == "tuple index out of range" and answer["total"] == 12.0
        assert all(answer["as python"]) and len(answer["as python"]) == 27
        assert answer["compiled"] == compiled
        assert answer["safe"] == (["doubled", "pair"] if compiled else [])
