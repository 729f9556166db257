"""What the loop and the door tell each other: frozen records, whole or not at all (message passing; Hoare 1978).

The loop is the process that runs one engine at a fixed rate; the door is the process that the user started, with the page and the
ports. Both are ours and of one session, so that their messages are pickled; nothing that comes from outside is.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from avatarsim.engine import Settings
from avatarsim.scene.scene import Scene
from avatarsim.scene.tracker import TrackerSample

Array = NDArray[np.float64]

RATES = (10.0, 1000.0)
"""[1/s] slowest and fastest rate of a loop: slower is no motion to an eye, faster leaves no time to sleep between two frames."""


@dataclass(frozen=True, eq=False)
class Plan:
    """What a loop is to run.

    engine   "module:class" of an engine of `avatarsim.engine.Engine`, constructed without arguments
    scene    the scene, `settings` how the engine is run, `rate` [1/s] frames a second
    logs     folder for the log of what is driven (avatarsim/live/recording.py); empty: none is written
    name     by which the session and its page know it: "avatarsim", "mujoco/tuned"
    off      effects that are off at first, beyond those that the scene's author left out: a `Switch` brings them back
    """

    engine: str
    scene: Scene
    settings: Settings
    rate: float
    logs: str = ""
    name: str = "avatarsim"
    off: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Target:
    """Where the user wants the avatars: `sample`, whose time counts for nothing, since a frame's time is the loop's own.

    stamp   [ns] of the monotonic clock when the bytes or the event behind it arrived at the door
    number  ascending from 1 in a session
    """

    sample: TrackerSample
    stamp: int
    number: int


class Order(Enum):
    """What the door orders; `value` of the command is said here."""

    RESET = "reset"
    """Begin the scene again."""
    PAUSE = "pause"
    """Show what is shown until told otherwise."""
    GO_ON = "go on"
    """The end of a pause."""
    STEP = "step"
    """One frame, in a pause."""
    KEEP = "keep"
    """Keep a snapshot of the state shown, the one to come back to."""
    BACK = "back"
    """Come back to the snapshot that was kept last, or to the start of the scene where none was."""
    TAKE = "take"
    """Attach what the first avatar touches to the link that touches it, or release all that it holds; the answer tells which."""
    PINCH = "pinch"
    """`value` True: from now on what the first avatar grips is attached, and released once it grips it no more; False: not."""
    SWITCH = "switch"
    """Another `Switch`: effects that are off, preset and options of the engine."""
    SAVE = "save"
    """Bring the log to the disk; the answer tells where it is. It holds all since the scene began, or began again."""
    STOP = "stop"
    """End the loop."""


@dataclass(frozen=True)
class Switch:
    """What is switched: `off` names effects that the user switches off beyond those that the scene's author did; `preset` and
    `options` are those of our engine, and no other's."""

    off: tuple[str, ...] = ()
    preset: str = "default"
    options: Mapping[str, object] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Command:
    """An order, what it needs, and its number, which the answer names."""

    order: Order
    value: object = None
    number: int = 0


@dataclass(frozen=True, eq=False)
class Answer:
    """What became of a command: `refused` is empty, or the sentence that says why; `frame` the last one before it; `told` what
    was asked for: of SAVE the path of the log, of TAKE what was taken or released."""

    number: int
    order: Order
    frame: int
    refused: str = ""
    told: str = ""


@dataclass(frozen=True, eq=False)
class Touching:
    """Where the first avatar touches in the state of a frame, `contacts` (k, 6): points [m], and unit normals out of the second
    body into the first. Sent after the state, where the frame has time left: nothing waits for it."""

    frame: int
    contacts: Array


@dataclass(frozen=True, eq=False)
class State:
    """What is shown after a frame, and what it cost. Bodies are in the scene's canonical order.

    frame         frames since the loop began; `time` [s] of the engine
    positions     (n, 3) [m], orientations (n, 4) scalar first, their signs as in the last frame, angles (hinges,) [rad]
    target        the newest target's number, 0 before the first; `latency` [ns] from its stamp until this state was published, -1
                  where it was used before
    engine_ns     how long the engine took, in `advance`, `cpu_ns` of that on the processor: others took the rest
    is_late       published after the next frame was due; `skipped` frames that were due and left out, since the loop began
    due           [ns] of the monotonic clock at which the next frame begins
    statuses      as in FrameRecord, and counts, stage_ns
    state_hash    of the frame record
    is_paused     whether time stands still; `is_logged` whether this frame is in the log
    """

    frame: int
    time: float
    positions: Array
    orientations: Array
    angles: Array
    target: int
    latency: int
    engine_ns: int
    is_late: bool
    skipped: int
    due: int
    statuses: Mapping[str, int]
    counts: Mapping[str, int]
    stage_ns: Mapping[str, int]
    state_hash: str
    is_paused: bool = False
    is_logged: bool = False
    cpu_ns: int = 0
