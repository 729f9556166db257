"""Fixed bodies never give way, driven ones first, simulated ones if it must be."""

import pytest

from avatarsim.model.dynamics import DRIVEN, FIXED, SIMULATED
from avatarsim.paper.push_apart import shares

ROLES = (FIXED, SIMULATED, DRIVEN)


@pytest.mark.parametrize(
    ("a", "b", "must", "expected"),
    [
        (FIXED, DRIVEN, False, (0.0, 1.0)),
        (SIMULATED, FIXED, False, (1.0, 0.0)),
        (DRIVEN, DRIVEN, False, (0.5, 0.5)),
        (SIMULATED, SIMULATED, False, (0.5, 0.5)),
        (SIMULATED, DRIVEN, False, (0.0, 1.0)),
        (SIMULATED, DRIVEN, True, (1.0, 0.0)),
        (FIXED, FIXED, True, (0.0, 0.0)),
    ],
)
def test_the_rule(a, b, must, expected):
    assert shares(a, b, must) == expected


@pytest.mark.parametrize("must", [False, True])
def test_it_does_not_matter_which_of_the_two_is_a(must):
    for a in ROLES:
        for b in ROLES:
            assert shares(a, b, must) == shares(b, a, must)[::-1]
            assert sum(shares(a, b, must)) == (0.0 if a == b == FIXED else 1.0)
