"""Messages between the loop and the door: frozen records that arrive whole or not at all (message passing; Hoare 1978).

The loop is the process that runs one engine at a fixed rate. The door is the process that the user started, with the page and the
ports. Both belong to one session, so their messages are pickled; data from outside is never unpickled.
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
"""[1/s] Lowest and highest rate of a loop: lower is not seen as motion, higher leaves no time to sleep between two frames."""


@dataclass(frozen=True, eq=False)
class Plan:
    """Plan of a loop.

    engine   "module:class" of an engine of `avatarsim.engine.Engine`, constructed without arguments
    scene    scene; `settings` of the engine; `rate` [1/s] of frames
    logs     folder for the log of the session (avatarsim/live/recording.py); empty: no log
    name     name in the session and on its page: "avatarsim", "mujoco/tuned"
    off      effects that are off at first, in addition to those that the scene's author left out; a `Switch` turns them on
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
    """Target posture of the avatars: `sample`, whose time is ignored, since the loop has its own time.

    stamp   [ns] monotonic time at which the bytes or the event behind it arrived at the door
    number  ascending from 1 in a session
    """

    sample: TrackerSample
    stamp: int
    number: int


class Order(Enum):
    """Orders that the door sends to a loop; those that use the command's `value` describe it."""

    RESET = "reset"
    """Restart the scene."""
    PAUSE = "pause"
    """Stop time and keep showing the current state until GO_ON."""
    GO_ON = "go on"
    """End a pause."""
    STEP = "step"
    """Run one frame, then pause."""
    KEEP = "keep"
    """Store a snapshot of the shown state for BACK."""
    BACK = "back"
    """Restore the last stored snapshot, or restart the scene if there is none."""
    TAKE = "take"
    """Attach bodies to the links of the first avatar that touch them, or release all attached ones; the answer names them."""
    PINCH = "pinch"
    """`value` True: attach bodies that the first avatar grips and release those that it no longer grips; False: stop doing so."""
    SWITCH = "switch"
    """Apply another `Switch`: disabled effects, preset and options of the engine."""
    SAVE = "save"
    """Flush the log to disk; the answer gives its path. The log covers all frames since the scene began or was restarted."""
    STOP = "stop"
    """End the loop."""


@dataclass(frozen=True)
class Switch:
    """Value of SWITCH: `off` names effects that the user disables in addition to those that the scene's author did; `preset` and
    `options` apply to AvatarsimEngine only."""

    off: tuple[str, ...] = ()
    preset: str = "default"
    options: Mapping[str, object] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Command:
    """An order, its value, and the command's number, which the answer repeats."""

    order: Order
    value: object = None
    number: int = 0


@dataclass(frozen=True, eq=False)
class Answer:
    """Result of a command: `refused` is empty or the reason of a refusal, `frame` the last frame before it, `text` the requested
    text: for SAVE the path of the log, for TAKE the bodies that were taken or released."""

    number: int
    order: Order
    frame: int
    refused: str = ""
    text: str = ""


@dataclass(frozen=True, eq=False)
class Touching:
    """Contacts of the first avatar in the state of a frame: `contacts` (k, 6), points [m] and unit normals out of the second body
    into the first. Sent after the state if the frame has time left: nothing waits for it."""

    frame: int
    contacts: Array


@dataclass(frozen=True, eq=False)
class State:
    """Shown state after a frame, and its cost. Bodies are in the scene's canonical order.

    frame         frames since the loop began; `time` [s] of the engine
    positions     (n, 3) [m], orientations (n, 4) scalar first, their signs as in the last frame, angles (hinges,) [rad]
    target        number of the newest target, 0 before the first; `latency` [ns] from its stamp until this state was published,
                  -1 if an earlier state used it
    engine_ns     duration of the engine's `advance`; `cpu_ns` of it on the processor: other programs took the rest
    is_late       True if published after the next frame was due; `skipped` frames that were due and left out since the loop began
    due           [ns] monotonic time at which the next frame begins
    statuses      as in FrameRecord, like counts and stage_ns
    state_hash    hash of the frame record
    is_paused     True during a pause; `is_logged` True if this frame is in the log
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
