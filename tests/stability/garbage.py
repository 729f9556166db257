"""Garbage for the ports of a live session: damaged messages at a fixed rate, floods, half-open sockets, foreign origins.

    python -m tests.stability.garbage --udp PORT --ws PORT --page PORT --seconds 60

A process of its own, beside what it is sent to. It prints how many messages it sent, and how often it was cut or refused.
"""

import argparse
import random
import socket
import sys
import time
from collections import Counter
from collections.abc import Callable
from contextlib import suppress

from websockets.exceptions import WebSocketException
from websockets.sync.client import connect

from tests.live.ports.test_server import GARBAGE, GOOD

HOST = "127.0.0.1"
A_SECOND = 10_000
"""Datagrams."""
BATCH = 50
"""Datagrams sent at once, between two looks at the clock."""
HALF_OPEN = 100
"""TCP connections that say nothing, or half of a request."""
NUMBERS = 100_000_000
"""Zeros of one message: more than any reader may keep."""


def main() -> int:
    """Send until the time is over."""
    top = argparse.ArgumentParser(description="Garbage for the ports of a live session.")
    for name in ("--udp", "--ws", "--page"):
        top.add_argument(name, type=int, required=True, metavar="PORT")
    top.add_argument("--seconds", type=float, default=60.0)
    top.add_argument("--seed", type=int, default=1)
    asked = top.parse_args()
    chance, done, end = random.Random(asked.seed), Counter[str](), time.monotonic() + asked.seconds
    others = (
        lambda: flood(asked.ws, chance), lambda: foreign(asked.ws, "/tracker"), lambda: foreign(asked.page, "/"),
        lambda: half_open(asked.ws, chance), lambda: endless(asked.ws),
    )
    messages = [*GARBAGE.values(), GOOD.encode()]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as datagrams:
        next_other, due = time.monotonic(), time.monotonic()
        while (now := time.monotonic()) < end:
            for _ in range(BATCH):
                datagrams.sendto(damaged(chance.choice(messages), chance), (HOST, asked.udp))
            done["datagrams"] += BATCH
            if now >= next_other:
                next_other = now + 0.5
                attempt(chance.choice(others), done)
            due = max(due + BATCH / A_SECOND, now - 1.0)
            time.sleep(max(0.0, due - time.monotonic()))
    print(dict(done))
    return 0


def damaged(message: bytes, chance: random.Random) -> bytes:
    """The message, cut, longer, or with bytes of chance."""
    kind = chance.randrange(4)
    if kind == 0:
        return message[: chance.randrange(len(message) + 1)]
    if kind == 1:
        return message + chance.randbytes(chance.randrange(2000))
    if kind == 2 and message:
        at = chance.randrange(len(message))
        return message[:at] + chance.randbytes(1) + message[at + 1:]
    return message


def attempt(other: Callable[[], str], done: Counter[str]) -> None:
    """Do another thing, and count how it ended."""
    try:
        done[other()] += 1
    except (OSError, WebSocketException) as error:
        done[type(error).__name__] += 1


def flood(port: int, chance: random.Random) -> str:
    """Messages as fast as they go, until the socket is cut."""
    messages = list(GARBAGE.values())
    with connect(f"ws://{HOST}:{port}/tracker", compression=None) as one:
        for _ in range(5000):
            one.send(damaged(chance.choice(messages), chance))
    return "floods that were taken"


def foreign(port: int, path: str) -> str:
    """A handshake of another page."""
    with connect(f"ws://{HOST}:{port}{path}", origin="http://example.com", compression=None) as one:  # type: ignore[arg-type]
        one.recv(5.0)
    return "foreign origins that were served"


def half_open(port: int, chance: random.Random) -> str:
    """Connections that do not go on."""
    kept = list[socket.socket]()
    try:
        for _ in range(HALF_OPEN):
            kept.append(socket.create_connection((HOST, port), 1.0))
            kept[-1].sendall(b"GET /tracker HTTP/1.1\r\nHo"[: chance.randrange(25)])
    finally:
        for one in kept:
            with suppress(OSError):
                one.close()
    return "half-open sockets"


def endless(port: int) -> str:
    """One message of very many numbers."""
    with connect(f"ws://{HOST}:{port}/tracker", compression=None) as one:
        one.send(b"[" + b"0," * NUMBERS + b"0]")
        one.recv(5.0)
    return "endless messages that were taken"


if __name__ == "__main__":
    sys.exit(main())
