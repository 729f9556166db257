"""What MuJoCo and PyBullet are known to reach, and where that is shown of them here: measured facts about both engines.

They were measured on models written for each engine alone. To be read as a table of contents, and as the answer to whether the
engines that ours is compared with are at their best: one that falls short of what it is known to reach is set wrongly here.
`test_claims.py` fails when an entry names a test, scene, setting or contender that is not there. What is not matched is in
`unmatched.py`, with the reason.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Claim:
    """What is known, and what shows it: tests ("file::function", from `tests/`), scenes of the catalogue, settings of the sweep
    (as its tables name them), contenders of the narrow phase, times of each scene in bench.csv (as its column `metric` has them).

    Times are a machine's: a row shows today's, and no test holds them."""

    says: str
    tests: tuple[str, ...] = ()
    scenes: tuple[str, ...] = ()
    sweep: tuple[str, ...] = ()
    contenders: tuple[str, ...] = ()
    times: tuple[str, ...] = ()


HERE, NEWTON = "agreement/reached/", "agreement/reached/test_newton.py::test_"
ELSEWHERE, COULOMB = "agreement/reached/test_newton_elsewhere.py::test_", "agreement/reached/test_coulomb.py::test_"
ROLLING, LIMIT = "agreement/reached/test_rolling.py::test_", "agreement/reached/test_limits_of_joints.py::test_"
TRAP, FACTOR = "agreement/test_traps.py::test_", "agreement/test_factors.py::test_"
PRODUCT, MOTOR = "agreement/reached/test_products.py::test_", "agreement/reached/test_motors.py::test_"

RESTITUTION = (
    Claim("MuJoCo's one-step damper gives v+/v- to four decimals at every step and phase", (
        NEWTON + "velocities_across_the_step_of_an_impact_are_exact",
        NEWTON + "the_preset_adds_no_more_than_its_position_correction",
    ), ("bounce_ladder", "ball_drop"), ("mujoco/tuned kappa=0.02",)),
    Claim("seen at the surface, it is off by what is left of a step", (NEWTON + "at_the_surface_errors_are_those_of_the_step",)),
    Claim("at 1/60 means over phases are off by 0.005 of 0.5 and 0.035 of 1", (
        HERE + "test_newton_coarse.py::test_means_over_phases_are_as_near_as_known",
    )),
    Claim("two free spheres, boxes on four corners and on two", (
        ELSEWHERE + "two_free_spheres_part_at_half_their_speed",
        ELSEWHERE + "a_box_that_lands_on_four_corners_or_on_two_leaves_with_half_its_speed",
    ), ("two_spheres",)),
    Claim("at any speed", (
        ELSEWHERE + "slow_impacts_bounce_as_fast_ones_do",
        ELSEWHERE + "with_gravity_impacts_of_any_speed_are_within_the_known_range",
    )),
    Claim("not under DISCRETE or RK4", (ELSEWHERE + "the_damper_does_not_bounce_under_other_integrators",)),
    Claim("beside it friction needs constants of its own", (
        ELSEWHERE + "bouncing_boxes_slide_as_far_as_others", ELSEWHERE + "a_bouncing_box_at_rest_creeps_no_faster_than_known",
    )),
    Claim("springs and MuJoCo's defaults do not bounce or bounce wrongly", (TRAP + "mujoco_bounces_as_stated_when_tuned",),
          ("bounce_ladder",), ("mujoco/default", "mujoco/tuned contact_time=0.004")),
    Claim("a symmetric table needs explicit pairs", ("agreement/test_laws.py::test_every_pair_has_its_law",
                                                     "agreement/test_laws.py::test_table_1_needs_few_explicit_pairs")),
    Claim("PyBullet outside its multibody solver: to a thousandth at 1/1000", (
        NEWTON + "velocities_across_the_step_of_an_impact_are_exact",
        NEWTON + "pybullet_leaves_with_the_velocities_it_is_known_for",
    ), ("bounce_ladder",), ("pybullet/tuned multibody erp=0", "pybullet/tuned processing_threshold=1")),
    Claim("and its bodies rest within 0.01 mm", (
        ELSEWHERE + "a_ball_at_rest_in_pybullet_is_no_deeper_than_a_hundredth_of_a_millimetre",
    ), ("stack_ten",)),
    Claim("PyBullet bounces exactly from 0.2 m/s on", (ELSEWHERE + "pybullet_bounces_from_twenty_centimetres_a_second_on",)),
    Claim("products of factors are exact for three classes that touch", (
        FACTOR + "three_classes_that_touch_are_exact", FACTOR + "six_balls_on_six_slabs_are_exact_where_they_meet",
        FACTOR + "factors_do_not_depend_on_the_size_of_the_world",
    ), ("scale_mm", "scale_km")),
    Claim("products of three factors miss Table 1 by 0.050 and 0.033 at most", (
        PRODUCT + "table_1_is_missed_by_no_more_than_known_where_all_meet_all", PRODUCT + "no_factors_of_a_grid_are_better",
        PRODUCT + "what_can_be_said_is_said",
    )),
)
FRICTION = (
    Claim("boxes stop as far short as half a step's way", (
        COULOMB + "what_is_left_beside_half_a_step_is_no_more_than_known", COULOMB + "what_never_bounces_goes_as_far_in_mujoco",
    ), ("stop_distance", "stop_distance_30", "stop_distance_240")),
    Claim("in every direction, but on MuJoCo's pyramid", (
        COULOMB + "no_direction_is_worse", COULOMB + "the_pyramid_is_worse_by_as_much_as_is_known",
        TRAP + "10_friction_is_the_same_in_all_directions",
    ), ("stop_distance",), ("mujoco/tuned cone=PYRAMIDAL",)),
    Claim("and stay where they stopped", (COULOMB + "stopped_boxes_stay",), ("stop_distance",)),
    Claim("a sliding ball rolls at 5/7 of its speed, from the right time on", (
        ROLLING + "what_is_left_is_as_near_to_five_sevenths_as_known", ROLLING + "sliding_ends_within_a_step_of_its_time",
    ), ("slide_to_roll", "log_roll")),
    Claim("an oblique bounce", (ROLLING + "an_oblique_bounce_loses_what_coulomb_says",), ("oblique_bounce",)),
)
DRIVEN = (
    Claim("a ball led 10 cm into a wall: 0.04 and 0.01 mm deep at 1/240", (
        HERE + "test_ball_in_wall.py::test_a_ball_is_no_deeper_and_no_later_than_known",
    ), ("driven_10cm_wall",), ("mujoco/tuned DISCRETE dt=1/240", "pybullet/tuned drive=velocity", "pybullet/tuned dt=1/240")),
    Claim("a hand of fifteen ellipsoids pressed 10 cm into a table: 2 and 0.02 mm", (
        HERE + "test_hand_on_table.py::test_a_hand_is_no_deeper_than_known", TRAP + "6_driven_bodies_touch_fixed_ones",
    ), ("hand_over_table", "hand_in_corner_rigid", "thin_wall_hand")),
    Claim("arms that reach 18 cm into a wall: 0.07 and 0.02 mm", (
        HERE + "test_arms_in_wall.py::test_arms_are_no_deeper_than_known",
        HERE + "test_arms_in_wall.py::test_the_mannequin_has_sixteen_links_and_twenty_two_hinges",
    ), ("two_arms", "avatar_into_wall"), ("pybullet/tuned force=30",)),
    Claim("MuJoCo's by motors, with one setting for contacts, limits and drive", (
        MOTOR + "arms_in_a_wall_are_no_deeper_than_known", "agreement/test_motors.py::test_balls_arrive_without_swinging_on",
        "agreement/test_motors.py::test_no_ball_is_led_beyond_its_limits",
    ), sweep=("mujoco/tuned motors DISCRETE", "mujoco/tuned motors DISCRETE dt=1/240")),
    Claim("PyBullet's contacts act before bodies meet", (
        "agreement/test_contact_before_overlap.py::test_one_piece_is_met_before_it_overlaps",
        "agreement/test_contact_before_overlap.py"
        "::test_two_driven_pieces_are_met_before_they_overlap_each_once_and_never_by_each_other",
    ), (), ("pybullet/tuned breaking_threshold=0.02", "pybullet/tuned pieces_as_links=off")),
)
DEPTHS = (
    Claim("coal is exact, and settings make it so for curved shapes", (
        "reference/judging/test_judge_accuracy.py::test_judge_agrees_with_exact_answers_on_two_thousand_pairs",
        "reference/judging/test_judge_accuracy.py::test_concentric_hulls_are_judged_right",
    ), contenders=("coal exact", "coal default")),
    Claim("fcl, MuJoCo's and PyBullet's own queries are off by what is known of each", (
        "reference/narrow_phase/test_contenders.py::test_answers_belong_to_their_pairs",
        "agreement/test_traps_of_depth_and_drive.py::test_7_mujoco_underrates_a_capsule_deep_in_a_box",
    ), contenders=(
        "fcl", "mj geomDist default", "mj geomDist", "mj collision", "pb closest default", "pb closest", "pb detection",
    )),
    Claim("PyBullet's hulls are 2 mm too large by default, and right when tuned", (TRAP + "3_hulls_are_not_inflated_when_tuned",),
          (), ("pybullet/tuned margin=0.001",)),
    Claim("in a simulation, MuJoCo agrees with the judge to 1e-7 mm, PyBullet to 1 um", (
        HERE + "test_own_depths.py::test_mujoco_and_the_judge_agree_on_hulls_in_a_box",
        HERE + "test_own_depths.py::test_pybullet_and_the_judge_agree_on_hulls_in_a_box",
    )),
    Claim("all engines see the same vertices", (
        "agreement/test_parity.py::test_mujoco_meshes_are_where_the_scene_has_them",
        "agreement/test_parity.py::test_pybullet_hulls_are_where_the_scene_has_them",
    )),
)
KNOBS = (
    Claim("MuJoCo: step, integrator, contact and weld constants matter; iterations from 30 on do not", (), (), (
        "mujoco/tuned dt=1/60", "mujoco/tuned dt=1/240", "mujoco/tuned DISCRETE", "mujoco/tuned contact_time=0.004",
        "mujoco/tuned weld_time=0.01", "mujoco/tuned iterations=10", "mujoco/tuned margin=0",
    )),
    Claim("PyBullet: step, contact ERP, slop and margin matter; iterations hardly", (), (), (
        "pybullet/tuned dt=1/60", "pybullet/tuned contact_erp=0.1", "pybullet/tuned slop=1e-4", "pybullet/tuned margin=0.001",
        "pybullet/tuned solver_iterations=10", "pybullet/tuned solver_iterations=200", "pybullet/tuned breaking_threshold=0.02",
    )),
    Claim("solver variants, islands, warm starts and PyBullet's cone switch change no depth", (
        HERE + "test_solvers.py::test_mujoco_ends_as_deep_with_any_solver",
        HERE + "test_solvers.py::test_pybullet_ends_as_deep_however_it_begins",
    )),
)
LIMITS = (
    Claim("hinges asked 30 degrees past their limit: 0.010 and 0.002 degrees at 1/240, 0.000 at 1/1020", (
        LIMIT + "joints_are_no_further_beyond_than_known", LIMIT + "pybullet_s_preset_holds_them_as_well_once_they_are_there",
        TRAP + "8_hinge_limits_hold_when_tuned",
    ), ("limit_torture_hinges",)),
    Claim("MuJoCo's, by motors that ask for 30 degrees more: 1.4, 0.010, 0.000, held at 0.02, 0.001, 0.000; while a wall pushes "
          "0.33, 0.001, 0.000", (
        MOTOR + "a_servo_asked_too_much_is_held_as_well_as_known", MOTOR + "a_wall_that_pushes_bends_no_joint_further_than_known",
    ), ("two_arms",), ("mujoco/tuned motors DISCRETE dt=1/240",)),
    Claim("PyBullet's, while a wall pushes", (LIMIT + "pybullet_holds_them_against_a_wall",), ("two_arms",)),
    Claim("PyBullet's ball joints have limits in URDF files; createMultiBody, by which our adapter makes them, has no word for "
          "those, and here they are held by motors", (
        "agreement/test_limits_in_urdf.py::test_a_ball_joint_of_a_file_stops_at_its_limit",
        "agreement/test_limits_in_urdf.py::test_a_body_made_by_calls_has_no_word_for_limits",
        "agreement/test_ball_stops.py::test_legs_that_meet_stay_within_a_few_degrees",
    ), ("limit_torture",)),
)
BITS = (
    Claim("both repeat themselves bit for bit, in one process and in two", (
        HERE + "test_bits.py::test_three_runs_in_this_process_are_the_same",
        HERE + "test_bits.py::test_a_run_in_another_process_is_the_same",
        "agreement/test_parity.py::test_two_runs_give_the_same_bits",
        TRAP + "12_pybullet_replays_from_the_start", TRAP + "1_breaking_threshold_left_behind_by_others_does_not_matter",
    )),
    Claim("MuJoCo goes on from a kept state bit for bit, and so does its rollout; PyBullet does not", (
        HERE + "test_going_on.py::test_mujoco_goes_on_from_a_kept_state_bit_for_bit",
        HERE + "test_going_on.py::test_mujoco_s_rollout_is_its_loop_bit_for_bit",
        HERE + "test_going_on.py::test_pybullet_does_not_go_on_from_a_kept_state_as_it_did",
    )),
)
TIMES = (
    Claim("frame times, and what each setting costs", scenes=("hand_over_table", "two_arms"), sweep=(
        "mujoco/tuned dt=1/60", "mujoco/tuned dt=1/240", "mujoco/tuned DISCRETE dt=1/240", "pybullet/tuned dt=1/60",
        "pybullet/tuned dt=1/240", "pybullet/tuned solver_iterations=10",
    ), times=("frame_time_p50", "frame_time_p95", "frame_time_p99", "frame_time_max")),
    Claim("queries of single pairs take 3 to 50 us", contenders=("coal exact", "fcl", "mj geomDist", "pb closest")),
    Claim("Python costs MuJoCo's loop 3 %: what is outside its step, all of the adapter included", scenes=("two_arms",),
          times=("frame_time_python_p50", "stage_share_step")),
)
PACKAGES = (
    Claim("MuJoCo's defaults, its integrators, packages beside NumPy 2", (
        HERE + "test_packages.py::test_mujoco_s_defaults_are_what_the_preset_of_that_name_says",
        HERE + "test_packages.py::test_mujoco_has_every_integrator_that_figures_are_known_of",
        HERE + "test_packages.py::test_pybullet_speaks_numpy",
        HERE + "test_packages.py::test_packages_are_imported_without_a_warning_beside_numpy_2",
    )),
)
KNOWN = (*RESTITUTION, *FRICTION, *DRIVEN, *DEPTHS, *KNOBS, *LIMITS, *BITS, *TIMES, *PACKAGES)
