"""All that Clearance uses of numba's insides, which another version may rename: the minor version is pinned, and
`tests/unit/engine/kernels/test_numba_internals.py` says which name moved. Other modules import only what numba
documents.

Start reading at `inlined`, `cached`, `linked`.
"""

from __future__ import annotations

import logging
import os
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import partial
from hashlib import sha256
from io import BytesIO
from pathlib import Path
from types import FunctionType
from typing import Any, NamedTuple
from uuid import uuid4

from numba import config, njit, types
from numba._dynfunc import make_function
from numba.core.caching import CompileResultCacheImpl, FunctionCache, IndexDataCacheFile, _CacheLocator
from numba.core.ccallback import CFunc
from numba.core.codegen import JITCodeLibrary, get_host_cpu_features
from numba.core.compiler import Compiler
from numba.core.compiler_machinery import PassManager, register_pass
from numba.core.dispatcher import Dispatcher
from numba.core.extending import _Intrinsic
from numba.core.registry import CPUDispatcher
from numba.core.typed_passes import NativeLowering
from numba.core.typing.templates import builtin_registry

from worker.engine.kernels.cache import compiling

log = logging.getLogger("clearance.kernels")

Function = Callable[..., Any]

SOURCE = sha256(Path(__file__).read_bytes()).hexdigest()
"""Identifies how functions are compiled here."""

UNCALLABLE: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
"""Without the wrappers through which Python and C call a function."""

FLAGS: dict[str, Any] = {"fastmath": {"contract", "reassoc", "arcp", "nsz"}, "error_model": "numpy"}
"""Of kernels: reordering and fused operations are allowed. nnan and ninf are not: a NaN marks a failed simulation."""


def is_compiled(value: object) -> bool:
    """Whether it is a function that numba compiles."""
    return isinstance(value, Dispatcher)


def python(function: Any) -> Any:
    """The Python function that numba compiles, or that defines an intrinsic; anything else as it is."""
    function = function._defn if isinstance(function, _Intrinsic) else function
    return function.py_func if isinstance(function, Dispatcher) else function


def options(function: Any) -> str:
    """How a function that numba compiles is compiled."""
    made = function._compiler
    return f"{by_options(made.targetoptions)}{by_options(made.locals)}{made.pipeline_class.__qualname__}"


def by_options(options: Mapping[str, Any]) -> str:
    """Options of a compiled function as text; that of a set does not depend on the process."""
    return str(sorted((k, sorted(map(str, v)) if isinstance(v, (set, frozenset)) else v) for k, v in options.items()))


def extensions(known: Callable[[str], bool]) -> Iterator[tuple[FunctionType, Any, str]]:
    """The functions that tell numba how to compile others, which need not refer to them: `overload` and its kin, but
    those of known modules; each with what it is for, and its options."""
    for template in (*builtin_registry.functions, *builtin_registry.attributes):
        function: Any = getattr(template, "_overload_func", None)
        if function is not None and not known(function.__globals__.get("__name__", "")):
            yield function, getattr(template, "key", None), by_options(getattr(template, "_jit_options", {}))


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


class Stamp(NamedTuple):
    """64 hexadecimal digits, and the first thing that could not be read by value; empty if everything was."""

    digest: str
    unknown: str


Stamping = Callable[[Function, str, Mapping[str, Any]], Stamp]
"""What identifies the machine code of a function, made of it in some way with some flags."""


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


class _Place(_CacheLocator):
    """One folder for the functions of every copy of the package: what a function is decides, not where its text is."""

    def __init__(self, stamp: str) -> None:
        self._stamp, self._py_file = stamp, ""

    def get_cache_path(self) -> str:
        return str(Path(config.CACHE_DIR) / "compiled")  # type: ignore[attr-defined]

    def get_source_stamp(self) -> str:
        return self._stamp

    def get_disambiguator(self) -> str:
        return self._stamp[:32]


class _Placed(CompileResultCacheImpl):
    def __init__(self, function: Any, stamp: str) -> None:
        self._lineno, self._locator = function.__code__.co_firstlineno, _Place(stamp)
        name: str = function.__qualname__.rpartition(".")[2][:100]
        self._filename_base = self.get_filename_base(name, getattr(sys, "abiflags", ""))  # type: ignore[no-untyped-call]


class _Cache(FunctionCache):
    """Numba's cache of one function, by what it is; an entry that this version cannot load counts as missing, and a
    disk on which it cannot be stored prevents no evaluation."""

    _impl_class: Any

    def __init__(self, function: Any, kind: str, flags: Mapping[str, Any], stamp: Stamping) -> None:
        found = stamp(function, kind, flags)
        self._impl_class = partial(_Placed, stamp=found.digest)
        super().__init__(function)  # type: ignore[no-untyped-call]
        self._cache_file.__class__ = _Sealed
        if found.unknown:
            log.warning(
                "%s is not stored but compiled by every process, since it uses what cannot be told by value: %s",
                function.__qualname__, found.unknown,
            )  # fmt: skip
            self.disable()  # type: ignore[no-untyped-call]

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

    def _index_key(self, sig: Any, codegen: Any) -> Any:
        """Numba compares named tuples by their class and the types of their fields, not by the order of these."""
        return sig, _fields(getattr(sig, "args", sig)), codegen.magic_tuple()

    def save_overload(self, sig: Any, data: Any) -> None:
        try:
            super().save_overload(sig, data)  # type: ignore[no-untyped-call]
        except OSError as error:
            log.warning("a compiled function cannot be stored, and will be compiled again: %s", error)


def _fields(of: Any) -> str:
    """The names of the fields of all named tuples among types."""
    tuples: list[Any] = [each for each in of if isinstance(each, types.BaseTuple)]
    return str([(getattr(each, "fields", ()), _fields(tuple(each))) for each in tuples])


class _Cached(CPUDispatcher):
    _cache: Any
    stamp: Stamping | None = None
    """None in another process to which numba sent the function: it is compiled there, and not stored."""

    def compile(self, sig: Any) -> Any:
        if self.stamp is None:
            return super().compile(sig)
        with compiling(self.py_func) as missed:
            if not isinstance(self._cache, _Cache):  # now, when all is defined that it refers to
                self._cache = _Cache(self.py_func, "function", self.targetoptions, self.stamp)
            self._cache.missed = missed
            return super().compile(sig)


def cached(function: Function, stamp: Stamping, **flags: Any) -> Any:
    """A function that is compiled at its first call and cached on disk."""
    made: Any = njit(**flags)(function)
    made.__class__ = _Cached
    made.stamp = stamp
    return made


def cached_callback(function: Function, signature: Any, stamp: Stamping, **flags: Any) -> Any:
    """A C callback, compiled now and cached on disk; its `address` is valid for as long as the object exists."""
    made: Any = CFunc(function, (signature.args, signature.return_type), locals={}, options=flags)
    with compiling(function) as missed:
        made._cache = _Cache(function, f"callback {signature}", flags, stamp)
        made._cache.missed = missed
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
