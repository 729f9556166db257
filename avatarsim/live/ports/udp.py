"""UDP input: one datagram is one message (RFC 768), read by an event loop one by one, so that other tasks have their turn.

A source gets an answer to its first accepted datagram, and to one refused datagram a second. Source addresses can be forged:
answers are short, and too few to be of use for amplification.
"""

import asyncio
import json
import time
from collections import OrderedDict
from typing import Any

from avatarsim.live.ports.admission import SECOND, Limits, Window
from avatarsim.live.ports.gate import Gate
from avatarsim.live.ports.refusals import Peer

ANSWERS = 20
"""Answers a second to all sources together. More: a flood of forged addresses makes more traffic elsewhere."""
ACCEPTED = json.dumps({"taken": 1}).encode()
"""Answer to the first accepted datagram of a source."""


class Source:
    """State of a source of datagrams."""

    def __init__(self, limits: Limits) -> None:
        self.window, self.was_accepted, self.refused_at = Window(limits), False, -1


class Datagrams(asyncio.DatagramProtocol):
    """Reader of the socket. It does not wait for answers to be delivered."""

    def __init__(self, gate: Gate, limits: Limits) -> None:
        self._gate, self._limits = gate, limits
        self._sources: OrderedDict[object, Source] = OrderedDict()
        self._second, self._answers = -1, 0

    def connection_made(self, transport: asyncio.DatagramTransport) -> None:  # type: ignore[override]
        """Store the transport; called by the event loop when the socket is open."""
        self._transport = transport

    def datagram_received(self, data: bytes, address: tuple[Any, ...]) -> None:
        """Process a datagram; called by the event loop."""
        source = self._source(address)
        _, wrong = self._gate.handle(data, source.window, Peer.UDP, f"udp {address[0]}:{address[1]}")
        self._answer(source, address, wrong)

    def _answer(self, source: Source, address: tuple[Any, ...], wrong: str) -> None:
        """Send the reason of a refusal, at most one a second, or that a first datagram was accepted."""
        second = time.monotonic_ns() // SECOND
        if second != self._second:
            self._second, self._answers = second, 0
        if self._answers >= ANSWERS or (source.refused_at == second if wrong else source.was_accepted):
            return
        self._answers += 1
        if wrong:
            source.refused_at = second
        else:
            source.was_accepted = True
        self._transport.sendto(json.dumps({"refused": wrong}).encode() if wrong else ACCEPTED, address)

    def _source(self, address: object) -> Source:
        """Return a source by its address; the one silent longest makes room."""
        source = self._sources.pop(address, None) or Source(self._limits)
        self._sources[address] = source
        if len(self._sources) > self._limits.sources:
            self._sources.popitem(last=False)
        return source
