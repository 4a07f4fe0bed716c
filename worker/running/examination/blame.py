"""An exception as one sentence with the line of the component's file that it comes from."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from traceback import walk_tb
from types import TracebackType
from typing import Any

from worker.running.examination.mistake import Mistake, listed, meant

_UNEXPECTED = re.compile(r"(\w+)(?:\.__init__|\.__new__)?\(\) got an unexpected keyword argument '(\w+)'")
_MISSING = re.compile(
    r"(\w+)(?:\.__init__|\.__new__)?\(\) missing \d+ required (?:positional|keyword-only) arguments?: (.*)"
)
_TOO_MANY = re.compile(
    r"(\w+)(?:\.__init__|\.__new__)?\(\) takes (?:from \d+ to )?(\d+) positional arguments? but (\d+)"
)
_UNPACK = re.compile(r"(?:not enough values to unpack|too many values to unpack) \((expected.*)\)")


def mistake(error: BaseException, file: Path, doing: str) -> Mistake:
    """The exception as a mistake at the innermost line of the file; doing: such as "while importing it"."""
    line, innermost = _line(error.__traceback__, file)
    text = _sentence(error, innermost)
    what, colon, then = text.partition(": ")
    if not doing or " " not in what:  # the type of any other exception, and its message
        return Mistake(f"{text} ({doing})" if doing else text, line)
    return Mistake(f"{what} ({doing}){colon}{then}", line)


def _line(trace: TracebackType | None, file: Path) -> tuple[int, bool]:
    """The innermost line in the file, 0 if there is none, and whether the exception was raised there."""
    line, innermost, own = 0, False, str(file)
    for frame, number in walk_tb(trace):
        innermost = frame.f_code.co_filename == own
        line = number if innermost else line
    return line, innermost


def _sentence(error: BaseException, innermost: bool) -> str:
    text = " ".join(str(error).split())[:300].rstrip(".")
    if isinstance(error, SystemExit):
        return f"it calls sys.exit({error.code!r:.40}): remove the call"
    if isinstance(error, ImportError):
        return _imported(error, text)
    if isinstance(error, NameError) and error.name:
        return f"{error.name} is not defined: define or import it"
    if isinstance(error, AttributeError):
        return _attribute(error, text)
    if isinstance(error, ZeroDivisionError):
        return "a division by zero: keep the divisor away from zero, for example by the limits of the parameter"
    if isinstance(error, IndexError):
        return f"an index beyond the end ({text}): the tuple has fewer elements"
    if isinstance(error, ValueError) and "math domain" in text:
        return "a root or logarithm of a negative number: keep the argument within its domain"
    if isinstance(error, ValueError) and (found := _UNPACK.search(text)):
        return f"a tuple of another length is unpacked ({found[1]}): name as many as there are"
    if isinstance(error, TypeError):
        return _called(text)
    if isinstance(error, RecursionError):
        return "endless recursion: let the function that calls itself return"
    return f"{type(error).__name__}: {text or 'without a message'}"


def _imported(error: ImportError, text: str) -> str:
    module, name = error.name or "", str(getattr(error, "name_from", None) or "")
    if isinstance(error, ModuleNotFoundError):
        return f"module {module!r} does not exist: {_near_module(module)}"
    names = [n for n in vars(sys.modules.get(module, sys)) if not n.startswith("_")] if module in sys.modules else []
    name = name or (found[1] if (found := re.search(r"cannot import name '(\w+)'", text)) else "")
    if name and names:
        return f"{module} has no {name!r}: {meant(name, names, 'correct the name')}"
    return text


def _near_module(module: str) -> str:
    """Advice for a module that does not exist: a close one that is loaded, or one in the folder."""
    from worker.engine.components.own import folders

    if module.isidentifier() and any((folder / f"{module}.py").is_file() for folder in folders()):
        return f"a file of the same folder is imported with a point, from .{module} import ..."
    known = {name for name in sys.modules if not name.startswith("_") and "." in name}
    ours = [name for name in known if name.startswith("worker.")] + ["numpy", "math", "typing", "worker"]
    return meant(module, ours, "correct the name, or install the package")


def _attribute(error: AttributeError, text: str) -> str:
    names = [n for n in dir(error.obj) if not n.startswith("_")] if error.obj is not None else []
    if error.name and names:
        fields: Any = getattr(type(error.obj), "_fields", None)
        owner = error.obj.__name__ if hasattr(error.obj, "__name__") else type(error.obj).__name__
        return f"{owner} has no {error.name!r}: {meant(error.name, fields or names)[:200]}"
    return text


def _called(text: str) -> str:
    if found := _UNEXPECTED.search(text):
        return f"{found[1]} has no field {found[2]!r}: {_field(found[1], found[2])}"
    if found := _MISSING.search(text):
        names = re.findall(r"'(\w+)'", found[2])
        return f"{found[1]}(...) lacks {listed(names)}: give {'it' if len(names) == 1 else 'them'}"
    if found := _TOO_MANY.search(text):
        return f"{found[1]} takes {found[2]} arguments and was given {found[3]}: give as many as it takes"
    if "'list'" in text or "'NoneType'" in text or "unsupported operand" in text or "not subscriptable" in text:
        return f"a value of the wrong type ({text}): kernels compute with floats and tuples"
    return f"TypeError: {text}"


def _field(kind: str, name: str) -> str:
    from worker.engine.kernels import component

    fields = getattr(getattr(component, kind, None), "__dataclass_fields__", None)
    return meant(name, fields) if fields else "correct the name"
