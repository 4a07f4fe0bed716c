"""How claims describe a simulator: the kinds of ours, and what a package states of its own.

A package may define `scope`, `words`, `caveat`, `shows` and `bars` of its simulator; what it does not define is usual.
"""

from __future__ import annotations

from typing import Any

from campaigns.claims.say import say
from campaigns.claims.spans import Spans
from campaigns.claims.terms import Condition, Scope, Words
from worker.engine.systems.base import System
from worker.engine.systems.simulators.command import CommandSimulator
from worker.engine.systems.simulators.fmus.simulator import FmuSimulator
from worker.engine.systems.simulators.functions import InProcess, Isolated
from worker.engine.systems.simulators.simulated import FRESH, Simulated
from worker.evidence.scopes.base import Terms

LONGEST = 160
"""Characters of a command line in a sentence."""
OWN = frozenset({"scope", "words", "caveat", "shows", "bars"})
"""What a package may state of its own simulator."""


class _Usual:
    """The usual terms, which those of a package may extend by `super()`."""

    shows: tuple[Condition, ...] = ()

    @property
    def scope(self) -> Scope:
        return _scope(self)

    @property
    def words(self) -> Words:
        return _words(self)

    @property
    def caveat(self) -> str:
        return _caveat(self)

    def bars(self) -> list[tuple[str, Spans]]:
        return []


def terms(system: System) -> Terms:
    """The terms of a simulator."""
    if not OWN.intersection(dir(system)):
        return Terms(_scope(system), _words(system), _caveat(system))
    kind = type(system)
    if not isinstance(system, _Usual):  # a base, so that `super()` of its own terms finds the usual ones
        system.__class__ = type(kind.__name__, (kind, _Usual), {"__module__": kind.__module__})
    own: Any = system
    return Terms(own.scope, own.words, own.caveat, own.shows, tuple(own.bars()))


def _scope(system: Any) -> Scope:
    if not isinstance(system, Simulated):
        return Scope(say(f"simulator {type(system).__name__}"), (), f"simulator digest {system.digest[:12]}")
    title, name, version = system.entry.title, system.entry.name, f"digest {system.digest[:12]}"
    if isinstance(system, (InProcess, Isolated)):
        if system.unread:
            version = f"no digest, its code is not identified: {system.unread}"
            return Scope(say(f"{title}, Python function {name}"), (), version)
        return Scope(say(f"{title}, Python function {name}"), (), f"function {version}")
    what, settings, version = f"{title}, simulator {name}", "", f"simulator {version}"
    if isinstance(system, CommandSimulator) and system.given:
        line = " ".join(system.given.split())
        shown = line if len(line) <= LONGEST else f"{line[: LONGEST - 3]}..."
        what += f", run by a command that the campaign file gives, {shown}"
        version += f" {system.described.covers}"
    if isinstance(system, FmuSimulator):
        d = system.described
        settings = (
            f"FMI {d.model.version} co-simulation from {d.model.start:g} s to {d.stop:g} s,"
            f" communication step {d.step:g} s, {system.reuse}"
        )
    return Scope(say(what), say(settings), version)


def _words(system: Any) -> Words:
    halved = isinstance(system, Simulated) and system.step is not None
    return Words(
        one="case",
        agree=f"{FRESH} and one at half the step agree" if halved else f"{FRESH} agrees",
        disagrees=f"{FRESH} or one at half the step disagrees" if halved else f"{FRESH} disagrees",
        every="all evaluations" if halved else "both evaluations",
        again=f"evaluated again, each in {FRESH}{' and at half the step' if halved else ''}",
        reference=FRESH,
        check="repetition",
    )


UNCHECKED = "Whether an encounter takes place was not checked."


def _caveat(system: Any) -> str:
    if not isinstance(system, Simulated):
        return ""
    unread = _unread(system) if isinstance(system, (InProcess, Isolated)) else ""
    if isinstance(system, InProcess):
        again = "Cases were evaluated again by the same function in the same process only."
        return f"{again} {UNCHECKED}{_covered(system) or unread}"
    halved = "" if system.step is None else ", also at half its step"
    again = f"Cases were evaluated again by the same simulator only{halved}. {UNCHECKED}{unread}"
    if isinstance(system, FmuSimulator):
        return f"{again} Its variables are read every {system.described.step:g} s, and not in between."
    return again


def _covered(function: InProcess) -> str:
    """What the digest of a function covers, if it is not that of its files."""
    if function.from_files or function.unread:
        return ""
    return " The digest covers the function and what it uses, installed packages by version only."


def _unread(function: InProcess | Isolated) -> str:
    if not function.unread:
        return ""
    return f" The code of the function is not identified, because {function.unread} cannot be read exactly."
