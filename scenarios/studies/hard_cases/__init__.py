"""Stability of hard cases under changes that should not matter: start, seed, frame time, solver step, size and place."""

from scenarios.studies.hard_cases.ask import STUDY as STUDY
