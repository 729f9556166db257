"""UDP in: one datagram is one message (RFC 768). A non-blocking socket that an event loop reads in small batches.

Nothing is ever sent back, so that a forged source address makes no echo.
"""

import socket
from collections import OrderedDict

from avatarsim.live.ports.admission import Limits, Window
from avatarsim.live.ports.refusals import Peer
from avatarsim.live.ports.taking import Gate

LONGEST_DATAGRAM = 1 << 16
"""[bytes] more than a datagram can hold."""
BATCH = 64
"""Datagrams read before others have their turn: a millisecond or two of a flood."""


class Datagrams:
    """The socket's reader."""

    def __init__(self, end: socket.socket, gate: Gate, limits: Limits) -> None:
        self._end, self._gate, self._limits = end, gate, limits
        self._windows: OrderedDict[object, Window] = OrderedDict()

    def read(self) -> None:
        """Take what has come, up to a batch; the event loop calls again where more is there."""
        for _ in range(BATCH):
            try:
                data, source = self._end.recvfrom(LONGEST_DATAGRAM)
            except BlockingIOError:
                return
            except OSError:
                # a system that reports here what became of something sent earlier; the next call reads on
                return
            self._gate.take(data, self._window(source), Peer.UDP, f"udp {source[0]}:{source[1]}")

    def _window(self, source: object) -> Window:
        """The window of a source; that of the source that was silent longest makes room."""
        window = self._windows.pop(source, None) or Window(self._limits)
        self._windows[source] = window
        if len(self._windows) > self._limits.sources:
            self._windows.popitem(last=False)
        return window
