"""Numbers of a model as MuJoCo compiled it, checked: they come from another process, and from a file of any author."""

import io
import json
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, fields
from enum import IntEnum
from importlib.util import find_spec
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from avatarsim.assets import caps
from avatarsim.assets.models import preflight
from avatarsim.assets.models.mujoco_versions import check_folder
from avatarsim.errors import ROOT, InvalidFile, MissingPackage
from avatarsim.spatial import rotation

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

LONGEST_RUN = 300.0
"""Real time [s] after which the process is ended from outside, should its own limits fail."""

BODIES, GEOMS = 20_000, 20_000
"""Bodies and shapes of a model at most: a kitchen has 300. More: loading takes minutes."""

VISIBLE_GROUPS = 3
"""Groups of geoms that MuJoCo's viewer shows by default: 0, 1 and 2."""


class JointKind(IntEnum):
    """MuJoCo's mjtJoint."""

    FREE = 0
    BALL = 1
    SLIDE = 2
    HINGE = 3


class GeomKind(IntEnum):
    """MuJoCo's mjtGeom, as far as models may contain it."""

    PLANE = 0
    HFIELD = 1
    SPHERE = 2
    CAPSULE = 3
    ELLIPSOID = 4
    CYLINDER = 5
    BOX = 6
    MESH = 7
    SDF = 8


class EqualityKind(IntEnum):
    """MuJoCo's mjtEq."""

    CONNECT = 0
    WELD = 1
    JOINT = 2
    TENDON = 3
    FLEX = 4


class ObjectKind(IntEnum):
    """MuJoCo's mjtObj, for the objects that an equality connects."""

    BODY = 1
    SITE = 6


@dataclass(frozen=True, eq=False)
class Compiled:
    """A compiled model under MuJoCo's names: b bodies (the first is the world), j joints, g geoms, e equalities, m meshes.

    Lengths [m], masses [kg], angles [rad], quaternions scalar first. Poses of bodies are in their parents' frames at the
    reference coordinates `qpos0`; `geom_size` as MuJoCo has it: radii, half lengths. Vertices and triangles of the meshes
    that bodies collide with or viewers show lie one after the other, `mesh_vertnum` and `mesh_facenum` of each; triangles
    count within their mesh. `is_urdf` is True for a URDF file, `free_root` if its root is fixed to nothing, `mended_name` are
    bodies whose moments of inertia no solid has, `plate_name` meshes without thickness, `plugin_name` plugins that were left out,
    `unread_name` other features of the file without counterpart. `jnt_velocity` is the limit of speed of a URDF joint [rad/s], 0
    where the file states none. Frictions are those of sliding; keyframes have coordinates and poses of mocap bodies."""

    is_urdf: bool
    free_root: bool
    model_name: str
    mended_name: tuple[str, ...]
    plate_name: tuple[str, ...]
    plugin_name: tuple[str, ...]
    unread_name: tuple[str, ...]
    flexes: int
    body_name: tuple[str, ...]
    jnt_name: tuple[str, ...]
    geom_name: tuple[str, ...]
    eq_name: tuple[str, ...]
    mesh_name: tuple[str, ...]
    key_name: tuple[str, ...]
    gravity: Array
    body_parentid: Indices
    body_mocapid: Indices
    body_pos: Array
    body_quat: Array
    body_mass: Array
    body_ipos: Array
    body_iquat: Array
    body_inertia: Array
    jnt_type: Indices
    jnt_bodyid: Indices
    jnt_qposadr: Indices
    jnt_pos: Array
    jnt_axis: Array
    jnt_range: Array
    jnt_limited: Indices
    jnt_velocity: Array
    qpos0: Array
    geom_type: Indices
    geom_bodyid: Indices
    geom_dataid: Indices
    geom_group: Indices
    geom_contype: Indices
    geom_conaffinity: Indices
    geom_pos: Array
    geom_quat: Array
    geom_size: Array
    geom_friction: Array
    geom_priority: Indices
    geom_condim: Indices
    exclude_signature: Indices
    pair_geom1: Indices
    pair_geom2: Indices
    pair_friction: Array
    eq_type: Indices
    eq_objtype: Indices
    eq_obj1id: Indices
    eq_obj2id: Indices
    eq_active0: Indices
    eq_data: Array
    key_qpos: Array
    key_mpos: Array
    key_mquat: Array
    mesh_vertnum: Indices
    mesh_facenum: Indices
    mesh_vert: Array
    mesh_face: Indices

    def pose(self, body: int) -> tuple[Array, Array]:
        """Return position (3,) [m] and orientation (4,) of a body in the world, at the reference."""
        place, turn = np.zeros(3), np.array(rotation.IDENTITY)
        while body > 0:
            frame = rotation.normalised(self.body_quat[body])
            place, turn = self.body_pos[body] + rotation.rotate(frame, place), rotation.multiply(frame, turn)
            body = int(self.body_parentid[body])
        return place, turn

    def mesh(self, k: int) -> tuple[Array, Indices]:
        """Return vertices (n, 3) [m] and triangles (t, 3) of mesh `k`."""
        vertex, face = int(self.mesh_vertnum[:k].sum()), int(self.mesh_facenum[:k].sum())
        return (self.mesh_vert[vertex : vertex + int(self.mesh_vertnum[k])],
                self.mesh_face[face : face + int(self.mesh_facenum[k])])


def compiled(path: Path, folder: str | Path | None = None, scale: float = 1.0, collide: str = "collision") -> Compiled:
    """Return the model of an MJCF or URDF file, compiled by MuJoCo in a separate process with limits.
    `scale` is metres a unit of length, `collide` of `preflight.COLLIDE` the shapes that collide.

    All files that it names must lie in `folder`; see `preflight.folder_of`. Raises InvalidFile for a refused file, with the
    reason; MissingPackage without mujoco; UnsupportedVersion where two versions of it overwrote each other."""
    preflight.require_model(path)
    if find_spec("mujoco") is None:
        raise MissingPackage("mujoco", "assets", f"reading {path.name}")
    check_folder()
    return received(path.name, _run(path, preflight.folder_of(path, folder), scale, collide))


def received(name: str, content: bytes) -> Compiled:
    """Return the model that the process sent as the bytes of an npz file; `name` is its name in errors.
    Raises InvalidFile for a file that it refused, for invalid bytes, and for numbers that are not finite."""
    arrays = _arrays(name, content)
    if "refused" in arrays:
        thing, value, valid = json.loads(str(arrays["refused"]))
        raise InvalidFile(thing, value, valid)
    return _checked(name, arrays)


def _run(path: Path, folder: Path, scale: float, collide: str) -> bytes:
    """Return the output of the process. Raises InvalidFile where it does not end by itself."""
    arguments = [str(path.absolute()), str(folder), repr(scale), collide]
    command = [sys.executable, "-m", "avatarsim.assets.models.compile_process", *arguments]
    # threads and their heaps reserve address space, which is limited
    calm = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "MALLOC_ARENA_MAX": "1", "MUJOCO_GL": "disable"}
    calm["PYTHONPATH"] = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH", "")]))
    # an empty folder: any path that the compiler tries is missing
    with tempfile.TemporaryDirectory(prefix="avatarsim-model-") as nowhere:
        process = subprocess.Popen(
            command, cwd=nowhere, env=calm, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE
        )
        try:
            content, output = process.communicate(timeout=LONGEST_RUN)
        except subprocess.TimeoutExpired:
            raise InvalidFile(f"time for model {path.name} [s]", LONGEST_RUN, "a model that compiles in less") from None
        finally:
            process.kill()
            process.wait()
    if process.returncode == 0:
        return content
    if process.returncode in (-signal.SIGXCPU, -signal.SIGALRM):
        raise InvalidFile(f"time to compile model {path.name}", "too long", "a smaller model: 4 s, and 0.25 s for each megabyte")
    last = (output.decode("utf-8", "replace").strip().splitlines() or ["without a word"])[-1]
    ended = f"MuJoCo's compiler ended by {_ending(process.returncode)}: {last}"
    raise InvalidFile(f"model {path.name}", ended, "a model that it compiles within 2 GB")


def _ending(code: int) -> str:
    """Describe how a process ended."""
    return f"code {code}" if code >= 0 else signal.Signals(-code).name


def _arrays(name: str, content: bytes) -> Mapping[str, NDArray[Any]]:
    try:
        with np.load(io.BytesIO(content), allow_pickle=False) as found:
            return {key: found[key] for key in found.files}
    except (ValueError, OSError, EOFError, BadZipFile) as error:
        raise InvalidFile(f"compiled model {name}", f"cut off: {error}", "all arrays of it") from error


def _checked(name: str, arrays: Mapping[str, NDArray[Any]]) -> Compiled:
    """Return the model if all of its arrays are there, none is too long, and all numbers are finite."""
    for field in fields(Compiled):
        if field.name not in arrays:
            raise InvalidFile(f"arrays of compiled model {name}", f"none is {field.name}", "all arrays of it")
    for thing, key, most in (
        ("bodies", "body_name", BODIES), ("shapes", "geom_name", GEOMS), ("joints", "jnt_name", BODIES),
        ("vertices", "mesh_vert", caps.VERTICES),
    ):
        if len(arrays[key]) > most:
            raise InvalidFile(f"number of {thing} of {name}", len(arrays[key]), f"up to {most}")
    found: dict[str, Any] = {}
    for field in fields(Compiled):
        array = arrays[field.name]
        if field.type in (bool, int, str):
            found[field.name] = field.type(array)
        elif field.name.endswith("_name"):
            found[field.name] = tuple(str(one) for one in array)
        else:
            found[field.name] = _array(f"{field.name} of {name}", array, field.type is Array)
    return Compiled(**found)


def _array(thing: str, array: NDArray[Any], real: bool) -> NDArray[Any]:
    if array.dtype.kind not in "biuf" or not np.isfinite(array).all():
        raise InvalidFile(thing, "not finite", "finite numbers")
    return np.ascontiguousarray(array, dtype=np.float64 if real else np.int64)
