"""Compiles functions that are only called by compiled code: their intermediate code becomes part of their caller's.

numba optimises every function with all that it calls, and makes machine code of each. Of functions that nothing else
calls, only the outermost needs either: the reference integrator, with six levels, took twice as long. For functions
without fast-math only, whose bits do not depend on when they are optimised.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba import njit
from numba._dynfunc import make_function
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.compiler_machinery import PassManager, register_pass
from numba.core.typed_passes import NativeLowering


def linked(function: Callable[..., Any], **flags: Any) -> Any:
    """A function for compiled callers; a call from Python crashes the process."""
    flags |= {"pipeline_class": _Compiler, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    return njit(**flags)(function)


class _Library(JITCodeLibrary):
    """Code to link, as it was written."""

    def _optimize_final_module(self) -> None:
        """The outermost function does this."""

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()  # type: ignore[no-untyped-call]
        self._finalized = True


@register_pass(mutates_CFG=True, analysis_only=False)  # type: ignore[no-untyped-call]
class _Lowering(NativeLowering):
    _name = "linked_lowering"

    def run_pass(self, state: Any) -> bool:
        state.library = _Library(state.targetctx.codegen(), state.func_id.func_qualname)  # type: ignore[no-untyped-call]
        state.flags.no_compile = True
        done = super().run_pass(state)  # type: ignore[no-untyped-call]
        state.library.finalize()
        made = state["cr"]
        nothing = make_function(made.fndesc.lookup_module(), made.fndesc.qualname, "", 0, made.env, (state.library,))
        state.targetctx.insert_user_function(nothing, made.fndesc, [state.library])
        state["cr"] = made._replace(cfunc=nothing)
        return bool(done)


class _Compiler(Compiler):
    def define_pipelines(self) -> list[PassManager]:
        (pipeline,) = super().define_pipelines()  # type: ignore[no-untyped-call]
        pipeline.passes = [(_Lowering if p is NativeLowering else p, text) for p, text in pipeline.passes]
        pipeline._finalized = False
        pipeline.finalize()
        return [pipeline]
