"""Contact law: restitution and friction that bodies show where a scene states them, by engine, step and shape."""

from scenarios.studies.contact_law.ask import STUDY as STUDY
