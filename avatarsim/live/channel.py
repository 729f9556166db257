"""Latest-value channel between two processes: connected, non-blocking datagram sockets (Stevens 1998, ch. 15).

A datagram arrives whole or not at all and its sender never waits: what does not fit is dropped, so that neither side can make the
other late, and no queue grows. What must arrive goes by a pipe instead.
"""

import pickle
import socket
from collections.abc import Iterator
from typing import Any

LONGEST = 1 << 18
"""Bytes of a message at most, and of the room that is asked of the system for those under way: some 3,000 bodies."""


class Channel:
    """One end of a channel; both ends send and receive. It can be handed to a process that is being started."""

    def __init__(self, end: socket.socket) -> None:
        end.setblocking(False)
        for option in (socket.SO_SNDBUF, socket.SO_RCVBUF):
            end.setsockopt(socket.SOL_SOCKET, option, LONGEST)
        self._end, self.dropped = end, 0

    def send(self, message: object) -> bool:
        """Hand a message on; False, and counted in `dropped`, where the other end has not taken the last ones or is gone."""
        try:
            self._end.send(pickle.dumps(message, protocol=pickle.HIGHEST_PROTOCOL))
        except OSError:
            self.dropped += 1
            return False
        return True

    def drain(self) -> Iterator[Any]:
        """All messages that have come, oldest first."""
        while True:
            try:
                data = self._end.recv(LONGEST)
            except OSError:
                return
            if not data:
                return
            yield pickle.loads(data)

    def newest(self) -> Any | None:
        """The message that came last, all before it are dropped; None where none has come."""
        messages = list(self.drain())
        return messages[-1] if messages else None

    def close(self) -> None:
        """The end of this end."""
        self._end.close()


def pair() -> tuple[Channel, Channel]:
    """Two ends of a new channel."""
    if hasattr(socket, "AF_UNIX"):
        one, other = socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)
        return Channel(one), Channel(other)
    ends = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(2)]
    for end in ends:
        end.bind(("127.0.0.1", 0))
    # connected: the system drops what comes from anywhere else
    ends[0].connect(ends[1].getsockname())
    ends[1].connect(ends[0].getsockname())
    return Channel(ends[0]), Channel(ends[1])
