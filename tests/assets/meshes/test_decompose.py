"""CoACD in its own process: the same bits again, no output, and errors that state the cause. (A small L: a second each.)"""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from avatarsim.assets.meshes import decompose
from avatarsim.assets.meshes.decompose import PieceOptions, decomposed
from avatarsim.console import Progress
from avatarsim.errors import InvalidShape, MissingPackage
from tests.assets.meshes.solids import ell, mesh

ELL = mesh(ell(), "ell.obj")


def test_the_same_seed_gives_the_same_bits_without_output(capfd: pytest.CaptureFixture[str]) -> None:
    once, again = (decomposed([ELL], PieceOptions(seed=3), False, sys.stderr) for _ in range(2))
    assert len(once) == 2
    for one, other in zip(once, again, strict=True):
        np.testing.assert_array_equal(one, other)
    out, err = capfd.readouterr()
    assert out == "" and all(line.startswith("decomposing ell.obj") for line in err.splitlines())


def test_neither_size_nor_place_changes_the_pieces() -> None:
    far = replace(ELL, vertices=1024.0 * ELL.vertices + [65536.0, 0.0, -4096.0])
    for here, there in zip(*(decomposed([one], PieceOptions(), False, None) for one in (ELL, far)), strict=True):
        np.testing.assert_allclose((there - [65536.0, 0.0, -4096.0]) / 1024.0, here, atol=1e-6)


def test_without_coacd_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(decompose, "find_spec", lambda name: None)
    with pytest.raises(MissingPackage, match=r"decomposing ell\.obj .*coacd.*pip install .*\[assets\]"):
        decomposed([ELL], PieceOptions(), False, None)


def test_a_process_that_dies_is_an_error_with_its_last_words(monkeypatch: pytest.MonkeyPatch) -> None:
    real = decompose._run
    script = "import os\nprint('no such luck', flush=True)\nos.abort()"
    monkeypatch.setattr(decompose, "_run", lambda command, n, progress: real([sys.executable, "-c", script], n, progress))
    with pytest.raises(InvalidShape, match=r"decomposition of ell\.obj is 'no such luck'"):
        decomposed([ELL], PieceOptions(), False, None)


def test_a_stop_by_the_user_ends_the_process(monkeypatch: pytest.MonkeyPatch) -> None:
    started = []
    real = subprocess.Popen

    def remembered(*words, **options):
        started.append(real(*words, **options))
        return started[-1]

    def stopped(self: Progress, share: float, what: str) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(subprocess, "Popen", remembered)
    monkeypatch.setattr(Progress, "step", stopped)
    script = "import time\nprint('mesh 0', flush=True)\ntime.sleep(600)"
    with pytest.raises(KeyboardInterrupt):
        decompose._run([sys.executable, "-c", script], 1, Progress("x", None))
    assert started[0].returncode is not None
