"""Options for reading, checking and combining files."""

import argparse
from pathlib import Path

from avatarsim.assets.meshes.decompose import REPAIRS
from avatarsim.assets.models.preflight import COLLIDE
from avatarsim.assets.models.smpl_skeleton import LEAST_STATURE, MOST_STATURE
from avatarsim.assets.models.spec_scale import LARGEST, SMALLEST
from avatarsim.assets.motions.frame_times import HIGHEST, LOWEST
from avatarsim.assets.motions.home import parsed_home
from avatarsim.clips.reading import Reading
from avatarsim.console import path_option
from avatarsim.errors import InvalidInput
from avatarsim.scene.checks import within

MASSES = (1e-3, 1e4)
"""Masses [kg] of a human that a recorded skeleton gets, dolls and giants included."""
RANGES = {
    "file_rate": (LOWEST, HIGHEST), "scale": (SMALLEST, LARGEST), "avatar_scale": (SMALLEST, LARGEST),
    "room_scale": (SMALLEST, LARGEST), "object_scale": (SMALLEST, LARGEST),
    "stature": (LEAST_STATURE, MOST_STATURE), "mass": MASSES,
}
"""Valid ranges of numeric options of readers, in the units of their help."""
OF_AVATAR, OF_ROOM = ("body", "fix", "root", "leave", "exclude"), ("room_scale", "room_up")
"""Options that go with an avatar's file, and with a room's."""
OF_EITHER = ("keyframe", "collide", "fit", "folder", "meshes", "repair")
"""Options that go with one of the two."""


def reading_options(one: argparse.ArgumentParser) -> None:
    """Add the options on how motions and models are read, which all commands that read them share."""
    motion = one.add_argument_group("how motions are read")
    motion.add_argument("--file-rate", type=float, metavar="HZ", help="frames a second of files that state none")
    motion.add_argument("--scale", type=float, metavar="M", help="metres a unit of length (default: guessed and said)")
    motion.add_argument("--up", choices=("y", "z"), help="the axis that points up (default: guessed and said)")
    motion.add_argument("--asf", metavar="FILE", type=path_option, help="skeleton of AMC files (default: the one beside them)")
    motion.add_argument("--home", metavar="FRAME | FILE | FILE:FRAME",
                        help="where a recorded skeleton's limits and allowed depths are measured: a frame, another clip of it")
    motion.add_argument("--mass", type=float, metavar="KG", help="of a human of a recorded skeleton (default: a mean one)")
    motion.add_argument("--no-limits", action="store_true", help="recorded skeletons without limits of joints")
    motion.add_argument("--quaternion", choices=("wxyz", "xyzw"), help="order of quaternions of trajectories")
    motion.add_argument("--joints", metavar="A,B,...", help="names of a trajectory's joints, where it has none")
    motion.add_argument("--offsets", metavar="FILE", help="rest joints of an SMPL body; or the word mean, of BVH")
    motion.add_argument("--stature", type=float, metavar="M", help="height of an SMPL body without offsets")
    motion.add_argument("--object", metavar="FILE", type=path_option,
                        help="shape of the object that motions have poses of: MJCF, URDF or a mesh")
    motion.add_argument("--object-scale", type=float, metavar="M",
                        help="metres a unit of length of it (default: as the motion states it, else 1)")
    model = one.add_argument_group("how models are read")
    model.add_argument("--body", default="", metavar="A,B,...",
                       help="bodies whose trees are the avatar (default: the tree with the most joints)")
    model.add_argument("--keyframe", metavar="NAME", help="keyframe to start at; qpos0: none (default: home, else the first)")
    model.add_argument("--collide", choices=COLLIDE, help="shapes that collide: as the file has it, or those to be looked at")
    model.add_argument("--fit", type=float, metavar="M", help="most metres that a piece may be wider than the hull of its mesh")
    model.add_argument("--fix", default="", metavar="A,B,...",
                       help="hold these joints at the file's reference; all: those that an avatar cannot have")
    model.add_argument("--root", choices=("file", "free", "fixed"), help="whether the avatar's root moves (default: file)")
    model.add_argument("--leave", default="", metavar="A,B,...", help="leave out these geoms")
    model.add_argument("--exclude", default="", metavar="A:B,...", help="pairs of links or bodies that never touch")
    model.add_argument("--folder", metavar="DIR", type=path_option, help="folder in which all files of a model must lie")
    model.add_argument("--meshes", choices=("hull", "decompose"), help="meshes by their hulls (default), or by convex pieces")
    model.add_argument("--repair", choices=REPAIRS, help="of open or crossing surfaces of meshes (default auto)")
    model.add_argument("--avatar-scale", type=float, metavar="M", help="metres a unit of length of the avatar's file (default 1)")
    model.add_argument("--room-scale", type=float, metavar="M", help="metres a unit of length of the room's file (default 1)")
    model.add_argument("--room-up", choices=("y", "z"), help="the axis that points up in a room that is a mesh (default z)")


def reading_of(args: argparse.Namespace) -> Reading:
    """Return the options for reading files. Raises InvalidInput for numbers out of range and options without their file."""
    for name, (least, most) in RANGES.items():
        if getattr(args, name, None) is not None:
            within(f"--{name.replace('_', '-')}", getattr(args, name), least, most, InvalidInput)
    # a user's own scene may contain the avatar
    of_avatar = () if getattr(args, "own_scene", False) else OF_AVATAR
    for what, names in (("avatar", (*of_avatar, "avatar_scale")), ("room", OF_ROOM), ("object", ("object_scale",))):
        for name in names:
            if getattr(args, name) and getattr(args, what) is None:
                raise InvalidInput(f"--{name.replace('_', '-')}", getattr(args, name), f"an option beside --{what}")
    exclude = _listed(args.exclude)
    for pair in exclude:
        if not all(pair.partition(":")):
            raise InvalidInput("--exclude", pair, "two names with a colon between")
    if not getattr(args, "own_scene", False) and args.avatar is None and args.room is None:
        for name in OF_EITHER:
            if getattr(args, name) is not None:
                raise InvalidInput(f"--{name}", getattr(args, name), "an option beside --avatar or --room")
    return Reading(
        scale=args.scale, up=args.up, file_rate=args.file_rate, quaternion=args.quaternion, joints=args.joints,
        home=_home(args.home), mass=args.mass, limits=not args.no_limits,
        offsets=args.offsets if args.offsets in (None, "mean") else str(Path(args.offsets).absolute()), stature=args.stature,
        asf=absolute(args.asf), fix=_listed(args.fix), root=args.root, leave=_listed(args.leave),
        folder=absolute(args.folder), meshes=args.meshes, repair=args.repair,
        body=_listed(args.body), keyframe=args.keyframe, collide=args.collide, fit=args.fit, exclude=exclude,
        avatar_scale=args.avatar_scale, room_scale=args.room_scale, room_up=args.room_up,
        object_file=absolute(args.object), object_scale=args.object_scale,
    )


def absolute(path: Path | None) -> str | None:
    """Return the absolute path as text; None without one."""
    return None if path is None else str(path.absolute())


def _home(text: str | None) -> str | None:
    """Return the value of --home, with an absolute path of its file. Raises InvalidInput."""
    file, frame = parsed_home("--home", text)
    return ":".join(str(part) for part in (absolute(file), frame) if part is not None) or None


def _listed(text: str) -> tuple[str, ...]:
    """Return names separated by commas."""
    return tuple(name.strip() for name in text.split(",") if name.strip())
