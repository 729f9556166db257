"""`python -m scenarios.robots FOLDER`: every model of a folder, driven into walls and itself through the Shield.

Overlap is that of the file's own geoms by MuJoCo's distance, which knows nothing of the shapes that the Shield is given.
"""

import argparse
import csv
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, fields
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import avatarsim as av
from avatarsim.assets.models.compile_process import compiled_by_mujoco
from avatarsim.assets.models.coordinates import WIDTHS, Slot
from avatarsim.assets.models.doors import MODELS, folder_of
from avatarsim.assets.models.pieces_of_geoms import vector_of
from avatarsim.cleaning.chords import scene_of
from avatarsim.cleaning.result import DEFAULTS
from avatarsim.console import ended, path_option
from avatarsim.errors import AvatarsimError
from avatarsim.running.processes import Died
from avatarsim.scene.joint import MANY_TURNS
from scenarios.run.gate import FAILED, PASSED
from scenarios.run.processes import side_by_side
from scenarios.run.progress import Progress

Array = NDArray[np.float64]

ROOM = 0.05
"""[m] from the box around the start posture to the walls. Larger: the robot does not reach them; less: it cannot move."""
SEEN = 1e-6
"""[m] overlap that counts."""
SWING = 1.1
"""Amplitude of a joint's sine, in halves of its range: it leads beyond both limits."""
SIDES = (("floor", 2, 0, -0.5), ("wall x", 0, 1, 0.5), ("wall y", 1, 1, 0.5), ("top", 2, 1, 0.5))
"""Sides of the room: name, axis, whether at the upper end, and where the middle of the wall is from its face [m]."""
TURN = 1.0
"""[rad] amplitude of joints without limits, of balls and of free roots; [m] a tenth of it for places."""


@dataclass(frozen=True)
class Driven:
    """Result of one model; overlap [m] of its own geoms, times of a call [us]. `note` says why it was refused."""

    model: str
    loads: bool
    links: int = 0
    joints: int = 0
    overlap: float = 0.0
    pair: str = ""
    call_p50: float = 0.0
    call_p99: float = 0.0
    free: float = 0.0
    note: str = ""


class OwnGeoms:
    """Distances of a file's own geoms, of pairs that the scene of the avatar watches."""

    def __init__(self, path: Path, model: av.Model) -> None:
        import mujoco

        self._mj = mujoco
        self._model = compiled_by_mujoco(path, folder_of(path), limited=False)[0]
        self._data = mujoco.MjData(self._model)
        scene = scene_of(model, (), DEFAULTS)
        index = {name: k for k, name in enumerate(scene.names)}
        owners = [self._owner(geom, scene, index) for geom in range(self._model.ngeom)]
        touching = (self._model.geom_contype != 0) | (self._model.geom_conaffinity != 0)
        self._pairs = [
            (g, h) for h, b in enumerate(owners) for g, a in enumerate(owners[:h])
            if a >= 0 and b >= 0 and touching[g] and touching[h] and scene.pair_filter[a, b]
        ]
        joints = {self._joint_name(j): j for j in range(self._model.njnt)}
        assert model.coordinates is not None
        self._columns = [(slot.name, slot.kind, joints.get(slot.name, -1)) for slot in model.coordinates.slots]

    def _joint_name(self, joint: int) -> str:
        body = int(self._model.jnt_bodyid[joint])
        return self._model.joint(joint).name or f"joint {joint} of {self._model.body(body).name or f'body {body}'}"

    def _owner(self, geom: int, scene: av.Scene, index: dict[str, int]) -> int:
        """Return the number in the scene of what a geom belongs to; -1 for what is not in it."""
        body = int(self._model.geom_bodyid[geom])
        name = self._model.body(body).name or f"body {body}"
        own = self._model.geom(geom).name or f"world {geom}"
        avatar = scene.avatars[0].name
        return index.get(f"{avatar}/{name}", index.get(own if body == 0 else name, -1))

    def deepest(self, q: Array) -> tuple[float, str]:
        """Return the largest depth [m] at coordinates `q` of the avatar, and its pair."""
        m, d, first = self._model, self._data, 0
        d.qpos[:] = m.qpos0
        for name, kind, joint in self._columns:
            width = WIDTHS[kind]
            if joint >= 0 and kind != "fixed":
                d.qpos[m.jnt_qposadr[joint] : m.jnt_qposadr[joint] + width] = q[first : first + width]
            elif name == "root":
                root = int(np.flatnonzero(m.body_parentid == 0)[1])
                m.body_pos[root], m.body_quat[root] = q[first : first + 3], q[first + 3 : first + 7]
            first += width
        self._mj.mj_kinematics(m, d)
        worst, found = 0.0, ""
        for g, h in self._pairs:
            near = m.geom_rbound[g] + m.geom_rbound[h]
            if min(m.geom_rbound[g], m.geom_rbound[h]) > 0.0 and np.linalg.norm(d.geom_xpos[g] - d.geom_xpos[h]) > near:
                continue
            depth = -self._mj.mj_geomDistance(m, d, g, h, 1e-3, None)
            if depth > worst:
                worst, found = depth, f"{m.body(m.geom_bodyid[g]).name}, {m.body(m.geom_bodyid[h]).name}"
        return worst, found


def walls(model: av.Model) -> tuple[av.Body, ...]:
    """Return floor, two walls and a ceiling around the start posture, each ROOM away from it."""
    from avatarsim.model.world import build

    scene = model.scene()
    world = build(scene)
    own = world.poses.hulls[len(scene.bodies) : len(scene.bodies) + len(scene.avatars[0].links)]
    own = own[np.isfinite(own).all(axis=1)]
    low, high = own[:, :3].min(axis=0) - ROOM, own[:, 3:].max(axis=0) + ROOM
    size, middle = float((high - low).max()) + 2.0, 0.5 * (low + high)
    found = []
    for name, axis, face, side in SIDES:
        place = middle.copy()
        place[axis] = (high if face else low)[axis] + side
        extent = np.full(3, size)
        extent[axis] = 1.0
        piece = av.Piece(av.Box(vector_of(extent)))
        found.append(av.fixed(f"room {name}", (piece,), "wood", vector_of(place)))
    return tuple(found)


def driven(model: av.Model, frames: int, seed: int, rate: float) -> Iterator[Array]:
    """Yield coordinates of sines of all joints, each of its own period, that go beyond its limits."""
    coordinates, start = model.coordinates, model.start
    assert coordinates is not None and start is not None and model.avatar is not None
    rng = np.random.default_rng(seed)
    motion = av.Motion(np.zeros(1), start.positions[None], start.rotations[None], start.angles[None])
    rest = coordinates.rows(motion)[0]
    limits = [(h.lower, h.upper) for link in model.avatar.links for h in getattr(link.joint, "hinges", ())]
    speeds, phases = rng.uniform(0.3, 1.2, len(rest)), rng.uniform(0.0, 2.0 * np.pi, len(rest))
    for frame in range(frames):
        wave = np.sin(2.0 * np.pi * speeds * frame / rate + phases) - np.sin(phases)
        q, first = rest.copy(), 0
        for slot in coordinates.slots:
            width = WIDTHS[slot.kind]
            own, swing = q[first : first + width], wave[first : first + width]
            _swing(own, swing, slot, limits)
            first += width
        yield q


def _swing(own: Array, swing: Array, slot: Slot, limits: Sequence[tuple[float, float]]) -> None:
    """Move one joint's coordinates by its sines."""
    if slot.kind == "fixed":
        return
    if slot.kind in ("free", "ball"):
        own[:-4] += 0.1 * TURN * swing[:-4]
        turned = own[-4:] + 0.5 * TURN * swing[-4:]
        own[-4:] = turned / np.linalg.norm(turned)
        return
    low, high = limits[slot.hinge]
    bounded = high - low < 2.0 * MANY_TURNS - 1.0
    own += (0.5 * SWING * (high - low) if bounded else TURN) * swing


def drive(path: Path, frames: int, seed: int, rate: float) -> Driven:
    """Return what one model gives; a refusal is a row too."""
    name = "/".join(path.parts[-2:])
    try:
        model = av.load_avatar(path)
        if model.avatar is None or model.coordinates is None:
            return Driven(name, False, note="no avatar")
        room = walls(model)
        shield, judge = av.Shield(model, room, rate), OwnGeoms(path, model)
        times, free, deepest, pair = list[float](), 0, 0.0, ""
        for q in driven(model, frames, seed, rate):
            begun = time.perf_counter_ns()
            shown = shield(q)
            times.append(1e-3 * (time.perf_counter_ns() - begun))
            free += shield.is_free
            depth, of = judge.deepest(shown)
            if depth > deepest:
                deepest, pair = depth, of
    except AvatarsimError as error:
        return Driven(name, False, note=" ".join(str(error).split()))
    joints = sum(slot.kind not in ("fixed", "free") for slot in model.coordinates.slots)
    p50, p99 = np.percentile(times[1:], [50, 99])
    note = "; ".join(model.said)
    return Driven(name, True, len(model.avatar.links), joints, deepest, pair, float(p50), float(p99), free / frames, note)


def main(arguments: Sequence[str] | None = None) -> int:
    """Print a table and write it; FAILED where a model that loads overlaps by its own geoms."""
    options = argparse.ArgumentParser(prog="python -m scenarios.robots", description=(__doc__ or "").partition("\n")[0])
    options.add_argument("folders", nargs="+", type=path_option, metavar="FOLDER", help="of MJCF and URDF files; or files")
    options.add_argument("--frames", type=int, default=300, metavar="N", help="calls of the Shield (default 300)")
    options.add_argument("--seed", type=int, default=0, metavar="N", help="of the motion (default 0)")
    options.add_argument("--rate", type=float, default=60.0, metavar="HZ", help="calls a second (default 60)")
    options.add_argument("--jobs", type=int, default=2, metavar="N", help="models side by side; 0: in this process (default 2)")
    options.add_argument("--out", type=path_option, metavar="FILE.csv", help="file for the table")
    asked = options.parse_args(arguments)
    files = [file for folder in asked.folders for file in ([folder] if folder.is_file() else sorted(folder.rglob("*")))]
    files = [file for file in files if file.suffix.lower() in MODELS]
    task, rows = partial(drive, frames=asked.frames, seed=asked.seed, rate=asked.rate), list[Driven]()
    with Progress("robots", len(files), sys.stderr) as progress:
        for file, row in side_by_side(task, files, asked.jobs, lambda file: False):
            if isinstance(row, Died):
                row = Driven(file.name, False, note=str(row))
            rows.append(row)
            progress.step(file.name)
    rows.sort(key=lambda row: (row.loads, row.model))
    for row in rows:
        size = f"{row.links:4} links {row.joints:4} joints"
        figures = f"{size}  {1e3 * row.overlap:8.4f} mm  {row.call_p50:7.0f} us {row.call_p99:7.0f} us"
        print(f"{row.model:40.40} {figures}  {row.pair}" if row.loads else f"{row.model:40.40} refused: {row.note}")
    loaded = [row for row in rows if row.loads]
    print(f"{len(loaded)} of {len(rows)} load; {sum(row.overlap > SEEN for row in loaded)} overlap by their own geoms")
    if asked.out is not None:
        with asked.out.open("w", newline="", encoding="utf-8") as file:
            table = csv.DictWriter(file, [field.name for field in fields(Driven)])
            table.writeheader()
            table.writerows(map(asdict, rows))
    return FAILED if any(row.overlap > SEEN for row in loaded) else PASSED


if __name__ == "__main__":
    sys.exit(ended(main))
