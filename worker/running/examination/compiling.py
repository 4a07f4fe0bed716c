"""Compiles the kernels of a component one by one for the types that they were simulated with: `compile_each`."""

from __future__ import annotations

import sys
import warnings
from types import FunctionType
from typing import Any

import numba
from numba.core.errors import NumbaError

from worker.engine.kernels.numba_internals import is_compiled
from worker.engine.kernels.reduced import reduced
from worker.running.examination.flying import Calls
from worker.running.examination.mistake import Mistake
from worker.running.examination.reading import Source


def compile_each(source: Source, module: str, calls: Calls) -> None:
    """Raises `Mistake` for the first kernel that cannot be compiled; helpers come before those that call them."""
    dispatchers: list[Any] = [v for v in vars(sys.modules[module]).values() if is_compiled(v)]
    own = {d.py_func.__code__: d for d in dispatchers if isinstance(d.py_func, FunctionType)}
    for code in sorted(calls, key=lambda code: code.co_firstlineno):
        kernel = own.get(code)
        if kernel is None:
            continue
        types = tuple(_typeof(_floats(value)) for value in calls[code][0])
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                kernel.compile(types)
        except NumbaError as error:
            found = reduced(error, lambda file: file == str(source.file))
            raise Mistake(found.text, found.line or code.co_firstlineno) from None
        except Exception as error:
            text = " ".join(str(error).split())[:200].rstrip(".")
            raise Mistake(
                f"{code.co_name} cannot be compiled ({type(error).__name__}: {text}): kernels compute with numbers and "
                "tuples only",
                code.co_firstlineno,
            ) from None


_typeof: Any = numba.typeof


def _floats(value: Any) -> Any:
    """Whole numbers as floats: the loop stores everything as floats."""
    if isinstance(value, bool):
        return value
    if isinstance(value, int | float):
        return float(value)
    if isinstance(value, tuple):
        inner = [_floats(each) for each in value]
        return type(value)(*inner) if hasattr(value, "_fields") else tuple(inner)
    return value
