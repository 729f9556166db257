"""From a message to a target: stamp, pace, parse, hand on or count (a guarded gate; one for all ways in)."""

import time
from collections.abc import Callable

from avatarsim.errors import AvatarsimError
from avatarsim.live.ports.admission import Pace, Window
from avatarsim.live.ports.protocol import Goals, Shape, parse
from avatarsim.live.ports.refusals import Peer, Refusal, Refusals, Refused
from avatarsim.scene.tracker import TrackerSample

OnTarget = Callable[[TrackerSample | Goals, int, str], None]
"""Called with what a tracker wants, when its bytes arrived [ns of the monotonic clock], and where it came from."""


class Gate:
    """Where messages of trackers go through, whichever way they came."""

    def __init__(self, shape: Shape, on_target: OnTarget, refusals: Refusals) -> None:
        self.shape, self.refusals = shape, refusals
        self._on_target = on_target

    def take(self, data: bytes, window: Window, peer: Peer, source: str) -> tuple[Pace, str]:
        """Hand on what `data` says, or count why not: the pace of its peer, and what was wrong, empty where nothing was."""
        stamp = time.monotonic_ns()
        pace = window.admit(stamp)
        if pace is not Pace.READ:
            self.refusals.count(Refusal.TOO_FAST, peer)
            return pace, Refusal.TOO_FAST.value
        try:
            found = parse(data, self.shape)
        except Refused as error:
            return pace, self._refused(error.reason, peer, str(error))
        try:
            self._on_target(found, stamp, source)
        except AvatarsimError as error:
            return pace, self._refused(Refusal.NOT_TAKEN, peer, str(error))
        self.refusals.took(peer)
        return pace, ""

    def _refused(self, reason: Refusal, peer: Peer, sentence: str) -> str:
        self.refusals.count(reason, peer, sentence)
        return sentence
