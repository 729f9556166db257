"""Admission of requests, and the number of messages of a peer that are read in a second."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from avatarsim.errors import InvalidInput
from avatarsim.live.ports.admission import SECOND, Limits, Pace, Window, as_address, host_of, judged
from avatarsim.live.ports.refusals import Refusal


@pytest.mark.parametrize("host", ["127.0.0.1", "127.0.0.1:8080", "localhost:1", "LOCALHOST", "[::1]", "[::1]:8080"])
@pytest.mark.parametrize("origin", [None, "http://localhost:8000", "http://127.0.0.1", "https://[::1]:3"])
def test_loopback_is_ours(host: str, origin: str | None) -> None:
    assert judged([host], [] if origin is None else [origin], "127.0.0.1") is None


@pytest.mark.parametrize(
    "hosts",
    [
        [], [""], ["127.0.0.1", "127.0.0.1"], ["evil.example"], ["evil.example:8080"], ["127.0.0.1.evil.example"], ["localhost."],
        ["127.0.0.1@evil.example"], ["evil.example@127.0.0.1"], ["127.0.0.1/"], ["127.0.0.1:x"], [" 127.0.0.1"], ["127.0.0.1 "],
        ["192.168.0.9"], ["[::1"], ["127.0.0.1:99999999"],
    ],
)
def test_a_foreign_host_is_refused(hosts: list[str]) -> None:
    assert judged(hosts, [], "127.0.0.1") is Refusal.FOREIGN_HOST


@pytest.mark.parametrize(
    "origins",
    [
        ["null"], [""], ["http://evil.example"], ["http://localhost.evil.example"], ["http://localhost", "http://localhost"],
        ["file://"], ["http://localhost@evil.example"], ["ftp://localhost"], ["http://localhost/path"], ["http://192.168.0.9"],
        ["localhost"],
    ],
)
def test_a_foreign_origin_is_refused(origins: list[str]) -> None:
    assert judged(["127.0.0.1"], origins, "127.0.0.1") is Refusal.FOREIGN_ORIGIN


def test_beyond_loopback_own_address_and_allowed_names_are_ours() -> None:
    assert judged(["192.168.0.9:80"], ["http://192.168.0.9:80"], "192.168.0.9") is None
    assert judged(["headset.local"], [], "192.168.0.9") is Refusal.FOREIGN_HOST
    assert judged(["Headset.local:1"], ["http://headset.LOCAL:1"], "192.168.0.9", ["headset.local"]) is None


@given(st.text(max_size=40))
def test_any_header_is_judged(text: str) -> None:
    host = host_of(text)
    assert host == host.lower() and "@" not in host
    assert judged([text], [text], "127.0.0.1") in (None, Refusal.FOREIGN_HOST, Refusal.FOREIGN_ORIGIN)


def test_a_peer_is_read_at_its_pace_in_every_second() -> None:
    window = Window(Limits(per_second=2, flood=4))
    assert [window.admit(k) for k in range(5)] == [Pace.READ, Pace.READ, Pace.TOO_FAST, Pace.TOO_FAST, Pace.FLOOD]
    assert window.admit(SECOND) is Pace.READ


def test_an_address_is_numbers() -> None:
    assert as_address("localhost") == "127.0.0.1" and as_address("::1") == "::1" and as_address("0.0.0.0") == "0.0.0.0"
    for words in ("example.com", "", "127.0.0.1:80", "all"):
        with pytest.raises(InvalidInput, match="address to listen at"):
            as_address(words)


def test_limits_are_above_zero() -> None:
    with pytest.raises(InvalidInput, match="patience"):
        Limits(patience=0.0)
