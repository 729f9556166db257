"""Worker process of MuJoCo's compiler, the only module that imports it: `python -m avatarsim.assets.models.compile_process FILE`.

Reads MJCF and URDF by MjSpec (Todorov, Erez and Tassa 2012) and writes numbers of the compiled model to the standard output, as
the bytes of an npz file. It is a separate process, with limits on memory and time: the compiler is made for files of its user,
and a file from elsewhere may crash it or block it. It gets file contents in memory only, no path that it could open.
"""

import io
import json
import os
import re
import resource
import signal
import sys
from pathlib import Path
from typing import Any

import numpy as np

from avatarsim.assets import caps
from avatarsim.assets.models import preflight
from avatarsim.assets.models.compiled import VISIBLE_GROUPS
from avatarsim.assets.models.mesh_files import MeshFiles
from avatarsim.assets.models.spec_repairs import bare, with_solid_moments
from avatarsim.assets.models.spec_scale import in_metres
from avatarsim.errors import InvalidFile

MEMORY = 2**31
"""Bytes of address space [2.1 GB]. MuJoCo with the meshes of a humanoid (19 MB) takes 0.6 GB. Less: robots with fine meshes fail;
more: two at a time fill a small machine."""

SECONDS, SECONDS_PER_MEGABYTE = 4, 0.25
"""CPU time [s] for any model, and for each megabyte of its files. MuJoCo takes 0.02 s for one on a machine of 2020."""

WALL = 10
"""Real time for each second of CPU time, on a machine with other work. Less: sound models are refused on one with ten jobs a
core; more: a blocked process is ended later."""

COPLANAR = re.compile("mesh '(.*)' has coplanar vertices")
"""MuJoCo's message for a mesh without thickness."""

NOWHERE = "/avatarsim-model/"
"""Virtual folder of a model's texts for the compiler, in memory only: no machine has it."""


def seconds_for(count: int) -> float:
    """Return the CPU time [s] for a model of so many bytes."""
    return SECONDS + SECONDS_PER_MEGABYTE * count / 2**20


def limit(seconds: float) -> None:
    """Limit memory and time, counted from the process's start; the process ends beyond them."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    # the soft limit ends the process as well, and may be raised once the sizes of the files are known
    resource.setrlimit(resource.RLIMIT_CPU, (int(np.ceil(seconds)), resource.getrlimit(resource.RLIMIT_CPU)[1]))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    signal.setitimer(signal.ITIMER_REAL, WALL * seconds)


def compiled(path: Path, folder: Path, scale: float = 1.0, collide: str = "collision") -> dict[str, Any]:
    """Return arrays of the model of a file, all of whose files lie in `folder`; `scale` is metres a unit of length.
    `collide` selects the shapes that collide. Raises InvalidFile."""
    import mujoco

    model, texts, mended, plates = compiled_by_mujoco(path, folder, scale, collide)
    numbers = _numbers(model, path, mujoco)
    numbers |= _keyframes(model, mujoco, scale)
    kind = {"free_root": np.array(texts.free_root), "is_urdf": np.array(texts.is_robot)}
    kind["plate_name"] = np.array(plates, dtype=np.str_)
    kind["plugin_name"] = np.array(texts.plugins, dtype=np.str_)
    # MuJoCo does not read limits of speed
    stated = [texts.velocities.get(name, 0.0) for name in numbers["jnt_name"].tolist()]
    kind["jnt_velocity"] = np.array(stated, dtype=np.float64)
    return {**kind, "mended_name": np.array(mended, dtype=np.str_), **numbers}


def compiled_by_mujoco(
    path: Path, folder: Path, scale: float = 1.0, collide: str = "collision", limited: bool = True
) -> tuple[Any, preflight.Texts, list[str], list[str]]:
    """Return MuJoCo's model of a file, its texts, bodies whose moments were raised, meshes that were thickened.
    If `limited`, this process is limited by the files' sizes.

    Raises InvalidFile."""
    texts = preflight.texts_of(path, folder, collide)
    import mujoco

    def count(read: int) -> None:
        if limited:
            limit(seconds_for(texts.bytes + read))

    vfs = mujoco.MjVfs()
    for name, content in texts.texts.items():
        place = NOWHERE + name
        vfs[place] = content
    try:
        spec = mujoco.MjSpec.from_file(NOWHERE + texts.main, vfs=vfs)
        files = MeshFiles(texts, NOWHERE, count)
        files.attach_meshes(spec)
        bare(spec, mujoco)
        in_metres(spec, scale, mujoco.mjtJoint.mjJNT_SLIDE)
        mended = with_solid_moments(spec)
        # links of a robot stay links, and nothing of the URDF file is merged into the world
        spec.compiler.fusestatic = False
        if collide == "visual" and not texts.is_robot:
            _swap_shapes(spec)
        return _compiled(spec, files, mujoco), texts, mended, files.plates
    except (ValueError, RuntimeError, mujoco.FatalError) as error:
        text = " ".join(str(error).replace(NOWHERE, "").split())
        raise InvalidFile(f"model {path.name}", text, "a model that MuJoCo's compiler takes") from error


def _swap_shapes(spec: Any) -> None:
    """Let visual shapes collide, in place of the collision shapes of their body.

    A body without any keeps its own; the world's, such as a floor, are both, and stay."""
    spec.compiler.discardvisual = False
    named = {name for pair in spec.pairs for name in (pair.geomname1, pair.geomname2)}
    off = set[str]()
    for body in spec.bodies:
        seen = [geom for geom in body.geoms if not (geom.contype or geom.conaffinity or geom.name in named)]
        for geom in body.geoms if seen and body.name != "world" else ():
            geom.contype = geom.conaffinity = 0
            off.add(geom.name)
        for geom in seen:
            geom.contype = geom.conaffinity = 1
    for pair in list(spec.pairs):
        if {pair.geomname1, pair.geomname2} & off:
            spec.delete(pair)


def _compiled(spec: Any, files: MeshFiles, mujoco: Any) -> Any:
    """Return the compiled model; masses of open meshes are those of their hulls, or of their surfaces; flat ones are plates."""
    kinds = iter((mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX, mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL))
    while True:
        try:
            return spec.compile()
        except ValueError as error:
            flat = COPLANAR.search(str(error))
            if flat is not None and flat[1] not in files.plates:
                files.thicken(spec.mesh(flat[1]))
                continue
            kind = next(kinds, None)
            if kind is None or not ("volume" in str(error) or "orientation" in str(error)):
                raise
        for mesh in spec.meshes:
            mesh.inertia = kind


def _numbers(model: Any, path: Path, mujoco: Any) -> dict[str, Any]:
    """Return the arrays that are read from a compiled model, under MuJoCo's names."""
    kinds = {"body": (mujoco.mjtObj.mjOBJ_BODY, model.nbody), "jnt": (mujoco.mjtObj.mjOBJ_JOINT, model.njnt),
             "geom": (mujoco.mjtObj.mjOBJ_GEOM, model.ngeom), "eq": (mujoco.mjtObj.mjOBJ_EQUALITY, model.neq),
             "mesh": (mujoco.mjtObj.mjOBJ_MESH, model.nmesh), "key": (mujoco.mjtObj.mjOBJ_KEY, model.nkey)}
    found: dict[str, Any] = {}
    for kind, (code, count) in kinds.items():
        names = [mujoco.mj_id2name(model, code, k) or "" for k in range(count)]
        if longest := max((name for name in names if len(name) > caps.NAME), key=len, default=""):
            raise InvalidFile(f"characters of a name in {path.name}", len(longest), f"up to {caps.NAME}")
        found[f"{kind}_name"] = np.array(names, dtype=np.str_)
    for name in (
        "body_parentid body_mocapid body_pos body_quat body_mass body_ipos body_iquat body_inertia jnt_type jnt_bodyid jnt_pos "
        "jnt_axis jnt_range jnt_limited jnt_qposadr qpos0 geom_type geom_bodyid geom_pos geom_quat geom_size geom_contype "
        "geom_conaffinity geom_dataid geom_group geom_priority geom_condim exclude_signature pair_geom1 pair_geom2 eq_type "
        "eq_objtype eq_obj1id eq_obj2id eq_data eq_active0"
    ).split():
        found[name] = getattr(model, name)
    weightless = model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_GRAVITY
    found["gravity"] = np.zeros(3) if weightless else model.opt.gravity.copy()
    # sliding friction: torsional and rolling friction have no part in point contacts
    found["geom_friction"], found["pair_friction"] = model.geom_friction[:, 0].copy(), model.pair_friction[:, 0].copy()
    if model.opt.enableflags & mujoco.mjtEnableBit.mjENBL_OVERRIDE:
        found["geom_friction"][:] = found["pair_friction"][:] = model.opt.o_friction[0]
    # a contact of one dimension has a normal alone
    found["pair_friction"][model.pair_dim == 1] = 0.0
    found["unread_name"] = np.array(_unread(model, mujoco), dtype=np.str_)
    found["flexes"] = np.array(model.nflex)
    found["model_name"] = np.array(bytes(model.names).split(b"\0")[0].decode("utf-8", "replace"))
    return found | _meshes(model, mujoco)


def _unread(model: Any, mujoco: Any) -> list[str]:
    """Return the features of motion and contacts in the file that have no counterpart here."""
    option, disabled = model.opt, mujoco.mjtDisableBit
    loose = np.isin(model.body_rootid, model.jnt_bodyid[model.jnt_type == mujoco.mjtJoint.mjJNT_FREE])
    stated = {
        "a flag that disables all contacts": option.disableflags & (disabled.mjDSBL_CONTACT | disabled.mjDSBL_CONSTRAINT),
        "a flag that lets parent and child touch": option.disableflags & disabled.mjDSBL_FILTERPARENT,
        "wind, density or viscosity of a medium": option.density or option.viscosity or option.wind.any(),
        "gravity compensation of loose bodies": (model.body_gravcomp[loose] != 0.0).any(),
    }
    return [text for text, is_stated in stated.items() if is_stated]


def _keyframes(model: Any, mujoco: Any, scale: float) -> dict[str, Any]:
    """Return coordinates of the keyframes, with `scale` metres a unit of length."""
    qpos, kinds = model.key_qpos.copy(), mujoco.mjtJoint
    for kind, address in zip(model.jnt_type, model.jnt_qposadr, strict=True):
        if kind in (kinds.mjJNT_FREE, kinds.mjJNT_SLIDE):
            qpos[:, address : address + (3 if kind == kinds.mjJNT_FREE else 1)] *= scale
    turns = model.key_mquat.reshape(-1, 4).copy()
    turns[~turns.any(axis=1)] = 1.0, 0.0, 0.0, 0.0
    return {"key_qpos": qpos, "key_mpos": scale * model.key_mpos, "key_mquat": turns.reshape(model.key_mquat.shape)}


def _meshes(model: Any, mujoco: Any) -> dict[str, Any]:
    """Return vertices and triangles of the meshes that bodies collide with, one after the other, and of visible meshes.
    The latter only where all together are within the limit of vertices; other meshes are empty."""
    touching = (model.geom_contype != 0) | (model.geom_conaffinity != 0)
    touching[model.pair_geom1] = touching[model.pair_geom2] = True
    of_mesh = model.geom_type == mujoco.mjtGeom.mjGEOM_MESH
    for used in (touching | (model.geom_group < VISIBLE_GROUPS), touching):
        chosen = np.isin(np.arange(model.nmesh), model.geom_dataid[used & of_mesh])
        if model.mesh_vertnum[chosen].sum() <= caps.VERTICES:
            break
    vertices = model.mesh_vert[np.repeat(chosen, model.mesh_vertnum)]
    faces = model.mesh_face[np.repeat(chosen, model.mesh_facenum)]
    return {
        "mesh_vertnum": np.where(chosen, model.mesh_vertnum, 0), "mesh_facenum": np.where(chosen, model.mesh_facenum, 0),
        "mesh_vert": vertices.astype(np.float64), "mesh_face": faces,
    }


def main(arguments: list[str]) -> int:
    """Compile the file; npz bytes go to the standard output: the model, or in `refused` the error as JSON."""
    path = Path(arguments[0])
    # MuJoCo prints warnings: only the answer is written to the standard output
    answer = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    limit(SECONDS)
    try:
        numbers = compiled(path, preflight.folder_of(path, arguments[1]), float(arguments[2]), arguments[3])
    except InvalidFile as error:
        value = error.value if isinstance(error.value, str | int | float) else repr(error.value)
        numbers = {"refused": np.array(json.dumps([error.thing, value, error.valid]))}
    except MemoryError:
        valid = f"one that compiles in {MEMORY:.2g} bytes"
        numbers = {"refused": np.array(json.dumps([f"model {path.name}", "too large", valid]))}
    buffer = io.BytesIO()
    np.savez(buffer, **numbers)
    with answer:
        answer.write(buffer.getbuffer())
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
