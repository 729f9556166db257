"""Where each equation, table, figure and algorithm of the paper is shown: by which tests, and in which scenes.

To be read as a table of contents. `test_claims.py` fails when an entry is missing, or names a test or a scene that is not there.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Claim:
    """A claim of the paper, scenes of the catalogue, and the tests that show it here ("file::function", from `tests/`)."""

    says: str
    scenes: tuple[str, ...]
    tests: tuple[str, ...]


def of(file: str, *tests: str) -> tuple[str, ...]:
    """Return tests of a file."""
    return tuple(f"{file}::{test}" for test in tests)


EQUATIONS = {
    "equation 1": Claim(
        "global penetration depth: sum(pd^2 n) / |sum pd|", ("shallow_overlap", "opposed_normals", "split_invariance"),
        of(
            "paper/test_equation_1.py", "test_equal_pieces_with_one_normal_give_exactly_their_depth",
            "test_a_corner_of_n_walls_loses_one_nth_of_its_depth",
            "test_equal_opposite_normals_are_a_status_and_not_a_zero_push"
        )
        + of("paper/test_algorithm_1.py", "test_step_3_their_squares_along_their_normals_over_their_sum"),
    ),
    "equation 2": Claim(
        "end effector: the mean of the contacts of a link", ("two_arms", "avatar_into_wall"),
        of("paper/test_equation_2.py", "test_it_is_the_mean_of_the_first_k_contacts"),
    ),
    "equation 3": Claim(
        "goal: the end effector on the outside of the obstacle", ("two_arms", "avatar_into_wall"),
        of("paper/test_equation_3.py", "test_the_sign_says_who_is_a", "test_the_goal_lies_on_the_outside_of_the_obstacle"),
    ),
    "equation 4": Claim(
        "projection onto the plane of a joint", ("singular_chain",),
        of(
            "paper/test_equation_4.py", "test_it_drops_exactly_the_part_along_the_axis",
            "test_the_equation_as_printed_would_not_project"
        ),
    ),
    "equation 5": Claim(
        "the turn of a joint that brings the effector nearest to its goal", ("singular_chain",),
        of(
            "paper/test_equation_5.py", "test_no_other_turn_brings_the_effector_nearer",
            "test_small_angles_are_exact_where_acos_is_blind"
        ),
    ),
    "equation 6": Claim(
        "virtual coupling: a damped spring between tracker and driven object",
        ("coupling_sweep", "hand_over_table", "squeeze", "coach_release"),
        of("paper/test_equation_6.py", "test_agrees_with_an_integrator", "test_energy_never_grows")
        + of("paper/test_figure_3.py", "test_eq_6_a_hand_trails_and_catches_up_as_an_oscillator"),
    ),
    "equation 7": Claim(
        "normal velocity of a contact", ("two_spheres",),
        of("paper/test_equation_7.py", "test_is_the_rate_of_the_gap"),
    ),
    "equation 8": Claim(
        "restitution: v+ = -e v-", ("bounce_ladder", "ball_drop", "zeno"),
        of("paper/test_equation_8.py", "test_a_dropped_ball_rebounds_as_stated", "test_a_corner_is_hit_symmetrically"),
    ),
    "equation 9": Claim(
        "magnitude of the impulse, masses and turning of both bodies in it",
        ("two_spheres", "rod_impact", "superball", "newton_cradle"),
        of("paper/test_equation_9.py", "test_reverses_the_normal_velocity_of_any_two_bodies", "test_a_rod_hit_off_its_centre"),
    ),
    "equation 10": Claim(
        "impulse of Coulomb friction", ("oblique_bounce", "stop_distance", "slide_to_roll", "incline"),
        of(
            "paper/test_equation_10.py", "test_as_printed", "test_oblique_sphere_sticks_or_slides",
            "test_as_printed_it_reverses_the_slip_and_may_add_energy"
        ),
    ),
}
TABLES = {
    "table 1": Claim(
        "restitution and friction of six pairs of materials", ("ball_drop",),
        of("paper/test_table_1.py", "test_pair")
        + of("scene/test_material.py", "test_table_1_is_the_papers"),
    ),
    "table 2": Claim(
        "frame time, joints, iterations and pairs of four scenes; shares as printed",
        ("two_arms", "self_collision", "two_arms_and_leg", "arm_in_corner"),
        of(
            "benchmarks/test_table_2.py", "test_the_papers_rows_are_its_table",
            "test_counts_are_of_frames_advanced_and_times_of_those_timed",
            "test_the_command_writes_table_and_traces"
        ),
    ),
}
FIGURES = {
    "figure 1": Claim(
        "a finger snips a ball, which rolls over the table and off it", ("ball_off_table",),
        of(
            "paper/test_figure_1.py", "test_the_ball_rolls_over_the_table_and_off_it",
            "test_nothing_overlaps_while_the_ball_is_pushed"
        ),
    ),
    "figure 2": Claim(
        "an avatar moves into a wall: arm and leg are pushed back", ("avatar_into_wall",),
        of(
            "paper/test_figure_2.py", "test_arm_and_leg_are_pushed_back_and_the_rest_goes_on",
            "test_the_user_is_far_in_the_wall_and_what_is_shown_is_not"
        ),
    ),
    "figure 3": Claim(
        "architecture: a loop for driven objects, then one for simulated ones", ("hand_over_table", "squeeze"),
        of(
            "paper/test_figure_3.py", "test_a_wall_pushes_an_arm_back_and_they_stay_in_touch",
            "test_in_free_motion_only_the_first_search_is_made", "test_a_ball_gives_way_where_the_arm_cannot"
        ),
    ),
    "figure 4": Claim(
        "global depth: a reasonable case, and one where normals cancel", ("shallow_overlap", "opposed_normals"),
        of(
            "paper/test_figure_4.py", "test_several_pieces_overlapped_little_take_translation_only",
            "test_normals_that_cancel_are_reported_and_walked_back"
        ),
    ),
    "figure 5": Claim(
        "an articulated hand slides along a non-convex corner", ("hand_in_corner", "hand_in_corner_rigid"),
        of("paper/test_figure_5.py", "test_it_slides_along_the_corner_and_never_jumps"),
    ),
    "figure 6": Claim(
        "a joint is turned so that the distance to the goal is least", ("singular_chain",),
        of("paper/test_equation_5.py", "test_no_other_turn_brings_the_effector_nearer")
        + of(
            "printed/test_cyclic_coordinate_descent.py", "test_two_links_reach_as_the_law_of_cosines_says",
            "test_a_sweep_never_leads_away_from_the_goal"
        ),
    ),
    "figure 7": Claim(
        "frame time of the hand's run: idle, two plateaus, spikes at the ball", ("hand_over_table",),
        of(
            "paper/test_figure_7.py", "test_idle_the_hand_asks_for_no_contact", "test_two_plateaus_with_a_break_between",
            "test_spikes_towards_the_end_when_the_ball_is_hit"
        ) + of(
            "benchmarks/test_table_2.py", "test_every_frame_of_figure_7_has_a_time_and_shares",
        ),
    ),
    "figure 8": Claim(
        "frame time of two arms: a spike for each push into the wall", ("two_arms",),
        of("paper/test_figure_8.py", "test_a_spike_for_every_push_and_silence_between")
        + of("benchmarks/test_table_2.py", "test_the_command_writes_table_and_traces"),
    ),
}
ALGORITHMS = {
    "algorithm 1": Claim(
        "cull, depth per convex pair, eq. 1, interpolate if needed", ("shallow_overlap", "opposed_normals", "hand_in_corner"),
        of(
            "paper/test_algorithm_1.py", "test_step_1_pairs_that_do_not_overlap_are_culled",
            "test_step_2_every_convex_pair_has_its_depth", "test_step_3_their_squares_along_their_normals_over_their_sum",
            "test_step_4_without_direction_the_state_goes_back"
        ),
    ),
}
IN_WORDS = {
    "three kinds of objects": Claim(
        "fixed ones never give way, driven ones first, simulated ones if they must", ("squeeze",),
        of("printed/test_push_apart.py", "test_the_rule")
        + of("paper/test_figure_3.py", "test_a_hand_in_a_ball_gives_way_and_the_ball_stays"),
    ),
    "order of chains": Claim(
        "the order in which chains are treated is randomised", ("chain_order",),
        of("paper/test_figure_3.py", "test_same_seed_same_bits_and_another_seed_another_order"),
    ),
    "self-collision": Claim(
        "chains that collide with one another part", ("self_collision",),
        of("paper/test_figure_3.py", "test_two_arms_part"),
    ),
    "joint limits": Claim(
        "planar joints stop at an angle, others are projected back into a reach cone", ("limit_torture", "reach_cone_edges"),
        of("printed/test_cyclic_coordinate_descent.py", "test_hinge_limits_hold_exactly_for_ten_thousand_goals")
        + of("model/test_reach_cone.py", "test_nothing_inside_is_nearer_than_the_nearest_direction"),
    ),
    "parallel link": Claim(
        "a link parallel to the surface is moved out by translation and reconnected", ("parallel_link",),
        of("printed/test_free_link.py", "test_a_nearly_parallel_link_is_moved_and_not_turned"),
    ),
    "coach and trainee": Claim(
        "the posture is attracted to the user's", ("coach_release",),
        of("paper/test_coach_and_trainee.py", "test_the_papers_attraction_returns_on_its_exponential")
        + of("printed/test_attraction.py", "test_a_released_posture_returns_exponentially"),
    ),
    "sweep and prune": Claim(
        "pairs are filtered before they are asked", ("balls_216",),
        of("collision/test_broad_phase.py", "test_finds_the_pairs_of_the_dumb_twin_frame_after_frame"),
    ),
    "missed collisions": Claim(
        "left to future work: continuous collision detection", ("tunnelling", "thin_wall_hand"),
        of("rigid/test_upper.py", "test_nothing_tunnels"),
    ),
}
PAPER = {**EQUATIONS, **TABLES, **FIGURES, **ALGORITHMS, **IN_WORDS}
