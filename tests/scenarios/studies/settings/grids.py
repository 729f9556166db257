"""Grids of the engines that have one."""

from runfiles.engines import engines
from scenarios.studies.settings.grid import settings_of

GRIDS = {name: settings_of(name, ()) for name in engines() if settings_of(name, ())}
