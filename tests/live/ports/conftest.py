"""Ports that are closed at the end of a test."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from typing import Any

import pytest

from avatarsim.live.ports.admission import Limits
from tests.live.ports.opened import Opened


@pytest.fixture
def opened() -> Iterator[Callable[..., Opened]]:
    """Yield a function that opens ports, which are closed at the test's end."""
    with ExitStack() as stack:

        def make(**options: Any) -> Opened:
            one = Opened(**options)
            stack.callback(one.ports.close)
            one.ports.start()
            return one

        yield make


@pytest.fixture
def live(opened: Callable[..., Opened]) -> Opened:
    """Return ports with default limits."""
    return opened()


@pytest.fixture
def strict(opened: Callable[..., Opened]) -> Opened:
    """Return ports with the shortest patience and few connections."""
    return opened(limits=Limits(per_second=5, flood=50, patience=2.0, connections=3, waiting=4, sources=2))
