"""Ports on loopback at system-assigned numbers, the messages that they passed on, and clients of plain sockets."""

import json
import socket
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import avatarsim as av
from avatarsim.live.messages import State
from avatarsim.live.ports.protocol import HEAD, SAMPLE, VERSION, WIDTHS
from avatarsim.live.ports.refusals import Peer, Refusal
from avatarsim.live.ports.server import Ports
from avatarsim.scene.tracker import TrackerSample

UPGRADE = ("Upgrade: websocket", "Connection: Upgrade", "Sec-WebSocket-Version: 13", f"Sec-WebSocket-Key: {'A' * 22}==")
"""Headers that request a WebSocket."""
LONG = 60.0
"""[s] after which a waiting test has failed; it measures nothing."""


def until(holds: Callable[[], object]) -> None:
    """Wait until a condition is true."""
    end = time.monotonic() + LONG
    while not holds():
        assert time.monotonic() < end, "it never came"
        time.sleep(0.002)


def request(path: str, *headers: str) -> bytes:
    """Return an HTTP request."""
    return "\r\n".join([f"GET {path} HTTP/1.1", *headers, "", ""]).encode()


def scene() -> av.Scene:
    """Return a table, and a rigid hand of two pieces."""
    hull = av.ConvexHull(np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]]))
    pieces = (av.Piece(av.Sphere(0.05)), av.Piece(av.Capsule(0.01, 0.1), (0.1, 0.0, 0.0)), av.Piece(hull))
    table = av.fixed("table", (av.Piece(av.Box((1.0, 1.0, 0.1))), av.Piece(av.Ellipsoid((0.1, 0.2, 0.3)))), "wood")
    return av.Scene("a hand", (table,), (av.rigid_avatar("hand", pieces, av.solid(pieces[:1], 0.5)),))


def state(frame: int, bodies: int = 2) -> State:
    """Return the state of a frame."""
    places = np.full((bodies, 3), float(frame))
    turned = np.tile([1.0, 0.0, 0.0, 0.0], (bodies, 1))
    return State(frame, frame / 60, places, turned, np.zeros(0), 0, -1, 0, False, 0, 0, {}, {}, {}, "")


def counted(ports: Ports, reason: Refusal, peer: Peer | None = None) -> int:
    """Return the number of refusals for a reason, by all kinds of peers or by one."""
    return sum(times for (why, kind), times in ports.refusals.counts.items() if why is reason and peer in (None, kind))


def packed_sample(sample: TrackerSample, width: int = 4) -> bytes:
    """Return a sample as packed numbers of `width` bytes, 4 or 8, as `parse` reads it."""
    head = HEAD.pack(SAMPLE, VERSION, width, len(sample.positions), len(sample.angles))
    return head + b"".join(array.astype(WIDTHS[width]).tobytes() for array in (sample.positions, sample.rotations, sample.angles))


def json_sample(sample: TrackerSample) -> str:
    """Return a sample as JSON, as `parse` reads it."""
    return json.dumps({name: getattr(sample, name).tolist() for name in ("positions", "rotations", "angles")})


class Opened:
    """Ports and the targets that they received."""

    def __init__(self, **options: Any) -> None:
        self.targets: list[tuple[Any, int, str]] = []
        self.ports = Ports(scene(), lambda *target: self.targets.append(target), **options)

    @property
    def udp(self) -> tuple[str, int]:
        """Address for datagrams."""
        return self.ports.addresses["udp"]

    @property
    def web(self) -> tuple[str, int]:
        """Address for WebSockets."""
        return self.ports.addresses["websocket"]

    def url(self, path: str = "/tracker") -> str:
        """Return the address of a WebSocket."""
        return "ws://{}:{}{}".format(*self.web, path)

    def plain(self, data: bytes = b"") -> socket.socket:
        """Return a TCP connection that has sent some bytes."""
        end = socket.create_connection(self.web, LONG)
        end.sendall(data)
        return end

    def asked(self, path: str, *headers: str, upgrade: bool = True) -> tuple[int, str]:
        """Return the status and full text of the answer to a request with these headers and no others."""
        with self.plain(request(path, *headers, *(UPGRADE if upgrade else ()))) as end:
            said = b""
            while part := end.recv(65536):
                said += part
                if b"101 Switching" in said:
                    break
        return int(said.split()[1]), said.decode("latin-1")
