"""All that Clearance uses of numba's insides, which another version may rename: the minor version is pinned, and
`tests/unit/engine/kernels/test_numba_internals.py` says which name moved. Other modules import only what numba
documents.

Start reading at `inlined`, `cached`, `linked`.
"""

from __future__ import annotations

import logging
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from hashlib import sha256
from io import BytesIO
from pathlib import Path
from types import FunctionType
from typing import Any
from uuid import uuid4

from numba import njit
from numba._dynfunc import make_function
from numba.core.caching import FunctionCache, IndexDataCacheFile
from numba.core.ccallback import CFunc
from numba.core.codegen import JITCodeLibrary, get_host_cpu_features
from numba.core.compiler import Compiler
from numba.core.compiler_machinery import PassManager, register_pass
from numba.core.dispatcher import Dispatcher
from numba.core.extending import _Intrinsic
from numba.core.registry import CPUDispatcher
from numba.core.typed_passes import NativeLowering

from worker.engine.kernels.cache import compiling

log = logging.getLogger("clearance.kernels")

Function = Callable[..., Any]

UNCALLABLE: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
"""Without the wrappers through which Python and C call a function."""


def is_compiled(value: object) -> bool:
    """Whether it is a function that numba compiles."""
    return isinstance(value, Dispatcher)


def python(function: Any) -> FunctionType:
    """The Python function that numba compiles, or that defines an intrinsic; anything else as it is."""
    function = function._defn if isinstance(function, _Intrinsic) else function
    return function.py_func if isinstance(function, Dispatcher) else function  # type: ignore[no-any-return]


def processor_features() -> list[str]:
    """The features of this processor that code is compiled for."""
    named: str = get_host_cpu_features()  # type: ignore[no-untyped-call]
    return sorted(feature[1:] for feature in named.split(",") if feature.startswith("+"))


# Functions that are inlined into compiled code.


class _Inlined(CPUDispatcher):
    """It has no wrapper for Python: a direct call would crash the process."""

    plain: Callable[[Any], Function]

    def __call__(self, *arguments: Any) -> Any:
        return self.plain(self)(*arguments)


def inlined(function: Function, plain: Callable[[Any], Function], **flags: Any) -> Any:
    """A function that is always inlined into compiled ones; a call from Python runs its `plain` form."""
    made: Any = njit(**flags | {"forceinline": True} | UNCALLABLE)(function)
    made.__class__ = _Inlined
    made.plain = plain
    return made


# Functions that are cached on disk. A cached one refers to its modules by name: after an update that moved one of them,
# it cannot be loaded, and is compiled again and replaced.


class _Sealed(IndexDataCacheFile):
    """The files of one function, each with its digest at its end and on the disk before it has its name: a file that is
    cut off or damaged, whose machine code could do anything, counts as missing."""

    @contextmanager
    def _open_for_write(self, path: str) -> Iterator[BytesIO]:
        written = BytesIO()
        yield written
        content = written.getvalue()
        temporary = Path(f"{path}.tmp.{uuid4().hex[:16]}")
        try:
            with temporary.open("wb") as file:
                file.write(content + sha256(content).digest())
                file.flush()
                os.fsync(file.fileno())
            temporary.replace(path)
        finally:
            temporary.unlink(missing_ok=True)

    def _load_index(self) -> dict[Any, str]:
        if not self._is_whole(self._index_path):
            return {}
        found: dict[Any, str] = super()._load_index()  # type: ignore[no-untyped-call]
        return found

    def _load_data(self, name: str) -> Any:
        path = self._data_path(name)  # type: ignore[no-untyped-call]
        if not self._is_whole(path):
            raise FileNotFoundError(path)  # which numba takes for one that was removed meanwhile
        return super()._load_data(name)  # type: ignore[no-untyped-call]

    @staticmethod
    def _is_whole(path: str) -> bool:
        try:
            content = Path(path).read_bytes()
        except OSError:
            return False
        return content[-32:] == sha256(content[:-32]).digest()


class _Cache(FunctionCache):
    """Numba's cache of one function; an entry that this version cannot load counts as missing, and a disk on which it
    cannot be stored prevents no evaluation."""

    def __init__(self, function: Function) -> None:
        super().__init__(function)  # type: ignore[no-untyped-call]
        self._cache_file.__class__ = _Sealed

    missed: Callable[[], None] | None = None
    """Called once if the next look-up finds nothing, so that a compilation begins."""

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        found = None
        with suppress(Exception):
            found = super().load_overload(sig, target_context)  # type: ignore[no-untyped-call]
        missed, self.missed = self.missed, None
        if found is None and missed is not None:
            missed()
        return found

    def save_overload(self, sig: Any, data: Any) -> None:
        try:
            super().save_overload(sig, data)  # type: ignore[no-untyped-call]
        except OSError as error:
            log.warning("a compiled function cannot be stored, and will be compiled again: %s", error)


class _Cached(CPUDispatcher):
    _cache: Any

    def compile(self, sig: Any) -> Any:
        with compiling(self.py_func) as self._cache.missed:
            return super().compile(sig)


def cached(function: Function, **flags: Any) -> Any:
    """A function that is compiled at its first call and cached on disk."""
    made: Any = njit(**flags)(function)
    made.__class__ = _Cached
    made._cache = _Cache(function)
    return made


def cached_callback(function: Function, signature: Any, **flags: Any) -> Any:
    """A C callback, compiled now and cached on disk; its `address` is valid for as long as the object exists."""
    made: Any = CFunc(function, (signature.args, signature.return_type), locals={}, options=flags)
    made._cache = _Cache(function)
    with compiling(function) as made._cache.missed:
        made.compile()
    return made


# Functions that only compiled code calls: their intermediate code becomes part of their caller's. numba optimises every
# function with all that it calls, and makes machine code of each; only the outermost needs either.


def linked(function: Function, **flags: Any) -> Any:
    """A function for compiled callers; a call from Python crashes the process. For functions without fast-math only,
    whose bits do not depend on when they are optimised."""
    return njit(**flags | {"pipeline_class": _Compiler} | UNCALLABLE)(function)


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
