"""Admission: checks of the Host and Origin headers of requests against DNS rebinding (RFC 6454, RFC 6455 s. 10.2), and of the
rate at which a peer sends (fixed-window counting).

A page of the web can make a browser on this machine connect to a port on loopback. It cannot choose the headers Host and Origin,
so these distinguish such a page from ours: a name that an attacker's own name server resolves to 127.0.0.1 is still that name.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum
from ipaddress import ip_address
from urllib.parse import urlsplit

from avatarsim.errors import InvalidInput
from avatarsim.live.messages import RATES
from avatarsim.live.ports.refusals import Refusal

LOOPBACK = ("127.0.0.1", "localhost", "::1")
"""Hosts that are this machine, whichever name server resolves them."""
SECOND = 1_000_000_000
"""[ns]"""


@dataclass(frozen=True)
class Limits:
    """Limits of peers at the ports.

    per_second   messages of a peer that are read in a second; the fastest loop uses no more. Further ones are counted unread
    flood        messages in a second at which a WebSocket is dropped
    patience     [s] that a peer has to finish its handshake, and to receive a message; then it is dropped
    connections  WebSockets open at once; more are refused
    waiting      connections without a handshake at once; beyond that the oldest is dropped
    sources      UDP sources whose messages are counted separately; beyond that the one silent longest is forgotten
    """

    per_second: int = int(RATES[1])
    flood: int = 5 * int(RATES[1])
    patience: float = 5.0
    connections: int = 16
    waiting: int = 16
    sources: int = 64

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not value > 0:
                raise InvalidInput(f"{name} of the limits of the ports", value, "a number above 0")


class Pace(Enum):
    """Treatment of a message by the pace of its peer."""

    READ = "read"
    TOO_FAST = "too fast"
    FLOOD = "flood"


class Window:
    """Counter of a peer's messages in the current second."""

    def __init__(self, limits: Limits) -> None:
        self._limits, self._second, self._count = limits, -1, 0

    def admit(self, now: int) -> Pace:
        """Count a message that arrived at `now` [ns] and return its treatment."""
        second = now // SECOND
        if second != self._second:
            self._second, self._count = second, 0
        self._count += 1
        if self._count > self._limits.flood:
            return Pace.FLOOD
        return Pace.READ if self._count <= self._limits.per_second else Pace.TOO_FAST


def as_address(words: str) -> str:
    """Return the address that `--listen` names, as numbers. Raises InvalidInput for names, which could lead anywhere."""
    try:
        return str(ip_address("127.0.0.1" if words == "localhost" else words))
    except ValueError as error:
        raise InvalidInput("address to listen at", words, "an IP address of this machine, such as 127.0.0.1") from error


def host_of(header: str) -> str:
    """Return the host of a Host header in lower case, without port and brackets; empty for an invalid header."""
    try:
        parts = urlsplit(f"//{header}")
        # reading the port raises ValueError if it is no number
        is_plain = parts.port is None or parts.port >= 0
    except ValueError:
        return ""
    whole = parts.netloc == header and not parts.username and "@" not in header and not any(c.isspace() for c in header)
    return parts.hostname or "" if is_plain and whole else ""


def judged(hosts: Iterable[str], origins: Iterable[str], local: str, allowed: Iterable[str] = ()) -> Refusal | None:
    """Return why a request with these Host and Origin headers is refused; None if it is admitted.

    `local` is the address of this machine at which the request arrived: a numeric host is no name that a name server could
    redirect. `allowed` are further hosts. An origin must be one of those hosts; a program sends none."""
    known = {*LOOPBACK, *(name.lower() for name in allowed)}
    given = list(hosts)
    host = host_of(given[0]) if len(given) == 1 else ""
    if not host or host not in known | {local}:
        return Refusal.FOREIGN_HOST
    came_from = list(origins)
    if not came_from:
        return None
    scheme, _, rest = came_from[0].partition("://")
    if len(came_from) > 1 or scheme not in ("http", "https") or host_of(rest) not in known | {host}:
        return Refusal.FOREIGN_ORIGIN
    return None
