"""Detection of legs, arms and fingers."""

import numpy as np
import pytest

from avatarsim.assets.models.from_skeleton import human
from avatarsim.assets.models.smpl_skeleton import approximate
from avatarsim.live.drive.limbs import Limbs, closing, fingers_of, handle_links, limbs_of
from avatarsim.live.drive.tree import Tree, posture_of
from avatarsim.live.stages import stage
from avatarsim.scene.avatar import Avatar, Link, rigid_avatar
from avatarsim.scene.body import solid
from avatarsim.scene.joint import Ball, Free
from avatarsim.scene.motion import Motion
from avatarsim.scene.shape import Piece, Sphere
from avatarsim.scene.tracker import rest

PIECES = (Piece(Sphere(0.05)),)
MASS = solid(PIECES, 1.0)


def row(*names: str, z: float, y: float) -> list[Link]:
    """Return links attached to a root called "middle", one below the other."""
    parents = zip(names, ("middle", *names[:-1]), strict=True)
    return [
        Link(name, parent, Ball(), PIECES, MASS, anchor=(0.0, y, 0.0) if parent == "middle" else (0.0, 0.0, z))
        for name, parent in parents
    ]


def limbs(*links: Link) -> tuple[Tree, Limbs]:
    """Return the tree and limbs of an avatar of these links and a free root."""
    avatar = Avatar("one", (Link("middle", None, Free(), PIECES, MASS), *links))
    tree = Tree((avatar,))
    return tree, limbs_of(tree, posture_of(rest((avatar,))))


def test_a_human_has_legs_and_arms_and_no_fingers() -> None:
    scene = stage("gallery").scene
    tree = Tree(scene.avatars)
    found = limbs_of(tree, posture_of(scene.first_sample))
    assert [tree.nodes[leg.tip].name for leg in found.legs] == ["left_foot", "right_foot"]
    assert [tree.nodes[arm.tip].name for arm in found.arms] == ["left_hand", "right_hand"]
    assert fingers_of(tree) == ()


def test_a_hand_has_five_fingers_that_close_and_no_limbs() -> None:
    scene = stage("hand").scene
    tree = Tree(scene.avatars)
    assert limbs_of(tree, posture_of(scene.first_sample)) == Limbs()
    fingers = fingers_of(tree)
    assert [tree.nodes[finger.links[0]].name for finger in fingers] == ["thumb1", "index1", "middle1", "ring1", "little1"]
    # three joints bend in each finger; the spreading joints are unchanged
    assert len(closing(tree, fingers)) == 15
    assert all(closed > 0.0 for _, _, closed in closing(tree, fingers))


@pytest.mark.parametrize(("left", "right"), [
    (("lfemur", "ltibia", "lfoot"), ("rfemur", "rtibia", "rfoot")),
    (("LeftUpLeg", "LeftLeg", "LeftFoot"), ("RightUpLeg", "RightLeg", "RightFoot")),
    (("thigh.L", "shin.L", "foot.L"), ("thigh.R", "shin.R", "foot.R")),
])
def test_sides_are_told_by_words_and_by_letters(left: tuple[str, ...], right: tuple[str, ...]) -> None:
    tree, found = limbs(*row(*left, z=-0.4, y=0.1), *row(*right, z=-0.4, y=-0.1))
    assert [tree.nodes[leg.tip].name for leg in found.legs] == [left[-1], right[-1]]
    assert found.arms == ()


def test_fingers_are_no_legs_and_hands_have_handles() -> None:
    # little and ring finger, whose names mirror each other, below a palm
    digits = [row(f"{name}1", f"{name}2", f"{name}3", z=-0.03, y=0.02 * k) for k, name in enumerate(("lf", "rf", "mf"))]
    tree, found = limbs(*(link for digit in digits for link in digit))
    assert found == Limbs()
    assert [tree.nodes[k].name for k in handle_links(tree)] == ["middle", "lf3", "rf3", "mf3"]
    skeleton = approximate("SMPL-H")[0]
    still = Motion(np.zeros(1), *(array[None] for array in skeleton.still))
    avatar = human(skeleton, 1.7, still).avatar
    assert avatar is not None
    whole = Tree((avatar,))
    names = [whole.nodes[k].name for k in handle_links(whole)]
    assert names == ["pelvis", "left_foot", "right_foot", "head", "left_wrist", "right_wrist"]
    both = limbs_of(whole, posture_of(rest((avatar,))))
    assert [whole.nodes[limb.tip].name for limb in (*both.legs, *both.arms)] == [
        "left_foot", "right_foot", "left_wrist", "right_wrist"]


def test_limbs_above_the_root_are_arms_and_names_alone_make_none() -> None:
    _, up = limbs(*row("left_a", "left_b", "left_c", z=0.3, y=0.1), *row("right_a", "right_b", "right_c", z=0.3, y=-0.1))
    assert up.legs == () and len(up.arms) == 2
    _, none = limbs(*row("a", "b", "c", z=-0.3, y=0.1), *row("d", "e", "f", z=-0.3, y=-0.1))
    assert none == Limbs()


def test_handles_are_roots_and_ends() -> None:
    scene = stage("gallery").scene
    tree = Tree(scene.avatars)
    names = [tree.nodes[k].name for k in handle_links(tree)]
    assert names == ["pelvis", "left_foot", "right_foot", "head", "left_hand", "right_hand"]
    assert handle_links(Tree((rigid_avatar("stick", PIECES, MASS),))) == (0,)
