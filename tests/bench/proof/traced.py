"""The program of a closed loop over rows, recorded from the text that flies: its plain Python form run on `Row`s.

Every number of the state, the held guidance and the uncertain parameters is a `Row`; all else stays a float and folds.
The kernels that decide (`a if c else b`) are called in the forms of `FORMS`; any other decision raises.
"""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np

from worker.engine.kernels import maths
from worker.engine.kernels.bind import plain
from worker.engine.physics import autopilot, fields

LIN1, LIN2, MUL, SQUARE, RECIP, ROOT, SINCOS, ANGLE, TURN, ABS, MAX, LIMIT, CHOOSE, FREEZE, WRAP, FIRAS, BORN = range(
    17
)
BEARING = (LIMIT, CHOOSE, ANGLE, FIRAS)
"""Operations whose remainder becomes a symbol, so that what follows can cancel it."""


class Tape:
    """Operations in order: (code, out, a, b, c, second out) with values and constants (p, q, k)."""

    def __init__(self) -> None:
        self.ops: list[tuple[int, int, int, int, int, int]] = []
        self.constants: list[tuple[float, float, float]] = []
        self.count = 0
        self.known: dict[Any, Any] = {}
        self.limited = set[Any]()

    def new(self) -> Row:
        self.count += 1
        return Row(self, self.count - 1)

    def op(self, code: int, a: Row, b: Row | None = None, c: Row | None = None, p=0.0, q=0.0, k=0.0, pair=False) -> Any:  # type: ignore[no-untyped-def]
        at = tuple(-1 if r is None else r.at for r in (a, b, c))
        key = (code, at, p, q, k)
        if key not in self.known:
            out = self.new()
            second = self.new() if pair else None
            self.ops.append((code, out.at, *at, -1 if second is None else second.at))
            self.constants.append((p, q, k))
            self.known[key] = (out, second) if pair else out
        return self.known[key]


class Condition:
    """c > 0 of one row."""

    def __init__(self, row: Row) -> None:
        self.row = row


class Row:
    """A number that is not known: an index into the table of rows."""

    def __init__(self, tape: Tape, at: int) -> None:
        self.tape, self.at = tape, at

    def linear(self, p: float, k: float) -> Row:
        return self if p == 1.0 and k == 0.0 else self.tape.op(LIN1, self, p=p, k=k)

    def __add__(self, other: Any) -> Any:
        if isinstance(other, Row):
            return self.tape.op(LIN2, self, other, p=1.0, q=1.0)
        return self.linear(1.0, float(other))

    __radd__ = __add__

    def __sub__(self, other: Any) -> Any:
        if isinstance(other, Row):
            return self.tape.op(LIN2, self, other, p=1.0, q=-1.0)
        return self.linear(1.0, -float(other))

    def __rsub__(self, other: Any) -> Any:
        return self.linear(-1.0, float(other))

    def __neg__(self) -> Any:
        return self.linear(-1.0, 0.0)

    def __mul__(self, other: Any) -> Any:
        if isinstance(other, Row):
            return self.tape.op(SQUARE, self) if other.at == self.at else self.tape.op(MUL, self, other)
        return 0.0 if other == 0.0 else self.linear(float(other), 0.0)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Any:
        return self * other.tape.op(RECIP, other) if isinstance(other, Row) else self.linear(1.0 / float(other), 0.0)

    def __rtruediv__(self, other: Any) -> Any:
        return self.tape.op(RECIP, self) * float(other)

    def __abs__(self) -> Any:
        return self.tape.op(ABS, self)

    def __gt__(self, other: Any) -> Condition:
        return Condition(self - other)

    def __lt__(self, other: Any) -> Condition:
        return Condition(other - self)

    def __bool__(self) -> bool:
        raise TypeError("a decision about a number that is not known, outside the kernels of FORMS")


def row(tape: Tape, x: Any) -> Row:
    """x as a row: a float is the constant 0 x + k of any row."""
    return x if isinstance(x, Row) else tape.op(LIN1, Row(tape, 0), p=0.0, k=float(x))


def choose(c: Any, x: Any, y: Any) -> Any:
    """`x if c else y`."""
    if not isinstance(c, Condition):
        return x if c else y
    tape = c.row.tape
    return tape.op(CHOOSE, c.row, row(tape, x), row(tape, y))


def _sincos(x: Row) -> Any:
    return x.tape.op(SINCOS, x, pair=True)


def _atan2(y: Any, x: Any, code: int = ANGLE) -> Any:
    tape = y.tape if isinstance(y, Row) else x.tape
    return tape.op(code, row(tape, x), row(tape, y))


def _clip(x: Row, low: float, high: float) -> Row:
    if (x.at, low, high) in x.tape.limited:
        return x
    limited: Row = x.tape.op(LIMIT, x, p=low, q=high)
    x.tape.limited.add((limited.at, low, high))
    return limited


def _wrap(x: Row) -> Any:
    return x.tape.op(WRAP, x)


def _root(x: Any) -> Any:
    return x.tape.op(ROOT, x) if isinstance(x, Row) else math.sqrt(x)


def _firas(gap: Row, k: float, d_0: float) -> Any:
    return k * gap.tape.op(FIRAS, gap, p=d_0)


def _attraction(distance: Any, k: float, s: float) -> Any:
    return choose(distance > s, k * s / (distance + 1e-300), k) if s < 1e8 else k  # no flight is that far from a goal


def _relative(gap: Any, closing: Any, eta: float, rho_0: float, a: float, floor: float) -> Any:
    left = gap - 0.5 * closing * closing / a
    held = left.tape.op(MAX, left, row(left.tape, floor))
    near = left.tape.op(MAX, gap, row(left.tape, floor))
    g = eta / (held * held)

    def active(x: Any) -> Any:
        return choose(closing > 0.0, choose(left < rho_0, x, 0.0), 0.0)

    return active(-g * (1.0 + closing / a)), active(g * closing / a / near)


def _saturated(wanted: Row, low: float, high: float, rate: Any, push: Any) -> Any:
    return _clip(wanted, low, high), wanted.tape.op(FREEZE, wanted, push, rate, p=low, q=high)


def _referred(x: Any, demand: Any, per_demand: float, p: Any) -> Any:
    level = _root(demand[0] * demand[0] + demand[1] * demand[1])
    norm = _root(demand[0] * demand[0] + demand[1] * demand[1] + demand[2] * demand[2])
    climb = _clip(_atan2(-demand[2], level), -p.gamma_max, p.gamma_max)
    heading = _atan2(demand[1], demand[0], TURN)  # whole turns are free: `turn`, its one reader, wraps the difference
    return _clip(per_demand * norm, p.u_min, p.u_max), climb, choose(level > autopilot.STILL, heading, x[5])


FORMS: dict[Any, Any] = {
    maths.sincos: _sincos,
    maths.atan2: _atan2,
    maths.clip: _clip,
    maths.wrap: _wrap,
    fields.firas: _firas,
    fields.attraction: _attraction,
    fields.relative: _relative,
    autopilot.saturated: _saturated,
    autopilot.referred: _referred,
}
"""The kernels that decide or approximate, as operations on rows."""


def _known(kernel: Any, form: Any) -> Any:
    """The kernel as it is where all that it reads is known, else its form on rows."""
    as_is = plain(kernel)

    def called(*arguments: Any) -> Any:
        flat = [x for a in arguments for x in (a if isinstance(a, tuple) else (a,))]
        return (form if any(isinstance(x, Row) for x in flat) else as_is)(*arguments)

    return called


INSTEAD = {kernel: _known(kernel, form) for kernel, form in FORMS.items()} | {math: SimpleNamespace(sqrt=_root)}


ON_ROWS: dict[str, Any] = {kernel.__name__: INSTEAD[kernel] for kernel in FORMS} | {"sqrt": _root}
"""The same by name."""


def part(loop: Any, name: str) -> Any:
    """A function of the loop's generated text, on rows."""
    return plain(loop.kernel(name), INSTEAD)


def program(
    tape: Tape, inputs: int, outputs: list[Any], bearing: bool = False, all_: bool = False
) -> tuple[Any, Any, list[int], int, int]:
    """The operations that the outputs need, with temporary rows used again: codes, constants, where the outputs are,
    the numbers of rows and of symbols born; the first `inputs` rows and the outputs keep their place until the end."""
    outputs = [row(tape, x) for x in outputs]
    needed, kept = {x.at for x in outputs}, list[int]()
    for i in reversed(range(len(tape.ops))):
        op = tape.ops[i]
        if op[1] in needed or op[5] in needed:
            kept.append(i)
            needed |= {r for r in op[2:5] if r >= 0}
    kept.reverse()
    last = {r: i for i in kept for r in (*tape.ops[i][1:],) if r >= 0}
    ends = {x.at for x in outputs}
    place, free, count = {r: r for r in range(inputs)}, list[int](), inputs
    codes, constants, births = [], [], 0
    for i in kept:
        code, out, a, b, c, second = tape.ops[i]
        new = [code]
        for r in (out, second):
            if r >= 0:
                if not free:
                    free.append(count)
                    count += 1
                place[r] = free.pop()
        new += [place[r] if r >= 0 else -1 for r in (out, a, b, c, second)]
        for r in {a, b, c, out, second} - {-1}:
            if last[r] == i and r >= inputs and r not in ends:
                free.append(place[r])
        codes.append(new)
        constants.append(tape.constants[i])
        if bearing and (code in BEARING or (all_ and out in ends and code == MUL)):
            codes.append([BORN, place[out], births, -1, -1, -1])
            constants.append((0.0, 0.0, 0.0))
            births += 1
    return (
        np.array(codes, dtype=np.int64).reshape(-1, 6),
        np.array(constants, dtype=float).reshape(-1, 3),
        [place[x.at] for x in outputs],
        count,
        births,
    )
