"""Every Rapier setting we choose, with its reason: `default` is the library's, `tuned` the best found by kind of scene."""

from collections.abc import Mapping

from reference.presets import Chosen, Kind, Preset

LIBRARY = "Rapier's default"
SWINGS = ("none", "axes", "ropes")
"""Swing limits of ball joints: none, about two axes (a pyramid), or by ropes (a circular cone)."""

DEFAULT: Preset = {
    "dt": Chosen(1.0 / 60.0, LIBRARY + " [s]"),
    "solver_iterations": Chosen(4, LIBRARY + " (each is a substep of velocities, not of collision)"),
    "pgs_iterations": Chosen(1, LIBRARY + " (passes in each of them)"),
    "contact_frequency": Chosen(30.0, LIBRARY + " (of the spring by which contacts between moving bodies push out [Hz])"),
    "static_frequency": Chosen(60.0, LIBRARY + " (the same of contacts with fixed bodies [Hz])"),
    "contact_damping_ratio": Chosen(10.0, LIBRARY + " (of both)"),
    "friction_in_bias_pass": Chosen(False, LIBRARY + " (friction is also solved while positions are corrected)"),
    "contact_recycling": Chosen(True, LIBRARY + " (contact points are kept until two shapes have moved 5 cm)"),
    "prediction": Chosen(0.02, LIBRARY + " (distance at which contacts are foreseen, in length units)"),
    "loose_skin": Chosen(0.0, LIBRARY + " (distance that contacts keep around loose bodies, in length units)"),
    "driven_skin": Chosen(0.0, LIBRARY + " (the same around links)"),
    "length_unit": Chosen(1.0, LIBRARY + " [m]; 0: the power of a thousand nearest to the largest body that moves"),
    "ccd": Chosen(False, LIBRARY + " (fast bodies are swept against moving ones too; against fixed ones they always are)"),
    "sleep": Chosen(True, LIBRARY + " (bodies at rest are not computed)"),
    "reduced_coordinates": Chosen(False, "joints are constraints between bodies; true: a multibody, for avatars of hinges"),
    "weld_frequency": Chosen(100.0, "[rad/s] of each link's spring to its target; a fixed joint pulls a hand 58 mm into a table"),
    "weld_damping_ratio": Chosen(1.0, "critical: no overshoot; a target's velocity is fed forward, so steady motion has no lag"),
    "swing_limits": Chosen("axes", "limits of the spherical joint, about axes: 40 degrees asked, 54.5 on the diagonal"),
    "gravity_on_links": Chosen(True, LIBRARY + " (gravity_scale 1)"),
    "clamp_targets": Chosen(False, "the tracker is followed as it is"),
}

_TUNED: Preset = {
    "dt": Chosen(1.0 / 960.0, "errors fall with the step: apexes of bounces 22 mm off at 1/60, 11 at 1/240, 2.5 at 1/960"),
    "pgs_iterations": Chosen(2, "with contacts this stiff a stack creeps at 1"),
    "contact_frequency": Chosen(480.0, "a stack of ten is 4.8 mm deep at 30, 0.34 at 120, 0.12 at 480"),
    "static_frequency": Chosen(960.0, "over 28 drawn scenes a fifth of the overlap at 480, at the same distance from the user"),
    "contact_damping_ratio": Chosen(2.0, "1 bounces in piles, 10 is slow out of overlap"),
    "friction_in_bias_pass": Chosen(True, "as pgs_iterations"),
    "contact_recycling": Chosen(False, "a ball that falls 1 m is 10 mm deep with it at 1/240 and default contacts, 0.07 without"),
    "loose_skin": Chosen(2e-4, "no overlap is left; bodies stand up to 0.4 mm apart"),
    "driven_skin": Chosen(1e-3, "what a link covers in a step is taken up by air"),
    "sleep": Chosen(False, "what rests is computed too, so that this row says what that costs; rapier/sleeping has it"),
    "length_unit": Chosen(0.0, "scene of millimetres: courses 40 mm off at 1, 0.3 mm with its own unit"),
    "swing_limits": Chosen("ropes", "between two points 1 m out: a circular cone, exactly"),
    "gravity_on_links": Chosen(False, "a tracked limb is held up by its user, not by its spring"),
    "clamp_targets": Chosen(True, "asking a joint for more than its limit only bends the limit"),
}

_BOUNCING: Preset = {"dt": Chosen(1.0 / 3840.0, "where only bounces are judged: apexes 2.5 mm off at 1/960, 0.9 here")}

OPTIMISES: Mapping[str, str] = {
    "default": "nothing: the library's own values, with a spring per link",
    "tuned": "the least overlap in any frame shown, then error to a closed form, then distance from the user",
    "sleeping": "time where bodies rest; all else as tuned",
    "multibody": "joint limits of avatars that have hinges only; all else as tuned, at several times its cost",
}
"""Purpose of each preset, in one sentence."""

BETTER_ELSEWHERE = (
    "dt = 1/240 s: a quarter of the steps, and larger errors of bounces",
    "loose_skin = 0: bodies touch instead of standing apart, and overlap of hundredths of a millimetre",
    "sleep = true: frames of what rests take a fraction (row rapier/sleeping)",
    "solver_iterations = 1: a third of the time of piles at the same overlap; stacks creep by 0.7 mm and hands bend farther",
)
"""Settings that are better than tuned in another respect, and their cost."""


def presets(kind: Kind) -> Mapping[str, Preset]:
    """Return the presets for a kind of scene by name, the default first."""
    tuned = {**DEFAULT, **_TUNED, **(_BOUNCING if kind is Kind.BOUNCING else {})}
    sleeping, reduced = {"sleep": Chosen(True, LIBRARY)}, {"reduced_coordinates": Chosen(True, "limits are of the coordinates")}
    return {"default": DEFAULT, "tuned": tuned, "sleeping": {**tuned, **sleeping}, "multibody": {**tuned, **reduced}}
