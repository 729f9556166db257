"""Random impacts; `make fuzz` asks a million of them."""

import numpy as np

from tests.rigid.random_impacts import ROUNDING, main, run


def test_no_impact_adds_energy_or_loses_momentum() -> None:
    (impacts, guarded, rough), worst = run(50_000, seed=5)
    # Newton's law with friction would have added energy in some, and is shortened there
    assert impacts >= 50_000 and guarded > 0.001 * impacts and rough > 0.5 * impacts
    assert np.isfinite(worst).all() and (worst <= ROUNDING).all() and worst.min() > 0.0


def test_the_command_says_what_it_asked(capsys) -> None:
    assert main(["--impacts", "1000", "--seed", "3"]) == 0
    assert "impacts" in capsys.readouterr().out
