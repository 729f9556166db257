"""Typed refusals and their tally: external input that was rejected, by reason (input validation; Saltzer 1975)."""

import threading
from collections import Counter
from collections.abc import Mapping
from enum import Enum

from avatarsim.errors import InvalidSample


class Refusal(Enum):
    """Reason why a message, a request or a peer was refused; the value is the text on a page."""

    TOO_LONG = "longer than a message may be"
    NOT_TEXT = "not UTF-8"
    NOT_JSON = "not JSON"
    TOO_DEEP = "nested too deep"
    WRONG_TYPE = "a value of the wrong type"
    DUPLICATE = "a key or a link twice"
    UNKNOWN_KEY = "a key that no message has"
    MISSING_KEY = "a key is missing"
    UNKNOWN_LINK = "a link that the scene has not"
    WRONG_LENGTH = "the wrong number of rows, numbers or bytes"
    NOT_FINITE = "nan or infinity"
    TOO_LARGE = "a number beyond its cap"
    NOT_A_ROTATION = "a quaternion whose length is not 1"
    WRONG_MAGIC = "neither JSON nor packed numbers"
    WRONG_VERSION = "packed numbers of an unknown version or width"
    NOT_ACCEPTED = "refused by what is driven"
    UNEXPECTED = "a message where none is read"
    TOO_FAST = "more messages in a second than are read"
    FLOOD = "a peer dropped for flooding"
    FOREIGN_HOST = "a Host header that is none of ours"
    FOREIGN_ORIGIN = "an Origin header that is none of ours"
    NO_SUCH_PAGE = "a path that is not there"
    NOT_HTTP = "no request that can be read"
    NO_HANDSHAKE = "connected, and nothing asked in time"
    TOO_MANY = "more connections than are kept"
    STOPPED_READING = "a client dropped for not reading"
    BROKEN_FRAMES = "frames that break the WebSocket protocol"


class Peer(Enum):
    """Kind of connection of a peer."""

    UDP = "UDP"
    WEBSOCKET = "WebSocket"
    PAGE = "page"


class Refused(InvalidSample):
    """A refused message; `reason` classifies it, and the text gives the thing, its value and the valid range."""

    def __init__(self, reason: Refusal, thing: str, value: object, valid: str) -> None:
        self.reason = reason
        super().__init__(thing, value, valid)


class Refusals:
    """Counts of refusals by reason and kind of peer, and of accepted messages. Written by one thread, read by any."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._counts: Counter[tuple[Refusal, Peer]] = Counter()
        self._accepted: Counter[Peer] = Counter()

    def count(self, reason: Refusal, peer: Peer) -> None:
        """Count one more refusal."""
        with self._lock:
            self._counts[reason, peer] += 1

    def count_accepted(self, peer: Peer) -> None:
        """Count one more message that was valid and passed on."""
        with self._lock:
            self._accepted[peer] += 1

    @property
    def counts(self) -> Mapping[tuple[Refusal, Peer], int]:
        """Number of refusals by reason and kind of peer; without zeros."""
        with self._lock:
            return dict(self._counts)

    @property
    def accepted(self) -> Mapping[Peer, int]:
        """Number of valid messages by kind of peer."""
        with self._lock:
            return dict(self._accepted)
