"""Tests of the measures: for each metric a test with a known answer, for each closed form one by a second derivation.

Read as a list: `test_grades.py` fails when a metric or a closed form is missing here, or a test that is named does not exist.
"""

TIMING = "test_timing.py::test_the_least_of_all_repeats_counts_and_the_raw_times_stand_beside"
SHARES = "test_timing.py::test_shares_of_the_frames_are_those_of_a_sorted_list"
PHASES = "test_timing.py::test_a_median_of_two_phases_is_told_apart"
SUMS = "test_timing.py::test_frames_that_wait_plan_and_follow_are_a_sum_over_the_run"
DEPTHS = "test_overlap.py::test_known_depths_come_out_exactly"
COURSE = "bodies/test_course.py::test_the_farthest_from_the_course_is_the_figure"
REST = "bodies/test_course.py::test_drift_is_from_where_it_came_to_rest_and_energy_is_that_of_the_end"
MOMENTUM = "bodies/test_conserved.py::test_what_momentum_lacks_is_relative_to_what_there_was"
ENERGY = "bodies/test_conserved.py::test_energy_that_comes_or_goes_is_drift_and_only_what_comes_is_gain"
STOP = "bodies/test_course.py::test_a_stop_is_compared_along_its_way_and_its_angle_beside_it"
ROD = "bodies/test_spinning.py::test_a_rod_is_judged_by_its_angle_until_it_is_down"
HALT = "bodies/test_course.py::test_a_body_with_speed_that_stays_is_a_halt"
TOWERS = "bodies/test_course.py::test_towers_stand_up_to_the_first_ratio_that_falls"
FOLLOWS = "posture/test_tracker_offset.py::test_an_injected_offset_comes_out_and_free_frames_apart"
SHAKES = "posture/test_smoothness.py::test_an_injected_shake_comes_out"
TURNS = "posture/test_tracker_offset.py::test_an_injected_turn_comes_out_over_joints"

KEPT = "bodies/test_time_kept.py::test_an_injected_share_of_the_way_comes_out"
WAVE = "bodies/test_waves.py::test_the_speed_of_a_wave_comes_out_though_it_passes_between_frames"
CARRIED = "bodies/test_grips.py::test_what_a_carried_body_lacks_in_height_comes_out"
TOP = "bodies/test_spinning.py::test_a_top_is_compared_by_its_own_spin_and_by_how_its_axis_goes_round"

METRICS_GRADED = {
    "residual_overlap_max": "test_overlap.py::test_an_injected_overlap_is_found_to_ten_nanometres",
    "residual_overlap_p95": DEPTHS, "residual_overlap_mean": DEPTHS, "overlap_frames": DEPTHS,
    "substep_overlap_max": "test_overlap.py::test_overlap_inside_a_frame_is_seen_though_no_frame_shows_it",
    "wrong_side_frames": "test_side.py::test_frames_beyond_the_wall_are_counted_shown_or_inside_or_not_a_number",
    "restitution_error_max": "bodies/test_bounce.py::test_an_injected_error_of_the_ratio_comes_out",
    "apex_error_max": "bodies/test_bounce.py::test_the_apex_is_held_against_the_closed_form_of_every_bounce",
    "bounce_time_error_max": "bodies/test_bounce_times.py::test_impacts_seen_between_frames_are_right_to_a_frame",
    "zeno_end_error_max": "bodies/test_bounce_times.py::test_the_end_is_the_first_state_from_which_on_nothing_moves",
    "course_error_max": COURSE, "velocity_error_max": COURSE, "spin_error_max": COURSE,
    "drift_max": REST, "rest_energy_end": REST,
    "momentum_drift_max": MOMENTUM, "angular_momentum_drift_max": MOMENTUM, "energy_drift_max": ENERGY, "energy_gain_max": ENERGY,
    "stop_distance_error_max": STOP, "stop_direction_error_max": STOP,
    "flip_time_error_max": "bodies/test_spinning.py::test_flips_are_compared_one_by_one",
    "pivot_rate_error_max": ROD, "pivot_missing": ROD, "halted_frames": HALT, "status_frames": HALT,
    "time_kept_error": KEPT, "stalled_bodies": KEPT, "axis_spin_error_max": TOP, "precession_error_max": TOP,
    "wave_speed_error": WAVE, "wave_missing": WAVE, "height_missing": CARRIED, "grip_slip_max": CARRIED,
    "pile_height_error_max": "bodies/test_course.py::test_a_pile_is_as_high_as_its_bodies_are_on_the_mean_above_their_floor",
    "pressed_sideways_max": "bodies/test_grips.py::test_only_ways_at_right_angles_to_gravity_are_sideways",
    "sag_error_max": "bodies/test_grips.py::test_a_sag_is_compared_with_that_of_the_spring",
    "escaped_bodies": "bodies/test_course.py::test_the_share_of_bodies_that_left_their_region",
    "towers_fallen": TOWERS, "ratio_standing_max": TOWERS,
    "travel_missing": "bodies/test_travel.py::test_the_shortfall_of_a_stated_way_is_the_figure",
    "joint_limit_excess_max": "posture/test_limits.py::test_an_injected_excess_comes_out",
    "joint_gap_max": "posture/test_limits.py::test_a_link_torn_off_its_parent_shows_as_a_gap",
    "reach_cone_excess_max": "posture/test_limits.py::test_a_direction_outside_the_square_cone_is_as_far_as_its_face_says",
    "tracker_offset_max": FOLLOWS, "tracker_offset_rms": FOLLOWS, "tracker_offset_rms_free": FOLLOWS, "free_frames": FOLLOWS,
    "tracker_angle_rms": TURNS, "tracker_angle_rms_free": TURNS,
    "still_frames": "posture/test_stillness.py::test_injected_stillness_comes_out",
    "pose_jump_max": "posture/test_jumps.py::test_a_jump_of_a_joint_comes_out_in_degrees",
    "root_jump_max": "posture/test_jumps.py::test_a_jump_of_the_root_counts_beyond_the_users_own_way",
    "link_jump_max": "posture/test_jumps.py::test_a_jump_of_a_link_counts_beyond_its_own_targets_way",
    "jitter_rms": "posture/test_smoothness.py::test_jitter_of_a_sine_sampled_at_its_turns_is_its_swing",
    "reversal_max": "posture/test_smoothness.py::test_the_largest_displacement_to_and_fro_counts_out_of_contact_too",
    "chatter_frames": SHAKES, "reversal_p95": SHAKES,
    "contact_gap_p50": "posture/test_hover.py::test_the_median_is_over_states_in_contact_and_an_overlap_is_no_gap",
    "own_acceleration_rms": "posture/test_smoothness.py::test_following_exactly_neither_shakes_nor_is_off",
    "dash_frames": "posture/test_smoothness.py::test_following_exactly_neither_shakes_nor_is_off",
    "silent_offset_frames": "posture/test_smoothness.py::test_silent_are_frames_far_off_after_half_a_second_of_free_target",
    "energy_added_max": "bodies/test_energy.py::test_an_injected_kick_comes_out_in_joules",
    "lift_energy_max": "bodies/test_energy.py::test_an_injected_lift_is_lift_and_not_gain",
    "lift_height_max": "bodies/test_energy.py::test_an_injected_lift_is_lift_and_not_gain",
    "grasped_fall_end": "bodies/test_grasp.py::test_what_slips_out_has_fallen_by_its_height",
    "not_finite_frames": "test_finite.py::test_each_bad_frame_counts_once",
    "frame_time_p50": SHARES, "frame_time_p95": SHARES, "frame_time_p99": SHARES, "frame_time_max": TIMING,
    "frame_time_raw_p50": TIMING, "frame_time_raw_p95": SHARES, "frame_time_raw_p99": SHARES,
    "frame_time_python_p50": TIMING, "warmup": TIMING, "frame_time_moving_p50": PHASES, "frame_time_resting_p50": PHASES,
    "resting_frames": PHASES,
    "time_step": "../studies/settings/test_rows.py::test_a_measured_cell_has_a_row_per_error_and_time",
    "pose_distance_max": "../studies/test_effects.py::"
                         "test_leaving_out_bounce_or_continuous_detection_breaks_the_bounds_that_need_them",
    "end_distance": "../studies/hard_cases/test_trial.py::"
                    "test_rows_have_figures_states_and_the_distance_from_the_unchanged_end",
    "deterministic": "test_timing.py::test_repeats_that_end_in_other_bits_are_not_deterministic",
    "waiting": SUMS, "planning": SUMS, "following": SUMS, "out_of_work": SUMS,
}
"""Files are beside this one. The stand-in "run" is no measure."""

FALL = "closed_form/test_closed_form.py::test_free_fall_is_what_integration_gives"
BOUNCES = "closed_form/test_closed_form.py::test_bounces_are_where_integration_puts_them"
STOPS = "closed_form/test_closed_form.py::test_sliding_body_stops_where_integration_stops_it"
ROLLS = "closed_form/test_closed_form.py::test_sliding_sphere_rolls_where_integration_says"
OBLIQUE = "closed_form/test_closed_form.py::test_oblique_bounce_is_the_limit_of_small_impulses"

CLOSED_FORMS_GRADED = {
    "fall_height": FALL, "fall_velocity": FALL,
    "impact_speed": BOUNCES, "bounce_time": BOUNCES,
    "zeno_time": "closed_form/test_closed_form.py::test_zeno_end_is_the_sum_of_all_flights",
    "bounce_state": "closed_form/test_closed_form.py::test_bounce_state_agrees_with_walking_from_impact_to_impact",
    "wall_contact_time": "closed_form/test_closed_form.py::test_wall_contact_time_leaves_the_ball_on_the_surface",
    "two_spheres": "closed_form/test_closed_form.py::test_two_spheres_keep_momentum_and_obey_restitution",
    "superball_speed": "closed_form/test_closed_form.py::test_superball_is_a_floor_bounce_and_then_two_spheres",
    "cradle_velocities": "closed_form/test_closed_form.py::test_cradle_is_a_chain_of_two_sphere_impacts",
    "Oblique": OBLIQUE, "oblique_bounce": OBLIQUE,
    "point_impact": "closed_form/test_closed_form.py::test_point_impact_solves_newton_euler_and_restitution_together",
    "stop_distance": STOPS, "stop_time": STOPS, "roll_time": ROLLS, "roll_distance": ROLLS, "roll_speed": ROLLS,
    "incline_acceleration": "closed_form/test_closed_form.py::test_incline_agrees_with_forces_in_world_axes",
    "rod_angular_velocity": "closed_form/test_closed_form.py::test_falling_rod_is_what_its_equation_of_motion_gives",
    "tripod_load": "closed_form/test_closed_form.py::test_loads_of_a_sliding_tripod_balance_forces_and_moments",
    "flip_times": "closed_form/test_closed_form_rotation.py::test_flips_are_where_integration_puts_them",
    "top_precession": "closed_form/test_closed_form_rotation.py::test_a_top_goes_round_as_integration_has_it",
    "spring_state": "closed_form/test_closed_form_spring.py::test_spring_state_is_what_integration_gives",
}
"""Files are in tests/reference."""
