"""What is not asked again about types would have been answered the same."""

import math

import numpy as np
import pytest
from numba import njit
from numba.core import itanium_mangler, typeinfer, types
from numba.core.errors import TypingError

from avatarsim.quick_typing import asked_once, propagate, spelled_once


def wandering(rows, n):
    """A variable that turns from a whole number into a real one within a loop, and others that follow it."""
    total, last, pair = 0, 0, (0.0, 0)
    for i in range(n):
        last = total
        if rows[i, 0] > last:
            total = total + rows[i, 0] * math.sqrt(2.0)
        pair = (last, i)
        rows[i, 1] = pair[0]
    first, _ = pair
    return total + first + rows.shape[0]


def nowhere(rows):
    """Asks for what no array has."""
    return rows.nothing


ARGUMENTS = (types.float64[:, ::1], types.int64)


def inferred():
    """numba's types of all variables, and how often calls were resolved."""
    made = njit(wandering)
    made.compile(ARGUMENTS)
    return {name: str(kind) for name, kind in made.overloads[ARGUMENTS].type_annotation.typemap.items()}


def test_rounds_find_numbas_types_and_ask_less(monkeypatch):
    resolved = []
    resolve = typeinfer.CallConstraint.resolve
    monkeypatch.setattr(typeinfer.CallConstraint, "resolve", lambda *args, **kws: resolved.append(0) or resolve(*args, **kws))
    numbas, asked = inferred(), len(resolved)
    monkeypatch.setattr(typeinfer.ConstraintNetwork, "propagate", propagate)
    assert inferred() == numbas and {"int64", "float64"} < set(numbas.values())
    assert len(resolved) - asked < asked


def test_what_cannot_be_typed_is_told_as_numba_does(monkeypatch):
    told = []
    for _ in range(2):
        with pytest.raises(TypingError, match="Unknown attribute 'nothing'") as raised:
            njit(nowhere).compile(ARGUMENTS[:1])
        told.append(str(raised.value))
        monkeypatch.setattr(typeinfer.ConstraintNetwork, "propagate", propagate)
    assert told[0] == told[1]


def test_functions_are_asked_for_once_and_numbers_each_time():
    values = []
    asked = asked_once(lambda context, value: values.append(value) or (context, value))
    for value in (math.sqrt, np.sin, 1.0, math.sqrt, 1.0):
        assert asked("here", value) == ("here", value)
    assert asked("there", math.sqrt) == ("there", math.sqrt)
    assert values == [math.sqrt, np.sin, 1.0, 1.0, math.sqrt]


def test_types_are_spelled_as_numba_spells_them():
    spelled = spelled_once(itanium_mangler.mangle_type_or_value)
    pair = types.Tuple((types.float64, types.Array(types.int64, 2, "C")))
    for kind in (types.int64, pair, pair, 1, True, "name", types.int64):
        assert spelled(kind) == itanium_mangler.mangle_type_or_value(kind)
