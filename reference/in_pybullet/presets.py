"""Every PyBullet setting we choose, with its reason and its evidence. The one place where they are kept.

`default` has the values that the documentation gives when nothing is set. `tuned` is the best we found, scene kind by
scene kind. Steps are written in seconds; a frame is cut into the nearest whole number of them.
"""

from collections.abc import Mapping

from reference.presets import Chosen, Kind, Preset, of_one_scene

DOCUMENTED = "PyBullet's documented default"

DEFAULT: Preset = {
    "dt": Chosen(1.0 / 240.0, "PyBullet's documented time step [s]"),
    "solver_iterations": Chosen(50, DOCUMENTED),
    "contact_erp": Chosen(0.0, "negative or 0 with set_contact_erp false: " + DOCUMENTED),
    "set_contact_erp": Chosen(False, DOCUMENTED + " (about 0.08)"),
    "contact_slop": Chosen(1e-5, DOCUMENTED + " [m]: the depth at which contacts rest"),
    "breaking_threshold": Chosen(0.02, DOCUMENTED + ", set every time: it outlives resetSimulation and "
                                                    "even disconnect"),
    "processing_threshold": Chosen(1.0, "1: untouched, contacts act before bodies meet; 0: they act when "
                                        "they meet"),
    "restitution_threshold": Chosen(0.2, DOCUMENTED + " [m/s] below which nothing bounces"),
    "boxes_as_hulls": Chosen(False, "a box is a box"),
    "pieces_as_links": Chosen(False, "a link of several pieces is a compound"),
    "collision_margin": Chosen(0.001, DOCUMENTED + " [m] by which hulls are inflated"),
    "damping": Chosen(0.04, DOCUMENTED + " of linear and angular motion"),
    "maximal": Chosen(False, DOCUMENTED + ": all bodies in the multibody solver"),
    "split_impulse": Chosen(False, DOCUMENTED),
    "drive": Chosen("constraint", "the documented way to follow a hand: a fixed constraint between the "
                                  "root and the tracked pose"),
    "root_force": Chosen(100000.0, "the most force the constraint may use [N]: our setting and no default. A constraint as "
                                   "it is made has 500, PyBullet's own example of it 50"),
    "hand_force": Chosen(100000.0, "the same for an avatar without joints [N]: our setting too"),
    "position_gain": Chosen(0.1, DOCUMENTED),
    "ball_gain": Chosen(0.1, DOCUMENTED + " (positionGain of ball joints)"),
    "velocity_gain": Chosen(1.0, DOCUMENTED),
    "hinge_force": Chosen(100000.0, DOCUMENTED + " (largest torque of a hinge's motor) [N m]"),
    "ball_force": Chosen(100000.0, DOCUMENTED + " (largest torque of a ball joint's motor) [N m]"),
    "ball_limits": Chosen(True, "avatars whose ball joints have limits come from a URDF file, where Bullet has such limits. In a "
                                "study of 26 humanoid scenes the default's mean excess is 4.9 degrees; false: from "
                                "createMultiBody, which has none: 6.9"),
    "limit_force": Chosen(0.0, "0: ball joints have Bullet's limits alone"),
    "feed_forward": Chosen(False, "motors are given no target velocity, and take 0 then: our setting, as in the shortest call"),
    "root_speed": Chosen(0.0, "0: no cap; used by drive 'velocity' only [m/s]"),
    "clamp_targets": Chosen(False, "the tracker is followed as it is"),
    "gravity_on_links": Chosen(True, "gravity acts on all that has mass"),
    "sleep": Chosen(False, DOCUMENTED + ": nothing falls asleep"),
}
"""PyBullet's defaults and its documented way to drive an avatar: fixed constraint on the root, position
motors on the joints."""

_ALWAYS: Preset = {
    "contact_slop": Chosen(0.0, "contacts rest at the surface instead of 10 micrometres below it"),
    "collision_margin": Chosen(1e-6, "default inflates every hull by 1 mm; at 1e-6 hulls meet within 0.03 "
                                     "mm"),
    "damping": Chosen(0.0, "nothing in the scene damps free motion"),
    "restitution_threshold": Chosen(0.01, "the default 0.2 m/s kills small bounces"),
    "sleep": Chosen(False, "what rests is computed here, so that these rows say what that costs. The row pybullet/sleeping has "
                           "the flag, by which bodies sleep after two seconds of rest"),
}

_BOUNCING: Preset = {
    "dt": Chosen(1.0 / 960.0, "restitution seen at the surface is off by about g dt / v"),
    "processing_threshold": Chosen(0.0, "contacts that act before bodies meet stop them: at 1/4000 s "
                                        "nothing bounces at all"),
    "set_contact_erp": Chosen(True, "see contact_erp"),
    "contact_erp": Chosen(0.2, "with split impulses it adds no velocity; at 0 a stack of ten creeps 8 mm into itself"),
    "solver_iterations": Chosen(100, "a stack of ten boxes drifts 16 mm sideways in 5 s at 50, 1 mm at 100 to 200"),
    "maximal": Chosen(True, "outside the multibody solver split impulses act: restitution is right to 1e-5, not to 8e-3"),
    "split_impulse": Chosen(True, "acts on bodies outside the multibody solver only"),
}

_DRIVEN: Preset = {
    "solver_iterations": Chosen(50, DOCUMENTED + "; 200 cost three times as much and bring an avatar nothing"),
    "dt": Chosen(1.0 / 480.0, "a study of motion on a floor, worst overlap: 1/240 21 mm, 1/480 1.7 mm, 1/960 0.6 mm at "
                              "twice the steps"),
    "set_contact_erp": Chosen(True, "see contact_erp"),
    "contact_erp": Chosen(0.8, "overlap p95 at 1/60: 0.01 mm instead of 0.32 mm at 0.05; free of cost"),
    "breaking_threshold": Chosen(0.1, "a share of a shape's size, by which contacts begin early: at 0.02 a wrist is met 0.8 mm "
                                      "before it touches, less than it covers in a step; 5.8 mm deep inside a frame then, "
                                      "0.01 mm at 0.1"),
    "boxes_as_hulls": Chosen(True, "two boxes make no contact before they overlap, a hull and a box do: a foot at a wall is "
                                   "1.1 mm deep as a box, 0.008 mm as a hull"),
    "pieces_as_links": Chosen(True, "each of several pieces on a massless link of its own, met before it overlaps: a hand in a "
                                    "corner is 0 deep instead of 0.6 mm; it takes half as long again"),
    "root_force": Chosen(2000.0, "holds the body against its own limbs, yet yields to floors and walls"),
    "hand_force": Chosen(300.0, "a hand has no limbs to be held against: 0 deep in a thin wall instead of 9 mm, between two "
                                "balls 0.5 mm instead of 2.7; offsets are the same"),
    "position_gain": Chosen(0.1, "with feed-forward, stiff enough to follow and soft enough to yield to "
                                 "contacts"),
    "ball_gain": Chosen(0.5, "a tenth of the error per step, as hinges; 2.5 rattles more and follows no "
                             "better"),
    "hinge_force": Chosen(100.0, "more presses limbs into what they touch, less lags behind"),
    "ball_force": Chosen(100.0, "as hinge_force"),
    "limit_force": Chosen(5000.0, "torque of a ball joint's motor while it is beyond its limits [N m], beside Bullet's own, "
                                  "whose cones have corners and end at 85 degrees: largest excess, mean of 26 humanoid scenes, "
                                  "5.6 degrees at 0, 1.2 at 5000, and 1.3 with these motors alone; largest overlap 1.3, 0.8 and "
                                  "1.2 mm, offset from the user 39, 32 and 31 mm; 1000 is like 5000"),
    "feed_forward": Chosen(True, "the tracker's own joint velocity: no lag in steady motion"),
    "root_speed": Chosen(10.0, "used by drive 'velocity' only, which no preset has: without a cap, a blocked root builds up any "
                               "velocity and is thrown through the obstacle"),
    "clamp_targets": Chosen(True, "a motor that is asked for more than its joint allows presses against its limit"),
    "gravity_on_links": Chosen(False, "a tracked limb is held up by its user"),
}


_RESTING: Preset = {
    "maximal": Chosen(False, "where nothing bounces split impulses buy nothing: a stack of ten drifts 0.33 mm, in the "
                             "multibody solver 0.015 mm; heavy boxes sink 7.5 mm into light ones, 1.3 mm there"),
}

_EXACT: Preset = {
    "maximal": Chosen(False, "split impulses add energy where a rod is struck off its centre: velocities are 0.21 m/s off, 4e-6 "
                             "here. Balls stay with them: restitution is exact either way, heights are 0.4 mm off, here 0.7"),
    "contact_erp": Chosen(0.0, "in the multibody solver position correction bounces: 0.18 of restitution at 0.2. Without "
                               "it the velocity law is exact"),
}

_LEVEL: Preset = {
    "maximal": Chosen(True, "a box that slides at 22.5 degrees to the axes goes 14 % too far in the multibody solver"),
    "processing_threshold": Chosen(1.0, "contacts that act before bodies meet halve the error of the stop, to 0.19 %"),
}

_SLOW_HAND: Preset = {
    "pieces_as_links": Chosen(False, "nothing meets it that fast: it overlaps nothing as a compound either, in half the time"),
}

_HAND_OVER_TABLE: Preset = {
    **_SLOW_HAND,
    "contact_erp": Chosen(0.0, "nothing is lifted with more energy than the hand gives: 5.5e-4 J at 0.8; overlap is 7e-5 mm"),
    "dt": Chosen(1.0 / 960.0, "the ball, which meets the table when it touches it, is up to 0.03 mm deep at 1/480, 1e-7 mm here"),
}

_HEAVY_LOAD: Preset = {
    "contact_erp": Chosen(0.0, "a hand meets a ball in the multibody solver, where position correction throws it: velocities are "
                               "0.60 m/s off at 0.8, 0.20 here"),
    "hand_force": Chosen(2000.0, "a hand that pushes what weighs more than itself is 2.3 mm late at 300 N, 0.03 mm here"),
}

_EARLY: Preset = {
    "processing_threshold": Chosen(1.0, "where nothing bounces nothing is lost by contacts that act before bodies meet: a ball "
                                        "rolls at 5/7 of its speed to 3e-12 m/s instead of 0.01, painleve is 0.05 mm deep, not "
                                        "0.17, heavy bodies drift by 1.3 mm instead of 2.7"),
}

_JOINTED_HAND: Preset = {
    "breaking_threshold": Chosen(0.02, "where many parts are close together a wider threshold only adds contacts: hand_grasp "
                                       "overlaps in 81 % of frames at 0.1, and takes twice as long"),
    "root_force": Chosen(60.0, "a hand weighs less than a body: 2 kN break its fingers' limits by 118 degrees in a corner and "
                               "press it 9 mm in, 60 N by 47 and nothing overlaps; a free hand is 16 mm off instead of 4"),
    "hinge_force": Chosen(1.0, "as much as a finger has: 29 degrees beyond limits at 100 N m in hand_grasp, 0.4 here; free "
                               "offset 0.4 mm instead of 0.1"),
}

_IN_CORNER: Preset = {
    **_JOINTED_HAND,
    "solver_iterations": Chosen(200, "22 hinges in a row of light links: limits are broken by 16 degrees, at 50 by 47"),
}

_PUSHING_FINGER: Preset = {
    **_IN_CORNER,
    "root_force": Chosen(30.0, "the finger that pushes the ball overlaps it by 2e-7 mm, at 60 N by 0.05, at 2 kN and 100 N m "
                               "by 0.25"),
}

_THROWN_BACK: Preset = {
    "ball_gain": Chosen(0.25, "a body that walks into a wall with its chest is thrown back less: 3.8 mm from a user who has left "
                              "it, 18 mm at 0.5; where only limbs touch, 0.5 follows by 1 mm better"),
}

_PUSHED_BACK: Preset = {
    "contact_erp": Chosen(0.2, "worst overlap in squeeze 0.22 mm instead of 0.49 at 0.8 and 1.5 at 0, in coach_release 0.69 "
                               "instead of 0.90 and 2.6; lifted by 0.6 mJ instead of 2.5"),
}

SCENES: Mapping[str, Preset] = {
    **dict.fromkeys(("squeeze", "coach_release"), _PUSHED_BACK),
    **dict.fromkeys(("heavy_on_light", "painleve", "slide_to_roll"), _EARLY),
    "seams": {"maximal": Chosen(True, "boxes slide over seams at any angle: speeds 1.1 m/s off instead of 1.7, in half the time, "
                                      "but 0.4 mm deep instead of 0.06")},
    "hand_grasp": _JOINTED_HAND,
    "hand_in_corner": _IN_CORNER,
    "ball_off_table": _PUSHING_FINGER,
    **dict.fromkeys(("shallow_overlap", "start_inside"), _SLOW_HAND),
    **dict.fromkeys(("coupling_sweep", "coupling_sweep_30", "coupling_sweep_240"), _HEAVY_LOAD),
    "hand_over_table": _HAND_OVER_TABLE,
    "avatar_into_wall": _THROWN_BACK,
    "limit_torture": {"limit_force": Chosen(500.0, "a user who asks for the impossible all the time: 37 mm of overlap at 2000, "
                                                   "4.0 mm here; limits are lost either way, by 91 and 75 degrees")},
    "teleport": {"limit_force": Chosen(2000.0, "a tracker that jumps by metres: 70 mm of overlap and 81 degrees "
                                               "beyond limits at 5000, 15 mm and 47 degrees here")},
    "rod_impact": _EXACT,
    **dict.fromkeys(("stop_distance", "stop_distance_30", "stop_distance_240"), _LEVEL),
}
"""Settings that are best in some scenes only, by name."""


_FOLLOWS: Preset = {
    "feed_forward": Chosen(True, "the default with the tracker's own velocity: default motors aim where their user is now, "
                                 "and trail all that moves"),
    "ball_gain": Chosen(0.5, "a tenth of the error per step, as hinges at their default gain. A ball's motor of gain 0.1 "
                             "corrects a fiftieth. A row of its own, in scenes of recorded motion. In a study mocap_run was "
                             "8.8 mm off while free, default 121, tuned 110. Limits and overlap are as bad as the default's"),
}

_SLEEPING: Preset = {
    "sleep": Chosen(True, "PyBullet's activation state ENABLE_SLEEPING for all that is simulated. Bodies that rest for two "
                          "seconds are not computed until something wakes them. A row of its own, in scenes with bodies that "
                          "are to rest. In a study a frame of stack_ten took 32 us once it slept, 3.4 ms before"),
}

OPTIMISES: Mapping[str, str] = {
    "default": "nothing: what the documentation gives, with two exceptions. The force of the root's constraint is our setting "
               "(root_force, hand_force), and motors get no target velocity (feed_forward)",
    "tuned": "the least overlap in any frame shown and the least error to a closed form. Then the least excess over joint "
             "limits and the least distance from the user. Time decides where a setting takes several times as long for a "
             "millimetre",
    "sleeping": "time where bodies rest; all else as tuned",
    "follows": "the least distance from the user while nothing is in the way; all else as the default",
}
"""Purpose of each preset, in one sentence."""

BETTER_ELSEWHERE = (
    "dt = 1/960 s where avatars are led: less overlap, at twice the steps",
    "dt = 1/240 s there: half the steps, and more overlap",
    "pieces_as_links = false: less time where links have several pieces, and more overlap of a hand in a corner",
    "the default with feed_forward = true and ball_gain = 0.5 (row pybullet/follows): nearer to a user who is free, with overlap "
    "of centimetres",
    "sleep = true: frames of what has rested for two seconds take a fraction (row pybullet/sleeping)",
    "ball_gain = 0.25: a body thrown back by a wall is nearer to its user, limbs are farther",
)
"""Settings that are better than tuned in another respect, and their cost; the sweep of a run gives the figures."""


def presets(kind: Kind, scene: str = "") -> Mapping[str, Preset]:
    """Return the presets for a kind of scene, or for the scene of that name, by name, the default first."""
    tuned = {
        Kind.BOUNCING: {**DEFAULT, **_ALWAYS, **_BOUNCING},
        Kind.RESTING: {**DEFAULT, **_ALWAYS, **_BOUNCING, **_RESTING},
        Kind.MIXED: {**DEFAULT, **_ALWAYS, **_BOUNCING, **_DRIVEN},
        Kind.DRIVEN: {**DEFAULT, **_ALWAYS, **_DRIVEN},
    }
    best = {**tuned[kind], **of_one_scene(SCENES.get(scene, {}))}
    return {"default": DEFAULT, "tuned": best, "sleeping": {**best, **_SLEEPING}, "follows": {**DEFAULT, **_FOLLOWS}}
