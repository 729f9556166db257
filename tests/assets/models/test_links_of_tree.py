"""Trees of bodies as links: positions, joints, ranges, and bodies that are refused or fixed instead."""

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest

import avatarsim as av
from avatarsim.errors import InvalidFile, InvalidInput, UnknownName
from avatarsim.scene.joint import LONGEST_SLIDE, MANY_TURNS, Ball, Free, Hinge, Hinges, Rigid, Slide, axes_of
from avatarsim.spatial import rotation
from tests.assets.models.mujoco_twin import Twin, greatest_difference
from tests.assets.motions.robots import driven

GEOM = '<geom type="sphere" size="0.02"/>'


def written(folder: Path, body: str, rest: str = "", head: str = '<compiler angle="radian"/>') -> Path:
    """Return an MJCF file with one world."""
    path = folder / "model.xml"
    path.write_text(f"<mujoco>{head}<worldbody>{body}</worldbody>{rest}</mujoco>", encoding="utf-8")
    return path


def random_tree(rng: np.random.Generator, depth: int = 0) -> str:
    """Return a body with joints about centres of their own, and bodies below it."""
    def numbers(count: int) -> str:
        return " ".join(f"{value:.17g}" for value in rng.normal(size=count))

    joints = ""
    if depth == 0 and rng.random() < 0.5:
        joints = "<freejoint/>"
    elif rng.random() < 0.2:
        joints = f'<joint type="ball" pos="{numbers(3)}"/>'
    else:
        shared = numbers(3)
        for _ in range(rng.integers(0, 6)):
            place = shared if rng.random() < 0.6 else numbers(3)
            kind = "slide" if rng.random() < 0.3 else "hinge"
            turn = f'type="{kind}" axis="{numbers(3)}" ref="{rng.uniform(-1, 1)}" range="-3 3" limited="true"'
            joints += f'<joint pos="{place}" {turn} armature="1"/>'
    below = "".join(random_tree(rng, depth + 1) for _ in range(rng.integers(0, 3) if depth < 4 else 0))
    return f'<body pos="{numbers(3)}" quat="{numbers(4)}">{joints}{GEOM}{below}</body>'


@pytest.mark.parametrize("seed", range(6))
def test_random_trees_are_where_mujoco_has_them(seed: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed)
    body = random_tree(rng)
    while body.count("<joint") < 8:
        body = random_tree(rng)
    path = written(tmp_path, body)
    model = driven(av.load_avatar(path, size_range=(0.0, 1e3)))
    assert greatest_difference(Twin(path), model, 10, seed) <= 1e-12


def test_hinges_about_one_centre_are_one_joint(tmp_path: Path) -> None:
    joint = '<joint pos="0 0 {}" axis="{}"/>'
    axes = ("1 0 0", "0 1 0", "0 0 1", "1 1 0")
    joints = "".join(joint.format(z, axis) for z, axis in zip((0.1, 0.1, 0.1, 0.3), axes, strict=True))
    model = driven(av.load_avatar(written(tmp_path, f'<body name="arm">{joints}{GEOM}</body>')))
    first, arm = model.avatar.links
    assert isinstance(first.joint, Hinges) and isinstance(arm.joint, Hinges)
    assert (len(first.joint.hinges), len(arm.joint.hinges)) == (3, 1)
    assert not first.pieces and arm.name == "arm" and arm.parent == first.name
    np.testing.assert_allclose(arm.pieces[0].position, (0.0, 0.0, -0.3), atol=1e-15)


def test_limits_count_from_the_reference(tmp_path: Path) -> None:
    joints = '<joint name="a" axis="1 0 0" range="0.5 2" ref="1"/><joint name="b" axis="0 1 0"/>'
    model = driven(av.load_avatar(written(tmp_path, f"<body>{joints}{GEOM}</body>")))
    joint = model.avatar.links[0].joint
    assert isinstance(joint, Hinges)
    assert [(hinge.lower, hinge.upper) for hinge in joint.hinges] == [(-0.5, 1.0), (-MANY_TURNS, MANY_TURNS)]
    motion = model.coordinates.motion(np.array([[1.0, 0.0], [2.0, 0.3]]), np.arange(2.0))
    np.testing.assert_allclose(motion.angles, [[0.0, 0.0], [1.0, 0.3]])
    assert model.coordinates.names == ("a", "b")


@pytest.mark.parametrize("widest", [0.3, 1.0, 2.5, 3.1])
def test_a_ball_stays_within_mujocos_angle_and_reaches_it(widest: float, tmp_path: Path) -> None:
    geom = '<geom type="sphere" size="0.02" pos="0.1 0.2 0"/>'
    body = f'<body quat="0.5 0.5 0.5 0.5"><joint type="ball" range="0 {widest}"/>{geom}</body>'
    model = driven(av.load_avatar(written(tmp_path, body)))
    joint = model.avatar.links[0].joint
    assert isinstance(joint, Ball) and joint.limits is not None
    swing, twist = joint.limits.swing, joint.limits.twist[1]
    cosine = np.cos(0.5 * swing) * np.cos(0.5 * twist)
    whole = 2.0 * np.arctan2(np.sqrt(1.0 - cosine * cosine), cosine)
    assert widest - 0.2 < whole <= widest + 1e-12
    # at rest the limb points to the middle of its cone
    limb = rotation.rotate(model.avatar.links[0].orientation, joint.limits.axis)
    np.testing.assert_allclose(joint.limits.centre, limb, atol=1e-12)


@pytest.mark.parametrize("limit", ["", 'range="0 3.2"'])
def test_a_ball_without_a_limit_has_none(limit: str, tmp_path: Path) -> None:
    model = driven(av.load_avatar(written(tmp_path, f'<body><joint type="ball" {limit}/>{GEOM}</body>')))
    assert model.avatar is not None and model.avatar.links[0].joint == Ball()


SLIDE = (
    f'<body name="cart"><joint name="rail" type="slide" axis="1 0 0" range="-1 1"/>{GEOM}'
    f'<body name="pole"><joint name="turn"/>{GEOM}</body></body>'
)


def test_a_slide_is_a_joint_with_limits_in_metres(tmp_path: Path) -> None:
    model = driven(av.load_avatar(written(tmp_path, SLIDE)))
    assert model.avatar.links[0].joint == Slide((1.0, 0.0, 0.0), -1.0, 1.0)
    assert [slot.kind for slot in model.coordinates.slots] == ["slide", "hinge"]
    unlimited = driven(av.load_avatar(written(tmp_path, SLIDE.replace('range="-1 1"', ""))))
    assert unlimited.avatar.links[0].joint == Slide((1.0, 0.0, 0.0), -LONGEST_SLIDE, LONGEST_SLIDE)


def test_a_slide_may_be_fixed_at_the_reference(tmp_path: Path) -> None:
    model = driven(av.load_avatar(written(tmp_path, SLIDE), fix=("rail",)))
    assert isinstance(model.avatar.links[0].joint, Rigid) and model.notes
    # its column stays at its place in the file, and has the reference again when written
    motion = model.coordinates.motion(np.array([[0.5, 0.25]]), np.zeros(1))
    np.testing.assert_array_equal(model.coordinates.rows(motion), [[0.0, 0.25]])


def coupled(folder: Path, *equalities: str, limits: str = "") -> Path:
    """Return four hinges in a row, a to d, with equalities among them."""
    body = ""
    for name in "dcba":
        limit = f'range="{limits}"' if limits and name == "d" else ""
        body = f'<body pos="0.2 0 0"><joint name="{name}" axis="0 1 0" ref="0.1" {limit}/>{GEOM}{body}</body>'
    rest = "".join(f'<joint joint1="{one[0]}" joint2="{one[1]}" polycoef="{one[2:]}"/>' for one in equalities)
    return written(folder, body, f"<equality>{rest}</equality>")


def test_a_coupled_joint_follows_counted_from_the_reference(tmp_path: Path) -> None:
    path = coupled(tmp_path, "ba 0.3 2 0 0 0")
    model = driven(av.load_avatar(path))
    assert model.avatar.couplings == (av.Coupling(1, 0, 2.0, 0.3),)
    mujoco_model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(mujoco_model)
    assert model.start is not None
    q = model.coordinates.rows(replace(model.coordinates.motion(np.zeros((1, 4)), np.zeros(1)), angles=model.start.angles[None]))
    data.qpos[:] = q[0]
    mujoco.mj_forward(mujoco_model, data)
    # MuJoCo's error of the equality is zero
    np.testing.assert_allclose(data.efc_pos[data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY], 0.0, atol=1e-14)


@pytest.mark.parametrize(("equalities", "couplings"), [
    (("ab 0.3 2 0 0 0",), {1: (0, 0.5, -0.15)}),
    (("ba 0 2 0 0 0", "cb 0.1 -1 0 0 0"), {1: (0, 2.0, 0.0), 2: (0, -2.0, 0.1)}),
    (("bc 0 0.5 0 0 0", "dc 0 2 0 0 0"), {2: (1, 2.0, 0.0), 3: (1, 4.0, 0.0)}),
    (("ba 0 2 0 0 0", "cb 0 2 0 0 0", "ca 0 4 0 0 0"), {1: (0, 2.0, 0.0), 2: (0, 4.0, 0.0)}),
])
def test_couplings_in_a_row_or_a_ring_follow_the_first_joint(
    equalities: tuple[str, ...], couplings: dict[int, tuple[int, float, float]], tmp_path: Path
) -> None:
    model = driven(av.load_avatar(coupled(tmp_path, *equalities)))
    found = {one.follower: (one.leader, one.ratio, one.offset) for one in model.avatar.couplings}
    assert found.keys() == couplings.keys()
    for follower, wanted in couplings.items():
        assert found[follower] == pytest.approx(wanted)


def test_a_joint_coupled_to_nothing_or_what_is_fixed_is_fixed(tmp_path: Path) -> None:
    body = f'<body><joint name="a" axis="0 1 0"/>{GEOM}<body pos="0.2 0 0"><joint name="b" axis="0 1 0"/>{GEOM}</body></body>'
    alone = driven(av.load_avatar(written(tmp_path, body, '<equality><joint joint1="b" polycoef="0.2 0 0 0 0"/></equality>')))
    assert alone.avatar.couplings == () and alone.avatar.links[1].joint == Hinges((Hinge((0.0, 1.0, 0.0), 0.2, 0.2),))
    led = driven(av.load_avatar(coupled(tmp_path, "ba 0.3 2 0 0 0", "cb 0 1 0 0 0"), fix=("b",)))
    joints = [link.joint for link in led.avatar.links]
    assert led.avatar.couplings == () and isinstance(joints[1], Rigid)
    # the leader of the fixed joint still moves, and its followers are fixed
    assert [joint.hinges[0].lower for joint in joints if isinstance(joint, Hinges)][:2] == [-MANY_TURNS, 0.0]


def test_limits_of_a_follower_narrow_its_leaders(tmp_path: Path) -> None:
    model = driven(av.load_avatar(coupled(tmp_path, "da 0 -2 0 0 0", limits="-0.1 0.7")))
    leader, follower = (axes_of(model.avatar.links[k].joint)[0] for k in (0, 3))
    assert (leader.lower, leader.upper) == pytest.approx((-0.3, 0.1))
    assert (follower.lower, follower.upper) == pytest.approx((-0.2, 0.6))


@pytest.mark.parametrize(("equalities", "thing"), [
    (("ba 0 1 0.5 0 0",), "c2=0.5"), (("ba 0 2 0 0 0", "ba 0 1 0 0 0"), "coupling"),
])
def test_refuses_curved_and_contradicting_couplings(equalities: tuple[str, ...], thing: str, tmp_path: Path) -> None:
    with pytest.raises(InvalidFile, match=thing):
        av.load_avatar(coupled(tmp_path, *equalities))


def test_a_joint_that_follows_a_curve_may_be_fixed(tmp_path: Path) -> None:
    model = driven(av.load_avatar(coupled(tmp_path, "ba 0 1 0.5 0 0"), fix="all"))
    assert model.coordinates.hinges == 3 and model.avatar.couplings == ()


@pytest.mark.parametrize(("file", "root", "is_free"), [
    ("free", "file", True), ("free", "fixed", False), ("none", "file", False), ("none", "free", True), ("none", "fixed", False),
])
def test_the_root_moves_as_asked(file: str, root: str, is_free: bool, tmp_path: Path) -> None:
    free = "<freejoint/>" if file == "free" else ""
    path = written(tmp_path, f'<body pos="0 0 1">{free}{GEOM}<body name="arm"><joint name="a"/>{GEOM}</body></body>')
    model = driven(av.load_avatar(path, root=root))
    assert isinstance(model.avatar.links[0].joint, Free) == is_free
    assert model.coordinates.width == (8 if is_free or file == "free" else 1)
    if root == "free":
        assert model.start is not None and model.start.positions[0, 2] == 1.0
    else:
        assert greatest_difference(Twin(path), model, 3) <= 1e-12


def test_a_free_root_with_joints_of_its_own_gets_a_link_above(tmp_path: Path) -> None:
    path = written(tmp_path, f'<body name="top"><joint name="a"/>{GEOM}</body>')
    model = driven(av.load_avatar(path, root="free"))
    assert model.avatar is not None and [type(link.joint) for link in model.avatar.links] == [Free, Hinges]
    assert model.avatar.links[1].name == "top"


URDF = (
    '<robot name="r">{world}<link name="base"><inertial><mass value="1"/>'
    '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    '<collision><geometry><sphere radius="0.1"/></geometry></collision></link></robot>'
)
FIXED = '<link name="world"/><joint name="j" type="fixed"><parent link="world"/><child link="base"/></joint>'


def test_the_root_of_urdf_is_free_unless_the_file_fixes_it(tmp_path: Path) -> None:
    path = tmp_path / "robot.urdf"
    path.write_text(URDF.format(world=""), encoding="utf-8")
    model = driven(av.load_avatar(path))
    assert model.avatar is not None and isinstance(model.avatar.links[0].joint, Free) and model.avatar.name == "r"
    path.write_text(URDF.format(world=FIXED), encoding="utf-8")
    with pytest.raises(InvalidFile, match=r"joints of robot\.urdf is 0; .*load_room.*root=\"free\""):
        av.load_avatar(path)


@pytest.mark.parametrize(("options", "error", "said"), [
    ({"root": "loose"}, UnknownName, "root is 'loose'"), ({"fix": ("b",)}, UnknownName, "joint to fix of model.xml is 'b'"),
    ({"fix": "a"}, InvalidInput, "fix is 'a'"),
    ({"avatar": "none"}, UnknownName, "body of model.xml to be the avatar is 'none'"),
    ({"meshes": "boxes"}, UnknownName, "meshes is 'boxes'"), ({"leave": ("g",)}, UnknownName, "geom in leave is 'g'"),
    *(({"most_vertices": most}, InvalidInput, "vertices") for most in (-1, 3, 8.5, "x")),
    *(({"repair": repair}, InvalidInput, "repair") for repair in ("x", 3)),
    *(({"size_range": sizes}, InvalidInput, "size_range") for sizes in ((-1.0, 2.0), (2.0, 1.0), (float("nan"), 1.0))),
])
def test_options_that_do_not_fit_are_refused(options: dict, error: type, said: str, tmp_path: Path) -> None:
    path = written(tmp_path, f'<body><joint name="a"/>{GEOM}</body>')
    with pytest.raises(error, match=said):
        av.load_avatar(path, **options)
