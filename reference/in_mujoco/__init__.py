"""MuJoCo as an expert would run it on our scenes: at its documented defaults, and tuned."""

from avatarsim.assets.models.mujoco_versions import check_motion

# before the package is imported, which fails in its own words where two distributions share its folder
check_motion()
