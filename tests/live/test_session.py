"""Sessions: loops in processes of their own, their states and commands, and the death of one."""

import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from avatarsim.engine import Settings
from avatarsim.errors import InvalidFile, InvalidInput, InvalidSample
from avatarsim.live.drive.driver import Driver
from avatarsim.live.messages import Order, Plan, State, Switch
from avatarsim.live.recording import ENGINE, read
from avatarsim.live.replaying import replay
from avatarsim.live.session import LoopDied, LoopRefused, Session
from avatarsim.live.stages import stage
from avatarsim.scene.tracker import rest
from avatarsim.spatial import rotation
from avatarsim.tolerances import JUDGED
from reference.judging.judge import Judge
from tests.live.small import RATE, plan, pushed

PATIENCE = 60.0
"""[s] after which a silent loop is a failure of the test."""


@pytest.fixture(scope="module")
def session() -> Iterator[Session]:
    """Yield one session of two loops; the last test of this file ends them."""
    with Session([plan(), replace(plan(), name="other")]) as one:
        yield one


def until(session: Session, frames: int, name: str = "avatarsim") -> State:
    """Return the state of a loop after so many further frames."""
    end, first = time.monotonic() + PATIENCE, None
    while time.monotonic() < end:
        state = session.look().get(name)
        if state is not None:
            first = state.frame if first is None else first
            if state.frame >= first + frames:
                return state
        time.sleep(0.005)
    raise AssertionError(f"{name} does not go on")


def test_all_loops_follow_the_same_targets(session: Session) -> None:
    session.command(Order.RESET)
    for frame in range(40):
        session.send(pushed(frame))
        until(session, 1)
    states = until(session, 5), until(session, 5, "other")
    for state in states:
        assert state.positions[2][2] < 0.2 and state.target > 0 and not state.is_paused
    np.testing.assert_allclose(states[0].positions, states[1].positions, atol=0.05)
    figures = session.first.window.figures()
    assert figures.frames > 0 and figures.worst >= figures.p99 >= figures.p50 > 0 and figures.latency_p99 > 0


def test_quaternions_that_are_shown_keep_their_side(session: Session) -> None:
    session.command(Order.RESET)
    shown = []
    for frame in range(40):
        turn = rotation.from_axis_angle(np.array([0.0, 0.0, 1.0]), np.array(0.3 * frame))
        session.send(replace(pushed(0), rotations=np.stack([turn, pushed(0).rotations[1]])))
        shown.append(until(session, 1).orientations)
    turns = np.array(shown)
    assert ((turns[1:] * turns[:-1]).sum(axis=-1) > 0.0).all() and (turns[:, 2, 0] < -0.5).any()


def test_a_target_that_fits_no_avatar_is_refused_at_the_door(session: Session) -> None:
    for bad in (replace(pushed(0), angles=np.zeros(3)), replace(pushed(0), positions=np.full((2, 3), np.nan)), rest(())):
        with pytest.raises(InvalidSample):
            session.send(bad)
    until(session, 3)


def test_a_pause_holds_and_a_step_is_one_frame(session: Session) -> None:
    session.command(Order.PAUSE)
    time.sleep(0.1)
    held = session.first.look()
    time.sleep(0.1)
    again = session.first.look()
    assert held is not None and again is not None and again.frame == held.frame
    session.command(Order.STEP)
    end = time.monotonic() + PATIENCE
    while (one := session.first.look()) is not None and one.frame == held.frame and time.monotonic() < end:
        time.sleep(0.01)
    assert one is not None and one.frame == held.frame + 1
    session.command(Order.GO_ON)
    until(session, 3)


def test_refusals_are_sentences_and_the_loop_goes_on(session: Session) -> None:
    answers = session.command(Order.SWITCH, Switch(("nothing",)))
    assert "effect is 'nothing'" in answers["avatarsim"].refused and answers["other"].refused
    until(session, 3)


def test_what_was_driven_is_saved_and_runs_again(session: Session, tmp_path: Path) -> None:
    session.command(Order.RESET)
    for frame in range(30):
        session.send(pushed(2 * frame))
        until(session, 1)
        if frame == 10:
            assert not session.command(Order.KEEP)["avatarsim"].refused
        if frame == 15:
            assert not session.command(Order.SWITCH, Switch(("friction",), "paper"))["avatarsim"].refused
        if frame == 25:
            assert not session.command(Order.SWITCH, Switch())["avatarsim"].refused
    session.save(tmp_path / "a.live")
    found = read(tmp_path / "a.live")
    assert found.frames >= 30 and not found.is_torn
    assert replay(found).difference is None
    assert [path.name for path in tmp_path.iterdir()] == ["a.live"]


def test_a_place_that_takes_no_file_is_named(session: Session, tmp_path: Path) -> None:
    (tmp_path / "a.live").write_text("mine")
    with pytest.raises(InvalidFile, match="a place that takes a file"):
        session.save(tmp_path / "a.live" / "b.live")
    assert (tmp_path / "a.live").read_text() == "mine"


def test_a_loop_that_cannot_begin_says_why() -> None:
    nowhere = replace(plan(), engine="nowhere:Engine")
    with pytest.raises(LoopRefused, match="avatarsim could not begin: .*'nowhere:Engine'"), Session([nowhere]):
        pass
    with pytest.raises(LoopRefused, match="could not begin: preset"), Session([plan(preset="other")]):
        pass


def test_sessions_without_plans_or_with_a_name_twice_are_refused() -> None:
    for plans in ([], [plan(), plan()]):
        with pytest.raises(InvalidInput, match="plans of a session"):
            Session(plans)


def test_a_mug_in_the_house_is_dragged_to_taken_and_lifted() -> None:
    scene, (hand, mug) = stage("house").scene, ("human/right_hand", "mug")
    driver, at, end = Driver(scene), scene.names.index(mug), time.monotonic() + PATIENCE
    with Session([Plan(ENGINE, scene, Settings(), RATE)]) as one:
        first = until(one, 1).positions[at]

        def pull(place: np.ndarray, is_there: Callable[[State], bool]) -> State:
            """Drag the hand to a place until a condition is met."""
            driver.drag(hand, place)
            while not is_there(state := until(one, 1)) and time.monotonic() < end:
                one.send(driver.tick(1.0 / RATE))
            return state

        wrist = scene.names.index(hand)
        pull(first + (-0.08, 0.0, 0.05), lambda state: float(np.linalg.norm(state.positions[wrist] - first)) < 0.11)
        while one.command(Order.TAKE)["avatarsim"].text != "took mug" and time.monotonic() < end:
            one.send(driver.tick(1.0 / RATE))
        lifted = pull(first + (-0.2, 0.05, 0.4), lambda state: bool(state.positions[at][2] > first[2] + 0.3))
        assert lifted.positions[at][2] > first[2] + 0.3
        shown = one.first.window.states()
    poses = (np.array([getattr(state, name) for state in shown]) for name in ("positions", "orientations"))
    assert Judge(scene).depths(*poses).max() <= JUDGED


def test_a_dead_loop_is_left_out_and_the_driven_one_ends_all(session: Session) -> None:
    session.loops["other"]._process.kill()
    end = time.monotonic() + PATIENCE
    while "other" in session.loops and time.monotonic() < end:
        session.look()
        time.sleep(0.01)
    assert list(session.loops) == ["avatarsim"]
    until(session, 2)
    session.first._process.kill()
    with pytest.raises(LoopDied, match="avatarsim was killed by signal 9"):
        until(session, 10**6)
