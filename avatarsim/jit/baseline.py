"""Microarchitecture levels of the x86-64 psABI: the processor that kernels which travel are compiled for.

A machine runs such kernels if it has all instructions of the level. numba is not imported here: it reads its settings when it is.
"""

import os
import platform

import llvmlite.binding as llvm

from avatarsim.errors import InvalidInput

NAME = "x86-64-v3"
"""Level for kernels that travel: most processors sold by AMD and Intel since 2015, with AVX2 and fused multiplication. A lower
level halves the width of vector code; a higher one leaves out most machines."""

FEATURES = (
    "64bit", "avx", "avx2", "bmi", "bmi2", "cmov", "cx16", "cx8", "f16c", "fma", "fxsr", "lzcnt", "mmx", "movbe", "popcnt",
    "sahf", "sse", "sse2", "sse3", "sse4.1", "sse4.2", "ssse3", "xsave",
)
"""Instructions of that level, as LLVM names them."""

LISTED = ",".join(f"+{feature}" for feature in FEATURES)
"""These features as LLVM takes them."""


def runs_baseline() -> bool:
    """Return True if this machine runs code of that level."""
    host = llvm.get_host_cpu_features()
    return platform.machine() in ("x86_64", "AMD64") and all(host.get(feature, False) for feature in FEATURES)


def compile_for_baseline() -> None:
    """Have numba compile for the baseline in this process and its children; to be called before numba is imported.

    Raises InvalidInput on a machine that could not run the compiled code.
    """
    if not runs_baseline():
        raise InvalidInput("this machine's processor", llvm.get_host_cpu_name(), f"one that runs {NAME}, or use --cpu host")
    os.environ["NUMBA_CPU_NAME"], os.environ["NUMBA_CPU_FEATURES"] = NAME, LISTED
