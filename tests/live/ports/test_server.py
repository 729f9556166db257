"""Ports with real sockets on loopback: valid messages arrive, others are counted, and no peer stops another."""

import json
import socket
import struct
import threading
from collections.abc import Callable
from contextlib import ExitStack, suppress
from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from avatarsim.errors import InvalidInput, InvalidSample, MissingPackage
from avatarsim.live.ports.protocol import POSES, POSES_HEAD, SAMPLE, Goals
from avatarsim.live.ports.refusals import Peer, Refusal
from avatarsim.live.ports.server import Ports, PortUnavailable
from avatarsim.scene.tracker import TrackerSample
from tests.live.ports.opened import LONG, UPGRADE, Opened, counted, packed_sample, request, scene, state, until

GOOD = json.dumps({"positions": [[1, 2, 3]], "rotations": [[1, 0, 0, 0]]})
GARBAGE: dict[Refusal, bytes] = {
    Refusal.TOO_LONG: b"{" + b" " * 20000,
    Refusal.NOT_TEXT: b"{\xff}",
    Refusal.NOT_JSON: b"{oops",
    Refusal.TOO_DEEP: b'{"links":' + b"[" * 100 + b"]" * 100 + b"}",
    Refusal.WRONG_TYPE: b'{"links": 3}',
    Refusal.DUPLICATE: b'{"links": {}, "links": {}}',
    Refusal.UNKNOWN_KEY: b'{"link": {}, "positions": []}',
    Refusal.MISSING_KEY: b'{"positions": []}',
    Refusal.UNKNOWN_LINK: b'{"links": {"table": {"position": [0, 0, 0]}}}',
    Refusal.WRONG_LENGTH: b'{"positions": [], "rotations": []}',
    Refusal.NOT_FINITE: b'{"links": {"hand": {"position": [NaN, 0, 0]}}}',
    Refusal.TOO_LARGE: b'{"links": {"hand": {"position": [1e9, 0, 0]}}}',
    Refusal.NOT_A_ROTATION: b'{"links": {"hand": {"position": [0, 0, 0], "rotation": [1, 1, 0, 0]}}}',
    Refusal.WRONG_MAGIC: b"\x01\x02",
    Refusal.WRONG_VERSION: SAMPLE + b"\x02" + bytes(11),
}
"""A message for each reason that depends on its content; one that is too long ends a WebSocket, see below."""


def send(live: Opened, data: bytes) -> None:
    """Send a datagram from a socket of its own."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as end:
        end.sendto(data, live.udp)


def reached(live: Opened, count: int) -> bool:
    """Return whether so many messages that are none were counted."""
    return counted(live.ports, Refusal.WRONG_MAGIC) == count


@pytest.mark.parametrize("reason", GARBAGE, ids=lambda reason: reason.name)
def test_garbage_by_udp_is_counted_and_answered(live: Opened, reason: Refusal) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as end:
        end.settimeout(LONG)
        end.sendto(GARBAGE[reason], live.udp)
        assert json.loads(end.recv(1024))["refused"]
    send(live, GOOD.encode())
    until(lambda: live.targets)
    assert live.ports.refusals.counts == {(reason, Peer.UDP): 1}
    assert live.ports.refusals.accepted == {Peer.UDP: 1} and len(live.targets) == 1


@pytest.mark.parametrize("reason", [one for one in GARBAGE if one is not Refusal.TOO_LONG], ids=lambda reason: reason.name)
def test_garbage_by_websocket_is_counted_and_told(live: Opened, reason: Refusal) -> None:
    with connect(live.url()) as client:
        assert "links" in json.loads(client.recv(LONG))
        client.send(GARBAGE[reason])
        assert json.loads(client.recv(LONG))["refused"]
        client.send(GOOD)
        until(lambda: live.targets)
    assert live.ports.refusals.counts == {(reason, Peer.WEBSOCKET): 1}


def test_only_the_first_good_datagram_is_answered(live: Opened) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as end:
        end.settimeout(LONG)
        for _ in range(3):
            end.sendto(GOOD.encode(), live.udp)
        assert json.loads(end.recv(1024)) == {"taken": 1}
        until(lambda: len(live.targets) == 3)
        end.setblocking(False)
        with pytest.raises(BlockingIOError):
            end.recv(1024)


def test_answers_by_udp_are_few_whatever_comes(opened: Callable[..., Opened], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("avatarsim.live.ports.udp.time", SimpleNamespace(monotonic_ns=lambda: 0))
    live, answers = opened(), 0
    with ExitStack() as stack:
        ends = [stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) for _ in range(30)]
        for end in ends:
            before = counted(live.ports, Refusal.WRONG_MAGIC)
            end.sendto(b"garbage", live.udp)
            end.sendto(b"garbage", live.udp)
            until(partial(reached, live, before + 2))
        for end in ends:
            end.setblocking(False)
            with suppress(BlockingIOError):
                while end.recv(1024):
                    answers += 1
    # one for each source, limited by the total of all sources
    assert answers == 20


def test_the_first_refusal_of_each_peer_is_reported_and_no_other(opened: Callable[..., Opened]) -> None:
    told = list[tuple[str, str]]()
    live = opened(on_refusal=lambda *refusal: told.append(refusal))
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one, connect(live.url()) as other:
        one.sendto(b'{"links": {"\\u001b[2J\\n": 1}}', live.udp)
        until(lambda: told)
        for _ in range(3):
            one.sendto(b"garbage", live.udp)
            other.send(b"garbage")
        until(lambda: sum(live.ports.refusals.counts.values()) == 7)
        sources = [f"udp 127.0.0.1:{one.getsockname()[1]}", f"websocket 127.0.0.1:{other.local_address[1]}"]
    assert [source for source, _ in told] == sources and all(reason.isprintable() for _, reason in told)
    assert live.asked("/nowhere", "Host: localhost")[0] == 404
    assert told[2][1] == Refusal.NO_SUCH_PAGE.value
    for _ in range(100):
        before = counted(live.ports, Refusal.WRONG_MAGIC)
        send(live, b"garbage")
        until(partial(reached, live, before + 1))
    assert len(told) == 64


def test_text_that_is_none_is_refused_and_the_socket_goes_on(live: Opened) -> None:
    with connect(live.url()) as client:
        client.send(b'{"links": {"\xff": 1}}', text=True)
        client.send(GOOD)
        until(lambda: live.targets)
    assert live.ports.refusals.counts == {(Refusal.NOT_TEXT, Peer.WEBSOCKET): 1}


def test_a_message_that_is_too_long_ends_its_socket_alone(live: Opened) -> None:
    with connect(live.url()) as other, connect(live.url()) as client:
        client.send(GARBAGE[Refusal.TOO_LONG])
        with pytest.raises(ConnectionClosed):
            while True:
                client.recv(LONG)
        other.send(GOOD)
        until(lambda: live.targets)
    assert live.ports.refusals.counts == {(Refusal.TOO_LONG, Peer.WEBSOCKET): 1}


def test_samples_and_goals_arrive_with_stamp_and_source(live: Opened) -> None:
    sample = TrackerSample(0.0, np.array([[1.0, 2.0, 3.0]]), np.array([[0.0, 1.0, 0.0, 0.0]]), np.zeros(0))
    with connect(live.url()) as client:
        client.send(GOOD)
        client.send(packed_sample(sample))
        client.send('{"links": {"hand": {"position": [4, 5, 6]}}}')
        until(lambda: len(live.targets) == 3)
    send(live, packed_sample(sample, 8))
    until(lambda: len(live.targets) == 4)
    text, packed, goals, datagram = live.targets
    assert isinstance(goals[0], Goals) and goals[0].links["hand"].position.tolist() == [4.0, 5.0, 6.0]
    for found in (text, packed, datagram):
        assert found[0].positions.tolist() == [[1.0, 2.0, 3.0]]
    assert [text[1], packed[1], goals[1], datagram[1]] == sorted(one[1] for one in live.targets)
    assert text[2].startswith("websocket 127.0.0.1:") and datagram[2].startswith("udp 127.0.0.1:")


def test_what_the_driven_refuses_is_counted(opened: Callable[..., Opened]) -> None:
    live = opened()

    def refuse(*target: object) -> None:
        raise InvalidSample("a goal", 1, "another")

    live.ports._gate._on_target = refuse
    send(live, GOOD.encode())
    until(lambda: counted(live.ports, Refusal.NOT_ACCEPTED))


def test_by_default_nothing_listens_beyond_loopback(live: Opened) -> None:
    assert {host for host, _ in live.ports.addresses.values()} == {"127.0.0.1"}
    assert live.ports.hands == f"http://localhost:{live.web[1]}/hands"


def test_an_address_is_listened_at_when_it_is_named(opened: Callable[..., Opened]) -> None:
    live = opened(listen="127.0.0.2", udp_port=None, allow=("headset.local",))
    assert live.ports.addresses.keys() == {"websocket"} and live.web[0] == "127.0.0.2"
    assert live.asked("/tracker", "Host: 127.0.0.2")[0] == 101
    assert live.asked("/tracker", "Host: headset.local:80", "Origin: http://headset.local")[0] == 101
    assert live.asked("/tracker", "Host: other.local")[0] == 403


@pytest.mark.parametrize("port", ["udp_port", "ws_port"])
def test_a_port_that_is_taken_is_a_typed_error(live: Opened, port: str) -> None:
    number = (live.udp if port == "udp_port" else live.web)[1]
    options: dict[str, Any] = {port: number}
    other = Ports(scene(), print, **options)
    with pytest.raises(PortUnavailable, match=rf"{number}'; valid: a port that no other program has"):
        other.start()
    assert not other.addresses
    other.close()


def test_wrong_ports_and_addresses_are_refused() -> None:
    for port in (-1, 65536, True, "80"):
        with pytest.raises(InvalidInput, match="UDP port"):
            Ports(scene(), print, udp_port=port)  # type: ignore[arg-type]
    with pytest.raises(InvalidInput, match="address to listen at"):
        Ports(scene(), print, listen="example.com")
    with pytest.raises(PortUnavailable, match="an address of this machine"):
        Ports(scene(), print, listen="192.0.2.1").start()


def test_without_its_package_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    monkeypatch.delitem(sys.modules, "avatarsim.live.ports.websocket", raising=False)
    monkeypatch.setitem(sys.modules, "websockets.asyncio.server", None)
    with pytest.raises(MissingPackage, match="websockets.*view"):
        Ports(scene(), print).start()


def test_ports_close_twice_and_publish_after_it_does_nothing(opened: Callable[..., Opened]) -> None:
    live = opened()
    address = live.web
    with connect(live.url("/poses")) as client:
        live.ports.close()
        live.ports.close()
        live.ports.publish(state(1))
        assert "avatarsim ports" not in [thread.name for thread in threading.enumerate()] and not live.ports.addresses
        with pytest.raises(ConnectionClosed):
            while True:
                client.recv(LONG)
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(address, LONG)


@pytest.mark.parametrize("path", ["/tracker", "/poses", "/poses/packed"])
def test_foreign_hosts_and_origins_are_forbidden(live: Opened, path: str) -> None:
    host = "Host: {}:{}".format(*live.web)
    assert live.asked(path, "Host: evil.example")[0] == 403
    assert live.asked(path)[0] == 403
    assert live.asked(path, host, "Origin: http://evil.example")[0] == 403
    assert live.asked(path, host, "Origin: null")[0] == 403
    counts = {(Refusal.FOREIGN_HOST, Peer.WEBSOCKET): 2, (Refusal.FOREIGN_ORIGIN, Peer.WEBSOCKET): 2}
    assert live.ports.refusals.counts == counts
    assert live.asked(path, host, "Origin: http://localhost:8000")[0] == 101
    assert live.asked("/hands", "Host: evil.example", upgrade=False)[0] == 403
    assert counted(live.ports, Refusal.FOREIGN_HOST, Peer.PAGE) == 1


def test_other_paths_are_not_there(live: Opened) -> None:
    host = "Host: localhost"
    for path in ("/", "/tracker/", "/../pages.py", "/hands.html", "/%2e%2e/pages.py"):
        assert live.asked(path, host)[0] == 404
        assert live.asked(path, host, upgrade=False)[0] == 404
    assert counted(live.ports, Refusal.NO_SUCH_PAGE, Peer.PAGE) == 5


def test_clients_of_poses_get_the_scene_and_the_newest_state(live: Opened) -> None:
    with connect(live.url("/poses")) as one, connect(live.url("/poses/packed")) as other:
        first, second = json.loads(one.recv(LONG)), json.loads(other.recv(LONG))
        assert [body["role"] for body in first["bodies"]] == ["fixed", "driven"]
        assert first == second and [body["name"] for body in first["bodies"]] == ["table", "hand"]
        kinds = [piece["shape"] for body in first["bodies"] for piece in body["pieces"]]
        assert kinds == ["box", "ellipsoid", "sphere", "capsule", "hull"] and first["links"] == ["hand"]
        for frame in range(1, 1001):
            live.ports.publish(state(frame))
        message, packed = dict[str, Any](frame=0), b""
        while message["frame"] < 1000:
            message = json.loads(one.recv(LONG))
        assert message["positions"] == [[1000.0] * 3] * 2 and message["orientations"] == [[1.0, 0.0, 0.0, 0.0]] * 2
        frame = 0
        while frame < 1000:
            packed = other.recv(LONG, decode=False)
            magic, version, width, bodies, hinges, frame, at = POSES_HEAD.unpack_from(packed)
        assert (magic, version, width, bodies, hinges, at) == (POSES, 1, 4, 2, 0, 1000 / 60)
        numbers = struct.unpack_from("<14f", packed, POSES_HEAD.size)
        assert numbers[:6] == (1000.0,) * 6 and len(packed) == POSES_HEAD.size + 56
    with connect(live.url("/poses")) as late:
        late.recv(LONG)
        assert json.loads(late.recv(LONG))["frame"] == 1000, "also a client that comes when nothing moves"
    assert not live.ports.refusals.counts


def test_a_client_of_poses_that_talks_is_counted(live: Opened) -> None:
    with connect(live.url("/poses")) as client:
        client.send(GOOD)
        until(lambda: counted(live.ports, Refusal.UNEXPECTED))
    assert not live.targets


def test_a_client_that_never_reads_is_dropped_and_others_go_on(strict: Opened) -> None:
    silent = strict.plain(request("/poses", "Host: localhost", *UPGRADE))
    with silent, connect(strict.url("/poses"), max_size=None) as reader:
        reader.recv(LONG)
        frame = seen = 0
        while not counted(strict.ports, Refusal.STOPPED_READING):
            frame += 1
            strict.ports.publish(state(frame, 2000))
            # the reading client proceeds, whatever the other does
            while seen < frame:
                seen = json.loads(reader.recv(LONG))["frame"]
        assert strict.ports.refusals.counts == {(Refusal.STOPPED_READING, Peer.WEBSOCKET): 1}
        strict.ports.publish(state(frame + 1))
        assert json.loads(reader.recv(LONG))["frame"] == frame + 1


def test_half_open_sockets_are_cut_and_others_go_on(strict: Opened) -> None:
    ends = [strict.plain(data) for data in (b"", b"GET /tracker HTT", b"GET /tracker HTTP/1.1\r\nHost: localhost\r\n")]
    with connect(strict.url()) as client:
        client.send(GOOD)
        until(lambda: strict.targets)
        until(lambda: counted(strict.ports, Refusal.NO_HANDSHAKE) == 3)
    for end in ends:
        with end, pytest.raises((ConnectionResetError, ConnectionAbortedError, EOFError)):
            if not end.recv(100):
                raise EOFError


def test_of_many_half_open_sockets_the_oldest_go(opened: Callable[..., Opened]) -> None:
    live = opened()
    ends = [live.plain() for _ in range(40)]
    until(lambda: counted(live.ports, Refusal.TOO_MANY) == 40 - 16)
    with connect(live.url()) as client:
        client.send(GOOD)
        until(lambda: live.targets)
    for end in ends:
        end.close()


def test_more_clients_than_are_kept_are_refused(strict: Opened) -> None:
    with connect(strict.url()), connect(strict.url("/poses")), connect(strict.url()):
        with pytest.raises(InvalidStatus, match="503"):
            connect(strict.url())
        assert strict.ports.refusals.counts == {(Refusal.TOO_MANY, Peer.WEBSOCKET): 1}
    until(lambda: strict.asked("/tracker", "Host: localhost")[0] == 101)


@pytest.mark.parametrize("data", [b"\x16\x03\x01\x02\x00\r\n\r\n", b"hello\r\n\r\n", b"POST / HTTP/1.0\r\n\r\n", b"x" * 100_000])
def test_what_is_no_request_is_counted(live: Opened, data: bytes) -> None:
    with live.plain() as end:
        try:
            end.sendall(data)
        except (BrokenPipeError, ConnectionResetError):
            pass
        until(lambda: counted(live.ports, Refusal.NOT_HTTP) == 1)
    assert live.asked("/tracker", "Host: localhost")[0] == 101


def test_frames_that_break_the_protocol_are_counted(live: Opened) -> None:
    with live.plain(request("/tracker", "Host: localhost", *UPGRADE)) as end:
        assert b"101 Switching" in end.recv(100)
        end.sendall(b"\xff\xff\xff\xff")
        until(lambda: counted(live.ports, Refusal.BROKEN_FRAMES) == 1)


def test_ten_thousand_datagrams_are_counted_and_others_are_read(strict: Opened) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as flood:
        for _ in range(10_000):
            flood.sendto(b"garbage", strict.udp)
    until(lambda: counted(strict.ports, Refusal.TOO_FAST, Peer.UDP) > 100)

    def arrives() -> bool:
        send(strict, GOOD.encode())
        return bool(strict.targets)

    until(arrives)
    assert strict.ports.refusals.counts.keys() == {(Refusal.TOO_FAST, Peer.UDP), (Refusal.WRONG_MAGIC, Peer.UDP)}


def test_a_websocket_that_floods_is_dropped_and_others_are_read(strict: Opened) -> None:
    with connect(strict.url()) as other, connect(strict.url()) as client:
        with pytest.raises(ConnectionClosed):
            for _ in range(10_000):
                client.send("garbage")
            while True:
                client.recv(LONG)
        assert counted(strict.ports, Refusal.FLOOD) == 1 and counted(strict.ports, Refusal.TOO_FAST) >= 45
        other.send(GOOD)
        until(lambda: strict.targets)
