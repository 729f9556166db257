"""Worker process of MuJoCo's compiler, the only module that imports it: `python -m avatarsim.assets.models.compile_process FILE`.

Reads MJCF and URDF by MjSpec (Todorov, Erez and Tassa 2012) and writes numbers of the compiled model to the standard output, as
the bytes of an npz file. A process of its own, with limits on memory and time: the compiler is made for files of its user, and a
file from elsewhere may crash it or keep it forever. It is given memory only, no path that it could open.
"""

import io
import json
import os
import resource
import signal
import sys
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np

from avatarsim.assets.models import doors
from avatarsim.errors import InvalidFile
from avatarsim.files import read_bytes

MEMORY = 2**31
"""Bytes of address space [2.1 GB]. MuJoCo with the meshes of a humanoid (19 MB) takes 0.6 GB. Less: robots with fine meshes fail;
more: two at a time fill a small machine."""

SECONDS, SECONDS_PER_MEGABYTE = 4, 0.25
"""CPU time [s] for any model, and for each megabyte of its files. MuJoCo takes 0.02 s for one on a machine of 2020."""

WALL = 3
"""Real time for each second of CPU time: on a machine with other work."""

FLAT = 2
"""Width [pixels] of what stands in for a texture."""


def limit(seconds: float) -> None:
    """End this process when it takes more memory, or more time from its start on."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    # the soft limit ends the process as well, and may be raised once the sizes of the files are known
    resource.setrlimit(resource.RLIMIT_CPU, (int(np.ceil(seconds)), resource.getrlimit(resource.RLIMIT_CPU)[1]))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    signal.setitimer(signal.ITIMER_REAL, WALL * seconds)


def compiled(path: Path, folder: Path) -> dict[str, Any]:
    """Arrays of the model of a file, all of whose files lie in `folder`. Raises InvalidFile."""
    texts = doors.texts_of(path, folder)
    import mujoco

    vfs = mujoco.MjVfs()
    for name, content in texts.texts.items():
        vfs[name] = content
    try:
        spec = mujoco.MjSpec.from_file(texts.main, vfs=vfs)
    except (ValueError, mujoco.FatalError) as error:
        raise _uncompiled(path, error) from error
    meshes = _mesh_files(spec, texts)
    total = texts.bytes + sum(map(len, meshes.values()))
    limit(SECONDS + SECONDS_PER_MEGABYTE * total / 2**20)
    spec.assets = meshes
    _without_pictures(spec, mujoco)
    # links of a robot stay links, and nothing of the URDF file is merged into the world
    spec.compiler.fusestatic = False
    try:
        model = spec.compile()
    except (ValueError, mujoco.FatalError) as error:
        raise _uncompiled(path, error) from error
    return {"urdf": np.array(texts.is_urdf), **_numbers(model, mujoco)}


def _uncompiled(path: Path, error: Exception) -> InvalidFile:
    said = " ".join(str(error).split())
    return InvalidFile(f"model {path.name}", said, "a model that MuJoCo's compiler takes")


def _mesh_files(spec: Any, texts: doors.Texts) -> dict[str, bytes]:
    """The content of each mesh file by a name of its own, which takes the place of its path in the model."""
    main, found, left = PurePosixPath(texts.main).parent, dict[str, bytes](), doors.ASSET_BYTES
    # the folders of the models that this one is made of, its own first
    bases = list(dict.fromkeys([main, *(PurePosixPath(name).parent for name in texts.texts)]))
    names = dict[Path, str]()
    # the settings of the compiler are shared between meshes: read before the first one is changed
    for mesh, meshdir in [(mesh, mesh.compiler.meshdir) for mesh in spec.meshes if mesh.file]:
        mesh.name = mesh.name or PurePosixPath(mesh.file).stem
        thing = f"mesh {mesh.name} of {texts.main}"
        doors.require_relative(thing, mesh.file)
        ending = PurePosixPath(mesh.file).suffix.lower()
        if ending not in doors.MESH_ENDINGS:
            valid = f"a file {' '.join(doors.MESH_ENDINGS)}, which is what MuJoCo reads: convert it"
            raise InvalidFile(thing, mesh.file, valid)
        _, place = doors.existing(thing, candidates(mesh.file, meshdir, bool(spec.strippath), bases), texts.folder)
        if place not in names:
            content = read_bytes(place, thing, "a readable mesh file", left)
            left -= len(content)
            names[place] = f"{len(names)}{ending}"
            found[names[place]] = content
        mesh.file, mesh.content_type = names[place], ""
        mesh.compiler.meshdir = ""
    spec.meshdir, spec.strippath = "", False
    return found


def candidates(file: str, meshdir: str, stripped: bool, bases: list[PurePosixPath]) -> list[PurePosixPath]:
    """Paths below the folder at which a mesh may lie, in the order in which they are tried: as MuJoCo would find it, as it is
    written, and for package://name/rest the rest below each folder above, with and without the name."""
    scheme, mark, rest = file.partition("://")
    path = PurePosixPath(rest if mark else scheme)
    found: list[PurePosixPath] = []
    for base in bases:
        if stripped and meshdir:
            found.append(base / meshdir / path.name)
        if not mark:
            found += [base / meshdir / path, base / path]
        else:
            for above in (base, *base.parents):
                found += [above / path, above / PurePosixPath(*path.parts[1:])]
        if stripped:
            found.append(base / meshdir / path.name)
    return list(dict.fromkeys(found))


def _without_pictures(spec: Any, mujoco: Any) -> None:
    """Plain colours for textures and flat ground for height fields, so that no picture is opened; no skin, no keyframe."""
    for texture in spec.textures:
        texture.file, texture.builtin = "", mujoco.mjtBuiltin.mjBUILTIN_FLAT
        texture.cubefiles = [""] * len(texture.cubefiles)
        texture.width = FLAT
        texture.height = FLAT if texture.type == mujoco.mjtTexture.mjTEXTURE_2D else 6 * FLAT
    for field in spec.hfields:
        field.file, field.nrow, field.ncol, field.userdata = "", FLAT, FLAT, [0.0] * FLAT**2
    for unread in (*spec.skins, *spec.keys):
        spec.delete(unread)


def _numbers(model: Any, mujoco: Any) -> dict[str, Any]:
    """What is read of a compiled model, under MuJoCo's names."""
    kinds = {"body": (mujoco.mjtObj.mjOBJ_BODY, model.nbody), "jnt": (mujoco.mjtObj.mjOBJ_JOINT, model.njnt),
             "geom": (mujoco.mjtObj.mjOBJ_GEOM, model.ngeom), "eq": (mujoco.mjtObj.mjOBJ_EQUALITY, model.neq),
             "mesh": (mujoco.mjtObj.mjOBJ_MESH, model.nmesh)}
    found: dict[str, Any] = {
        f"{kind}_name": np.array([mujoco.mj_id2name(model, code, k) or "" for k in range(count)], dtype=np.str_)
        for kind, (code, count) in kinds.items()
    }
    for name in (
        "body_parentid body_mocapid body_pos body_quat body_mass body_ipos body_iquat body_inertia jnt_type jnt_bodyid jnt_pos "
        "jnt_axis jnt_range jnt_limited jnt_qposadr qpos0 geom_type geom_bodyid geom_pos geom_quat geom_size geom_contype "
        "geom_conaffinity geom_dataid exclude_signature pair_geom1 pair_geom2 eq_type eq_objtype eq_obj1id eq_obj2id eq_data "
        "eq_active0"
    ).split():
        found[name] = getattr(model, name)
    found["flexes"] = np.array(model.nflex)
    found["model_name"] = np.array(bytes(model.names).split(b"\0")[0].decode("utf-8", "replace"))
    return found | _meshes(model, mujoco)


def _meshes(model: Any, mujoco: Any) -> dict[str, Any]:
    """Vertices and triangles of the meshes that bodies collide with, one after the other; of the rest none."""
    touching = (model.geom_contype != 0) | (model.geom_conaffinity != 0)
    touching[model.pair_geom1] = touching[model.pair_geom2] = True
    used = model.geom_dataid[touching & (model.geom_type == mujoco.mjtGeom.mjGEOM_MESH)]
    chosen = np.isin(np.arange(model.nmesh), used)
    vertices = model.mesh_vert[np.repeat(chosen, model.mesh_vertnum)]
    faces = model.mesh_face[np.repeat(chosen, model.mesh_facenum)]
    return {
        "mesh_vertnum": np.where(chosen, model.mesh_vertnum, 0), "mesh_facenum": np.where(chosen, model.mesh_facenum, 0),
        "mesh_vert": vertices.astype(np.float64), "mesh_face": faces,
    }


def main(arguments: list[str]) -> int:
    """Compile the file; npz bytes go to the standard output: the model, or in `refused` the error as JSON."""
    path = Path(arguments[0])
    # MuJoCo prints warnings: what is written to the standard output is the answer and nothing else
    answer = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    limit(SECONDS)
    try:
        numbers = compiled(path, doors.folder_of(path, arguments[1] if len(arguments) > 1 else None))
    except InvalidFile as error:
        value = error.value if isinstance(error.value, str | int | float) else repr(error.value)
        numbers = {"refused": np.array(json.dumps([error.thing, value, error.valid]))}
    except MemoryError:
        numbers = {"refused": np.array(json.dumps([f"model {path.name}", "out of memory", f"one that takes {MEMORY:g} bytes"]))}
    buffer = io.BytesIO()
    np.savez(buffer, **numbers)
    with answer:
        answer.write(buffer.getbuffer())
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
