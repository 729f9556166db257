"""Exact answers that outrank every engine. The door to all families; each lives in a file of its own.

SI units, g positive and pulling down. Callers hand in valid numbers: nothing is checked beyond the formula's own domain.
"""

from reference.closed_form.bounce import (
    apex_height,
    bounce_path,
    bounce_state,
    bounce_time,
    fall_height,
    fall_velocity,
    impact_speed,
    semi_implicit_fall_error,
    wall_contact_time,
    zeno_time,
)
from reference.closed_form.impact import (
    Oblique,
    cradle_velocities,
    oblique_bounce,
    oblique_bounce_literal,
    point_impact,
    superball_speed,
    two_spheres,
)
from reference.closed_form.reach import reach_angles, reach_shortfall
from reference.closed_form.rotation import flip_times, top_precession
from reference.closed_form.sliding import (
    incline_acceleration,
    rod_angular_velocity,
    roll_distance,
    roll_speed,
    roll_time,
    stop_distance,
    stop_time,
    tips_over,
    tripod_load,
)
from reference.closed_form.spring import (
    coach_offset,
    coach_steady_offset,
    damping_ratio,
    spring_overshoot,
    spring_stable_step,
    spring_state,
)

__all__ = [
    "Oblique", "apex_height", "bounce_path", "bounce_state", "bounce_time", "coach_offset", "coach_steady_offset",
    "cradle_velocities", "damping_ratio", "fall_height", "fall_velocity", "flip_times", "impact_speed",
    "incline_acceleration",
    "oblique_bounce", "oblique_bounce_literal", "point_impact", "reach_angles", "reach_shortfall",
    "rod_angular_velocity", "roll_distance", "roll_speed", "roll_time", "semi_implicit_fall_error", "spring_overshoot",
    "spring_stable_step", "spring_state", "stop_distance", "stop_time", "superball_speed", "tips_over",
    "top_precession", "tripod_load",
    "two_spheres",
    "wall_contact_time", "zeno_time",
]
