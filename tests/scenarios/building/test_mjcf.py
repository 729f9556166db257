"""Avatars from MJCF: the same tree as MuJoCo's own reader makes of the file, in every posture; damaged files are refused."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

from avatarsim.errors import InvalidFile, MissingPackage
from avatarsim.scene.avatar import Avatar
from avatarsim.scene.joint import Hinges
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample, link_poses, rest
from reference.judging.judge import Judge
from scenarios import data_folder
from scenarios.building.avatars import shadow_hand as hand_file
from scenarios.building.avatars.mjcf import Mjcf, parsed
from scenarios.building.avatars.mjcf_humanoid import hinged_humanoid
from scenarios.building.avatars.shadow_hand import shadow_hand
from scenarios.building.avatars.stl import corners
from scenarios.data_folder import data_file, robotics_assets

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


def test_every_link_of_the_hand_has_a_shape_and_no_hull_is_large() -> None:
    assert all(link.pieces for link in shadow_hand().links)
    assert max(len(vertices) for link in shadow_hand().links for piece in link.pieces
               if (vertices := getattr(piece.shape, "vertices", None)) is not None) <= 64


def test_the_hand_needs_its_package(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(data_folder, "find_spec", lambda name: None)
    with pytest.raises(MissingPackage, match=r"gymnasium-robotics.*pip install .*\[hand\]"):
        hand_file.robotics_assets()


@pytest.mark.parametrize(("body", "said"), [
    ('<body name="a"/>', "mass of body a"),
    ('<body name="a"><geom type="cylinder" size="1 1"/></body>', "cylinder"),
    ('<body name="a"><geom type="box" size="1 1"/></body>', "size of <geom"),
    ('<body name="a"><geom type="sphere" size="x"/></body>', "size of <geom"),
    ('<body name="a"><geom type="mesh" mesh="b"/></body>', "mesh of a geom"),
    ('<body name="a"><geom size="1"/><body name="b"><joint type="slide" range="0 1"/></body></body>', "slide"),
    ('<body name="a"><geom size="1"/><body name="b"><joint/><geom size="1"/></body></body>', "range of <joint"),
])
def test_what_the_reader_does_not_know_is_refused(body: str, said: str, tmp_path: Path) -> None:
    path = tmp_path / "some.xml"
    path.write_text(f"<mujoco>{body}</mujoco>")
    root = parsed(path).find("body")
    assert root is not None
    with pytest.raises(InvalidFile, match=said):
        Mjcf(path, True, lambda geom: True, lambda body, volume: volume, {}).links(root)


def test_cut_off_files_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "some.xml"
    path.write_text("<mujoco><body>")
    with pytest.raises(InvalidFile, match=r"some\.xml"):
        parsed(path)
    whole = (robotics_assets() / "stls" / "hand" / "F1.stl").read_bytes()
    for content in (b"", whole[:-1], whole[:50]):
        mesh = tmp_path / "some.stl"
        mesh.write_bytes(content)
        with pytest.raises(InvalidFile, match=r"some\.stl"):
            corners(mesh)
