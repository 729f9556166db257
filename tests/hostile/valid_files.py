"""Small valid files of every format that is read: the originals of the damaged ones."""

import io
import json
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from avatarsim.clips import certificate
from runfiles import array_file, record
from scenarios import catalog
from tests.assets.meshes.solids import cube, ell, torus
from tests.assets.motions.clips import upright
from tests.assets.motions.files import ASF, WALKER, amc, bvh
from tests.assets.motions.robots import JOINTS, walk
from tests.clips.entries import entry
from tests.reports import recorded, small_runs
from tests.reports.conftest import whole_run
from tests.scenarios import examples

Files = Mapping[str, bytes]


@cache
def meshes(ending: str) -> Files:
    """Return a cube, an L and a ring in one format."""
    import trimesh

    found: dict[str, bytes] = {}
    for name, (vertices, triangles) in (("cube", cube()), ("ell", ell()), ("ring", torus(around=8, across=5))):
        mesh = trimesh.Trimesh(vertices, triangles, process=False)
        if ending == "obj":
            groups = "".join(f"v {x:g} {y:g} {z:g}\n" for x, y, z in vertices) + "o one\n"
            groups += "".join(f"f {a + 1}//1 {b + 1} {c - len(vertices)}\n" for a, b, c in triangles) + "g two\nf 1 2 3 4\n"
            found[f"{name}.obj"] = groups.encode()
        elif ending == "gltf":
            found |= {f"{name}/{part}": content for part, content in mesh.scene().export(file_type="gltf").items()}
        else:
            made = mesh.export(file_type={"stl": "stl", "stl_ascii": "stl_ascii"}.get(ending, ending))
            found[f"{name}.{ending.partition('_')[0]}"] = made if isinstance(made, bytes) else str(made).encode()
    return found


ROBOT = """<mujoco model="robot"><compiler angle="radian" meshdir="."/><include file="room.xml"/>
<option gravity="0 0.1 -3.7" o_friction="0.5 0.5 0.1 0.1 0.1"><flag gravity="enable" override="disable"/></option>
<default><geom friction="0.7" priority="1"/><pair friction="0.4 0.4"/></default>
<asset><mesh name="tip" file="tip.obj" scale="0.1 0.1 0.1"/></asset><worldbody><body name="hip" pos="0 0 1"><freejoint/>
<geom name="trunk" type="capsule" size="0.1 0.2" condim="1"/>
<geom type="box" size="0.1 0.1 0.1" contype="0" conaffinity="0"/><plugin plugin="some.cable"><config key="a" value="1"/></plugin>
<body name="leg" pos="0 0 -0.5"><joint name="knee" axis="0 1 0" range="-1 1"/>
<joint name="turn" type="ball" range="0 1"/><geom type="cylinder" size="0.05 0.1" pos="0 0 -0.2"/>
<body name="foot" pos="0 0 -0.4"><joint name="rail" type="slide"/>
<geom type="mesh" mesh="tip" euler="1 0 0"/></body></body></body>
</worldbody><contact><exclude body1="hip" body2="foot"/><pair geom1="trunk" geom2="floor" condim="4"/></contact>
<keyframe><key name="low" qpos="3 0 1 1 0 0 0 0 0 1.5 1 0 0 0 0.2 1 0 0 0 0.1" mpos="0 3 1"/>
<key name="home" mquat="0 1 0 0"/>
</keyframe><extension><plugin plugin="mujoco.pid"><instance name="i"/></plugin></extension>
<actuator><plugin plugin="mujoco.pid" instance="i" joint="knee"/><motor name="m" joint="knee"/></actuator>
<custom><tuple name="t"><element objtype="actuator" objname="m"/></tuple></custom>
<equality><joint joint1="knee" polycoef="0 1 0 0 0"/></equality></mujoco>"""

ROOM = """<mujoco><worldbody><geom name="floor" type="plane" size="1 1 1"/><geom type="ellipsoid" size="0.1 0.2 0.3" pos="2 0 0"/>
<body name="lead" mocap="true" pos="0 3 0"><geom size="0.1" friction="0.2"/></body>
<body name="box" pos="3 0 1"><freejoint/><geom type="box" size="0.1 0.1 0.1"/></body></worldbody></mujoco>"""

URDF = """<robot name="arm"><material name="grey"><color rgba="1 1 1 1"/></material><link name="base"><visual><geometry>
<capsule radius="0.1" length="0.2"/></geometry><material name="grey"/></visual>
<collision><geometry><box size="0.1 0.2 0.3"/></geometry></collision></link>
<link name="tip"><collision><origin xyz="0 0 0.2" rpy="1 0 0"/><geometry>
<mesh filename="tip.obj" scale="0.1 0.1 0.1"/></geometry></collision>
<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="turn" type="revolute"><parent link="base"/><child link="tip"/><axis xyz="0 0 1"/><origin xyz="0 0 0.3"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""


@cache
def clip() -> Files:
    """Return a motion clip of four frames."""
    step, _, *still = upright(0.03)
    frames = [[step, 0.1 * k, *still] for k in range(4)]
    return {"humanoid3d_some.txt": json.dumps({"Loop": "wrap", "Frames": frames}).encode()}


@cache
def trajectory() -> Files:
    """Return a robot's trajectory with names, and one of GMR's without."""
    q, stream, other = walk(4), io.BytesIO(), io.BytesIO()
    bodies = np.tile(q[:, None, :3], (1, 2, 1)), np.tile(q[:, None, 3:7], (1, 2, 1))
    np.savez(
        stream, fps=np.array([50]), joint_pos=q, joint_names=np.array(JOINTS), body_names=np.array(["world", "pelvis"]),
        body_pos_w=bodies[0], body_quat_w=bodies[1], joint_vel=np.gradient(q, axis=0)[:, :-1], object_pos_w=q[:, :3],
        object_quat_w=q[:, 3:7], object_name="box", object_size=np.full(3, 0.2),
    )
    np.savez(other, fps=30.0, root_pos=q[:, :3], root_rot=q[:, 3:7], dof_pos=q[:, 7:].astype(np.float32))
    return {"robot.npz": stream.getvalue(), "apart.npz": other.getvalue()}


@cache
def texts() -> Mapping[str, Files]:
    """Return small files of one text each, by their reader."""
    lines = b"".join(b",".join(repr(value).encode() for value in row) + b"\n" for row in walk(4).tolist())
    names = ("root_x", "root_y", "root_z", "root_qw", "root_qx", "root_qy", "root_qz", *JOINTS)
    troubles = [("cut.bvh", "unreadable", "cut off"), ("deep/", "unreadable", "Permission denied")]
    return {
        "trajectory csv": {"plain.csv": lines, "named.csv": ",".join(names).encode() + b"\n" + lines},
        "bvh": {"walker.bvh": bvh(WALKER, np.linspace(0.0, 30.0, 60).reshape(2, 30)).encode()},
        "asf": {"07.asf": ASF.encode()}, "amc": {"07_01.amc": amc(np.linspace(0.0, 30.0, 44).reshape(2, 22)).encode()},
        "model": {"some.xml": MODEL.encode()}, "mesh of a model": {"tip.stl": meshes("stl")["cube.stl"]},
        **dict.fromkeys(
            ("avatar", "avatar looked at"),
            {"robot.xml": ROBOT.encode(), "room.xml": ROOM.encode(), "robot.urdf": URDF.encode()},
        ),
        "mesh of an avatar": {"tip.obj": meshes("obj")["cube.obj"]}, "settings": {"mine.toml": SETTINGS.encode()},
        "certificate": {"walk.bvh.json": certificate.text(entry())},
        "certificate of a folder": {"certificate.json": certificate.text(certificate.summary("clean", [entry()], troubles))},
    }


@cache
def body() -> Files:
    """Return a body of the SMPL family, of 24 joints."""
    stream = io.BytesIO()
    poses = np.linspace(-0.3, 0.3, 3 * 72).reshape(3, 72)
    np.savez(stream, poses=poses, trans=np.zeros((3, 3)), mocap_framerate=np.array(120.0), betas=np.zeros(16), gender="neutral")
    return {"body.npz": stream.getvalue()}


MODEL = """<mujoco model="some"><worldbody>
<body name="torso" pos="0 0 1"><freejoint name="root"/><geom name="t" type="capsule" fromto="0 -.07 0 0 .07 0" size=".07"/>
 <geom name="h" type="sphere" pos="0 0 .19" size=".09"/>
 <body name="arm" pos="0 -.17 .06" quat="1 0 0 0"><joint name="a1" type="hinge" axis="2 1 1" pos="0 0 0" range="-85 60"/>
  <joint name="a2" type="hinge" axis="0 -1 1" pos="0 0 0.01" range="-85 60"/><geom type="box" size=".03 .03 .1" euler="0 30 0"/>
  <body name="hand" pos=".18 -.18 -.18" axisangle="0 1 0 10"><joint type="hinge" axis="0 -1 1" range="-90 50"/>
   <geom type="sphere" size=".04"/><geom type="mesh" mesh="tip" pos="0 0 .05"/></body></body>
 <body name="tail" pos="0 0 -.2"><inertial pos="0 0 0" mass="0.4" diaginertia="1e-4 1e-4 1e-4"/></body></body>
</worldbody></mujoco>"""


SETTINGS = """# rows
[avatarsim.near]
preset = "default"
stand_off = 1e-4
sweeps = 20

[mujoco.fine]
preset = "tuned"
dt = 0.0005
solimp = [0.9, 0.95, 0.001]
"""


JUDGED = {"pairs": 1000, "largest_depth_error": 1e-9, "misses": 0, "false_alarms": 0}
"""Results of the judge's own test."""


@cache
def run() -> Files:
    """results.json of three scenes and four engines, and one of each table that a page reads: path -> content."""
    with TemporaryDirectory() as made:
        folder = Path(made)
        whole = whole_run()
        rows = whole["rows"]
        assert isinstance(rows, list)
        series = {"arm_wall": {"avatarsim/default": {"overlap_m": [0.0, 1e-7, None], "frame_time_us": [31.0, "Infinity", 40.0]}}}
        (folder / "results.json").write_text(json.dumps(whole | {"rows": rows[:12] + rows[-4:], "series": series}))
        small_runs.write_all(folder)
        (folder / "judge.json").write_text(json.dumps({"all": JUDGED}))
        return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


SCENE, RUN, TABLE_2 = "arm_wall", "avatarsim/default", "two_arms"
"""A scene and an engine that the run has."""


@cache
def kept() -> Files:
    """Return the files that a run keeps of a scene: its look, a recording as pages read it, pairs that overlap."""
    with TemporaryDirectory() as made:
        folder = Path(made)
        recorded.scene(folder, SCENE)
        recorded.recording(folder, SCENE, RUN, sinks=True)
        return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


@cache
def recording() -> Files:
    """Return a recording with everything in it, as later questions read it."""
    states, bodies, links, inside = 6, 3, 2, 4
    turns = np.zeros((states, bodies, 4))
    turns[..., 0] = 1.0
    numbers = {"times": (states,), "positions": (states, bodies, 3), "velocities": (states, bodies, 3),
               "angular_velocities": (states, bodies, 3), "angles": (states, 2), "raw_positions": (states, links, 3),
               "raw_angles": (states, 2), "inside_time": (inside,), "inside_positions": (inside, bodies, 3),
               "inside_orientations": (inside, bodies, 4), "inside_velocities": (inside, bodies, 3),
               "inside_angular_velocities": (inside, bodies, 3), "overlap": (states,)}
    arrays = {name: np.linspace(0.0, 1.0, int(np.prod(shape))).reshape(shape) for name, shape in numbers.items()}
    meta = {"schema_version": record.SCHEMA_VERSION, "dt": 1 / 60, "scene": SCENE, "engine": "avatarsim"}
    stream = io.BytesIO()
    array_file.write(stream, {
        "meta": np.array(json.dumps(meta)), **arrays, "orientations": turns, "raw_orientations": turns[:, :links],
        "inside_frame": np.array([1, 1, 2, 5]), "inside_event": np.zeros(inside, dtype=np.int64),
        "state_hashes": np.array(["0123456789abcdef"] * states), "counts:contacts": np.arange(states),
        "statuses:led": np.zeros(states, dtype=np.int64), "frame_times_ns": np.full((3, states - 1), 30_000),
    })
    return {"recording.npz": stream.getvalue()}


@cache
def recorded_apart() -> Files:
    """Return a recording of a scene of Table 2 as a run keeps it: its user's motion in a file next to it."""
    scenario = catalog.get(TABLE_2)
    scene = scenario.build()
    motion = scenario.motion(scene, 0)
    held = examples.recorded(scene, [scene.first_sample, motion(0), motion(1)])
    with TemporaryDirectory() as made:
        folder = Path(made)
        name = f"{TABLE_2}.{RUN.replace('/', '.')}.0.npz"
        whole = replace(held, meta=dict(held.meta) | {"full": True})
        record.save(whole, folder / "recordings" / name, folder / record.MOTIONS)
        return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*.npz")}


PIECES = "0123456789abcdef"
"""The key under which pieces are kept."""


@contextmanager
def cache_in(folder: Path) -> Iterator[None]:
    """Let this process keep pieces of meshes below a folder, whatever its environment sets."""
    places = ("XDG_CACHE_HOME", "AVATARSIM_CACHE_DIR")
    before = {name: os.environ.pop(name, None) for name in places}
    os.environ["XDG_CACHE_HOME"] = str(folder)
    try:
        yield
    finally:
        for name, value in before.items():
            os.environ.pop(name, None)
            if value is not None:
                os.environ[name] = value


@cache
def pieces() -> Files:
    """Return the files that the cache of convex pieces keeps of one mesh."""
    from avatarsim.assets.meshes import cache as kept_pieces
    from avatarsim.assets.meshes.hausdorff import Deviation

    hulls = tuple(np.asarray(points, dtype=np.float64) for points in (cube()[0], ell()[0]))
    answer = kept_pieces.Answer(hulls, "decomposed", Deviation(0.1, 0.2, 0.05), ("a repair",))
    with TemporaryDirectory() as made, cache_in(Path(made)):
        kept_pieces.store(PIECES, answer)
        return {str(path.relative_to(made)): path.read_bytes() for path in Path(made).rglob("*") if path.is_file()}
