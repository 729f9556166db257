"""What is foreseen of a trial is what certificates of that trial would say, and the row is the one that they would ask for."""

import numpy as np
import pytest

from avatarsim.collide.support import support
from avatarsim.posture.certify import certify
from avatarsim.posture.contact_row import list_pair, rows_of_listed, support_row
from avatarsim.posture.foreseen import farthest_of, foresee
from avatarsim.posture.kinematics import carry, forward
from avatarsim.posture.workspace import ADDING, COUNT
from avatarsim.scene.avatar import rigid_avatar
from avatarsim.scene.body import fixed
from avatarsim.scene.mass import solid
from avatarsim.scene.scene import Scene
from avatarsim.scene.shape import Box, Ellipsoid, Piece
from avatarsim.scene.tracker import rest
from tests.posture.little_worlds import SETTINGS, Little, little, mixed_avatar, random_sample

pytestmark = [pytest.mark.nojit, pytest.mark.boundscheck]
WALL, FOOT = 0, 1
TURN = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.1])


def foot_before_wall(width: float = 4.0) -> Little:
    """A cube of 0.1 m, listed as 1 mm before the face of a wall, with the row of that pair."""
    pieces = (Piece(Box((0.1, 0.1, 0.1))),)
    wall = fixed("wall", (Piece(Box((0.1, width, 1.0))),), "wood", (0.101, 0.0, 0.0))
    found = little(Scene("s", (wall,), (rigid_avatar("foot", pieces, solid(pieces, 0.5)),)))
    geo, skel, _, poses = found.parts
    list_pair(FOOT, WALL, FOOT, found.memory)
    rows_of_listed(geo, skel, poses, SETTINGS, found.memory)
    return found


def ask(found: Little, step: np.ndarray, asked: bool = True) -> bool:
    """`foresee` of a step."""
    geo, skel, posture, poses = found.parts
    found.memory.rows.x[:] = step
    return bool(foresee(geo, skel, posture, poses, SETTINGS, asked, found.memory))


@pytest.mark.parametrize("seed", range(4))
def test_the_farthest_point_is_that_of_the_vertices_that_were_not_carried(seed: int) -> None:
    avatar = mixed_avatar()
    pieces = (Piece(Ellipsoid((0.1, 0.2, 0.3)), (0.1, 0.0, 0.0)),)
    egg = rigid_avatar("egg", pieces, solid(pieces, 1.0))
    found = little(Scene("s", (), (avatar, egg), start=random_sample((avatar, egg), seed)))
    geo, skel, posture, _ = found.parts
    rng = np.random.default_rng(seed)
    step, trial = 0.3 * rng.normal(size=len(found.memory.rows.x)), found.memory.trial
    for piece in range(len(geo.body)):
        d = tuple(float(v) for v in rng.normal(size=3))
        carry(skel, posture, step, trial, found.memory.trial_axes)
        point = farthest_of(geo, trial, piece, d)
        forward(geo, skel, posture, step, trial, found.memory.trial_axes)
        twin, _ = support(trial.vertices, geo.shapes, piece, d)
        assert np.dot(point, d) == pytest.approx(np.dot(twin, d), abs=1e-12)


@pytest.mark.parametrize("seed", range(20))
def test_it_is_refused_where_its_certificate_would_refuse_it(seed: int) -> None:
    found = foot_before_wall()
    geo, skel, posture, poses = found.parts
    step = np.random.default_rng(seed).normal(size=6) * (3e-4, 0.01, 0.01, 0.01, 0.01, 0.01)
    said = ask(found, step)
    found.memory.flags[ADDING] = 0.0
    forward(geo, skel, posture, step, found.memory.trial, found.memory.trial_axes)
    assert said == (certify(geo, skel, poses, SETTINGS, found.memory) > 0)


def test_both_answers_are_asked_for() -> None:
    assert {ask(foot_before_wall(), share * TURN) for share in (0.0, 0.1, 1.0)} == {False, True}


def test_the_row_is_that_of_the_corner_at_the_trial() -> None:
    found = foot_before_wall()
    geo, skel, posture, _ = found.parts
    rows = found.memory.rows
    assert ask(found, TURN) and rows.size[COUNT] == 2
    foreseen, bound = rows.jacobian[1].copy(), rows.bound[1]
    rows.size[COUNT] = 1
    forward(geo, skel, posture, TURN, found.memory.trial, found.memory.trial_axes)
    support_row(geo, skel, FOOT, WALL, (-1.0, 0.0, 0.0), SETTINGS.stand_off, found.memory)
    assert rows.pair[1].tolist() == [FOOT, WALL]
    assert foreseen == pytest.approx(rows.jacobian[1], abs=1e-12) and bound == pytest.approx(rows.bound[1], abs=1e-12)


def test_beyond_the_edge_nothing_is_in_the_way() -> None:
    found = foot_before_wall(width=0.02)
    assert not ask(found, TURN) and found.memory.rows.size[COUNT] == 1


def test_where_no_row_is_wanted_links_are_carried_all_the_same() -> None:
    found = foot_before_wall()
    assert not ask(found, TURN, asked=False) and found.memory.rows.size[COUNT] == 1
    carried = found.memory.trial.position.copy(), found.memory.trial.rotation.copy()
    geo, skel, posture, _ = found.parts
    forward(geo, skel, posture, TURN, found.memory.trial, found.memory.trial_axes)
    assert (carried[0] == found.memory.trial.position).all() and (carried[1] == found.memory.trial.rotation).all()


def test_between_links_nothing_is_foreseen() -> None:
    pieces = (Piece(Box((0.1, 0.1, 0.1))),)
    avatars = tuple(rigid_avatar(name, pieces, solid(pieces, 0.5)) for name in ("left", "right"))
    start = rest(avatars)
    start.positions[1] = 0.101, 0.0, 0.0
    found = little(Scene("s", (), avatars, start=start))
    geo, skel, _, poses = found.parts
    list_pair(0, 1, 0, found.memory)
    rows_of_listed(geo, skel, poses, SETTINGS, found.memory)
    assert found.memory.rows.size[COUNT] == 1
    assert not ask(found, np.append(TURN, np.zeros(6))) and found.memory.rows.size[COUNT] == 1
