"""What happens in the other engines when a scene's author leaves an effect out: which has the switch, and which cannot say it.

Restitution, friction, limits and self-contact are left out by the adapters. Neither engine knows reach cones, nor looks for
impacts within a step, and sleeping is off in both unless a preset asks for it: a scene without them runs there as it always does.
"""

from collections.abc import Mapping

from avatarsim.scene.scene import Scene

SWITCHED = ("restitution", "friction", "limits", "self_contact")
"""Effects that the adapters leave out."""

NEVER_THERE = ("sleeping", "continuous", "reach_cones")
"""Effects that these engines do not have by themselves, so that there is nothing to leave out."""

ALWAYS_THERE: Mapping[str, str] = {
    "overlap_removal": "cannot be switched off apart from contact as a whole",
    "coupling": "a driven link is a body with mass, which gives and takes in every contact",
    "dynamics": "what is free moves: a simulated body cannot be told to stand",
    "gyroscopic": "cannot be switched off for links",
}
"""Effects that cannot be left out in these engines, and why."""


def not_left_out(scene: Scene, always: Mapping[str, str] = ALWAYS_THERE) -> dict[str, str]:
    """`no EFFECT` -> why not, for every effect that the author took away and the engine keeps all the same."""
    return {f"no {effect.replace('_', ' ')}": always[effect] for effect in scene.lapsed if effect in always}
