"""Avatars read from their files: masses, axes, joints and limits of the humanoid; MJCF files as MuJoCo reads them."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray

from avatarsim.assets.motions.deepmimic import LAYOUT
from avatarsim.errors import InvalidFile, UnknownName
from avatarsim.scene.avatar import Avatar, Link
from avatarsim.scene.joint import Ball, Free, Hinges, Rigid
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, link_poses, rest
from avatarsim.spatial import rotation
from reference.judging.judge import Judge
from scenarios.building.avatars.humanoid import CHAINS, humanoid
from scenarios.building.avatars.limits import HINGES, RANGES, WIDEST_REACH, ball_limits, ends, hinge_limits, reach_cone, tilted
from scenarios.building.avatars.mjcf import Mjcf, parsed
from scenarios.building.avatars.mjcf_humanoid import hinged_humanoid
from scenarios.building.avatars.shadow_hand import shadow_hand
from scenarios.building.avatars.standing import CLEARANCE, standing
from scenarios.building.avatars.stl import corners
from scenarios.building.stage import floor
from scenarios.data_folder import data_file, robotics_assets
from scenarios.measure.posture.limits import beyond_cone

Array = NDArray[np.float64]
HUMAN = humanoid()
NAMES = [link.name for link in HUMAN.links]
HINGED = [link.name for link in HUMAN.links if isinstance(link.joint, Hinges)]


def turned(name: str, axis: tuple[float, float, float], degrees: float) -> TrackerSample:
    """Return the rest posture with one ball joint turned."""
    sample = rest((HUMAN,))
    rotations = sample.rotations.copy()
    rotations[NAMES.index(name)] = rotation.from_axis_angle(axis, np.radians(degrees))
    return replace(sample, rotations=rotations)


def place(sample: TrackerSample, name: str) -> Array:
    return np.asarray(link_poses((HUMAN,), sample)[0][NAMES.index(name)])


def angle(a: ArrayLike, b: ArrayLike) -> float:
    """Return the angle [rad] between two directions."""
    u, v = np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)
    return float(np.arctan2(np.linalg.norm(np.cross(u, v)), np.dot(u, v)))


def overlapping(sample: TrackerSample) -> set[frozenset[str]]:
    """Return the pairs of the avatar's own links that overlap."""
    verdict = Judge(Scene("alone", (), (HUMAN,))).overlaps(*link_poses((HUMAN,), sample))
    return {frozenset((a.removeprefix("human/"), b.removeprefix("human/"))) for a, b, _ in verdict.pairs}


def test_humanoid_has_15_links_45_kg_and_the_clips_joints() -> None:
    assert len(HUMAN.links) == 15 and set(CHAINS) <= set(NAMES)
    assert sum(link.mass.mass for link in HUMAN.links) == pytest.approx(45.0, abs=1e-9)
    assert set(NAMES) == {name for name, _ in LAYOUT} | {"left_wrist", "right_wrist"}
    kinds = {link.name: type(link.joint) for link in HUMAN.links}
    assert kinds["root"] is Free and kinds["left_wrist"] is kinds["right_wrist"] is Rigid
    for name, width in LAYOUT[1:]:
        assert kinds[name] is (Ball if width == 4 else Hinges)


def test_both_sides_mirror_each_other() -> None:
    for link in (link for link in HUMAN.links if link.name.startswith("left_")):
        other = HUMAN.links[NAMES.index(link.name.replace("left", "right"))]
        assert np.array(link.anchor) * (1.0, -1.0, 1.0) == pytest.approx(np.array(other.anchor), abs=1e-12)
        assert link.mass.mass == other.mass.mass


@pytest.mark.parametrize("side", ["left", "right"])
def test_elbows_fold_forwards_and_knees_backwards(side: str) -> None:
    sample = rest((HUMAN,))
    for hinge, tip, angle, sign in (("elbow", "wrist", 0.5, 1.0), ("knee", "ankle", -0.5, -1.0)):
        low, high = hinge_limits(f"{side}_{hinge}")
        assert low <= angle <= high
        angles = np.zeros(len(HINGED))
        angles[HINGED.index(f"{side}_{hinge}")] = angle
        moved = place(replace(sample, angles=angles), f"{side}_{tip}") - place(sample, f"{side}_{tip}")
        assert sign * moved[0] > 0.05
    # and a limb swings forward about -y
    swung = turned(f"{side}_hip", (0.0, -1.0, 0.0), 60.0)
    assert (place(swung, f"{side}_ankle") - place(sample, f"{side}_ankle"))[0] > 0.3


def test_nothing_overlaps_standing_or_with_all_joints_at_zero() -> None:
    start = standing(HUMAN)
    scene = Scene("standing", (floor(),), (HUMAN,), start=start)
    positions, orientations = link_poses((HUMAN,), start)
    body = scene.bodies[0]
    verdict = Judge(scene).overlaps(
        np.vstack([body.position, positions]), np.vstack([body.orientation, orientations]), 0.05
    )
    assert verdict.deepest == 0.0 and verdict.gap == pytest.approx(CLEARANCE, abs=1e-9)
    assert HUMAN.ignore == () and overlapping(rest((HUMAN,))) == set()
    # the judge does find a thigh in the other
    assert frozenset(("left_hip", "right_hip")) in overlapping(turned("left_hip", (1.0, 0.0, 0.0), -25.0))


@pytest.mark.parametrize("link", [link for link in HUMAN.links if isinstance(link.joint, Ball)], ids=lambda link: link.name)
def test_cone_holds_all_ends_of_motion_and_the_neutral_posture(link: Link) -> None:
    name = link.name
    limits = ball_limits(name)
    side, joint = (-1.0 if name.startswith("right") else 1.0), name.split("_")[-1]
    angles = [angle(limits.centre, end) for end in ends(RANGES[joint], side)]
    # one end lies on the rim: the cone is not larger than the table requires
    assert max(angles) == pytest.approx(limits.swing, abs=1e-12)
    assert angle(limits.centre, limits.axis) < limits.swing
    assert limits.twist[0] < 0.0 < limits.twist[1]


@pytest.mark.parametrize("joint", ["hip", "ankle", "shoulder"])
def test_left_and_right_limits_and_reach_cones_mirror_each_other(joint: str) -> None:
    left, right = ball_limits(f"left_{joint}"), ball_limits(f"right_{joint}")
    assert np.array(left.centre) * (1.0, -1.0, 1.0) == pytest.approx(np.array(right.centre))
    assert left.swing == right.swing and left.twist == pytest.approx((-right.twist[1], -right.twist[0]))
    mirrored = reach_cone(f"left_{joint}").vertices * (1.0, -1.0, 1.0)
    apart = np.abs(reach_cone(f"right_{joint}").vertices[:, None] - mirrored[None]).max(axis=2)
    assert apart.min(axis=1).max() < 1e-12


def test_hinge_limits_are_those_of_the_table() -> None:
    assert hinge_limits("right_knee") == pytest.approx(np.radians(HINGES["knee"]).tolist())
    for limits, link in ((hinge_limits, "neck"), (ball_limits, "left_knee"), (reach_cone, "left_knee")):
        with pytest.raises(UnknownName, match=link):
            limits(link)


@pytest.mark.parametrize("change", [
    lambda text: text[:5000],
    lambda text: text.replace("<capsule", "<cone"),
    lambda text: text.replace('type="spherical"', 'type="planar"'),
    lambda text: text.replace('<mass value = "14', '<mass weight = "14'),
    lambda text: text.replace("0.000000 0.944604", "0.944604"),
])
def test_a_broken_humanoid_file_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, change: Callable[[str], str]) -> None:
    broken = tmp_path / "broken.urdf"
    broken.write_text(change(data_file("humanoid/humanoid.urdf").read_text(encoding="utf-8")), encoding="utf-8")
    monkeypatch.setattr("scenarios.building.avatars.humanoid.data_file", lambda name: broken)
    with pytest.raises(InvalidFile, match=r"broken\.urdf"):
        humanoid.__wrapped__()


@pytest.mark.parametrize("name", ["left_hip", "right_hip", "left_ankle", "right_shoulder", "chest", "neck"])
def test_a_reach_cone_goes_through_the_four_ends_of_the_table(name: str) -> None:
    cone, side = reach_cone(name), -1.0 if name.startswith("right") else 1.0
    found = RANGES[name.removeprefix("left_").removeprefix("right_")]
    for end, degrees in zip(ends(found, side), (found.forward, found.backward, found.outward, found.inward), strict=True):
        if degrees <= WIDEST_REACH:
            assert np.abs(cone.vertices - end).max(axis=1).min() < 1e-12
    assert beyond_cone(cone, np.array([found.axis])) == 0.0
    # half-way between two ends an ellipse is nearer than both together
    both = tilted(found, side, found.forward / np.sqrt(2.0), -found.inward / np.sqrt(2.0))
    near, far = beyond_cone(cone, np.stack([both, tilted(found, side, found.forward, -found.inward)]))
    assert near < np.radians(2.0) < far


FILES = {
    "humanoid": (hinged_humanoid, lambda: data_file("mjcf/humanoid.xml"), "", "torso"),
    "hand": (shadow_hand, lambda: robotics_assets() / "hand" / "reach.xml", "robot0:", "forearm"),
}


@pytest.mark.parametrize("which", FILES)
def test_joints_are_where_mujoco_has_them_in_any_posture(which: str) -> None:
    make, file, prefix, root = FILES[which]
    avatar: Avatar = make()
    model = mujoco.MjModel.from_xml_path(str(file()))
    data = mujoco.MjData(model)
    hinges = [hinge for link in avatar.links if isinstance(link.joint, Hinges) for hinge in link.joint.hinges]
    assert len(hinges) == model.njnt == {"humanoid": 21, "hand": 24}[which]
    assert np.allclose([[hinge.lower, hinge.upper] for hinge in hinges], model.jnt_range, atol=1e-9)
    random, base = np.random.default_rng(3), rest((avatar,))
    for _ in range(20):
        angles = random.uniform(model.jnt_range[:, 0], model.jnt_range[:, 1])
        data.qpos[:] = angles
        mujoco.mj_kinematics(model, data)
        start = data.body(prefix + root)
        places, _ = link_poses((avatar,), TrackerSample(0.0, base.positions, base.rotations, angles))
        seen = {link.name: place for link, place in zip(avatar.links, places, strict=True)}
        frame = start.xmat.reshape(3, 3)
        for joint in range(model.njnt):
            body = model.body(model.jnt_bodyid[joint]).name.removeprefix(prefix)
            # of hinges with different centres in one body the last one is where the link's frame is
            if joint + 1 < model.njnt and model.jnt_bodyid[joint + 1] == model.jnt_bodyid[joint]:
                continue
            assert seen[body] == pytest.approx(frame.T @ (data.xanchor[joint] - start.xpos), abs=1e-6)


def test_masses_are_those_of_the_files() -> None:
    model = mujoco.MjModel.from_xml_path(str(data_file("mjcf/humanoid.xml")))
    bodies = sum(link.mass.mass for link in hinged_humanoid().links if link.name[-2:] != "_0")
    assert bodies == pytest.approx(float(model.body_mass.sum()), rel=1e-6)
    assert sum(link.mass.mass for link in shadow_hand().links) == pytest.approx(4.911, abs=1e-3)


def test_what_overlaps_at_rest_is_what_the_hand_ignores() -> None:
    hand = shadow_hand()
    bare = Avatar("hand", hand.links, hand.chains)
    verdict = Judge(Scene("bare", (), (bare,))).overlaps(*link_poses((bare,), rest((bare,))))
    found = {frozenset((a.split("/")[1], b.split("/")[1])) for a, b, _ in verdict.pairs}
    assert found == {frozenset(pair) for pair in hand.ignore}
    human = hinged_humanoid()
    assert Judge(Scene("human", (), (human,))).overlaps(*link_poses((human,), rest((human,)))).deepest == 0.0


@pytest.mark.parametrize(("body", "named"), [
    ('<body name="a"/>', "mass of body a"),
    ('<body name="a"><geom type="cylinder" size="1 1"/></body>', "cylinder"),
    ('<body name="a"><geom type="box" size="1 1"/></body>', "size of <geom"),
    ('<body name="a"><geom type="sphere" size="x"/></body>', "size of <geom"),
    ('<body name="a"><geom type="mesh" mesh="b"/></body>', "mesh of a geom"),
    ('<body name="a"><geom size="1"/><body name="b"><joint type="slide" range="0 1"/></body></body>', "slide"),
    ('<body name="a"><geom size="1"/><body name="b"><joint/><geom size="1"/></body></body>', "range of <joint"),
    ("<body>", "some.xml"),
])
def test_unknown_and_cut_off_files_are_refused(body: str, named: str, tmp_path: Path) -> None:
    path = tmp_path / "some.xml"
    path.write_text(f"<mujoco>{body}</mujoco>")
    with pytest.raises(InvalidFile, match=named):
        (root,) = parsed(path).findall("body")
        Mjcf(path, True, lambda geom: True, lambda body, volume: volume, {}).links(root)


def test_cut_off_meshes_are_refused(tmp_path: Path) -> None:
    whole = (robotics_assets() / "stls" / "hand" / "F1.stl").read_bytes()
    for content in (b"", whole[:-1], whole[:50]):
        (tmp_path / "some.stl").write_bytes(content)
        with pytest.raises(InvalidFile, match=r"some\.stl"):
            corners(tmp_path / "some.stl")
