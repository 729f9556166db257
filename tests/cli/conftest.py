"""Models are compiled in the process of the tests."""

from tests.assets.models.in_process import models_compiled_here  # noqa: F401
