"""Every MuJoCo setting we choose, with its reason and its evidence. The one place where they are kept.

`default` has the values that the documentation gives when nothing is set. `tuned` is the best we found, scene kind by
scene kind. Steps are written in seconds; a frame is cut into the nearest whole number of them.
"""

from collections.abc import Mapping

from reference.presets import Chosen, Kind, Preset, of_one_scene

DOCUMENTED = "MuJoCo's documented default"

DEFAULT: Preset = {
    "dt": Chosen(0.002, "MuJoCo's documented time step [s]"),
    "integrator": Chosen("EULER", DOCUMENTED),
    "cone": Chosen("PYRAMIDAL", DOCUMENTED),
    "refsafe": Chosen(True, DOCUMENTED + ": no time constant is shorter than two steps. It acts on welds, limits and contacts in "
                            "the standard format only. Contacts of one step have the direct one, which it leaves as it is"),
    "solver": Chosen("NEWTON", DOCUMENTED + "; CG and PGS end as deep"),
    "islands": Chosen(True, DOCUMENTED + " (who does not touch is solved apart)"),
    "warm_starts": Chosen(True, DOCUMENTED + " (the solver begins with the last step's forces)"),
    "iterations": Chosen(100, DOCUMENTED + " (most iterations of the solver)"),
    "tolerance": Chosen(1e-8, DOCUMENTED + " (gain of an iteration at which the solver ends, as a share of the mean inertia)"),
    "impratio": Chosen(1.0, DOCUMENTED + " (impedance of frictional over that of normal constraints)"),
    "noslip_iterations": Chosen(0, DOCUMENTED + " (passes that solve friction anew, the normal forces being known)"),
    "contact": Chosen("soft", DOCUMENTED + " (spring and damper by time constant and damping ratio: nothing "
                                           "bounces)"),
    "contact_time": Chosen(0.02, DOCUMENTED + " (time constant [s] of soft contacts)"),
    "contact_steps": Chosen(0.0, "0: contact_time is used; else the time constant in steps"),
    "solimp": Chosen((0.9, 0.95, 0.001), DOCUMENTED + " (impedance at depth 0, at full depth, depth [m])"),
    "kappa": Chosen(0.0, "used by one-step contacts only"),
    "kappa_driven": Chosen(0.0, "used by one-step contacts only"),
    "kappa_resting": Chosen(0.0, "used by one-step contacts only"),
    "friction_steps": Chosen(2.0, "used by one-step contacts only"),
    "friction_steps_resting": Chosen(2.0, "used by one-step contacts only"),
    "friction_time_resting": Chosen(0.0, "used by one-step contacts only"),
    "limit_steps": Chosen(0.0, "0: " + DOCUMENTED + " time constant 0.02 s of joint limits; else in steps"),
    "swing_limits": Chosen(False, "a cone is no documented joint limit of MuJoCo"),
    "drive": Chosen("welds", "of two usual ways to follow motion capture the nearer one: a mocap body per link, welded to it. "
                             "Motors: servos in the joints, and the root alone welded; they want DISCRETE, under IMPLICITFAST "
                             "swing limits and servos diverge. Welds follow better: in a study 0.9 mm off in mocap_punch_wall, "
                             "2.7 in avatar_into_wall, servos of 100 N m 2.3 and 23; limits 28 and 0.18 degrees, 0.19 and 0.05"),
    "motor_stiffness": Chosen(400.0, "of servos [N m/rad], too stiff for fingers; used by drive 'motors' only"),
    "motor_damping_ratio": Chosen(1.0, "neither overshoots nor creeps; used by drive 'motors' only"),
    "motor_force": Chosen(30.0, "largest torque of a servo [N m]: at 150 arms are 2.2 mm in a wall at 1/240, at 30 0.07 mm; used "
                                "by drive 'motors' only"),
    "weld_time": Chosen(0.02, DOCUMENTED + " (time constant [s] of the weld to the tracked pose)"),
    "weld_steps": Chosen(0.0, "0: weld_time is used; else the time constant in steps"),
    "weld_solimp": Chosen((0.9, 0.95, 0.001), DOCUMENTED),
    "weld_stiffness": Chosen(0.0, "0: the weld has a time constant; else its spring [N/m]. With 1000, weld_damping 40 and "
                                  "weld_solimp (0.5, 0.5, 0.001) it is the spring of eq. 6, on which a hand also sets out after "
                                  "its user: in coupling_sweep places are 37 mm off, velocities 0.8 m/s, with the time constant "
                                  "15 and 0.19"),
    "weld_damping": Chosen(0.0, "of that spring [N s/m]"),
    "weld_rotation": Chosen(1.0, DOCUMENTED + " (torquescale)"),
    "gravity_on_links": Chosen(True, DOCUMENTED + " (gravcomp 0)"),
    "clamp_targets": Chosen(False, "the tracker is followed as it is"),
    "lead": Chosen(0.0, "the tracker is followed as it is"),
    "lead_stops": Chosen(False, "used with a lead only"),
    "armature": Chosen(0.0, DOCUMENTED + " (rotor inertia of a joint, here as a share of its link's inertia)"),
    "margin": Chosen(0.0, DOCUMENTED + " (distance [m] at which contact of an avatar's links begins)"),
    "loose_margin": Chosen(0.0, DOCUMENTED + " (distance [m] at which contact begins of simulated bodies with one another and "
                                "with what is fixed)"),
    "ball_joints": Chosen("balls", "a ball joint is a ball, whose range limits its total turn. The scene's swing cones are "
                                   "tendons, its twist has no limit. Hinges: three hinges with ranges in its place"),
    "sleep": Chosen(False, DOCUMENTED + " (trees at rest are computed like all others)"),
    "floors": Chosen("boxes", "a fixed box is a box, as the scene has it"),
}
"""MuJoCo's defaults, and every link welded to a mocap body: the documentation offers mocap bodies and welds, and does not state
how many links of a body to weld."""

EVERYWHERE: Mapping[str, tuple[object, str]] = {
    "filterparent": (False, "disabled in every preset, default too, where MuJoCo's default is on. Which pairs may meet is the "
                            "scene's. MuJoCo's rule also drops grandparents across rigid joints"),
    "autoreset": (False, "disabled in every preset, default too, where MuJoCo's default is on. A state that has diverged must "
                         "stay visible instead of going back to the first one"),
    "contact excludes": ("pairs that the scene lets pass", "in every preset: what filterparent would drop, and what scenes say "
                                                           "beyond it"),
    "welds": ("one per link", "in every preset but servos, which welds the root alone. Each link that moves is welded to a mocap "
                              "body of its own, since a tracker gives a pose for each. The "
                              "documentation says of no body how many of its links to weld"),
}
"""Departures from MuJoCo's defaults in every preset: setting -> (value, reason)."""

_HARD = Chosen((0.9999, 0.9999, 0.001), "a contact that gives way by 1e-4 of the force only: the law below "
                                        "acts in full")

_ALWAYS: Preset = {
    "cone": Chosen("ELLIPTIC", "the pyramid slides 41 % too far on the diagonal; the ellipse 0.15 %"),
    "solimp": _HARD,
    "swing_limits": Chosen(True, "a tendon between two points is a circular cone, exactly"),
    "gravity_on_links": Chosen(False, "a tracked limb is held up by its user, not by its servo"),
    "clamp_targets": Chosen(True, "asking a joint for more than its limit only bends the limit"),
    "sleep": Chosen(False, "what rests is computed here, so that these rows say what that costs; the row mujoco/sleeping has "
                           "the flag. With the same margins no error is larger asleep (stack_ten, rest_ten_minutes, zeno: 0 "
                           "deep either way), and frames of what rests take a sixteenth: by the rule of this preset alone it "
                           "would be on there. Without a margin bodies fall asleep as deep in one another as they are and stay "
                           "so"),
}

_ONE_STEP: Preset = {
    "dt": Chosen(1.0 / 960.0, "restitution seen at the surface is off by about g dt / v; 16 steps still "
                              "fit many times into a frame"),
    "integrator": Chosen("IMPLICITFAST", "the one-step damper gives no bounce under DISCRETE or RK4"),
    "tolerance": Chosen(1e-12, "at 1e-8 the solver ends too early where forces are small: a stack of millimetres moves by 0.6, "
                               "now by 7e-5; unequal stacks drift 8e-6 m, now 7e-12; iterations are as many"),
    "contact": Chosen("one_step", "damping (1 + e) / dt turns the approach into e times itself within one "
                                  "step: Newton's law exactly"),
    "kappa": Chosen(0.002, "position correction of bouncing pairs: adds at most this to e; a stack of ten ends 0.003 mm deep "
                           "(0.02: 0.0002 mm deep, e off by 0.019)"),
    "kappa_driven": Chosen(0.25, "a critically damped stop for driven bodies, which do not bounce"),
    "kappa_resting": Chosen(0.1, "position correction of simulated bodies that do not bounce. Where they fall on one another it "
                                "makes up to this much restitution"),
    "friction_steps": Chosen(2.0, "time constant, in steps, of friction between bodies that bounce: an impact lasts one "
                                  "step. The price is the convex cone. What slides on leaves with friction times its sliding "
                                  "speed on top (0.48 of 5 m/s in oblique_bounce; at 20 steps friction is 1.2 m/s short), unless "
                                  "friction is found afterwards: see impratio"),
    "friction_steps_resting": Chosen(40.0, "the same where nothing bounces: at 2 steps a box that slides at 3 m/s hops by "
                                           "7 cm, at 20 by 0.7 mm, at 40 by 0.1 mm, and stops 0.04 % short, not 0.17 %"),
    "friction_time_resting": Chosen(0.08, "longest of those times [s]: at 1/60 forty steps are 0.7 s and a box slides 21 % "
                                          "too far; so it stops 2.2 % short, and half a step's way is 2.5 %"),
    "limit_steps": Chosen(2.0, "the stiffest limit that refsafe admits"),
}

_DRIVEN: Preset = {
    **_ONE_STEP,
    "dt": Chosen(1.0 / 960.0, "a study of eight clips against a wall, worst overlap: 1/240 15 mm, 1/480 4 mm, 1/960 0.0 mm"),
    "tolerance": Chosen(1e-8, DOCUMENTED + ": 1e-12 takes 5 % more iterations and changes nothing for who is led"),
    "weld_time": Chosen(0.02, "0.015 brings 1 mm of 28 mm offset and costs 5 mm of overlap; 0.03 costs 3 mm of offset"),
    "weld_rotation": Chosen(5.0, "a pressed limb is pushed back rather than twisted: at 1 up to 5 mm of overlap, at 5 none; "
                                 "a hand at 30 and more rattles by 0.4 mm"),
    "lead": Chosen(1.0, "aiming ahead by the weld's own lag: free offset of a mocap clip 9 mm instead of 46 mm"),
    "lead_stops": Chosen(True, "no joint is led beyond its limit: largest excess in three walks 0.03 degrees otherwise and 0 so, "
                               "in mocap_run 1.5 and 0.1, offsets are the same"),
    "armature": Chosen(0.3, "a thin limb pulled against its cone otherwise spins up about its axis and diverges"),
    "margin": Chosen(0.004, "contacts of links begin 4 mm early, so that what a foot covers in a step is taken up by air: "
                            "worst overlap at 2 mm 4.6 mm, at 4 mm 0.0 mm; offset grows by 0.5 mm"),
}


_CLOSE = Chosen(0.001, "fingers lie side by side: at 4 and 2 mm they hold each other off, 14 degrees from their user's in free "
                       "air, at 1 mm 0.2; who meets what is loose is as shallow, 0.04 mm, and nearer to the user")
"""[m] margin of hands, and of all that meets loose bodies."""

_NEWTON: Preset = {
    "dt": Chosen(1.0 / 3840.0, "an impact is found up to v dt deep, wherever steps happen to end: 4.3 mm at 1/1000, 0.4 mm here"),
}

_LADDER: Preset = {
    **_NEWTON,
    "kappa": Chosen(0.0005, "bounces are higher by this much: apexes 0.7 mm off at 60 frames per second, at 0.002 2.6 mm"),
    "kappa_resting": Chosen(0.005, "what does not bounce leaves with up to this share of its speed, pushed out of the v dt that "
                                   "it fell in by: at 1000 frames per second the ball of restitution 0 bounces by 0.097 at 0.1, "
                                   "by 0.002 here"),
}

_IMPACT: Preset = {
    **_NEWTON,
    "kappa": Chosen(0.0, "nothing pulls the bodies together again: without position correction the velocity law is exact, with "
                         "0.002 velocities are 4 mm/s off"),
    "kappa_resting": Chosen(0.0, "the same of pairs that do not bounce, which 0.1 drives apart with 0.2 of 2 m/s"),
}

FITTED = "fitted to its closed form, no advice for other models: "
"""Beginning of the reason of a setting that is right where one law is tested alone."""

_COULOMB: Preset = {
    "impratio": Chosen(1e-6, FITTED + "the ratio of frictional to normal impedance takes friction out of the main solve, and "
                                      "noslip "
                             "adds it afterwards. The convex cone trades slip for a lift by friction times what is left of it; "
                             "so normal forces are those of Newton's law"),
    "noslip_iterations": Chosen(10, FITTED + "friction by Coulomb's law at those normal forces; 1 is as good for balls. Where "
                                             "bodies are "
                                    "piled up this is worse: a stack that is struck sinks 7 mm instead of 1"),
}
"""For the five scenes that test friction alone. Errors with this and without: oblique_bounce 0.037 and 0.48 m/s, triball
0.006 and 0.031 m/s, seams 6 and 150 mm, log_roll 0.018 and 0.019 m/s, slide_to_roll 0.024 and 0.027 m/s."""

_ROLLING: Preset = {
    **_COULOMB,
    "friction_steps_resting": Chosen(20.0, "what is left of slip in a time constant goes on as spin that is late: largest errors "
                                           "0.019 m/s and 0.37 rad/s, at 40 steps 0.024 and 1.2, at 10 0.033 and 0.17"),
}

_WILD: Preset = {
    "lead_stops": Chosen(False, "a user who asks for the impossible all the time: with it limbs are up to 33 mm in one another"),
}

_PLANE: Preset = {
    "floors": Chosen("planes", "the only fixed body is a level box that nothing can reach the edges of: rods of 1 m start "
                               "above its middle and slide at most 3 m/s for a second on 20 m by 8, or fall over on 4 m by 4. "
                               "A plane is the same world there, and meets both ends of a rod at any depth, where a box makes "
                               "one contact once the axis is inside: by default 32 mm deep at the ends instead of 1.01 m, 126 "
                               "mm instead of 1.87 m; tuned alike"),
}
"""For every preset: which geom a floor is was never a question of stiffness."""



def _apart(margin: float, reason: str) -> Preset:
    """Return a margin of loose bodies."""
    return {"loose_margin": Chosen(margin, reason)}


SCENES: Mapping[str, Preset] = {
    "falling_rod": {**_PLANE, **_apart(0.001, "0 deep instead of 5.4 mm, and angular speed 0.008 rad/s off instead of 0.010")},
    "painleve": {**_PLANE, **_apart(0.0002, "1.4 mm deep instead of 2.2; at 0.4 mm 1.6, at 1 mm 2.4")},
    "hand_in_corner": {"margin": _CLOSE},
    "squeeze": {
        "margin": Chosen(0.002, "at 1 mm the hand is 0.24 mm in the slab, at 2 mm 0.06, at 4 mm 0.20"),
        **_apart(0.0002, "0 deep instead of 0.06 mm; offsets are the same"),
    },
    **dict.fromkeys(("stack_ten", "rest_ten_minutes"), _apart(
        0.0004, "0 deep in every frame instead of 0.16 mm, at 0.2 mm 0.02; the boxes stand 0.4 mm apart, and what is pushed "
                "off them comes 2.8 mm less far")),
    "stack_struck": _apart(0.001, "0.4 mm deep instead of 1.2; at 0.2 mm 3.8, at 0.4 mm 1.5: a blow falls into steps as it may"),
    "ball_drop": _apart(0.0002, "0 deep instead of 0.86 mm, and apexes 0.43 mm off instead of 0.70; at 0.4 mm 0.48, at 1 mm "
                                "0.64"),
    "zeno": _apart(0.0002, "0 deep instead of 0.17 mm, and apexes 0.5 mm off instead of 2.9; at 1 mm 1.0"),
    "elastic_20s": _apart(0.0002, "0 deep instead of 0.67 mm, and apexes 7 mm off instead of 10; at 0.4 mm 14"),
    "hand_grasp": _apart(0.0004, "0 deep instead of 0.04 mm, and in no frame on the wrong side instead of 5; at 0.2 mm 11, at "
                                 "1 mm 7: which finger slips first is a matter of chance"),
    "ball_off_table": _apart(0.0002, "0 deep instead of 0.04 mm; offsets are the same"),
    "incline_tips": _apart(0.0002, "0.7 mm deep instead of 1.0; at 0.4 mm 2.9, at 1 mm 1.2"),
    **dict.fromkeys(("superball", "newton_cradle"), _apart(
        0.0002, "velocities are nearer to the law: superball 0.011 m/s instead of 0.022, newton_cradle 0.0009 instead of 0.0011; "
                "at 1 mm balls that meet one after the other meet at once, and are 5.9 and 0.7 m/s off")),
    "rod_impact": _apart(0.0002, "0.3 mm deep instead of 2.1, velocities 0.0004 m/s off instead of 0.0033: the lever of the "
                                 "blow is that of bodies that touch"),
    **dict.fromkeys(("bounce_ladder", "bounce_ladder_30", "bounce_ladder_240", "bounce_ladder_1000"), _LADDER),
    **dict.fromkeys(("seams", "triball"), _COULOMB),
    **dict.fromkeys(("log_roll", "slide_to_roll"), _ROLLING),
    "oblique_bounce": {
        **_COULOMB,
        "dt": Chosen(1.0 / 3840.0, "a ball found 5 mm deep is turned by a lever that is 2.4 mm short: 0.037 of 5 m/s at 1/960, "
                                   "0.015 here without a margin"),
        **_apart(0.0002, "0.0016 of 5 m/s off instead of 0.015, spins 0.023 rad/s instead of 0.21: the ball is turned where it "
                         "touches; at 1 mm 0.017"),
    },
    "two_spheres": _IMPACT,
    "incline": {"friction_steps_resting": Chosen(2.0, "blocks a tenth of a degree from slipping: at 40 steps they creep "
                                                      "77 mm in a second, at 2 by 0.6 mm (the one that slides hops 9 mm)")},
    "dzhanibekov": {"integrator": Chosen("RK4", "nothing touches: no damper needs one step, and flips come 1.6 ms late under "
                                                "IMPLICITFAST")},
    "limit_torture": _WILD,
    "teleport": {
        **_WILD,
        "weld_time": Chosen(0.06, "a tracker that jumps by metres: at 0.02 the weld's pull ends in poses that are no numbers and "
                                  "in steps of 70 ms, at 0.06 nothing overlaps, and of six settings it has the smallest offset"),
    },
    "slender_spin": {"integrator": Chosen("RK4", "nothing touches; IMPLICITFAST loses all of the angular momentum")},
}
"""Settings that are best in some scenes only, by name."""


_SLEEPING: Preset = {
    "sleep": Chosen(True, "MuJoCo's documented flag: trees that stay below its velocity tolerance are not computed until "
                          "something wakes them. A row of its own, in scenes with bodies that are to rest. Frames of what "
                          "rests take a sixteenth; what falls asleep keeps the overlap that it has, hence loose_margin"),
}


def _asleep(margin: float, price: str) -> Preset:
    """Return a margin in a scene in which tuned has none, as a rest or a closed form is worse with it."""
    return _apart(margin, f"nothing falls asleep inside anything; tuned has no margin here, since {price}")


_ASLEEP: Mapping[str, Preset] = {
    **dict.fromkeys(("dt_torture", "dt_torture_1ms", "dt_torture_30ms", "far_from_origin"), _asleep(
        0.0002, "bodies that touch at the start are pushed apart: they move 0.6 mm before they rest, for 0.14 mm of overlap")),
    "scale_km": _asleep(0.2, "bodies are pushed apart at the start, as in far_from_origin, a thousand times as large"),
    "scale_mm": _asleep(2e-7, "bodies are pushed apart at the start, as in far_from_origin, a thousandth as large"),
    **dict.fromkeys(("heavy_on_light", "heavy_on_light_ratios"), _asleep(
        0.0002, "towers of two stand 0.4 mm higher than their closed form, for 0.1 mm of overlap")),
}
"""Both sides of that choice are shown, as two rows side by side."""

_SERVOS: Preset = {
    "drive": Chosen("motors", "usual where a body follows motion capture: a servo in each joint, the root alone welded "
                              "to its mocap body. A row of its own, in scenes of recorded motion"),
    "integrator": Chosen("DISCRETE", "servos damp outside the constraints: under IMPLICITFAST they and swing limits diverge"),
    "dt": Chosen(1.0 / 960.0, "as tuned. At 1/240 s, without refsafe and with an armature of 4, one motion in a corridor that "
                              "nothing was tuned for ended in 292 frames without numbers, and walls were 35 mm deep; here 4 to "
                              "8 mm, and all are numbers; at 1/480 s 34"),
    "contact": Chosen("soft", "nothing that is driven needs to bounce"),
    "contact_steps": Chosen(2.0, "the shortest stop that refsafe admits"),
    "limit_steps": Chosen(2.0, "the shortest stop that refsafe admits"),
    "motor_force": Chosen(100.0, "at 30 N m fast limbs come late: mocap_spin 148 mm off and 25 degrees beyond its limits, at "
                                 "300 30 mm and 0.6, but mocap_punch_wall 5.3 mm deep instead of 3.1"),
    "lead": Chosen(1.0, "aiming ahead by a servo's own lag: mocap_walk_wall 19 mm off at 300 N m; without and at 30 N m 127"),
    "weld_time": Chosen(0.04, "of the root's weld [s], whose lag is led too"),
}

_HINGED: Preset = {
    "ball_joints": Chosen("hinges", "three hinges with ranges for each ball joint, the last about the limb, as MJCF models of "
                                    "bodies have them. Twist is limited, at the second hinge's angle by another angle than "
                                    "the scene's. The second ends at 89 degrees. A row of its own, in rooms that nothing "
                                    "was tuned for. In a study of five, with motions of their own, hinges "
                                    "and tuned: excess 0.9 and 4.6, 5.6 and 36, 28 and 145, 95 and 138, 95 and 150 degrees; "
                                    "overlap at most 2.9 and 6.3 mm, in each room as shallow or shallower; offsets up to a sixth "
                                    "apart, either way"),
}

OPTIMISES: Mapping[str, str] = {
    "default": "nothing: what the documentation gives, but for what every preset has. That is: filterparent and autoreset "
               "disabled, a weld per link, pairs excluded as the scene has them",
    "tuned": "the least of the larger of two: overlap in any frame shown, and error to a closed form or of a rest. A hundredth "
             "of a way counts as 10 mm. Of settings as good, to a tenth, the nearest to the user is taken, and time decides only "
             "among those. 1/960 s is twice the time of 1/480 s, for no overlap instead of 4 mm in a study of eight clips",
    "sleeping": "time where bodies rest, and no overlap that is kept asleep; all else as tuned",
    "servos": "torques that a motor could have, where a body of many links follows a recorded motion. Poses are to be numbers "
              "in motion that nothing was tuned for. Overlap and distance from the user do not count; all else as tuned",
    "hinges": "limits of twist; all else as tuned",
}
"""Purpose of each preset, in one sentence."""

BETTER_ELSEWHERE = (
    "dt = 1/480 s where avatars are led: half the steps, and more overlap, or none more, by scene",
    "dt = 1/240 s there: a quarter of the steps, and overlap of millimetres to centimetres",
    "weld_time = 0.015 s: links nearer to their user, and more overlap",
    "margin = 0.002 m: links nearer to their user, and more overlap",
    "drive = motors, integrator = DISCRETE (row mujoco/servos): no torque above 100 N m, links farther from their user; with "
    "dt = 1/240 s, refsafe off and armature 4 a quarter of the steps, and poses that are no numbers in motion not tuned for",
    "sleep = true: frames of what rests take a fraction (row mujoco/sleeping); with a margin no error is larger",
    "loose_margin = 0.0002 m where tuned has none, in stop_distance, slide_to_roll, log_roll, heavy_on_light, triball, "
    "free_flight: no overlap, and stops, courses and heights of towers farther off",
    "loose_margin = 0.001 m in bounce_ladder: no overlap, and apexes farther off",
    "loose_margin = 0 where tuned has one: bodies touch instead of standing apart by it",
)
"""Settings that are better than tuned in another respect, and their cost; the sweep of a run gives the figures."""


def presets(kind: Kind, scene: str = "") -> Mapping[str, Preset]:
    """Return the presets for a kind of scene, or for the scene of that name, by name, the default first."""
    tuned = {
        Kind.BOUNCING: {**DEFAULT, **_ALWAYS, **_ONE_STEP},
        Kind.RESTING: {**DEFAULT, **_ALWAYS, **_ONE_STEP},
        Kind.MIXED: {**DEFAULT, **_ALWAYS, **_DRIVEN, "margin": _CLOSE},
        Kind.DRIVEN: {**DEFAULT, **_ALWAYS, **_DRIVEN},
    }
    best = {**tuned[kind], **of_one_scene(SCENES.get(scene, {}))}
    default = {**DEFAULT, "floors": best["floors"]}
    return {"default": default, "tuned": best, "sleeping": {**best, **_SLEEPING, **_ASLEEP.get(scene, {})},
            "servos": {**best, **_SERVOS}, "hinges": {**best, **_HINGED}}
