"""Order of the test files: the longest first."""

LONGEST = (
    "test_cluster", "test_killed", "test_kernel_cache", "test_compile_ahead", "test_bad_engines", "test_linking",
    "test_processes", "test_own_scenes", "test_comparing", "test_timing", "test_pytest_plugin", "test_session", "test_examples",
    "test_motions", "test_exact", "test_any_frame_time", "test_judge_accuracy",
)
"""They take half of the time, of some 330 files. A file is one worker's: one that begins last leaves the others nothing to do."""
