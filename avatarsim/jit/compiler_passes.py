"""LLVM passes over the code of a kernel: it is optimised once, and becomes machine code only where that is called.

numba tidies every function with nearly all of LLVM's passes, inlines and tidies again for the sake of reference counting, and
then begins in earnest. Kernels count no references, and the last of the three does the work of the others. Two kernels of three
are so small that each caller has them inlined: of these only LLVM's code is kept, which is never translated or loaded.
"""

from itertools import islice
from typing import Any

import llvmlite.binding as llvm
from numba.core import compiler
from numba.core.codegen import JITCodeLibrary

SEALED_FROM = 200
"""Size, in LLVM instructions, from which a kernel is called instead of inlined. LLVM's inliner stops at some 50, but continues
for straight code whose arguments are known; well above this value the same code is compiled again in every caller."""

BRANCHING_FROM = 13
"""Blocks from which a kernel of half that size is called as well: LLVM inlines one in twenty of these. Without this compiling
takes 3 % longer; fewer blocks: sums over the terms of a contact are called in the innermost loops, and heaps take 4 % longer."""


def is_large(function: Any) -> bool:
    """Return True if a function of LLVM's has so many instructions that it is called instead of inlined."""
    branching = sum(1 for _ in islice(function.blocks, BRANCHING_FROM)) == BRANCHING_FROM
    most = SEALED_FROM // 2 if branching else SEALED_FROM
    # To count thousands of instructions takes longer than to compile some of them.
    return sum(1 for _ in islice((1 for block in function.blocks for _ in block.instructions), most)) == most


class NoMachine:
    """Stand-in for numba's code generator where there is no machine code."""

    @staticmethod
    def set_env(name: str, environment: object) -> None:
        """Do nothing: code that never runs reads no environment."""


class KernelLibrary(JITCodeLibrary):
    """numba's library of one compiled function, for a kernel.

    `only_inlined` becomes true when the code turns out to be small, unless Python calls it.
    """

    def __init__(self, codegen: Any, name: str, from_python: bool) -> None:
        super().__init__(codegen, name)
        self.from_python, self.only_inlined = from_python, False

    @classmethod
    def inlined(cls, codegen: Any, name: str, code: bytes) -> "KernelLibrary":
        """Return the library of a small kernel from its LLVM code."""
        library = cls(codegen, name, from_python=False)
        library._final_module, library.only_inlined = llvm.parse_bitcode(code), True
        library._finalize_final_module()
        return library

    @property
    def codegen(self) -> Any:
        """Return the code generator, which passes an environment to the machine code."""
        return NoMachine if self.only_inlined else self._codegen

    def get_pointer_to_function(self, name: str) -> int:
        """Return the address of the machine code of a function; 0 if there is none."""
        self._ensure_finalized()
        return 0 if self.only_inlined else int(super().get_pointer_to_function(name))

    def _optimize_functions(self, module: Any) -> None:
        module.data_layout = self._codegen._data_layout

    def _optimize_final_module(self) -> None:
        # adjacent sums of three and four products are most of a kernel's work; this changes no result
        manager, builder = self._codegen._module_pass_manager(slp_vectorize=True)
        manager.run(self._final_module, builder)
        if not self.from_python:
            # Code that was linked in has another linkage.
            own = [one for one in self._final_module.functions if not one.is_declaration and one.linkage == llvm.Linkage.external]
            self.only_inlined = not any(is_large(function) for function in own)

    def _finalize_final_module(self) -> None:
        if self.only_inlined:
            self._finalize_dynamic_globals()
            self._verify_declare_only_symbols()
            self._finalized = True
        else:
            super()._finalize_final_module()


class KernelCompiler(compiler.Compiler):
    """numba's compiler, with LLVM's passes as in KernelLibrary."""

    def compile_extra(self, function: Any) -> Any:
        """Compile a function; its code goes to a library of this module."""
        codegen, flags = self.state.targetctx.codegen(), self.state.flags
        self.state.library = KernelLibrary(codegen, function.__qualname__, from_python=not flags.no_cpython_wrapper)
        self.state.library.enable_object_caching()
        return super().compile_extra(function)
