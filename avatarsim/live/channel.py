"""Latest-value channel between two processes: connected, non-blocking datagram sockets (Stevens 1998, ch. 15).

A datagram arrives whole or not at all and its sender never waits. A datagram that does not fit is dropped: neither side can delay
the other, and no queue grows. Messages that must arrive go through a pipe instead.
"""

import pickle
import socket
from collections.abc import Iterator
from typing import Any

LONGEST = 1 << 18
"""Largest message [bytes], also the size of both socket buffers that is requested from the system: some 3,000 bodies."""


class Channel:
    """One end of a channel; both ends send and receive. It can be passed to a process that is being started."""

    def __init__(self, end: socket.socket) -> None:
        end.setblocking(False)
        for option in (socket.SO_SNDBUF, socket.SO_RCVBUF):
            end.setsockopt(socket.SOL_SOCKET, option, LONGEST)
        self._end, self.dropped = end, 0

    def send(self, message: object) -> bool:
        """Send a message. Return False, and increment `dropped`, if the buffer of the other end is full or closed."""
        try:
            self._end.send(pickle.dumps(message, protocol=pickle.HIGHEST_PROTOCOL))
        except OSError:
            self.dropped += 1
            return False
        return True

    def drain(self) -> Iterator[Any]:
        """Yield all messages that have arrived, oldest first."""
        while True:
            try:
                data = self._end.recv(LONGEST)
            except OSError:
                return
            if not data:
                return
            yield pickle.loads(data)

    def newest(self) -> Any | None:
        """Return the newest message and drop the older ones; None if none has arrived."""
        messages = list(self.drain())
        return messages[-1] if messages else None

    def close(self) -> None:
        """Close this end."""
        self._end.close()


def pair() -> tuple[Channel, Channel]:
    """Return the two ends of a new channel."""
    if hasattr(socket, "AF_UNIX"):
        one, other = socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)
        return Channel(one), Channel(other)
    ends = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(2)]
    for end in ends:
        end.bind(("127.0.0.1", 0))
    # connected: the system drops datagrams from any other sender
    ends[0].connect(ends[1].getsockname())
    ends[1].connect(ends[0].getsockname())
    return Channel(ends[0]), Channel(ends[1])
