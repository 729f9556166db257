"""`python -m scenarios.robots FOLDER`: every model of a folder, driven into walls and itself through the Shield.

Overlap is that of the file's own geoms by MuJoCo's distance, which knows nothing of the shapes that the Shield is given. A model
that is refused is tried again with the options that the error names, as its user would.
"""

import argparse
import csv
import re
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, fields, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import avatarsim as av
from avatarsim.assets.models.compile_process import compiled_by_mujoco
from avatarsim.assets.models.coordinates import WIDTHS, Coordinates, Slot
from avatarsim.assets.models.pieces_of_geoms import vector_of
from avatarsim.assets.models.preflight import MODELS, folder_of
from avatarsim.cleaning.chords import scene_of
from avatarsim.cleaning.result import DEFAULTS
from avatarsim.console import ended, path_option
from avatarsim.errors import AvatarsimError, InvalidFile, StartOverlaps
from avatarsim.running.processes import Died
from avatarsim.scene.joint import MANY_TURNS, axes_of
from scenarios.run.gate import FAILED, PASSED
from scenarios.run.processes import side_by_side
from scenarios.run.progress import Progress

Array = NDArray[np.float64]

ROOM = 0.05
"""[m] from the box around the start posture to the walls. Larger: the robot does not reach them; less: it cannot move."""
SEEN = 1e-6
"""[m, rad] overlap, and excess over a limit of position, that counts."""
ROUNDING = 1e-6
"""Share of a limit of speed or acceleration that is rounding: differences of postures, times the square of the rate."""
SWING = 1.1
"""Amplitude of a joint's sine, in halves of its range: it leads beyond both limits."""
SIDES = (("floor", 2, 0, -0.5), ("wall x", 0, 1, 0.5), ("wall y", 1, 1, 0.5), ("top", 2, 1, 0.5))
"""Sides of the room: name, axis, whether at the upper end, and where the middle of the wall is from its face [m]."""
TURN = 1.0
"""[rad] amplitude of joints without limits, of balls and of free roots; [m] a tenth of it for places."""


ACCELERATION = 30.0
"""[rad/s^2, m/s^2] limit of all joints. Larger: robots stop within a call, and braking is hardly tried."""
NAMED, REASON = 4, 120
"""Models named of those that are refused for one reason, and characters of a reason: a table that is read on a screen."""
HIGHEST = 4
"""Folders above a file that are tried as that of its model."""
TRIES = 12
"""Loads of a model, each with one more option that the last refusal names."""
ROOT = re.compile(rb"<(?:mujoco|robot)[\s>]")
"""Root of a file that is a model by itself; files that others include begin with mujocoinclude."""


@dataclass(frozen=True)
class Driven:
    """Result of one model. `note` has the refusal, or the report of the load; `options` those that it needed.

    `overlap` [m] of its own geoms beyond their allowance at rest, `beyond` [rad, m] the limits of joints, `speed` and
    `acceleration` as shares of their limits, times of a call [us], `load` [s]. `kind` is robot, room or refused. `own_joints` are
    the file's own moving joints without free ones, `lost` those of them that move nothing though no option fixes them."""

    package: str
    model: str
    kind: str
    links: int = 0
    joints: int = 0
    overlap: float = 0.0
    pair: str = ""
    beyond: float = 0.0
    speed: float = 0.0
    acceleration: float = 0.0
    load: float = 0.0
    call_p50: float = 0.0
    call_p99: float = 0.0
    free: float = 0.0
    own_joints: int = 0
    lost: str = ""
    options: str = ""
    note: str = ""

    @property
    def is_kept(self) -> bool:
        """Return True where neither geoms overlap, nor a limit is passed, nor a joint is lost."""
        return not self.lost and max(self.overlap, self.beyond) <= SEEN and max(self.speed, self.acceleration) <= 1.0 + ROUNDING


class OwnGeoms:
    """Distances of a file's own geoms, of pairs that the scene of the avatar watches."""

    def __init__(self, path: Path, model: av.Model, folder: Path | None = None, collide: str = "collision") -> None:
        import mujoco

        self._mj = mujoco
        self._model = compiled_by_mujoco(path, folder_of(path, folder), collide=collide, limited=False)[0]
        self._data = mujoco.MjData(self._model)
        self._bodies = {body.name: body for body in model.bodies}
        scene = scene_of(model, (), DEFAULTS)
        may = {(a, b): depth for a, b, depth in scene.resting}
        index = {name: k for k, name in enumerate(scene.names)}
        owners = [self._owner(geom, scene, index) for geom in range(self._model.ngeom)]
        touching = (self._model.geom_contype != 0) | (self._model.geom_conaffinity != 0)
        self._pairs = [
            (g, h, may.get((min(a, b), max(a, b)), 0.0)) for h, b in enumerate(owners) for g, a in enumerate(owners[:h])
            if a >= 0 and b >= 0 and touching[g] and touching[h] and scene.pair_filter[a, b]
        ]
        joints = {self._joint_name(j): j for j in range(self._model.njnt)}
        assert model.coordinates is not None
        self._columns = [(slot.name, slot.kind, joints.get(slot.name, -1)) for slot in model.coordinates.slots]

    def _joint_name(self, joint: int) -> str:
        body = int(self._model.jnt_bodyid[joint])
        return self._model.joint(joint).name or f"joint {joint} of {self._model.body(body).name or f'body {body}'}"

    def _owner(self, geom: int, scene: av.Scene, index: dict[str, int]) -> int:
        """Return the number in the scene of the body or link that a geom belongs to; -1 for a geom that is not in it."""
        body = int(self._model.geom_bodyid[geom])
        if body == 0:
            # an avatar of several trees has a link of this name
            return index.get(self._model.geom(geom).name or f"world {geom}", -1)
        name = self._model.body(body).name or f"body {body}"
        return index.get(f"{scene.avatars[0].name}/{name}", index.get(name, -1))

    def deepest(self, q: Array) -> tuple[float, str]:
        """Return the largest depth [m] at coordinates `q` of the avatar, beyond that which is allowed, and its pair."""
        m, d, first = self._model, self._data, 0
        d.qpos[:] = m.qpos0
        for free in np.flatnonzero(m.jnt_type == self._mj.mjtJoint.mjJNT_FREE):
            if loose := self._bodies.get(m.body(m.jnt_bodyid[free]).name):
                address = m.jnt_qposadr[free]
                d.qpos[address : address + 7] = *loose.position, *loose.orientation
        for name, kind, joint in self._columns:
            width = WIDTHS[kind]
            if joint >= 0 and kind != "fixed":
                d.qpos[m.jnt_qposadr[joint] : m.jnt_qposadr[joint] + width] = q[first : first + width]
            elif name == "root":
                root = int(np.flatnonzero(m.body_parentid == 0)[1])
                m.body_pos[root], m.body_quat[root] = q[first : first + 3], q[first + 3 : first + 7]
            first += width
        self._mj.mj_kinematics(m, d)
        worst, pair = 0.0, ""
        for g, h, allowed in self._pairs:
            near = m.geom_rbound[g] + m.geom_rbound[h]
            if min(m.geom_rbound[g], m.geom_rbound[h]) > 0.0 and np.linalg.norm(d.geom_xpos[g] - d.geom_xpos[h]) > near:
                continue
            depth = -self._mj.mj_geomDistance(m, d, g, h, 1e-3, None) - allowed
            if depth > worst:
                worst, pair = depth, f"{m.body(m.geom_bodyid[g]).name}, {m.body(m.geom_bodyid[h]).name}"
        return worst, pair


def own_joints(path: Path) -> list[str]:
    """Return names of the joints, free ones left out, of a file as MuJoCo reads it; unnamed ones are empty.

    Only files that MuJoCo cannot read as they are, such as a URDF with two materials of one name, are read through the loader."""
    import mujoco

    try:
        spec = mujoco.MjSpec.from_file(str(path))
    except (ValueError, RuntimeError):
        return []
    return [joint.name for joint in spec.joints if joint.type != mujoco.mjtJoint.mjJNT_FREE]


def lost_joints(own: Sequence[str], coordinates: Coordinates | None, is_fixed: bool) -> list[str]:
    """Return joints of the file that are no coordinate of the avatar; with `is_fixed`, an option may hold joints that are named.

    Unnamed ones are compared by their number."""
    slots = () if coordinates is None else coordinates.slots
    imported = Counter(slot.name for slot in slots if slot.kind != "free" and (is_fixed or slot.kind != "fixed"))
    missing = list((Counter(name for name in own if name) - imported).elements())
    unnamed = len(own) - sum(bool(name) for name in own)
    spare = sum((imported - Counter(own)).values())
    return missing + [f"{unnamed - spare} unnamed"] * (unnamed > spare)


def walls(model: av.Model) -> tuple[av.Body, ...]:
    """Return floor, two walls and a ceiling around the start posture, each ROOM away from it."""
    from avatarsim.model.world import build

    scene = model.scene()
    world = build(scene)
    own = world.poses.hulls[len(scene.bodies) : len(scene.bodies) + len(scene.avatars[0].links)]
    own = own[np.isfinite(own).all(axis=1)]
    low, high = own[:, :3].min(axis=0) - ROOM, own[:, 3:].max(axis=0) + ROOM
    size, middle = float((high - low).max()) + 2.0, 0.5 * (low + high)
    bodies = []
    for name, axis, face, side in SIDES:
        place = middle.copy()
        place[axis] = (high if face else low)[axis] + side
        extent = np.full(3, size)
        extent[axis] = 1.0
        piece = av.Piece(av.Box(vector_of(extent)))
        bodies.append(av.fixed(f"room {name}", (piece,), "wood", vector_of(place)))
    return tuple(bodies)


def driven(model: av.Model, frames: int, seed: int, rate: float) -> Iterator[Array]:
    """Yield coordinates of sines of all joints, each of its own period, that go beyond its limits."""
    coordinates, start = model.coordinates, model.start
    assert coordinates is not None and start is not None and model.avatar is not None
    rng = np.random.default_rng(seed)
    motion = av.Motion(np.zeros(1), start.positions[None], start.rotations[None], start.angles[None])
    rest = coordinates.rows(motion)[0]
    limits = [(axis.lower, axis.upper) for link in model.avatar.links for axis in axes_of(link.joint)]
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
    unbounded = 0.1 * TURN if slot.kind == "slide" else TURN
    own += (0.5 * SWING * (high - low) if bounded else unbounded) * swing


def loaded(path: Path) -> tuple[av.Model, dict[str, Any]]:
    """Return a model and the options that it needs, each taken from the refusal before.

    Raises the error of `load_avatar` where no option helps."""
    options: dict[str, Any] = {"needed": False}
    refusal: AvatarsimError | None = None
    for _ in range(TRIES):
        try:
            model = av.load_avatar(path, **options)
            trees = re.search(r"avatar=\(([^)]*)\) drives all", "; ".join(model.notes))
            if trees is None or "avatar" in options:
                return model, options
            more = {"avatar": tuple(re.findall('"([^"]*)"', trees[1]))}
        except StartOverlaps as error:
            refusal, more = error, {"exclude": (*options.get("exclude", ()), *((a, b) for a, b, _ in error.pairs))}
        except InvalidFile as error:
            # a file that lies in no folder is missing from that of the model
            refusal = refusal if refusal is not None and "folder=..." in error.valid else error
            more = _advised(path, options, error)
        if not more:
            break
        options |= more
    assert refusal is not None
    raise refusal


def _advised(path: Path, options: dict[str, Any], error: InvalidFile) -> dict[str, Any]:
    """Return the option that an error names; none where it names none."""
    advice = error.valid
    if (wider := re.search(r'folder="([^"]+)"', advice)) and Path(wider[1]) != options.get("folder"):
        return {"folder": Path(wider[1])}
    if "folder=..." in advice and (above := options.get("folder", folder_of(path)).parent) in path.resolve().parents[:HIGHEST]:
        return {"folder": above}
    if (left := re.search(r'leave=\("([^"]+)",\)', advice)) and left[1] not in options.get("leave", ()):
        return {"leave": (*options.get("leave", ()), left[1])}
    if 'collide="visual"' in advice and "collide" not in options:
        return {"collide": "visual"}
    if 'fix="all"' in advice and "fix" not in options:
        return {"fix": "all"}
    return {}


def drive(path: Path, frames: int, seed: int, rate: float) -> Driven:
    """Return the result of one model; a refusal is a row too."""
    package, name = path.parts[-3] if len(path.parts) > 2 else "", "/".join(path.parts[-2:])
    try:
        begun = time.perf_counter()
        model, options = loaded(path)
        load = time.perf_counter() - begun
        given = " ".join(f"{key}={len(value) if isinstance(value, tuple) else getattr(value, 'name', value)}"
                         for key, value in options.items() if key != "needed")
        own = own_joints(path)
        lost = ", ".join(lost_joints(own, model.coordinates, "fix" in options))
        if model.avatar is None or model.coordinates is None:
            return Driven(
                package, name, "room", load=load, own_joints=len(own), lost=lost, options=given, note="; ".join(model.notes),
            )
        speeds = {slot.name: slot.speed or None for slot in model.coordinates.slots if slot.kind != "fixed"}
        shield = av.Shield(model, walls(model), rate, speed_limits=speeds, acceleration_limits=ACCELERATION)
        judge = OwnGeoms(path, model, options.get("folder"), options.get("collide", "collision"))
        times, rows, free, deepest, pair = list[float](), list[Array](), 0, 0.0, ""
        for q in driven(model, frames, seed, rate):
            begun = time.perf_counter()
            rows.append(shield(q))
            times.append(1e6 * (time.perf_counter() - begun))
            free += shield.is_free
            depth, of = judge.deepest(rows[-1])
            if depth > deepest:
                deepest, pair = depth, of
    except AvatarsimError as error:
        return Driven(package, name, "refused", note=" ".join(str(error).split()))
    joints = sum(slot.kind not in ("fixed", "free") for slot in model.coordinates.slots)
    p50, p99 = np.percentile(times[1:], [50, 99])
    beyond, speed, acceleration = within_limits(model, np.array(rows), rate)
    return Driven(
        package, name, "robot", len(model.avatar.links), joints, deepest, pair, beyond, speed, acceleration, load, float(p50),
        float(p99), free / frames, len(own), lost, given, "; ".join(model.notes),
    )


def within_limits(model: av.Model, rows: Array, rate: float) -> tuple[float, float, float]:
    """Return how far hinges and slides are beyond their limits [rad, m], and their largest speed and acceleration as shares of
    the limits; 0 where there are none. `rows` (F, width)."""
    assert model.coordinates is not None and model.avatar is not None
    axes = [axis for link in model.avatar.links for axis in axes_of(link.joint)]
    beyond, speed, acceleration, first = 0.0, 0.0, 0.0, 0
    for slot in model.coordinates.slots:
        if slot.hinge >= 0:
            column, axis = rows[:, first] - slot.rest, axes[slot.hinge]
            beyond = max(beyond, float((column - axis.upper).max()), float((axis.lower - column).max()))
            step = np.diff(column) * rate
            acceleration = max(acceleration, float(np.abs(np.diff(step, prepend=0.0)).max()) * rate / ACCELERATION)
            if slot.speed > 0.0:
                speed = max(speed, float(np.abs(step).max()) / slot.speed)
        first += WIDTHS[slot.kind]
    return beyond, speed, acceleration


def is_model(path: Path) -> bool:
    """Return True for a file that is a model by itself."""
    ending = path.suffix.lower()
    return ending in MODELS and path.is_file() and (ending != ".xml" or bool(ROOT.search(path.read_bytes())))


def markdown(rows: Sequence[Driven]) -> str:
    """Return tables of packages, and of refusals by their statement of the valid form."""
    lines = ["| package | files | robots | rooms | refused | links | slowest load | call, median | overlap |",
             "|---|---|---|---|---|---|---|---|---|"]
    for package in dict.fromkeys(row.package for row in rows):
        own = [row for row in rows if row.package == package]
        robots, kinds = [row for row in own if row.kind == "robot"], Counter(row.kind for row in own)
        links = f"{min(row.links for row in robots)} to {max(row.links for row in robots)}" if robots else ""
        figures = (f"{max(row.load for row in robots):.1f} s | {np.median([row.call_p50 for row in robots]):.0f} us | "
                   f"{1e3 * max(row.overlap for row in robots):.3g} mm" if robots else " | | ")
        counts = " | ".join(str(count) for count in (len(own), kinds["robot"], kinds["room"], kinds["refused"]))
        lines.append(f"| {package} | {counts} | {links} | {figures} |")
    reasons = dict[str, list[str]]()
    for row in rows:
        if row.kind == "refused":
            reasons.setdefault(reason(row.note), []).append(f"{row.package}: {Path(row.model).name}")
    lines += ["", "| refused | what would be valid |", "|---|---|"]
    for why, models in sorted(reasons.items(), key=lambda entry: -len(entry[1])):
        more = f" and {len(models) - NAMED} more" if len(models) > NAMED else ""
        lines.append(f"| {', '.join(models[:NAMED])}{more} | {why} |")
    return "\n".join(lines)


def reason(note: str) -> str:
    """Return a refusal's statement of the valid form, without the parts of one file: its folder, and numbers."""
    valid = (note.partition("valid: ")[2] or note).partition(";")[0]
    return re.sub(r"(a file that exists in) \S+", r"\1 the folder", re.sub(r"; folder=.*", "", valid)).replace("|", "/")[:REASON]


def main(arguments: Sequence[str] | None = None) -> int:
    """Print a table and write it; FAILED where a robot overlaps by its own geoms or passes a limit."""
    options = argparse.ArgumentParser(prog="python -m scenarios.robots", description=(__doc__ or "").partition("\n")[0])
    options.add_argument("folders", nargs="+", type=path_option, metavar="FOLDER", help="of MJCF and URDF files; or files")
    options.add_argument("--frames", type=int, default=300, metavar="N", help="calls of the Shield (default 300)")
    options.add_argument("--seed", type=int, default=0, metavar="N", help="of the motion (default 0)")
    options.add_argument("--rate", type=float, default=60.0, metavar="HZ", help="calls a second (default 60)")
    options.add_argument("--jobs", type=int, default=2, metavar="N", help="models side by side; 0: in this process (default 2)")
    options.add_argument("--out", type=path_option, metavar="FILE.csv", help="table, a row as soon as a model is done")
    options.add_argument("--markdown", action="store_true", help="print tables of packages and refusals, as in docs/files.md")
    args = options.parse_args(arguments)
    packages = {file: folder.name for folder in args.folders
                for file in ([folder] if folder.is_file() else sorted(folder.rglob("*"))) if is_model(file)}
    task, rows = partial(drive, frames=args.frames, seed=args.seed, rate=args.rate), list[Driven]()
    with Progress("robots", len(packages), sys.stderr) as progress, table(args.out) as write:
        for file, row in side_by_side(task, list(packages), args.jobs, lambda file: False):
            if isinstance(row, Died):
                row = Driven("", file.name, "refused", note=str(row))
            rows.append(replace(row, package=packages[file]))
            write(rows[-1])
            progress.step(file.name)
    rows.sort(key=lambda row: (row.package, row.kind, row.model))
    robots = [row for row in rows if row.kind == "robot"]
    print(markdown(rows) if args.markdown else "\n".join(map(line, rows)))
    counted = f"{len(robots)} robots and {sum(row.kind == 'room' for row in rows)} rooms of {len(rows)} files"
    print(f"{counted}; {sum(row.overlap > SEEN for row in robots)} overlap by their own geoms", file=sys.stderr)
    return PASSED if all(row.is_kept for row in robots) else FAILED


@contextmanager
def table(out: Path | None) -> Iterator[Callable[[Driven], None]]:
    """Open a table, and yield what writes a row of it as soon as it is known, or nothing without a file."""
    if out is None:
        yield lambda row: None
        return
    with out.open("w", buffering=1, newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, [field.name for field in fields(Driven)])
        writer.writeheader()
        yield lambda row: writer.writerow(asdict(row))


def line(row: Driven) -> str:
    """Return a model's line of the table."""
    if row.kind != "robot":
        return f"{row.model:40.40} {row.kind}: {row.note}"
    size = f"{row.links:4} links {row.joints:4} joints"
    figures = f"{1e3 * row.overlap:8.4f} mm {row.beyond:7.1g} {row.speed:5.2f} {row.acceleration:5.2f}"
    return f"{row.model:40.40} {size}  {figures}  {row.call_p50:7.0f} us {row.call_p99:7.0f} us  {row.pair} {row.options}"


if __name__ == "__main__":
    sys.exit(ended(main))
