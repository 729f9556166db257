"""Fixtures of the tests of studies."""

from tests.scenarios.studies.settings.fakes import fakes

__all__ = ["fakes"]
