"""Grips: a carried body that stays behind, slips in a turning hand or is squeezed aside, and a hand that sags too far."""

from dataclasses import replace

import numpy as np
import pytest

from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import simulated, solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Piece
from avatarsim.spatial import rotation
from runfiles.record import Array, Recording
from scenarios.building.expected import Carried, Pressed, Sag
from scenarios.measure.bodies.grips import carried, pressed, sags
from scenarios.measure.value import Missing, Values
from tests.scenarios.examples import DT, expecting, resting

FRAMES, BOX, HAND = 60, 0, 1
GRIPPED = 10
"""Frame from which on the hand rises by 1 cm per frame."""
CARRIED = Carried("box", ("hand",), GRIPPED * DT)


def scene() -> Scene:
    """Return a box next to a hand."""
    box, palm = (Piece(Box((0.1, 0.1, 0.1))),), (Piece(Box((0.02, 0.1, 0.1))),)
    return Scene("grip", (simulated("box", box, "wood", solid(box, 0.3), (0.06, 0.0, 0.05)),),
                 (rigid_avatar("hand", palm, solid(palm, 0.5)),))


def height() -> Array:
    return 0.01 * np.maximum(np.arange(FRAMES + 1) - GRIPPED, 0.0)


def lifted(share: float = 1.0, sag: float = 0.0) -> Recording:
    """Return a recording: the user rises, the hand follows `sag` lower, and the box rises by a `share` of the height."""
    recording = resting(scene(), FRAMES)
    recording.raw_positions[:, 0, 2] += height()
    recording.positions[:, HAND, 2] += height() - sag * (height() > 0.0)
    recording.positions[:, BOX, 2] += share * height()
    return recording


def of_grip(recording: Recording) -> Values:
    return carried(recording, expecting(FRAMES, carried=(CARRIED,)), scene())


@pytest.mark.parametrize("share", [1.0, 0.9, 0.0])
def test_what_a_carried_body_lacks_in_height_comes_out(share: float) -> None:
    found = of_grip(lifted(share))
    assert found["height_missing"] == pytest.approx((1.0 - share) * 0.5, abs=1e-12)
    assert found["grip_slip_max"] == pytest.approx((1.0 - share) * 0.5, abs=1e-12)


def test_a_sag_of_hand_and_body_is_height_and_no_slip() -> None:
    recording = lifted(sag=0.004)
    recording.positions[GRIPPED + 1 :, BOX, 2] -= 0.004
    found = of_grip(recording)
    assert found["height_missing"] == pytest.approx(0.004) and found["grip_slip_max"] == pytest.approx(0.0, abs=1e-12)


def test_body_that_turns_with_its_hand_does_not_slip() -> None:
    recording, angle = lifted(), np.linspace(0.0, 1.0, FRAMES + 1)
    turns = np.array([rotation.from_axis_angle((0.0, 0.0, 1.0), a) for a in angle])
    arm = recording.positions[:, BOX] - recording.positions[:, HAND]
    recording.orientations[:, HAND] = turns
    behind = of_grip(recording)["grip_slip_max"]
    # the chord of 0.06 m for the angle that the hand turned during the grip
    assert behind == pytest.approx(2.0 * 0.06 * np.sin(0.5 * (angle[-1] - angle[GRIPPED])))
    recording.positions[:, BOX] = recording.positions[:, HAND] + rotation.rotate(turns, arm)
    assert of_grip(recording)["grip_slip_max"] == pytest.approx(0.0, abs=1e-12)


def test_only_the_stated_time_counts() -> None:
    recording = lifted()
    recording.positions[: GRIPPED - 1, BOX, 0] += 0.5
    recording.positions[40:, BOX, 2] -= 0.5
    until = replace(CARRIED, until=39 * DT)
    found = carried(recording, expecting(FRAMES, carried=(until,)), scene())
    assert found["height_missing"] == pytest.approx(0.0, abs=1e-12) and found["grip_slip_max"] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("aside", [0.0, 2e-6, 0.24])
def test_only_ways_at_right_angles_to_gravity_are_sideways(aside: float) -> None:
    recording = resting(scene(), FRAMES)
    recording.positions[30:, BOX, 1] += aside
    recording.positions[30:, BOX, 2] -= 0.3
    found = pressed(recording, expecting(FRAMES, pressed=(Pressed("box", 0.2),)), scene())
    assert found["pressed_sideways_max"] == pytest.approx(aside, abs=1e-12)


@pytest.mark.parametrize("sag", [0.004, 0.0, 0.01])
def test_a_sag_is_compared_with_that_of_the_spring(sag: float) -> None:
    recording = lifted(sag=sag)
    found = sags(recording, expecting(FRAMES, sags=(Sag("hand", 0.004, (GRIPPED + 1) * DT),)), scene())
    assert found["sag_error_max"] == pytest.approx(abs(sag - 0.004), abs=1e-12)
    recording.positions[-1, HAND, 0] += 0.3
    found = sags(recording, expecting(FRAMES, sags=(Sag("hand", 0.004, (GRIPPED + 1) * DT),)), scene())
    assert found["sag_error_max"] == pytest.approx(np.hypot(0.3, sag - 0.004))


def test_what_is_no_number_stays_none() -> None:
    recording = lifted()
    recording.positions[-1] = np.nan
    everything = expecting(FRAMES, carried=(CARRIED,), pressed=(Pressed("box", 0.0),), sags=(Sag("hand", 0.0, 0.0),))
    found = {**carried(recording, everything, scene()), **pressed(recording, everything, scene()),
             **sags(recording, everything, scene())}
    assert len(found) == 4 and all(np.isnan(float(str(value))) for value in found.values())


def test_short_recording_says_so_and_no_grips_say_nothing() -> None:
    early = 2.0 * FRAMES * DT
    late = replace(CARRIED, since=early)
    everything = expecting(FRAMES, carried=(late,), pressed=(Pressed("box", early),), sags=(Sag("hand", 0.0, early),))
    for family in (carried, pressed, sags):
        found = family(lifted(), everything, scene())
        assert found and all(isinstance(value, Missing) and value.fault == "scene" for value in found.values())
        assert family(lifted(), expecting(FRAMES), scene()) == {}
