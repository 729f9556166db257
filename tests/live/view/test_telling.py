"""The panel: how deep the user's own posture is in something, and counts of refusals that quote no message."""

from dataclasses import replace

from avatarsim.live.ports.refusals import Peer, Refusal, Refusals
from avatarsim.live.stages import stage
from avatarsim.live.view.depth import OwnOverlap
from avatarsim.live.view.telling import at_ports


def test_a_user_inside_something_has_a_pair_and_one_outside_has_none() -> None:
    found = stage("hand").scene
    start, own = found.first_sample, OwnOverlap(found)
    pair = own.pair(replace(start, positions=start.positions + (0.0, 0.0, 0.75 - 0.97)))
    assert own.pair(start) is None and pair is not None and pair[0] == "table" and pair[1].startswith("hand/")


def test_refusals_are_counted_and_never_quoted() -> None:
    refusals = Refusals()
    for reason in list(Refusal)[:6]:
        refusals.count(reason, Peer.UDP, "<script>")
    assert "script" not in at_ports(refusals) and refusals.counts == {(reason, Peer.UDP): 1 for reason in list(Refusal)[:6]}
