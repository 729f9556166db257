"""What the panel says."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.live.figures import Figures
from avatarsim.live.messages import State
from avatarsim.live.ports.refusals import Peer, Refusal, Refusals
from avatarsim.live.stages import stage
from avatarsim.live.view.depth import OwnOverlap
from avatarsim.live.view.telling import at_page, at_ports, depth, overlapping, sentence, table


def state(**other: object) -> State:
    """A state of which only the words count."""
    nothing = np.zeros((0, 3))
    said: dict[str, object] = {"statuses": {}, "is_paused": False, "is_logged": True} | other
    plain: dict[str, object] = {"counts": {}, "stage_ns": {}, "state_hash": ""}
    return State(1, 0.0, nothing, np.zeros((0, 4)), np.zeros(0), 0, -1, 0, False, 0, 0, **(plain | said))  # type: ignore[arg-type]


@pytest.mark.parametrize(("metres", "said"), [
    (0.0, "none"), (1e-6, "none"), (1.1e-6, "0.0011 mm"), (0.0123, "12.3 mm"), (float("nan"), "?"),
])
def test_depths_are_in_millimetres(metres: float, said: str) -> None:
    assert depth(metres) == said


def test_the_table_has_a_row_for_each_engine_and_for_the_user() -> None:
    figures = {"avatarsim": Figures(600, 123_456, 700_000, 1_500_000, 0.002), "mujoco/tuned": Figures(600, 5_000_000)}
    lines = table(figures, {"avatarsim": 0.0, "mujoco/tuned": 0.004}, 0.1).splitlines()
    assert lines[2] == "| avatarsim | 0.12 | 0.70 | 1.50 | 0.2% | none |" and "| 4 mm |" in lines[3]
    assert lines[4] == "| your own posture | | | | | 100 mm |" and "16.7 at 60 Hz, 11.1 at 90 Hz" in lines[-1]


def test_statuses_are_words() -> None:
    assert "follows freely" in sentence(state(), Figures())
    assert "looks for a way round" in sentence(state(statuses={"planning": 3}), Figures())
    assert "goal found late" in sentence(state(statuses={"goal_found_late": 1}), Figures())
    words = sentence(state(is_paused=True, is_logged=False), Figures(skipped=2, stages={"posture": 50_000, "motion": 0}))
    assert "Paused" in words and "2 frames left out" in words and "posture 50 us" in words and "motion" not in words
    assert "not saved" in words


@pytest.mark.parametrize("status", ["waiting", "goal_not_reached"])
def test_a_user_inside_something_is_told_what_to_pull_out(status: str) -> None:
    found = stage("hand").scene
    start, own, links = found.first_sample, OwnOverlap(found), found.names[len(found.bodies):]
    sunk = replace(start, positions=start.positions + (0.0, 0.0, 0.75 - 0.97))
    pair = own.pair(sunk)
    assert own.pair(start) is None and pair is not None and pair[0] == "table" and pair[1].startswith("hand/")
    words = sentence(state(statuses={status: 1}), Figures(), overlapping(("table", "hand/palm"), links))
    assert "palm" in words and "table" in words and "Reset" in words
    assert "table" not in sentence(state(), Figures(), overlapping(("table", "hand/palm"), links))


def test_one_who_waits_outside_is_told_what_to_do() -> None:
    assert "Reset" in sentence(state(statuses={"waiting": 1}), Figures())


def test_refusals_are_counted_by_reason_and_never_quoted() -> None:
    refusals = Refusals()
    assert at_ports(refusals) == "Messages of trackers: none. Refused: none."
    refusals.took(Peer.UDP)
    for reason in list(Refusal)[:6]:
        refusals.count(reason, Peer.UDP, "<script>")
    refusals.count(Refusal.FLOOD, Peer.WEBSOCKET)
    refusals.count(Refusal.FLOOD, Peer.WEBSOCKET)
    said = at_ports(refusals)
    assert said.startswith("Messages of trackers: 1 by UDP. Refused: 2 a peer dropped for flooding (WebSocket); 1 longer")
    assert said.endswith(" and 3 more reasons.") and "script" not in said


def test_connections_to_the_page_that_were_cut_are_said() -> None:
    refusals = Refusals()
    assert at_page(refusals) == ""
    refusals.count(Refusal.FOREIGN_ORIGIN, Peer.PAGE)
    assert at_page(refusals) == "Connections to this page refused: 1 an Origin header that is none of ours (page)."
