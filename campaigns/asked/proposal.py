"""Search methods and budgets that fit the time one evaluation takes: how many evaluations, and by which methods.

The rules follow from the tables of `make search-bench`; docs/methods.md shows them.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterable
from dataclasses import dataclass, field, replace

from campaigns.catalogue import MethodEntry

MANY = 1000
"""Evaluations per parameter: no more are proposed, unless this is below the usual number."""
CHEAP = 0.02
"""Time of an evaluation [s] below which it is not stated to a method: its own milliseconds count then."""
USUAL = 10_000
"""The largest number of evaluations that is proposed where there are few parameters."""

BUSY = 16
"""Slots that count: `auto` gives no further member a turn while so many points are pending (its `PENDING`, which a test
compares). On 32 and 64 slots a search took 0.5 to 1.5 times as long as counted so."""
WAITING = 4
"""Slots up to which a search takes as long as its evaluations, within 7 %. On more, members of `auto` wait for each
other: on 8 it took 1.2 times as long, on 16 up to 1.9 times."""
NOTABLE = 0.1
"""Fraction of the time of a call above which a sentence names that of starting a process."""

LONGEST = "The time with all evaluations is that {}."
ALONE, RETRIED = "of one evaluation after the other", "with every retry"


@dataclass(frozen=True)
class Budget:
    """One search as a campaign states it."""

    method: str
    evaluations: int
    options: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Proposal:
    """Searches, the time that they take in all [s], at least that on some numbers of slots (see `taking`), and the
    sentence that says why these; without searches: why none.

    note: further information on them, the end of the sentence. The other stages of a run, such as certify and validate,
    take evaluations in addition.
    """

    searches: tuple[Budget, ...]
    seconds: float
    sentence: str
    note: str = ""


@dataclass(frozen=True)
class Cost:
    """What one call of a simulator took [s], with `slots` of them side by side.

    start: what the start of a process adds to a call in it [s], 0 if that was not measured; recycle: the calls after
    which a process is replaced, 0 for never (with 1 the time of a call includes the start); noisy: results do not
    repeat.
    run: the name of the run whose first stage measured it; None if `clearance check-simulator` did, on the machine
    `host`; at: when [s since 1970], if known; evaluations: of the measurement, of which `failed` failed.
    """

    run: str | None
    seconds: float
    slots: int
    evaluations: int
    failed: int = 0
    at: float | None = None
    host: str = ""
    start: float = 0.0
    recycle: int = 0
    noisy: bool = False

    @property
    def source(self) -> str:
        """The source of the time: R-0012, or the command with its machine and time."""
        if self.run is not None:
            return self.run
        on = f" on {self.host}" if self.host else ""
        when = "" if self.at is None else time.strftime(", %Y-%m-%d %H:%M UTC", time.gmtime(self.at))
        return f"clearance check-simulator{on}{when}"

    def sentence(self, calls: int = 1) -> str:
        """One evaluation took 0.42 s (R-0012, 15 evaluations)."""
        failed = f", of which {self.failed} failed" if self.failed else ""
        what = "evaluation" if calls == 1 else "call"
        text = f"One {what} took {lasting(self.seconds)} ({self.source}, {self.evaluations} evaluations{failed})"
        text += f" and the start of a process {lasting(self.start)}" if self.start > NOTABLE * self.seconds else ""
        if calls == 1:
            return text
        return f"{text}; an evaluation of {calls} calls takes about {lasting(self.of(calls)[0])}"

    def of(self, calls: int) -> tuple[float, int]:
        """Time of an evaluation of several calls [s], with the replacement of processes, and how many evaluations run
        side by side."""
        turns, at_once = self._turns(calls)
        return (self.seconds + (self.start / self.recycle if self.recycle else 0.0)) * turns, at_once

    def again(self, evaluations: int, calls: int = 1) -> float:
        """Time of so many evaluations of which each call has a fresh process [s]."""
        turns, at_once = self._turns(calls)
        return math.ceil(evaluations / busy(at_once)) * (self.seconds + self.start) * turns

    def bounds(self, least: int, most: int, calls: int = 1, retries: int = 0) -> tuple[float, float]:
        """Time that between `least` and `most` evaluations take at this speed [s]: those with all slots busy, these one
        after the other, each call in a fresh process and tried again `retries` times. A search may request one point at
        a time. No run is bound to this speed: a call that times out takes longer."""
        each, at_once = self.of(calls)
        alone = (self.seconds + self.start) * self._turns(calls)[0] * (1 + retries)
        return self.start + math.ceil(least / at_once) * each, self.start + most * alone

    def _turns(self, calls: int) -> tuple[int, int]:
        """How many calls of an evaluation follow each other in a slot, and how many evaluations run side by side."""
        at_once = max(self.slots // calls, 1)
        return math.ceil(calls * at_once / self.slots), at_once

    def lasts(self, evaluations: int, calls: int = 1, again: int = 0, retries: int = 0) -> tuple[float, str]:
        """Time of so many evaluations on the slots of the measurement [s], without retries, and where it is known from.

        again: evaluations in fresh processes that confirm results, in addition; retries: how often a call may be tried
        again, which only the time with all evaluations counts (`bounds`).
        """
        each, at_once = self.of(calls)
        seconds = self.start + math.ceil(evaluations / busy(at_once)) * each + self.again(again, calls)
        more = f"; {again:,} more{self.fresh} confirm results" if again else ""
        ways = [ALONE] * (at_once > 1) + [RETRIED] * (retries > 0)
        longest = f" {LONGEST.format(', '.join(ways))}" if ways else ""
        return seconds, f"{self.sentence(calls)}, on {self._on}{_counted(at_once)}{more}.{longest}"

    @property
    def fresh(self) -> str:
        """The clause on fresh processes for evaluations made again; empty if no start of a process was measured."""
        return ", each in a fresh process," if self.start else ""

    @property
    def _on(self) -> str:
        return "1 slot" if self.slots == 1 else f"{self.slots} slots"

    def proposed(self, methods: Iterable[MethodEntry], parameters: int, patience: float, calls: int = 1) -> Proposal:
        """What to search with within `patience` [s] on its slots; raises ValueError as `proposed` does."""
        if calls < 1:
            raise ValueError(f"invalid number of calls {calls}: give at least 1")
        seconds, at_once = self.of(calls)
        methods = list(methods)
        found = proposed(methods, seconds, parameters, at_once, patience, self.start)
        if not found.searches:
            return found
        room = _two(math.floor((patience - self.start) / seconds) * busy(at_once))
        [search] = found.searches
        name = next(method.title for method in methods if method.name == search.method)
        most = "at most about" if _waits(at_once) else "about"
        text = f"In {lasting(patience)} on {self._on}{_counted(at_once)}: {most} {room} evaluations. Proposed: {name} "
        text += f"with {search.evaluations:,}, {taking(found.seconds, at_once)} in all{found.note}"
        return replace(found, sentence=text)


def proposed(
    methods: Iterable[MethodEntry],
    cost: float,
    parameters: int,
    slots: int = 1,
    patience: float = 3600.0,
    start: float = 0.0,
) -> Proposal:
    """Which of the methods to search with, and how long.

    cost: time of an evaluation [s], of which `slots` run side by side, `BUSY` at most in the result; patience: time for
    all searches [s]; start: until the slots are ready, once [s]. Raises ValueError for a value that is not possible.
    """
    _possible(cost, parameters, slots, patience, start)
    methods = list(methods)
    chosen = next(iter(ranked(methods)), None)
    if chosen is None:
        return Proposal((), 0.0, "No installed method states when it is proposed: start a worker of this version")
    rounds = int(min((patience - start) / cost, 1e12))
    if rounds <= 0:
        first = f" and the start of its process {lasting(start)}" if start > NOTABLE * cost else ""
        text = f"One evaluation takes about {lasting(cost)}{first}, longer than the {lasting(patience)} that are "
        return Proposal((), 0.0, text + "available: allow more time")
    at_once = busy(slots)
    own = min(rounds, max(max(USUAL, MANY * parameters) // at_once, 1))
    count, seconds = own * at_once, start + own * cost
    needed = chosen.confirms * parameters
    note = ""
    if count < needed:
        long = taking(start + math.ceil(needed / at_once) * cost, slots)
        note = f"; it may be too few for a verdict of cleared: below {needed:,} evaluations ({long}) "
        note += "its parts need not count as searches"
    places = f" on {slots} slots{_counted(slots)}" if slots > 1 else ""
    taken = "1 evaluation takes" if count == 1 else f"{count:,} evaluations take"
    known = f"One evaluation takes about {lasting(cost)}"
    text = f"{known}: {taken} {taking(seconds, slots)}{places}; use {chosen.title}{note}"
    return Proposal((Budget(chosen.name, count, _options(chosen, cost, slots)),), seconds, text, note)


def taking(seconds: float, slots: int) -> str:
    """The time of a search with so many evaluations side by side: about 20 min, or at least that where members wait."""
    return f"{'at least' if _waits(slots) else 'about'} {lasting(seconds)}"


def busy(slots: int) -> int:
    """How many of the slots count, in every time that is stated."""
    return min(slots, BUSY)


def _waits(slots: int) -> bool:
    return WAITING < slots <= BUSY


def _counted(slots: int) -> str:
    return f" (counted as {BUSY} evaluations side by side)" if slots > BUSY else ""


def ranked(methods: Iterable[MethodEntry]) -> list[MethodEntry]:
    """The methods that are proposed, the preferred ones first."""
    return sorted((m for m in methods if m.proposed), key=lambda m: m.proposed)


def _options(method: MethodEntry, cost: float, slots: int) -> dict[str, float]:
    """What a method has options for: how many evaluations run side by side, within its limit, and what one takes."""
    stated: dict[str, float] = {}
    if method.at_once and slots > 1:
        stated[method.at_once] = min(slots, method.options["properties"][method.at_once].get("maximum", slots))
    if method.takes and cost >= CHEAP:
        stated[method.takes] = float(f"{cost:.2g}")
    return stated


def _possible(cost: float, parameters: int, slots: int, patience: float, start: float) -> None:
    for name, value, unit in (("cost", cost, " [s]"), ("patience", patience, " [s]")):
        if not (math.isfinite(value) and value > 0):
            raise ValueError(f"invalid {name} {value:g}: give a finite time above 0{unit}")
    if not (math.isfinite(start) and start >= 0):
        raise ValueError(f"invalid start {start:g}: give a finite time of at least 0 [s]")
    for name, count in (("parameters", parameters), ("slots", slots)):
        if count < 1:
            raise ValueError(f"invalid number of {name} {count}: give at least 1")


def lasting(seconds: float) -> str:
    """A length of time in two significant digits, for an estimate: 12 s, 20 min, 2.5 h, 3 days."""
    for limit, unit, size in ((1e-3, "µs", 1e-6), (1.0, "ms", 1e-3), (100.0, "s", 1.0), (6000.0, "min", 60.0)):
        if seconds < limit:
            return f"{_two(seconds / size)} {unit}"
    return f"{_two(seconds / 3600)} h" if seconds < 172800 else f"{_two(seconds / 86400)} days"


def _two(value: float) -> str:
    return f"{float(f'{value:.2g}'):,.10g}"
