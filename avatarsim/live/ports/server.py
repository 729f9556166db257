"""UDP and WebSocket ports in one event loop in a thread of its own (reactor pattern; Schmidt 1995), on loopback by default."""

import asyncio
import errno
import socket
import threading
from collections.abc import Mapping
from concurrent.futures import Future
from contextlib import suppress
from types import TracebackType
from typing import TYPE_CHECKING, Self

from avatarsim.errors import InvalidInput, MissingPackage
from avatarsim.live.messages import State
from avatarsim.live.ports.admission import Limits, as_address
from avatarsim.live.ports.drawing import described
from avatarsim.live.ports.gate import Gate, OnRefusal, OnTarget
from avatarsim.live.ports.protocol import Shape
from avatarsim.live.ports.refusals import Refusals
from avatarsim.live.ports.udp import Datagrams
from avatarsim.scene.scene import Scene

if TYPE_CHECKING:
    from avatarsim.live.ports.websocket import WebSockets

HIGHEST_PORT = 65535


class PortUnavailable(InvalidInput):
    """A port that the system refuses: another program has it, it needs more rights, or the address is another machine's."""


class Ports:
    """UDP and WebSocket ports of a live scene. `start`, then `publish` states; a context manager does start and close.

    on_target  called in the ports' own thread with a sample or goals, the time [ns, monotonic] its bytes arrived, and the source;
               messages that it refuses by an AvatarsimError are counted
    listen     address of this machine; other machines can reach any but loopback
    udp_port, ws_port  0: the system chooses one; None: there is none
    allow      further hosts that Host and Origin headers may name
    on_refusal called in the ports' own thread with a peer's address and the reason of its first refusal

    Raises InvalidInput for an invalid address or port."""

    def __init__(
        self, scene: Scene, on_target: OnTarget, listen: str = "127.0.0.1", udp_port: int | None = 0, ws_port: int | None = 0,
        allow: tuple[str, ...] = (), limits: Limits | None = None, on_refusal: OnRefusal | None = None,
    ) -> None:
        self.refusals = Refusals()
        self._listen = as_address(listen)
        self._requested = {"udp": _port("UDP port", udp_port), "websocket": _port("WebSocket port", ws_port)}
        self._limits = limits or Limits()
        self._gate = Gate(Shape.of(scene), on_target, self.refusals, on_refusal)
        self._scene, self._allow = scene, allow
        self._ends: dict[str, socket.socket] = {}
        self._loop: asyncio.AbstractEventLoop
        self._is_over: asyncio.Event
        self._thread: threading.Thread | None = None
        self._web: WebSockets | None = None
        self._newest: State | None = None
        self._is_offered = False

    @property
    def addresses(self) -> Mapping[str, tuple[str, int]]:
        """Address and port by "udp" and "websocket", as the system assigned them; empty before `start`."""
        return {name: end.getsockname()[:2] for name, end in self._ends.items()}

    @property
    def hands(self) -> str:
        """Address of the page of tracked hands; empty without a WebSocket port."""
        if "websocket" not in self._ends:
            return ""
        host, port = self.addresses["websocket"]
        # a browser treats localhost as secure enough for WebXR, like TLS
        shown = "localhost" if host in ("127.0.0.1", "::1") else f"[{host}]" if ":" in host else host
        return f"http://{shown}:{port}/hands"

    def start(self) -> Self:
        """Open the ports. Raises PortUnavailable if one is not available, MissingPackage if `websockets` is not installed."""
        if self._thread is not None:
            return self
        begun: Future[None] = Future()
        try:
            self._open()
            self._thread = threading.Thread(target=self._run, args=(begun,), name="avatarsim ports", daemon=True)
            self._thread.start()
            begun.result()
        except BaseException:
            self.close()
            raise
        return self

    def close(self) -> None:
        """Close the ports; a second call does nothing."""
        thread, self._thread = self._thread, None
        if thread is not None:
            # the thread may have ended by itself
            with suppress(RuntimeError):
                self._loop.call_soon_threadsafe(self._is_over.set)
            thread.join()
        for end in self._ends.values():
            end.close()
        self._ends.clear()

    def publish(self, state: State) -> None:
        """Send a state to all clients of poses; never waits, callable from any thread. Of several states that come before the
        ports' thread has looked, only the newest is sent."""
        self._newest = state
        if self._is_offered or self._thread is None:
            return
        # set before the thread is woken and cleared before it reads: a state that finds it set is read by that wake
        self._is_offered = True
        try:
            self._loop.call_soon_threadsafe(self._offer)
        except RuntimeError:
            # closed in the meantime
            self._is_offered = False

    def __enter__(self) -> Self:
        return self.start()

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def _open(self) -> None:
        """Open the sockets here and not in the thread, so that the caller receives the error if one is not available."""
        if self._requested["websocket"] is not None:
            try:
                from avatarsim.live.ports.websocket import WebSockets
            except ImportError as error:
                raise MissingPackage("websockets", "view", "a WebSocket port") from error
            self._web = WebSockets(self._gate, described(self._scene), self._limits, self._allow)
            self._ends["websocket"] = _bound(self._listen, self._requested["websocket"], socket.SOCK_STREAM, "WebSocket port")
        if self._requested["udp"] is not None:
            self._ends["udp"] = _bound(self._listen, self._requested["udp"], socket.SOCK_DGRAM, "UDP port")

    def _run(self, begun: Future[None]) -> None:
        with asyncio.Runner(loop_factory=asyncio.SelectorEventLoop) as runner:
            runner.run(self._serve(begun))

    async def _serve(self, begun: Future[None]) -> None:
        """Read and write until the ports are closed; `begun` is done once they are open."""
        self._loop, self._is_over, udp = asyncio.get_running_loop(), asyncio.Event(), None
        try:
            if "udp" in self._ends:
                reader = Datagrams(self._gate, self._limits)
                udp, _ = await self._loop.create_datagram_endpoint(lambda: reader, sock=self._ends["udp"])
            if self._web is not None:
                await self._web.start(self._ends["websocket"])
        except BaseException as error:
            begun.set_exception(error)
        else:
            begun.set_result(None)
            await self._is_over.wait()
        if udp is not None:
            udp.close()
        if self._web is not None:
            await self._web.close()

    def _offer(self) -> None:
        self._is_offered = False
        if self._web is not None and self._newest is not None:
            self._web.publish(self._newest)


def _port(thing: str, value: int | None) -> int | None:
    if value is not None and (isinstance(value, bool) or not isinstance(value, int) or not 0 <= value <= HIGHEST_PORT):
        raise InvalidInput(thing, value, f"a whole number from 0, which lets the system choose, to {HIGHEST_PORT}")
    return value


def _bound(host: str, port: int | None, kind: socket.SocketKind, thing: str) -> socket.socket:
    """Return a non-blocking socket bound to an address; a stream socket listens."""
    family, end = socket.AF_INET6 if ":" in host else socket.AF_INET, None
    try:
        if kind is socket.SOCK_STREAM:
            end = socket.create_server((host, port), family=family)
        else:
            end = socket.socket(family, kind)
            end.bind((host, port))
        end.setblocking(False)
    except OSError as error:
        if end is not None:
            end.close()
        if error.errno == errno.EADDRINUSE:
            valid = "a port that no other program has; 0 lets the system choose"
        else:
            valid = f"a port and an address of this machine that may be used ({error.strerror})"
        raise PortUnavailable(thing, f"{host}:{port}", valid) from error
    return end
