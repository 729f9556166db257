"""Both engines repeat themselves bit for bit: again in this process, in another one, and after other scenes."""

import subprocess
import sys
from pathlib import Path

import pytest

from avatarsim.engine import Engine, Settings
from scenarios.engines import opened
from tests.agreement.rivals import ENGINES
from tests.agreement.runs import of_catalog

ROOT = Path(__file__).resolve().parents[3]
SCENE, FRAMES = "driven_10cm_wall", 60
ELSEWHERE = """
from tests.agreement.reached.test_bits import fingerprint
from scenarios.engines import opened
print(fingerprint(opened({name!r}), {preset!r}))
"""


def fingerprint(engine: Engine, preset: str) -> str:
    """What a run ends in, as digits of all its bits."""
    return of_catalog(engine, SCENE, Settings(preset), FRAMES)[1][-1].state_hash()


@ENGINES
@pytest.mark.parametrize("preset", ["default", "tuned"])
def test_three_runs_in_this_process_are_the_same(engine: Engine, preset: str) -> None:
    assert len({fingerprint(opened(engine.name), preset) for _ in range(3)}) == 1


@ENGINES
def test_a_run_in_another_process_is_the_same(engine: Engine) -> None:
    code = ELSEWHERE.format(name=engine.name, preset="tuned")
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.split()[-1] == fingerprint(opened(engine.name), "tuned")
