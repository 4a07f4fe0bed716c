"""How claims describe a simulator: the kinds of ours, and what a package states of its own.

A package may define `scope`, `words`, `caveat`, `shows` and `bars` of its simulator; what it does not define is usual.
"""

from __future__ import annotations

from typing import Any, Literal

from campaigns.claims.say import say
from campaigns.claims.spans import Spans
from campaigns.claims.terms import Condition, Scope, Words
from worker.engine.systems.base import System
from worker.engine.systems.simulators.command import CommandSimulator
from worker.engine.systems.simulators.fmus.simulator import FmuSimulator
from worker.engine.systems.simulators.functions import InProcess, Isolated
from worker.engine.systems.simulators.simulated import FRESH, Simulated
from worker.evidence.scopes.base import Terms

OF_FOLDER = "of the files of its folder"
"""What the digest of a program or an FMU is of: not what these load from elsewhere."""
LONGEST = 160
"""Characters of a command line in a sentence."""
UNCHECKED = "Whether an encounter takes place was not checked."
OWN = frozenset({"scope", "words", "caveat", "shows", "bars"})
"""What a package may state of its own simulator."""


def terms(system: System, calls: int = 1) -> Terms:
    """The terms of a simulator, of which an evaluation is so many calls."""
    stepped = _stepped(system)
    if not OWN.intersection(dir(system)):
        caveat = _caveat(system, calls)
        return Terms(_scope(system), _words(system), caveat, function=_function(system), stepped=stepped)
    kind = type(system)
    if not isinstance(system, _Usual):  # a base, so that `super()` of its own terms finds the usual ones
        system.__class__ = type(kind.__name__, (kind, _Usual), {"__module__": kind.__module__})
    own: Any = system
    return Terms(own.scope, own.words, own.caveat, own.shows, tuple(own.bars()), stepped=stepped)


def _function(system: Any) -> Literal["", "in_process", "isolated"]:
    if isinstance(system, InProcess):
        return "in_process"
    return "isolated" if isinstance(system, Isolated) else ""


def _scope(system: Any) -> Scope:
    if not isinstance(system, Simulated):
        return Scope(say(f"simulator {type(system).__name__}"), (), f"simulator digest {system.digest[:12]}")
    title, name = system.entry.title, system.entry.name
    if isinstance(system, (InProcess, Isolated)):
        return function_scope(title, name, system.digest, system.unread)
    if isinstance(system, CommandSimulator) and system.campaign_command:
        return simulator_scope(title, name, system.digest, system.campaign_command, system.described.covers)
    settings = ""
    if isinstance(system, FmuSimulator):
        d = system.described
        settings = (
            f"FMI {d.model.version} co-simulation from {d.model.start:g} s to {d.stop:g} s,"
            f" communication step {d.step:g} s, {system.reuse}"
        )
    return simulator_scope(title, name, system.digest, settings=settings)


def function_scope(title: str, name: str, digest: str, unknown: str = "") -> Scope:
    """The scope of a Python function; unknown: what of its code could not be read."""
    version = f"no digest, its code is not identified: {unknown}" if unknown else f"function digest {digest[:12]}"
    return Scope(say(f"{title}, Python function {name}"), (), version)


def simulator_scope(
    title: str, name: str, digest: str, command: str = "", covers: str = OF_FOLDER, settings: str = ""
) -> Scope:
    """The scope of any other simulator; command: the line that the campaign file gives; covers: what the digest is of,
    empty in results of earlier versions."""
    what, version = f"{title}, simulator {name}", f"simulator digest {digest[:12]} {covers}".rstrip()
    if command:
        line = " ".join(command.split())
        shown = line if len(line) <= LONGEST else f"{line[: LONGEST - 3]}..."
        what += f", run by a command that the campaign file gives, {shown}"
    return Scope(say(what), say(settings), version)


def _stepped(system: Any) -> bool:
    return isinstance(system, Simulated) and system.step is not None


def _words(system: Any) -> Words:
    return words_of(_stepped(system))


def words_of(halved: bool) -> Words:
    """The words for evaluations; halved: cases are confirmed at half the step, too."""
    return Words(
        one="case",
        agree=f"{FRESH} and one at half the step agree" if halved else f"{FRESH} agrees",
        disagrees=f"{FRESH} or one at half the step disagrees" if halved else f"{FRESH} disagrees",
        every="all evaluations" if halved else "both evaluations",
        again=f"evaluated again, each in {FRESH}{' and at half the step' if halved else ''}",
        reference=FRESH,
        check="repetition",
    )


def _caveat(system: Any, calls: int = 1) -> str:
    if not isinstance(system, Simulated):
        return ""
    if isinstance(system, InProcess):
        return function_caveat(system.unread or (None if system.from_files else ""))
    every = system.described.step if isinstance(system, FmuSimulator) else None
    unread = system.unread if isinstance(system, Isolated) else ""
    return simulator_caveat(_stepped(system), every, unread, calls)


def function_caveat(unread: str | None) -> str:
    """The caveat of a function in the same process; unread: code that could not be read, None if its files are
    known."""
    covered = _unread(unread or "")
    if unread == "":
        covered = " The digest covers the function and what it uses, installed packages by version only."
    return f"Cases were evaluated again by the same function in the same process only. {UNCHECKED}{covered}"


def simulator_caveat(stepped: bool, every: float | None = None, unread: str = "", calls: int = 1) -> str:
    """The caveat of any other simulator; every: the time between two readings of the variables of an FMU [s]; unread:
    what of the code of a function could not be read; calls: of an evaluation, several of which are not made at half the
    step."""
    halved, again = stepped and calls == 1, "Cases were evaluated again by the same simulator only"
    if stepped and not halved:
        again += ", not at half its step"
    between = f", at half the step every {every / 2:g} s" if halved and every is not None else ""
    read = "" if every is None else f" Its variables are read every {every:g} s{between}, and not in between."
    return f"{again}{', also at half its step' if halved else ''}. {UNCHECKED}{_unread(unread)}{read}"


def _unread(unread: str) -> str:
    return unread and f" The code of the function is not identified, because {unread} cannot be read exactly."


class _Usual:
    """The usual terms, which those of a package may extend by `super()`."""

    shows: tuple[Condition, ...] = ()
    scope, words, caveat = property(_scope), property(_words), property(_caveat)

    def bars(self) -> list[tuple[str, Spans]]:
        return []
