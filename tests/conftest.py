"""One hypothesis profile for all tests: no deadlines (the first call compiles), and the same examples in every run."""

from hypothesis import HealthCheck, settings

from avatarsim.kernel import config
from tests.by_reference import refer_in_tests

settings.register_profile(
    "avatarsim", deadline=None, derandomize=True, max_examples=60, database=None, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("avatarsim")

if not config.DISABLE_JIT:
    refer_in_tests()
