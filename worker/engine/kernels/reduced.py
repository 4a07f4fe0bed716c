"""Reduces the compiler's error to the line of a component's file and one sentence."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import NamedTuple

ANSI = re.compile(r"\x1b\[[0-9;]*m")
PLACES = re.compile(r'File "([^"]+)", line (\d+)|(?:at|defined at) (/[^\n]*?\.py) \((\d+)\)')
_NOISE = re.compile(
    r"^(Failed in |During: |- |\[\d+\]|There are \d+ candidate|Enable |This error |Overload |File |def |<source |>>>|"
    r"Invalid use of|Known signatures|\*|with argument|Of which|raised from|--|#|\^|Try|$)"
)


class Reduced(NamedTuple):
    """Where it is, line 0 if that is not known, and what is wrong there."""

    file: str
    line: int
    text: str


def reduced(error: BaseException, ours: Callable[[str], bool]) -> Reduced:
    """The innermost place in a file that is one of `ours`, and the cause in one sentence."""
    text = ANSI.sub("", str(error))
    places = [(a or c, int(b or d)) for a, b, c, d in PLACES.findall(text)]
    location = getattr(error, "loc", None)
    if location is not None:
        places.append((str(location.filename), int(location.line)))
    file, line = next(((f, n) for f, n in places if ours(f)), ("", 0))
    return Reduced(file, line, sentence(text))


def sentence(text: str) -> str:
    """The cause that a message of numba gives, in the words of components."""
    for pattern, words in _KNOWN:
        found = pattern.search(text)
        if found:
            return words(found)
    lines = (line.strip() for line in text.splitlines())
    first = next((line for line in lines if line and not _NOISE.match(line)), "")
    return f"the compiler refuses this: {first[:200].rstrip('.:') or 'it gives no reason'}"


def _name(text: str) -> str:
    """`scipy.special.gamma` of <built-in function gamma>, <ufunc 'clip'>, <function f at 0x7f...>."""
    found = re.search(r"(?:function|ufunc|class|type) '?([\w.]+)", text)
    return found[1] if found else text.strip("<>' ")


_KNOWN: list[tuple[re.Pattern[str], Callable[[re.Match[str]], str]]] = [
    (
        re.compile(r"Untyped global name '(\w+)'[^\n]*\n?[^\n]*(?:function|closure)"),
        lambda m: f"{m[1]} is a plain function, and kernels call kernels only: decorate it with @kernel",
    ),
    (
        re.compile(r"Untyped global name '(\w+)'"),
        lambda m: f"{m[1]} is neither a number, a tuple nor a kernel: kernels use nothing else",
    ),
    (re.compile(r"NameError: name '(\w+)' is not defined"), lambda m: f"{m[1]} is not defined: define or import it"),
    (
        re.compile(r"Unknown attribute '(\w+)' of type Module\(<module '([\w.]+)'"),
        lambda m: f"{m[2]}.{m[1]} cannot be compiled: use functions of worker.engine.kernels.maths, or others of math",
    ),
    (
        re.compile(r"Unknown attribute '(\w+)' of type (\w+)"),
        lambda m: f"there is no {m[1]!r} of a {m[2]}: correct the name",
    ),
    (
        re.compile(r"Cannot unify ([^\n]+?) and ([^\n]+?) for '"),
        lambda m: f"the branches have different types ({_type(m[1])} and {_type(m[2])}): give every branch the same",
    ),
    (
        re.compile(r"Can't unify return type from the following types: ([^\n]+)"),
        lambda m: f"the branches return different types ({_type(m[1])}): return the same in each",
    ),
    (
        re.compile(r"No implementation of function Function\(([^\n]+?)\) found for signature"),
        lambda m: (
            f"{_name(m[1])} cannot be called with these values in a kernel: use functions of "
            "worker.engine.kernels.maths and math on numbers"
        ),
    ),
    (
        re.compile(r"Use of unsupported NumPy function '([\w.]+)'"),
        lambda m: f"{m[1]} cannot be compiled: use functions of worker.engine.kernels.maths and math on numbers",
    ),
    (
        re.compile(r"Cannot determine Numba type of <class '([\w.]+)'>"),
        lambda m: f"a {m[1].rpartition('.')[2]} is used, and kernels compute with numbers and tuples only",
    ),
    (
        re.compile(r"cannot be represented as a (?:Numba|numba) type"),
        lambda m: "a value that is neither a number nor a tuple is used: kernels use nothing else",
    ),
    (
        re.compile(r"variable '?([\w.]+)'? (?:is )?not in scope|variable '([\w.]+)' referenced before assignment"),
        lambda m: f"{m[1] or m[2]} has no value in one of the branches: assign it before",
    ),
    (
        re.compile(r"tuple index out of range|tuple getitem index out of range|out of range"),
        lambda m: "an index beyond the end of a tuple: the tuple has fewer elements",
    ),
    (
        re.compile(r"not enough arguments: expected (\d+), got (\d+)|too many arguments: expected (\d+), got (\d+)"),
        lambda m: f"a kernel is called with {m[2] or m[4]} arguments, expected {m[1] or m[3]}: give as many",
    ),
    (re.compile(r"missing a required argument: '(\w+)'"), lambda m: f"a call lacks the argument {m[1]}: give it"),
]


def _type(kind: str) -> str:
    """float64 as "number", UniTuple(float64 x 2) as "tuple of 2"."""
    kind = re.sub(r"UniTuple\((\w+),? x (\d+)\)", r"tuple of \2", kind)
    kind = re.sub(r"Tuple\(([^()]*)\)", lambda m: f"tuple of {len([p for p in m[1].split(',') if p.strip()])}", kind)
    kind = re.sub(r"\b(?:Literal\[int\]\(-?\d+\)|int64|float64)\b", "number", kind)
    return kind.strip(" '")[:120]
