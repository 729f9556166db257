"""Which of numba's passes does a kernel need?

numba's own list serves closures, comprehensions, `with` blocks, literal arguments, array expressions and reports as well, and
each of those passes walks through the whole function. Kernels have none of these: a kernel that did would be refused by the
compiler, and the machine code of those there are is the same with and without.
"""

from typing import Any

from numba.core import compiler, typed_passes, untyped_passes
from numba.core.compiler_machinery import AnalysisPass, PassManager, register_pass
from numba.core.errors import new_error_context  # type: ignore[attr-defined]  # its annotations leave it out

from avatarsim.jit.kernel_library import KernelLibrary


@register_pass(mutates_CFG=False, analysis_only=True)
class NoAnnotation(AnalysisPass):
    """Leave out the listing of every line with its types, which `inspect_types` would show."""

    _name = "avatarsim_no_annotation"

    def __init__(self) -> None:
        super().__init__()

    def run_pass(self, state: Any) -> bool:
        """Say that there is none."""
        state.type_annotation = ""
        return False


PASSES = (
    untyped_passes.TranslateByteCode,
    untyped_passes.FixupArgs,
    untyped_passes.IRProcessing,
    untyped_passes.RewriteSemanticConstants,
    untyped_passes.DeadBranchPrune,
    untyped_passes.GenericRewrites,
    untyped_passes.ReconstructSSA,
    untyped_passes.DeadBranchPrune,
    typed_passes.NopythonTypeInference,
    typed_passes.PreLowerStripPhis,
    typed_passes.InlineOverloads,
    typed_passes.IRLegalization,
    NoAnnotation,
    typed_passes.NativeLowering,
    typed_passes.NoPythonBackend,
)
"""In this order; branches are pruned a second time because names of their own per assignment show more of them to be dead."""


class Pipeline(PassManager):
    """Passes in a row, without a report of every one, which spells out all types of the kernel each time."""

    def _runPass(self, index: int, stage: Any, state: Any) -> None:
        stage.analysis = self._analysis
        with new_error_context("Pass {name}", name=stage.name()):
            stage.run_initialization(state)
            stage.run_pass(state)
            stage.run_finalizer(state)


class KernelCompiler(compiler.CompilerBase):
    """numba's compiler with these passes, and with LLVM's as `kernel_library` says."""

    def compile_extra(self, function: Any) -> Any:
        """Compile a function; its code goes to a library of ours."""
        codegen, flags = self.state.targetctx.codegen(), self.state.flags
        self.state.library = KernelLibrary(codegen, function.__qualname__, from_python=not flags.no_cpython_wrapper)
        self.state.library.enable_object_caching()
        return super().compile_extra(function)

    def define_pipelines(self) -> list[PassManager]:
        """One pipeline; there is no other to fall back to."""
        manager = Pipeline("avatarsim kernel")
        for stage in PASSES:
            manager.add_pass(stage)
        manager.finalize()
        return [manager]
