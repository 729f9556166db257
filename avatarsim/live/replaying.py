"""Replay of a recording: the same calls in the same order, and the hash of each state against the recorded one.

Deterministic replay (LeBlanc and Mellor-Crummey 1987): an engine is a function of its calls, so that a file must hold no more.
"""

from collections.abc import Callable
from dataclasses import dataclass

from avatarsim.engine import FrameRecord
from avatarsim.errors import InvalidFile
from avatarsim.live.orders import World
from avatarsim.live.recording import VALID, Frame, Recorded


@dataclass(frozen=True)
class Difference:
    """A frame of the replay, 0 for the state that it began with, that shows another state than was recorded."""

    frame: int
    recorded: str
    replayed: str


@dataclass(frozen=True)
class Replayed:
    """How many frames ran, and the first that differs; None where all are the same to the bit."""

    frames: int
    difference: Difference | None


def replay(recorded: Recorded, on_frame: Callable[[int, FrameRecord], None] = lambda frame, record: None) -> Replayed:
    """Run a recording again; `on_frame` is called with each frame's number, from 1, and its record.

    Goes on behind a difference, so that all frames are shown. Raises InvalidFile for a command that the engine refuses now, and
    for a sample that it does not take: such ones are not recorded; and what `load` raises."""
    world = World(recorded.plan)
    difference, frames = None, 0
    if world.shown.state_hash() != recorded.first_hash:
        difference = Difference(0, recorded.first_hash, world.shown.state_hash())
    for number, row in enumerate(recorded.rows):
        if isinstance(row, Frame):
            frames += 1
            found = world.advance(row.sample)
            replayed = found.state_hash()
            if difference is None and replayed != row.state_hash:
                difference = Difference(frames, row.state_hash, replayed)
            on_frame(frames, found)
        elif refused := world.apply(row):
            raise InvalidFile(f"row {number} of the recording", refused, VALID)
    return Replayed(frames, difference)
