"""Order of the test files: the longest first."""

LONGEST = (
    "test_compile_ahead", "test_linking", "test_bad_engines", "test_judge_accuracy", "test_contact_times", "test_exact",
    "test_posture_fuzz", "test_any_frame_time", "test_cli", "test_from_mesh",
    "test_catalog", "test_kernel_cache", "test_report", "test_effects_in_catalogue", "test_solve_hostile", "test_slice",
    "test_killed",
)
"""They take half of the time, of some 330 files. A file is one worker's: one that begins last leaves the others nothing to do."""
