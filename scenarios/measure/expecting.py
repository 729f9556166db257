"""Reads what a scenario expects: the entries of one kind under one key."""

from typing import TypeVar

from scenarios.scenario import Scenario

Kind = TypeVar("Kind")


def expected(scenario: Scenario, key: str, kind: type[Kind]) -> tuple[Kind, ...]:
    """All entries of `kind` under `expects[key]`; empty when there are none."""
    listed = scenario.expects.get(key, ())
    return tuple(entry for entry in listed if isinstance(entry, kind)) if isinstance(listed, tuple | list) else ()
