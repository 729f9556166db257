"""Setup of all tests: one hypothesis profile without deadlines (the first call compiles) and with the same examples in every
run, kernels called by reference, and the longest files first."""

import pytest
from hypothesis import HealthCheck, settings

from avatarsim.jit.kernel import config
from tests.by_reference import refer_in_tests
from tests.longest_first import LONGEST

settings.register_profile(
    "avatarsim", deadline=None, derandomize=True, max_examples=60, database=None, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("avatarsim")

if not config.DISABLE_JIT:
    refer_in_tests()


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Let workers begin with the longest files."""
    if hasattr(config, "workerinput"):
        items.sort(key=lambda item: LONGEST.index(item.path.stem) if item.path.stem in LONGEST else len(LONGEST))
