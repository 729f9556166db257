"""Admission to the page's socket: other pages, or requests by another host name, are cut; the own page is served."""

import socket
from collections.abc import Iterator

import pytest

viser = pytest.importorskip("viser")

from websockets.exceptions import ConnectionClosed  # noqa: E402
from websockets.sync.client import ClientConnection, connect  # noqa: E402

from avatarsim.live.ports.refusals import Peer, Refusal  # noqa: E402
from avatarsim.live.view.server import AdmittingServer  # noqa: E402

SECONDS = 10.0


@pytest.fixture(scope="module")
def server() -> Iterator[AdmittingServer]:
    one = AdmittingServer("127.0.0.1", 0, "test")
    one.scene.add_frame("/one")
    yield one
    one.stop()


def client(server: AdmittingServer, host: str = "127.0.0.1", origin: str | None = None) -> ClientConnection:
    """Return a client with `host` and `origin` in its headers, whatever address it reaches."""
    end = socket.create_connection(("127.0.0.1", server.get_port()), SECONDS)
    uri = f"ws://{host}:{server.get_port()}"
    return connect(uri, sock=end, origin=origin, subprotocols=[f"viser-v{viser.__version__}"], compression=None)  # type: ignore[arg-type,list-item]


@pytest.mark.parametrize("origin", [None, "http://127.0.0.1:{port}", "http://localhost:{port}"])
def test_own_pages_and_programs_are_served(server: AdmittingServer, origin: str | None) -> None:
    before = dict(server.refusals.counts)
    with client(server, origin=origin and origin.format(port=server.get_port())) as one:
        assert one.recv(SECONDS)
    assert server.refusals.counts == before


@pytest.mark.parametrize(
    ("host", "origin", "reason"),
    [
        ("127.0.0.1", "http://example.com", Refusal.FOREIGN_ORIGIN),
        ("127.0.0.1", "null", Refusal.FOREIGN_ORIGIN),
        ("127.0.0.1", "file://", Refusal.FOREIGN_ORIGIN),
        ("example.com", "http://example.com", Refusal.FOREIGN_HOST),
        ("example.com", None, Refusal.FOREIGN_HOST),
    ],
)
def test_pages_from_elsewhere_are_cut_and_counted(
    server: AdmittingServer, host: str, origin: str | None, reason: Refusal
) -> None:
    before = server.refusals.counts.get((reason, Peer.PAGE), 0)
    with client(server, host, origin) as one:
        with pytest.raises(ConnectionClosed):
            one.recv(SECONDS)
    assert server.refusals.counts.get((reason, Peer.PAGE), 0) == before + 1
    assert not server.get_clients()


def test_no_client_makes_it_public(server: AdmittingServer) -> None:
    assert server.request_share_url() is None
