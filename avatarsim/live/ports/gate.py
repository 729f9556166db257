"""From a message to a target: stamp, pace, parse, pass on or count (a guarded gate; one for all ports)."""

import time
from collections.abc import Callable

from avatarsim.errors import AvatarsimError
from avatarsim.live.ports.admission import Pace, Window
from avatarsim.live.ports.protocol import Goals, Shape, parse
from avatarsim.live.ports.refusals import Peer, Refusal, Refusals, Refused
from avatarsim.scene.tracker import TrackerSample

OnTarget = Callable[[TrackerSample | Goals, int, str], None]
"""Called with a tracker's sample or goals, the arrival time of its bytes [ns of the monotonic clock], and its source."""


OnRefusal = Callable[[str, str], None]
"""Called with the source of a peer and the reason of its first refusal, in printable characters only."""

REPORTED = 64
"""Peers whose first refusal is reported; refusals of further peers are only counted, so that no flood fills a terminal."""


class Gate:
    """Gate for messages of trackers from all ports."""

    def __init__(self, shape: Shape, on_target: OnTarget, refusals: Refusals, on_refusal: OnRefusal | None = None) -> None:
        self.shape, self.refusals = shape, refusals
        self._on_target, self._on_refusal = on_target, on_refusal
        self._reported: set[str] = set()

    def handle(self, data: bytes, window: Window, peer: Peer, source: str) -> tuple[Pace, str]:
        """Pass on the content of `data`, or count a refusal. Return the pace of its peer, and the error, or ""."""
        stamp = time.monotonic_ns()
        pace = window.admit(stamp)
        if pace is not Pace.READ:
            return pace, self.refuse(Refusal.TOO_FAST, peer, source)
        try:
            found = parse(data, self.shape)
        except Refused as error:
            return pace, self.refuse(error.reason, peer, source, str(error))
        try:
            self._on_target(found, stamp, source)
        except AvatarsimError as error:
            return pace, self.refuse(Refusal.NOT_ACCEPTED, peer, source, str(error))
        self.refusals.count_accepted(peer)
        return pace, ""

    def refuse(self, reason: Refusal, peer: Peer, source: str, sentence: str = "") -> str:
        """Count a refusal, and report it if it is the first of its source. Return the sentence, or the reason without one."""
        sentence = sentence or reason.value
        self.refusals.count(reason, peer)
        if self._on_refusal is not None and source not in self._reported and len(self._reported) < REPORTED:
            self._reported.add(source)
            self._on_refusal(source, "".join(c if c.isprintable() else "?" for c in sentence))
        return sentence
