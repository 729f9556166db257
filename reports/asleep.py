"""Which engines sleep in the frame that a time is of, from the rows and settings of a run? No factor is made of such a time."""

from collections.abc import Mapping

from reports.load import Results
from scenarios import like_for_like
from scenarios.like_for_like import RESTING, SHARES, asleep

__all__ = ["RESTING", "SHARES", "asleep", "sleepers", "told"]


def told(results: Results) -> frozenset[tuple[str, str]]:
    """(scene, engine and preset) of those that a setting tells to sleep."""
    return frozenset((note.scenario, note.run) for note in results.engines if note.settings.get("sleep", ("", ""))[0] == "true")


def sleepers(results: Results) -> Mapping[str, Mapping[str, float]]:
    """Scene -> engine and preset that sleeps when all rests -> share of resting frames [%], the largest of its seeds."""
    return like_for_like.sleepers(results.rows, told(results))
