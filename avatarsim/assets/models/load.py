"""Entry points `load_avatar` and `load_room`: from a path and options to a Model."""

from pathlib import Path

from avatarsim.assets.meshes import pieces_of_mesh
from avatarsim.assets.meshes.convex_pieces import turned
from avatarsim.assets.meshes.mesh import BY_TRIMESH, read_mesh
from avatarsim.assets.meshes.repairs import ADVICE
from avatarsim.assets.models import preflight
from avatarsim.assets.models.from_mujoco import Options, model_of_file
from avatarsim.assets.models.links_of_tree import JointOptions
from avatarsim.assets.models.model import Model
from avatarsim.assets.models.pieces_of_geoms import PLANE, MeshOptions
from avatarsim.errors import InvalidFile, InvalidShape
from avatarsim.scene.avatar import PLAUSIBLE_SIZE
from avatarsim.scene.body import fixed
from avatarsim.scene.shape import Box, Piece

FLOOR = "floor"
"""Value for level ground without a file."""

MESHES = (".obj", *BY_TRIMESH)
"""Suffixes of mesh files that are rooms."""


def load_avatar(
    path: str | Path, *, avatar: str | tuple[str, ...] | None = None, root: str = "file", fix: tuple[str, ...] | str = (),
    meshes: str | tuple[str, ...] = "hull", most_vertices: int = 128, repair: str = "auto",
    fit: float | None = None, leave: tuple[str, ...] = (), masks: bool = True, folder: str | Path | None = None,
    size_range: tuple[float, float] = PLAUSIBLE_SIZE, scale: float = 1.0, keyframe: str | int | None = None,
    collide: str = "collision", needed: bool = True, exclude: tuple[tuple[str, str], ...] = (),
) -> Model:
    """Load an avatar, room and loose bodies of MJCF or URDF, compiled by MuJoCo (Todorov et al. 2012) in a limited process.

    avatar      name of a body of the tree that becomes the avatar, or several, whose trees are one avatar then (two arms on a
                table); by default the tree with the most joints
    root        "file": free where the file has a free joint, and in URDF, which cannot state it, unless its root is named
                "world"; "free"; "fixed"
    fix         names of joints to fix at the file's reference, or "all" for those that an avatar cannot have: that an equality
                makes follow another along a curve; otherwise these are refused by name
    meshes      "hull": the convex hull of each mesh; "decompose": convex pieces by CoACD, open surfaces mended as `repair` sets,
                which takes seconds for a mesh and is kept; or the names of those meshes to decompose
    most_vertices   of a piece of a mesh, which encloses the mesh's hull; the added distance is in `notes`
    fit         [m] that enclosing a hull may add; where `most_vertices` add more, a piece has more vertices
    leave       names of geoms to leave out
    masks       False: links touch regardless of contype and conaffinity
    folder      the folder in which all files of the model must lie; by default the file's own, of URDF the one with package.xml
    size_range  [m] valid range of the avatar's span
    scale       metres a unit of length of the file: all of it, room and loose bodies too; stated masses stay as they are
    collide     "collision": the file's collision shapes; "visual": its visual shapes in their place
    keyframe    name or number of the keyframe to start at, "qpos0" for the reference; by default the one named home, else the
                first one, else the reference
    needed      False: a file in which nothing has joints is a room and loose bodies, and no error
    exclude     pairs of names of links or bodies that never touch, besides those of the file

    Other trees with a free joint are loose bodies, those without joints the fixed room. At the start loose bodies that overlap
    are moved apart, a free avatar is raised out of the room, and links that overlap then may be no deeper; `notes` lists them
    with depths, and all other differences from the file.
    Raises InvalidFile for a rejected file, with file, place and advice; StartOverlaps for overlaps that can be neither moved
    apart nor guarded; UnknownName and InvalidInput for options that do not fit; MissingPackage without mujoco."""
    return model_of_file(
        Path(path),
        Options(
            avatar, True if needed else None, folder, JointOptions(fix, root),
            MeshOptions(meshes, most_vertices, repair, fit), leave, masks, size_range=size_range, scale=scale,
            collide=collide, keyframe=keyframe, exclude=exclude,
        ),
    )


def load_room(
    path: str | Path, *, meshes: str | tuple[str, ...] = "hull", most_vertices: int = 128, repair: str = "auto",
    fit: float | None = None, leave: tuple[str, ...] = (), folder: str | Path | None = None, scale: float = 1.0,
    y_up: bool = False, threshold: float = 0.05, keyframe: str | int | None = None, collide: str = "collision",
) -> Model:
    """Load a room from MJCF or URDF, a mesh (.obj .stl .ply .off .glb .gltf .dae), or "floor": level ground, its top at 0.

    Of a model all bodies are taken, jointed ones as they are at the reference: with a free joint loose, else fixed. The options
    are those of `load_avatar`, `scale` is metres a unit of length of any file. A mesh is one fixed body of convex pieces: `y_up`
    where y points up in it, `threshold` and `repair` as in `pieces_of_mesh`. Raises the errors of `load_avatar`."""
    if str(path) == FLOOR:
        top = Piece(Box(PLANE), (0.0, 0.0, -0.5 * PLANE[2]))
        return Model(None, None, (fixed(FLOOR, (top,), "wood"),), ())
    path = Path(path)
    if path.suffix.lower() in preflight.MODELS:
        wanted = MeshOptions(meshes, most_vertices, repair, fit)
        options = Options(
            driven=False, folder=folder, pieces=wanted, leave=leave, scale=scale, collide=collide, keyframe=keyframe
        )
        return model_of_file(path, options)
    if path.suffix.lower() not in MESHES:
        advice = preflight.CONVERSION.get(path.suffix.lower())
        valid = f"one of {' '.join((*preflight.MODELS, *MESHES))}, or the word {FLOOR}"
        raise InvalidFile(f"format of {path.name}", path.suffix, f"{valid}; {advice}" if advice else valid)
    try:
        mesh = read_mesh(path)
        found = pieces_of_mesh(
            mesh, scale, y_up=y_up, threshold=threshold, most_vertices=most_vertices, repair=repair, fit=fit
        )
    except InvalidShape as error:
        # a room has pieces only, no single hull
        valid = error.valid.replace(ADVICE, 'repair="remesh" wraps it in a closed one')
        raise InvalidFile(error.thing, error.value, valid) from error
    notes = (f"{len(found.pieces)} convex pieces ({found.source}), at most {1e3 * found.hausdorff:.3g} mm off", *found.repairs)
    visuals = {path.stem: ((turned(scale * mesh.vertices, y_up), mesh.triangles),)}
    return Model(None, None, (fixed(path.stem, found.pieces, "wood"),), notes, visuals=visuals)
