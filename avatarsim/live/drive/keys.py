"""Keys as velocities that decay: a page receives presses and repeats of a key, never reliably its release.

A press requests full speed; the request decays with a time constant, and the speed follows it as a first-order lag, so that
nothing starts or stops at once.
"""

from dataclasses import dataclass
from math import exp
from typing import Final

DECAY = 0.25
"""[s] Time constant of a press. Shorter: the wait before a key repeats, half a second, is seen as a stop; longer: the avatar
continues after the key is up."""

EASE = 0.08
"""[s] Time constant with which speeds follow: a quarter of a step of a walk. Longer: keys feel like rubber."""

STILL = 0.02
"""Share of full speed below which a speed is zero."""


@dataclass(frozen=True)
class Key:
    """A key: its name in browsers, its action, and the axis and sign of the speed that it sets, if any."""

    key: str
    what: str
    axis: str = ""
    sign: float = 0.0


KEYS: Final = (
    Key("i", "walk forward", "forward", 1.0),
    Key("k", "walk back", "forward", -1.0),
    Key("j", "step left", "side", 1.0),
    Key("l", "step right", "side", -1.0),
    Key("u", "turn left", "turn", 1.0),
    Key("o", "turn right", "turn", -1.0),
    Key("r", "stand up; without legs: up", "height", 1.0),
    Key("f", "crouch; without legs: down", "height", -1.0),
    Key("t", "reach forward with both arms; again: arms back"),
    Key("g", "close the fist", "fist", 1.0),
    Key("h", "open the fist", "fist", -1.0),
    Key("y", "raise the lift", "lift", 1.0),
    Key("n", "lower the lift", "lift", -1.0),
    Key(" ", "flick: a quick strike of the right arm, or of the hand"),
)
"""All keys, as the page lists them. The page's own camera flies by W A S D Q E and the arrow keys, which are not among these."""

BY_NAME: Final = {key.key: key for key in KEYS}
AXES: Final = ("forward", "side", "turn", "height", "fist", "lift")


class Speeds:
    """Shares of full speed, -1 to 1, by axis."""

    def __init__(self) -> None:
        self._targets = dict.fromkeys(AXES, 0.0)
        self.now = dict.fromkeys(AXES, 0.0)

    def press(self, axis: str, sign: float) -> None:
        """Request full speed along an axis."""
        self._targets[axis] = sign

    def stop(self) -> None:
        """Reset all speeds."""
        self._targets, self.now = dict.fromkeys(AXES, 0.0), dict.fromkeys(AXES, 0.0)

    def advance(self, dt: float) -> None:
        """Advance the decay and the speeds."""
        decay, follow = exp(-dt / DECAY), 1.0 - exp(-dt / EASE)
        for axis in AXES:
            self._targets[axis] *= decay
            if abs(self._targets[axis]) < STILL:
                self._targets[axis] = 0.0
            self.now[axis] += follow * (self._targets[axis] - self.now[axis])
            if self._targets[axis] == 0.0 and abs(self.now[axis]) < STILL:
                self.now[axis] = 0.0

    @property
    def is_moving(self) -> bool:
        """Return True if any speed is not zero."""
        return any(self._targets.values()) or any(self.now.values())
