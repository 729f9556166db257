"""The commands `avatarsim live` and `avatarsim replay`: exit codes, and refused input."""

import json
import socket
import webbrowser
from pathlib import Path

import pytest

from avatarsim.cli import main
from avatarsim.live.orders import World
from avatarsim.live.recording import Recorder
from tests.clips.made import robot
from tests.live.small import plan, pushed


def recording(folder: Path, wrong: int = 0) -> Path:
    """Return a recording of thirty frames; one of them, by its number, with another hash than was shown."""
    world = World(plan())
    recorder = Recorder(folder / "a.live", world.plan, world.shown.state_hash())
    for frame in range(1, 31):
        shown = world.advance(pushed(frame)).state_hash()
        recorder.frame(pushed(frame), "0" * 16 if frame == wrong else shown)
    recorder.close()
    return folder / "a.live"


@pytest.mark.parametrize(("wrong", "code"), [(0, 0), (7, 1)])
def test_a_recording_runs_again_up_to_its_first_difference(
    wrong: int, code: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = str(recording(tmp_path, wrong))
    assert main(["replay", path]) == code
    capsys.readouterr()
    assert main(["replay", path, "--json"]) == code
    result = json.loads(capsys.readouterr().out)
    assert result["is_same"] is (code == 0) and (result["frames"], result["commands"]) == (30, 0) and not result["other_versions"]
    assert (result["first_difference"] or {"frame": 0})["frame"] == wrong


def test_a_torn_recording_is_run_up_to_its_last_whole_row(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = recording(tmp_path)
    path.write_bytes(path.read_bytes()[:-5])
    assert main(["replay", str(path), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["frames"] == 29


def test_what_is_no_recording_ends_with_3(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "b.live").write_text("hello")
    for name in ("b.live", "none.live"):
        assert main(["replay", str(tmp_path / name)]) == 3
        assert name in capsys.readouterr().err


@pytest.mark.parametrize(("words", "code", "says"), [
    (["--room", "floor"], 2, "an option beside --avatar"), (["--rate", "0"], 2, "--rate is 0"), (["--rate", "nan"], 2, "--rate"),
    (["--seconds", "-1"], 2, "--seconds"), (["--avatar", "none.urdf"], 3, "none.urdf"),
    (["--motion", "a.bvh"], 3, "motion a.bvh"), (["--listen", "nowhere.invalid"], 2, "nowhere.invalid"),
    (["--scene", "hand", "--avatar", "a.urdf"], 2, "no option beside --avatar"),
    (["--port", "70000"], 2, "--port"),
])
def test_what_cannot_be_live_is_refused(words: list[str], code: int, says: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["live", "--no-browser", *words]) == code
    assert says in capsys.readouterr().err


def test_the_first_refusal_of_a_peer_is_a_line_on_stderr(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        one.bind(("127.0.0.1", 0))
        one.settimeout(60.0)
        place = free.getsockname()
        free.close()

        def opened(address: str) -> None:
            # the page is there, and the ports are open
            for _ in range(3):
                one.sendto(b'{"links": {"tail": {"position": [0, 0, 1]}}}', place)
            assert b"refused" in one.recv(1024)

        monkeypatch.setattr(webbrowser, "open", opened)
        words = ["--port", "0", "--seconds", "1", "--ws", "0", "--udp", str(place[1])]
        assert main(["live", "--avatar", str(robot(tmp_path)), "--room", "floor", *words]) == 0
        source = f"udp 127.0.0.1:{one.getsockname()[1]}"
    [line] = [line for line in capsys.readouterr().err.splitlines() if source in line]
    assert "'tail'" in line


def test_a_port_that_is_taken_ends_with_2(capsys: pytest.CaptureFixture[str]) -> None:
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = str(other.getsockname()[1])
        assert main(["live", "--no-browser", "--port", "0", "--seconds", "5", "--ws", port]) == 2
    assert port in capsys.readouterr().err
