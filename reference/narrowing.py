"""What happens in the other engines when a scene's author leaves an effect out: which has the switch, and which cannot say it.

Restitution, friction, limits and self-contact are left out by the adapters. Neither engine knows reach cones, nor looks for
impacts within a step, and sleeping is off in both unless a preset asks for it: a scene without them runs there as it always does.
"""

from collections.abc import Mapping

from avatarsim.scene.joint import Ball
from avatarsim.scene.scene import Scene

ALWAYS_THERE: Mapping[str, str] = {
    "overlap_removal": "cannot be switched off apart from contact as a whole",
    "coupling": "a driven link is a body with mass, which gives and takes in every contact",
    "dynamics": "what is free moves: a simulated body cannot be told to stand",
    "gyroscopic": "cannot be switched off for links",
}
"""Effects that cannot be left out in these engines, and why."""


def alike_in_both(scene: Scene) -> dict[str, str]:
    """Features that neither engine has -> consequence; `no EFFECT` -> why not, for effects that were narrowed away in vain."""
    found: dict[str, str] = {}
    if any(isinstance(link.joint, Ball) and link.joint.cone for link in scene.links):
        found["reach cones"] = "no spherical polygons: ignored"
    if any(any(link.surface_velocity) for link in scene.links):
        found["surface velocity"] = "belts do not carry loose bodies"
    if any(avatar.coupled_mass is not None for avatar in scene.avatars):
        found["coupled mass"] = "an avatar's links have one mass: their own"
    return found | {f"no {effect.replace('_', ' ')}": ALWAYS_THERE[effect] for effect in scene.lapsed if effect in ALWAYS_THERE}
