"""Contact between a driven avatar and its world, in real time, with nothing left overlapping.

A tracked hand or body follows its user, also into walls, tables and its own limbs. The engine shows the nearest posture that
touches but never overlaps, within joint limits, and makes loose objects bounce, slide and roll off it. It implements and extends
Schmidl and Lin, *Real-time Physically-based Interaction between Avatars and Virtual Environments*.

Example:
A fist moves down to a table and through it; it is shown on top.

    >>> import numpy as np
    >>> import avatarsim as av
    >>> fist = (av.Piece(av.Sphere(0.04)),)
    >>> table = av.fixed("table", (av.Piece(av.Box((1.0, 1.0, 0.05))),), "wood")
    >>> def hand(z):
    ...     return av.TrackerSample(0.0, np.array([[0.0, 0.0, z]]), np.array([[1.0, 0.0, 0.0, 0.0]]), np.zeros(0))
    >>> scene = av.Scene("reach", (table,), (av.rigid_avatar("hand", fist, av.solid(fist, 0.5)),), start=hand(0.3))
    >>> with av.AvatarsimEngine() as engine:
    ...     record = engine.load(scene, av.Settings(), dt=1 / 60)
    ...     for k in range(60):
    ...         record = engine.advance(hand(0.3 - 0.01 * k), dt=1 / 60)
    ...     touching = [(contact.a, contact.b) for contact in engine.contacts()]
    >>> print(record.shown.positions[1].round(4), touching)
    [0.     0.     0.0652] [('table', 'hand')]

Units and conventions
---------------------
SI units (m, kg, s, N), angles in radians, float64; z is up. Quaternions are (w, x, y, z) of length 1. Sizes of boxes are full
lengths. Arrays over bodies are in the order of `scene.names`: the bodies, then the links of each avatar. A contact's normal
points out of `b` into `a`. Descriptions (scenes, bodies, avatars, shapes) are frozen and checked when they are made: a fault
raises an `InvalidInput` that names the quantity, its value and the valid range.

The world
---------
    Scene           everything given before the first frame: bodies, avatars, materials, gravity, start
    Body            a fixed or loose body, made by the next two
    fixed           a body that does not move
    simulated       a loose body, which obeys the laws of physics
    moving          a body whose pose is given per frame, such as a door or a lift; one of the avatars of a scene
    Piece           one convex shape at its place on a body
    Sphere, Capsule, Box, Ellipsoid, ConvexHull     the shapes
    capsule_between the Piece of a capsule from one point to another
    pieces_of_mesh  convex pieces of a mesh file, with a bound on their distance from it (needs the extra `assets`)
    Mass            mass, centre of mass and inertia of a body or link
    solid           the Mass of pieces that are solid and of uniform density
    PairTable       materials: a ContactLaw for every pair of names; the default has wood, human and metal, as in the paper
    ContactLaw      restitution and friction of a pair

Avatars
-------
    rigid_avatar    a driven body without joints
    Avatar          a tree of links, driven by a tracker
    Drive           the spring between an avatar and its user, if it differs from that of the options
    Link            a rigid part of an avatar: its joint, pieces and mass
    Free            the joint of a root that follows its user
    Rigid           no motion relative to the parent
    Hinges, Hinge   one to three hinges that share a centre, and one of them with its limits
    Slide           a prismatic joint with its limits
    Coupling        a hinge or a slide that follows another one
    Ball            a ball and socket
    SwingTwist      limits of a ball: a cone for the limb, an interval for the twist about it
    TrackerSample   measured posture of all avatars at one instant
    rest            the sample with every joint at zero
    posed           the sample with joint values given by name
    from_xyzw       quaternions (w, x, y, z) of those of ROS, Unity, OpenXR and scipy, which are scalar last
    link_poses      forward kinematics: poses of the links of avatars for a sample

Files
-----
    load_avatar     avatar, room and loose bodies of an MJCF or URDF file (needs the extra `assets`)
    load_room       a room from such a file, from a mesh, or from the word "floor"
    load_object     the object of a motion file, such as a box, with its shape and its recorded poses
    load_motion     a motion file: BVH, AMC, npz, csv, the 44 columns of DeepMimic; and a way to write it again
    Model           content of a model file: avatar, coordinates in the file's order, bodies, notes on changes and guesses

Frames
------
    AvatarsimEngine load, advance, contacts; reset, change, snapshot, restore, posture, put, close
    Settings        preset, options, seed, and the quantities that are recorded
    FrameRecord     result of `advance`: the state shown, joint angles, counts, statuses
    Snapshot        positions, orientations and velocities of all bodies at one instant
    Contact         a contact of two bodies: their names, point, normal, gap
    advance_many    a frame of many engines at once, on several threads
    show            a browser window on a loop of your own, or a page of a recording (needs the extra `view`)

Cleaning
--------
    Motion          postures of one avatar at times
    clean           the nearest motion without overlap, certified in frames and between them
    audit           measures of an unchanged motion
    Shield          `clean` for a stream of postures: generalized coordinates in, certified ones out

Comparing
---------
    compare         a scene of your own in every installed engine: a pandas table (needs the extra `compare`)

Errors
------
    AvatarsimError  the base class of all errors raised on purpose
    InvalidInput    a value outside its valid range; the base of several errors (avatarsim.errors lists them)
    StartOverlaps   the first pose overlaps; names the pairs and their depths
    WorldsFailed    some worlds of `advance_many` failed; contains the records of the others

Less common names are in their modules: `avatarsim.scene` (reach cones, effects), `avatarsim.settings` (every option, its unit
and its effect), `avatarsim.errors`. Nothing of the engine is imported before a name is used.
"""

from importlib import import_module
from typing import TYPE_CHECKING

from avatarsim.version import VERSION as __version__  # noqa: N811

if TYPE_CHECKING:
    from avatarsim.assets.meshes import pieces_of_mesh
    from avatarsim.assets.models.load import load_avatar, load_room
    from avatarsim.assets.models.model import Model
    from avatarsim.assets.motions.carried_object import load_object
    from avatarsim.assets.motions.load import load_motion
    from avatarsim.cleaning import Shield, audit, clean
    from avatarsim.comparing import compare
    from avatarsim.engine import FrameRecord, Settings, Snapshot
    from avatarsim.errors import AvatarsimError, InvalidInput, StartOverlaps, WorldsFailed
    from avatarsim.live.show import show
    from avatarsim.many_worlds import advance_many
    from avatarsim.pose_queries import Contact
    from avatarsim.scene.avatar import Avatar, Drive, Link, rigid_avatar
    from avatarsim.scene.body import Body, ContactLaw, Mass, PairTable, fixed, simulated, solid
    from avatarsim.scene.joint import Ball, Coupling, Free, Hinge, Hinges, Rigid, Slide, SwingTwist
    from avatarsim.scene.motion import Motion
    from avatarsim.scene.moving import moving
    from avatarsim.scene.posed import posed
    from avatarsim.scene.scene import Scene
    from avatarsim.scene.shape import Box, Capsule, ConvexHull, Ellipsoid, Piece, Sphere, capsule_between
    from avatarsim.scene.tracker import TrackerSample, from_xyzw, link_poses, rest
    from avatarsim.simulator import AvatarsimEngine

__all__ = [
    "Avatar", "AvatarsimEngine", "AvatarsimError", "Ball", "Body", "Box", "Capsule", "Contact", "ContactLaw",
    "ConvexHull", "Coupling", "Drive", "Ellipsoid", "FrameRecord", "Free", "Hinge", "Hinges", "InvalidInput", "Link", "Mass",
    "Model", "Motion", "PairTable", "Piece", "Rigid", "Scene", "Settings", "Shield", "Slide", "Snapshot", "Sphere",
    "StartOverlaps", "SwingTwist", "TrackerSample", "WorldsFailed", "__version__", "advance_many", "audit", "capsule_between",
    "clean", "compare", "fixed", "from_xyzw", "link_poses", "load_avatar", "load_motion", "load_object", "load_room", "moving",
    "pieces_of_mesh", "posed", "rest", "rigid_avatar", "show", "simulated", "solid",
]

_MODULES = {
    "comparing": ("compare",),
    "engine": ("FrameRecord", "Settings", "Snapshot"),
    "errors": ("AvatarsimError", "InvalidInput", "StartOverlaps", "WorldsFailed"),
    "assets.meshes": ("pieces_of_mesh",),
    "assets.models.load": ("load_avatar", "load_room"), "assets.motions.carried_object": ("load_object",),
    "assets.models.model": ("Model",),
    "assets.motions.load": ("load_motion",),
    "cleaning": ("Shield", "audit", "clean"),
    "live.show": ("show",),
    "many_worlds": ("advance_many",),
    "pose_queries": ("Contact",),
    "scene.avatar": ("Avatar", "Drive", "Link", "rigid_avatar"),
    "scene.body": ("Body", "ContactLaw", "Mass", "PairTable", "fixed", "simulated", "solid"),
    "scene.motion": ("Motion",),
    "scene.moving": ("moving",),
    "scene.joint": ("Ball", "Coupling", "Free", "Hinge", "Hinges", "Rigid", "Slide", "SwingTwist"),
    "scene.scene": ("Scene",),
    "scene.posed": ("posed",),
    "scene.shape": ("Box", "Capsule", "ConvexHull", "Ellipsoid", "Piece", "Sphere", "capsule_between"),
    "scene.tracker": ("TrackerSample", "from_xyzw", "link_poses", "rest"),
    "simulator": ("AvatarsimEngine",),
}
"""Public names of each module: the imports above, for a running Python."""

_MODULE_OF = {name: f"{__name__}.{module}" for module, names in _MODULES.items() for name in names}

if not TYPE_CHECKING:  # otherwise every misspelt name would have a type

    def __getattr__(name: str) -> object:
        """Import a public name at its first use (PEP 562): the engine imports a compiler, which takes half a second."""
        if name not in _MODULE_OF:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        found = getattr(import_module(_MODULE_OF[name]), name)
        globals()[name] = found
        return found

    def __dir__() -> list[str]:
        """Return the public names, and those imported so far."""
        return sorted({*globals(), *__all__})
