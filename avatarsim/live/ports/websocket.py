"""WebSocket server (RFC 6455): samples in at /tracker, poses out at /poses and /poses/packed; each client has one latest value.

A client's slot holds the newest message only: a slow client skips those in between, and one that receives nothing for longer than
the limits' patience is dropped. So no client can fill memory, or delay another.
"""

import asyncio
import json
import logging
import socket
import time
from http import HTTPStatus
from typing import Any, ClassVar

from websockets.asyncio.server import Server, ServerConnection, serve
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response

from avatarsim.live.messages import State
from avatarsim.live.ports.admission import Limits, Pace, Window, judged
from avatarsim.live.ports.gate import Gate
from avatarsim.live.ports.pages import page
from avatarsim.live.ports.protocol import json_poses, packed_poses
from avatarsim.live.ports.refusals import Peer, Refusal

TRACKER, POSES, PACKED_POSES = "/tracker", "/poses", "/poses/packed"
WAYS = (TRACKER, POSES, PACKED_POSES)
"""Paths of WebSockets."""
SEND_BUFFER = 1 << 16
"""[bytes] Send buffer for a slow client in the system, and the same again in the server: some hundred poses of a hand."""
CLOSING = 1.0
"""[s] that clients have to close the connection when the server ends."""

QUIET = logging.getLogger("avatarsim.live.ports")
QUIET.addHandler(logging.NullHandler())
QUIET.propagate = False
"""The library's logger of failed handshakes, disabled since they are counted here."""


class Slot:
    """Newest message for a client."""

    def __init__(self) -> None:
        self._newest: Any = None
        self._is_new = asyncio.Event()

    def put(self, message: object) -> None:
        """Replace the message that has not been read."""
        self._newest = message
        self._is_new.set()

    async def next_message(self) -> Any:
        """Wait for a message that was not read yet."""
        await self._is_new.wait()
        self._is_new.clear()
        return self._newest


class Guarded(ServerConnection):
    """A connection that its server registers at its first byte, not at the end of its handshake."""

    owner: ClassVar["WebSockets"]
    is_evicted = is_served = False

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Register the peer; called by the event loop when it has connected."""
        super().connection_made(transport)
        self.owner.arrived(self)

    def data_received(self, data: bytes) -> None:
        """Read data; called by the event loop. After a protocol error nothing more is read, and the peer's close not awaited."""
        super().data_received(data)
        if self.protocol.handshake_exc is not None or self.protocol.parser_exc is not None:
            # a close waits until all is written, which never ends if the peer reads nothing
            end = self.transport.abort if self.transport.get_write_buffer_size() else self.transport.close
            end()

    def connection_lost(self, exc: Exception | None) -> None:
        """Unregister the peer; called by the event loop when the connection is gone."""
        super().connection_lost(exc)
        self.owner.left(self)


class WebSockets:
    """The server. Everything in it runs in one event loop."""

    def __init__(self, gate: Gate, description: dict[str, Any], limits: Limits, allowed: tuple[str, ...]) -> None:
        self._gate, self._limits, self._allowed = gate, limits, allowed
        self._description = json.dumps(description)
        self._waiting: dict[Guarded, None] = {}
        self._admitted: set[Guarded] = set()
        self._slots: dict[Slot, str] = {}
        self._newest: State | None = None
        self._server: Server | None = None

    async def start(self, end: socket.socket) -> None:
        """Serve at a listening socket."""
        # accepted sockets inherit this bound on the system's buffer for a client
        end.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER)
        self._server = await serve(
            self._serve, sock=end, process_request=self._judge, create_connection=type("Ours", (Guarded,), {"owner": self}),
            open_timeout=self._limits.patience, close_timeout=CLOSING, max_size=self._gate.shape.most_bytes, compression=None,
            write_limit=SEND_BUFFER, server_header=None, logger=QUIET,
        )

    async def close(self) -> None:
        """Close all clients properly, then cut those that do not answer."""
        if self._server is None:
            return
        goodbyes = [asyncio.ensure_future(connection.close(1001)) for connection in self._admitted]
        if goodbyes:
            await asyncio.wait(goodbyes, timeout=CLOSING)
        for connection in [*self._admitted, *self._waiting]:
            connection.transport.abort()
        self._server.close(close_connections=False)
        await self._server.wait_closed()

    def publish(self, state: State) -> None:
        """Put a state into each client's slot."""
        self._newest = state
        for slot, way in self._slots.items():
            if way != TRACKER:
                slot.put(self._newest)

    def arrived(self, connection: Guarded) -> None:
        """Add a connection without a request; beyond the limit the oldest is dropped, which has had the longest time."""
        self._waiting[connection] = None
        if len(self._waiting) > self._limits.waiting:
            oldest = next(iter(self._waiting))
            oldest.is_evicted = True
            self._waiting.pop(oldest)
            self._gate.refuse(Refusal.TOO_MANY, Peer.WEBSOCKET, source_of(oldest))
            oldest.transport.abort()

    def left(self, connection: Guarded) -> None:
        """Forget a connection; one that never sent a readable request is counted."""
        self._waiting.pop(connection, None)
        was_admitted = connection in self._admitted
        self._admitted.discard(connection)
        if connection.request is None and not connection.is_evicted:
            wrong = connection.protocol.handshake_exc
            is_cut = wrong is None or isinstance(wrong.__cause__, EOFError)
            self._gate.refuse(Refusal.NO_HANDSHAKE if is_cut else Refusal.NOT_HTTP, Peer.WEBSOCKET, source_of(connection))
        elif was_admitted and not connection.is_served:
            self._gate.refuse(Refusal.NOT_HTTP, Peer.WEBSOCKET, source_of(connection))

    def _judge(self, connection: ServerConnection, request: Request) -> Response | None:
        """Return None to continue the handshake, else the response to send instead."""
        headers = request.headers
        is_page = "Upgrade" not in headers
        peer, source = Peer.PAGE if is_page else Peer.WEBSOCKET, source_of(connection)
        foreign = judged(headers.get_all("Host"), headers.get_all("Origin"), str(connection.local_address[0]), self._allowed)
        if foreign is not None:
            return self._refuse(foreign, peer, source, HTTPStatus.FORBIDDEN)
        path = request.path.partition("?")[0]
        if is_page:
            found = page(path)
            if found is None:
                return self._refuse(Refusal.NO_SUCH_PAGE, peer, source, HTTPStatus.NOT_FOUND)
            answer = Headers({**found.headers, "Content-Length": str(len(found.body)), "Connection": "close"})
            return Response(HTTPStatus.OK.value, HTTPStatus.OK.phrase, answer, found.body)
        if path not in WAYS:
            return self._refuse(Refusal.NO_SUCH_PAGE, peer, source, HTTPStatus.NOT_FOUND)
        if len(self._admitted) >= self._limits.connections:
            return self._refuse(Refusal.TOO_MANY, peer, source, HTTPStatus.SERVICE_UNAVAILABLE)
        assert isinstance(connection, Guarded)
        self._admitted.add(connection)
        self._waiting.pop(connection, None)
        return None

    def _refuse(self, reason: Refusal, peer: Peer, source: str, status: HTTPStatus) -> Response:
        body = f"{self._gate.refuse(reason, peer, source)}\n".encode()
        answer = Headers({"Content-Type": "text/plain; charset=utf-8", "Content-Length": str(len(body)), "Connection": "close"})
        return Response(status.value, status.phrase, answer, body)

    async def _serve(self, connection: ServerConnection) -> None:
        """Serve a client from its handshake to its end."""
        assert isinstance(connection, Guarded) and connection.request is not None
        connection.is_served = True
        way, slot = connection.request.path.partition("?")[0], Slot()
        if way != TRACKER and self._newest is not None:
            slot.put(self._newest)
        self._slots[slot] = way
        writer = asyncio.ensure_future(self._write(connection, slot, way))
        try:
            await self._read(connection, slot, way)
        except ConnectionClosed as error:
            # 1007, 1009, 1002: refusals by the library itself
            sent = 0 if error.sent is None or error.rcvd_then_sent else error.sent.code
            reason = {1009: Refusal.TOO_LONG, 1002: Refusal.BROKEN_FRAMES, 1007: Refusal.BROKEN_FRAMES}.get(sent)
            if reason is not None:
                self._gate.refuse(reason, Peer.WEBSOCKET, source_of(connection))
        except Exception as error:
            # an error here, or in the receiver of the targets: reported like those of UDP, by the event loop's handler
            asyncio.get_running_loop().call_exception_handler({"message": "a WebSocket was given up", "exception": error})
        finally:
            del self._slots[slot]
            writer.cancel()

    async def _read(self, connection: ServerConnection, slot: Slot, way: str) -> None:
        """Read messages one by one; a tracker is sent the error of its last one."""
        window, source = Window(self._limits), source_of(connection)
        while True:
            # as bytes, whatever its kind: invalid text is then refused like any other message
            data = await connection.recv(decode=False)
            if way != TRACKER:
                wrong = self._gate.refuse(Refusal.UNEXPECTED, Peer.WEBSOCKET, source)
                pace = window.admit(time.monotonic_ns())
            else:
                pace, wrong = self._gate.handle(data, window, Peer.WEBSOCKET, source)
            if pace is Pace.FLOOD:
                self._gate.refuse(Refusal.FLOOD, Peer.WEBSOCKET, source)
                connection.transport.abort()
                return
            if wrong and way == TRACKER:
                slot.put(json.dumps({"refused": wrong}))

    async def _write(self, connection: ServerConnection, slot: Slot, way: str) -> None:
        """Send the scene description, then each newest message, until the client leaves or does not receive one in time."""
        message: str | bytes = self._description
        while True:
            try:
                async with asyncio.timeout(self._limits.patience):
                    await connection.send(message)
            except ConnectionClosed:
                return
            except TimeoutError:
                self._gate.refuse(Refusal.STOPPED_READING, Peer.WEBSOCKET, source_of(connection))
                connection.transport.abort()
                return
            newest = await slot.next_message()
            message = newest if isinstance(newest, str) else (packed_poses if way == PACKED_POSES else json_poses)(newest)


def source_of(connection: ServerConnection) -> str:
    """Return address and port of a peer; empty ones if it has already gone."""
    host, port = (connection.remote_address or ("", 0))[:2]
    return f"websocket {host}:{port}"
