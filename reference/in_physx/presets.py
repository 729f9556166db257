"""Every PhysX setting we choose, with its reason. The one place where they are kept.

`default` has the values of the package sapien when nothing is set. `tuned` is the best found on draws: drops, slides, stacks and
piles of bodies, and recorded motions in rooms.
"""

from collections.abc import Mapping

from reference.presets import Chosen, Kind, Preset

PACKAGE = "the package's default"

DEFAULT: Preset = {
    "dt": Chosen(0.01, PACKAGE + " [s]"),
    "position_iterations": Chosen(10, PACKAGE),
    "velocity_iterations": Chosen(1, PACKAGE),
    "tgs": Chosen(True, PACKAGE + " (temporal Gauss-Seidel; projected Gauss-Seidel leaves stacks ten times as deep)"),
    "pcm": Chosen(True, PACKAGE + " (contacts of a pair are kept from step to step)"),
    "bounce_threshold": Chosen(2.0, PACKAGE + " [m/s] below which nothing bounces"),
    "contact_offset": Chosen(0.01, PACKAGE + " [m]: the distance at which contact is looked for, per shape"),
    "rest_offset": Chosen(0.0, PACKAGE + " [m]: the distance that contact keeps, per shape of a loose body. 2e-4 leaves no "
                                         "overlap in piles, and throws a stack that begins in contact apart by metres"),
    "driven_rest_offset": Chosen(0.0, PACKAGE + " [m]: the same of a link"),
    "angular_damping": Chosen(0.05, PACKAGE + " [1/s]"),
    "max_angular_velocity": Chosen(100.0, PACKAGE + " [rad/s]"),
    "sleep": Chosen(True, PACKAGE + " (bodies at rest are not computed)"),
    "sleep_threshold": Chosen(0.005, PACKAGE + " [J/kg] below which a body may sleep"),
    "drive_frequency": Chosen(100.0, "[rad/s] of each link's spring to its target, critically damped; 200 jumps twice as far"),
    "lead_steps": Chosen(0.0, "targets are where the tracker is at the end of each step"),
    "gravity_on_links": Chosen(True, PACKAGE),
    "clamp_targets": Chosen(False, "the tracker is followed as it is"),
}

_TUNED: Preset = {
    "dt": Chosen(1.0 / 960.0, "errors fall with the step: avatars are 10 mm deep on average at 1/240, 3 at 1/480, 0.5 at 1/960"),
    "position_iterations": Chosen(20, "joints are 0.84 degrees beyond their limits on average, 3.8 at 10; stacks are 0.0016 mm "
                                      "deep, 0.0046 at 10, and creep at 30"),
    "pcm": Chosen(False, "piles are 0.017 mm deep, 0.27 with contacts kept; of 40 drawn motions 1 is over 5 mm deep, with 2"),
    "bounce_threshold": Chosen(0.01, "slow bounces are bounces too"),
    "driven_rest_offset": Chosen(1e-3, "what a link covers in a step is taken up by air"),
    "angular_damping": Chosen(0.0, "nothing in the scene damps free motion"),
    "max_angular_velocity": Chosen(1e4, "no limit for what scenes hold"),
    "sleep": Chosen(False, "what rests is computed too, so that this row says what that costs"),
    "lead_steps": Chosen(1.0, "a spring to a target of the step's end is one step late"),
    "gravity_on_links": Chosen(False, "a tracked limb is held up by its user, not by its spring"),
    "clamp_targets": Chosen(True, "asking a joint for more than its limit only bends the limit"),
}

_LED: Preset = {"contact_offset": Chosen(0.005, "in a corridor a limb is 70 mm in a wall at 0.02, 2 at 0.01, below 0.3 here")}

_BY_KIND: Mapping[Kind, Preset] = {
    Kind.BOUNCING: {
        "dt": Chosen(1.0 / 3840.0, "where only bounces are judged: heights are 0.35 mm off, 1.3 at 1/960"),
        "contact_offset": Chosen(0.2, "fast bodies are met in time: 2.5 % pass a thin wall, 11 % at 0.05, 23 % at 0.01"),
    },
    Kind.RESTING: {"dt": Chosen(1.0 / 1920.0, "stacks are 0.0012 mm deep with 10 iterations, 0.0046 at 1/960")},
    Kind.DRIVEN: _LED, Kind.MIXED: _LED,
}

OPTIMISES: Mapping[str, str] = {
    "default": "nothing: the values of the package sapien, which are not PhysX's own, with a spring per link",
    "tuned": "least overlap, error to a closed form, distance from the user; limbs that come free jump twice as far as default",
}
"""Purpose of each preset, in one sentence."""

BETTER_ELSEWHERE = (
    "dt = 1/240 s: a quarter of the steps or less, and more overlap",
    "driven_rest_offset = 0: links touch instead of standing 1 mm off, and overlap by tenths of a millimetre",
    "drive_frequency = 200: nearer to the user, with larger jumps; sleep = true: frames of what rests take less",
)
"""Settings that are better than tuned in another respect, and their cost."""


def presets(kind: Kind) -> Mapping[str, Preset]:
    """Return the presets for a kind of scene by name, the default first."""
    return {"default": DEFAULT, "tuned": {**DEFAULT, **_TUNED, **_BY_KIND[kind]}}
