"""Shared intermediate results of the metrics of a scene: computed once, and again for input that differs by a bit."""

from dataclasses import replace

import numpy as np
import pytest

from runfiles.record import Recording
from scenarios.measure.known import Known
from scenarios.measure.posture.free import free_frames
from tests.scenarios.examples import fist, fist_scene, walked


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[Recording]:
    """Return the list of recordings whose free frames were computed, not taken from the cache."""
    found: list[Recording] = []

    def counted(recording: Recording, *rest: object) -> object:
        found.append(recording)
        return free_frames(recording, *rest)  # type: ignore[arg-type]

    monkeypatch.setattr("scenarios.measure.known.free_frames", counted)
    return found


def test_free_frames_are_those_of_the_measure_itself(asked: list[Recording]) -> None:
    recording, known = walked(30), Known(fist(), fist_scene())
    plain = free_frames(recording, fist(), fist_scene(), known.judge.link_depths)
    assert known.free(recording).tolist() == plain.tolist() and 0 < plain.sum() < len(plain)
    # another engine's links have no effect
    elsewhere = recording.positions.copy()
    elsewhere[:, recording.links] += 1.0
    assert known.free(replace(recording, positions=elsewhere)).tolist() == plain.tolist()
    assert len(asked) == 1


@pytest.mark.parametrize("field", ["raw_positions", "raw_orientations"])
def test_what_differs_by_a_bit_is_asked_again(field: str, asked: list[Recording]) -> None:
    recording, known = walked(30), Known(fist(), fist_scene())
    known.free(recording)
    other = getattr(recording, field).copy()
    other[-1, 0, 0] = np.nextafter(other[-1, 0, 0], 2.0)
    known.free(replace(recording, **{field: other}))
    assert len(asked) == 2


def test_contact_is_of_the_postures_shown(asked: list[Recording]) -> None:
    recording, known = walked(30), Known(fist(), fist_scene())
    first = known.contact(recording)
    # a target in the wall puts the avatar in contact for any shown posture; before that only a shown posture near the wall does
    far = recording.positions.copy()
    far[:, recording.links] -= 0.5
    away = known.contact(replace(recording, positions=far))
    assert known.contact(recording).tolist() == first.tolist() and len(asked) == 1
    assert away.tolist() == (~known.free(recording)).tolist() and away.sum() < first.sum()
