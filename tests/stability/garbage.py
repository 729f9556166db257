"""Garbage for the ports of a live session: damaged messages at a fixed rate, floods, half-open sockets, foreign origins.

    python -m tests.stability.garbage --udp PORT --ws PORT --page PORT --seconds 60

A process of its own, apart from its target. It prints how many messages it sent, and how often it was cut or refused.
"""

import argparse
import logging
import random
import socket
import sys
import threading
import time
from collections import Counter
from contextlib import suppress

import viser
from websockets.exceptions import WebSocketException
from websockets.sync.client import connect

from tests.live.ports.test_server import GARBAGE, GOOD

HOST = "127.0.0.1"
A_SECOND = 10_000
"""Datagrams."""
BATCH = 50
"""Datagrams sent at once, between two looks at the clock."""
HALF_OPEN = 100
"""TCP connections that send nothing, or half of a request."""
PAUSE = 0.2
"""[s] between two such things."""
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
    # a client that is cut reports it at length
    logging.disable()
    done, end = Counter[str](), time.monotonic() + asked.seconds
    connecting = threading.Thread(target=connections, args=(asked, random.Random(asked.seed + 1), done, end), daemon=True)
    connecting.start()
    chance, messages = random.Random(asked.seed), [*GARBAGE.values(), GOOD.encode()]
    prepared = [damaged(chance.choice(messages), chance) for _ in range(A_SECOND)]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as datagrams:
        due = time.monotonic()
        while time.monotonic() < end:
            for _ in range(BATCH):
                datagrams.sendto(chance.choice(prepared), (HOST, asked.udp))
            done["datagrams"] += BATCH
            due += BATCH / A_SECOND
            time.sleep(max(0.0, due - time.monotonic()))
    print(dict(done), flush=True)
    return 0


def connections(asked: argparse.Namespace, chance: random.Random, done: Counter[str], end: float) -> None:
    """Floods, half-open sockets, foreign origins and endless messages, one after the other until the time is over."""
    others = (
        lambda: flood(asked.ws, chance), lambda: foreign(asked.ws, "/tracker"), lambda: foreign(asked.page, "/"),
        lambda: half_open(asked.ws, chance), lambda: endless(asked.ws),
    )
    while time.monotonic() < end:
        try:
            done[chance.choice(others)()] += 1
        except (OSError, WebSocketException) as error:
            done[type(error).__name__] += 1
        time.sleep(PAUSE)


def damaged(message: bytes, chance: random.Random) -> bytes:
    """Return the message, cut, longer, or with bytes of chance."""
    kind = chance.randrange(4)
    if kind == 0:
        return message[: chance.randrange(len(message) + 1)]
    if kind == 1:
        return message + chance.randbytes(chance.randrange(2000))
    if kind == 2 and message:
        at = chance.randrange(len(message))
        return message[:at] + chance.randbytes(1) + message[at + 1:]
    return message


def flood(port: int, chance: random.Random) -> str:
    """Send messages as fast as they go, until the socket is cut."""
    messages = list(GARBAGE.values())
    with connect(f"ws://{HOST}:{port}/tracker", compression=None) as one:
        for _ in range(5000):
            one.send(damaged(chance.choice(messages), chance))
    return "floods that were taken"


def foreign(port: int, path: str) -> str:
    """Send the handshake of another page, which speaks as ours does."""
    ours = [f"viser-v{viser.__version__}"] if path == "/" else None
    where = f"ws://{HOST}:{port}{path}"
    with connect(where, origin="http://example.com", subprotocols=ours, compression=None) as one:  # type: ignore[arg-type]
        one.recv(5.0)
    return "foreign origins that were served"


def half_open(port: int, chance: random.Random) -> str:
    """Open connections that do not go on."""
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
    """Send one message of very many numbers."""
    with connect(f"ws://{HOST}:{port}/tracker", compression=None) as one:
        one.send(b"[" + b"0," * NUMBERS + b"0]")
        one.recv(5.0)
    return "endless messages that were taken"


if __name__ == "__main__":
    sys.exit(main())
