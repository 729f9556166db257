"""The page's server: viser's, with the admission of our ports (Host and Origin headers; RFC 6454, RFC 6455 s. 10.2).

viser takes any WebSocket, so that another page in the same browser could send drags and events of the panel. It has no public way
to the headers of a connection; `PRIVATE` lists the attributes read instead, checked against the installed version at the start.
"""

import asyncio
from collections.abc import Callable
from typing import TypeVar

import viser
from viser.infra import WebsockClientConnection

from avatarsim.errors import InvalidInput, MissingPackage
from avatarsim.live.ports.admission import judged
from avatarsim.live.ports.refusals import Peer, Refusals

PRIVATE = ("_websock_server", "_live_connections")
"""Private attributes of viser that are read: the server of its sockets, and the server's connections by client."""

T = TypeVar("T")


class AdmittingServer(viser.ViserServer):
    """A page's server for its own page alone, which no client can make public: viser would open a tunnel to a host of its own at
    any client's request. A foreign connection is cut before a browser can send on it, and counted in `refusals`.

    Raises InvalidInput for a port that is taken, MissingPackage if the installed viser has no such connections."""

    def __init__(self, host: str, port: int, label: str) -> None:
        self.refusals = Refusals()
        try:
            super().__init__(host=host, port=port, label=label, verbose=False)
        except OSError as error:
            raise InvalidInput("port of the page", port, f"a port that is free ({error.strerror})") from error
        if not hasattr(getattr(self, PRIVATE[0], None), PRIVATE[1]):
            self.stop()
            raise MissingPackage("viser", "view", f"admission to its page ({viser.__version__} names its connections otherwise)")
        self._websock_server.on_client_connect(self._admit)
        # connections opened before the line above
        self.do(self._admit_all)

    @property
    def address(self) -> str:
        """Address of the page in a browser."""
        return f"http://{self.get_host()}:{self.get_port()}"

    def post(self, work: Callable[..., object], *about: object) -> None:
        """Run a callback in the server's thread, soon. Writing from another thread meets asyncio events that are made for one
        thread: with several viewers its buffers break."""
        self.get_event_loop().call_soon_threadsafe(work, *about)

    def do(self, work: Callable[[], T]) -> T:
        """Run a callback in the server's thread and return its result."""
        async def done() -> T:
            return work()

        return asyncio.run_coroutine_threadsafe(done(), self.get_event_loop()).result()

    async def _admit(self, client: WebsockClientConnection) -> None:
        """Judge a client; viser reads nothing of it before this returns."""
        self._judge(client.client_id)

    def _admit_all(self) -> None:
        for client in tuple(self._websock_server._live_connections):
            self._judge(client)

    def _judge(self, client: int) -> None:
        """Cut a client's connection if it comes from another page, or with another name for this machine."""
        connection = self._websock_server._live_connections[client]
        assert connection.request is not None
        headers = connection.request.headers
        foreign = judged(headers.get_all("Host"), headers.get_all("Origin"), str(connection.local_address[0]))
        if foreign is not None:
            self.refusals.count(foreign, Peer.PAGE)
            connection.transport.abort()

    def request_share_url(self, verbose: bool = True) -> str | None:
        """Return None: sharing is disabled."""
        return None
