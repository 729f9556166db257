"""Settings of engines: error against frame time of every engine over its own settings."""

from scenarios.studies.settings.ask import STUDY as STUDY
