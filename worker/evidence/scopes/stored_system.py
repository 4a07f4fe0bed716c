"""A stored run's system, as its catalogue describes it: what claims name of it, without anything that evaluates.

`systems` are all that the record may have had; of a package with terms of its own none gives its words.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from functools import partial
from typing import NoReturn

import numpy as np

from campaigns import Campaign, Catalogue
from campaigns.asked.criteria import named
from campaigns.checked.check import parameters, seeded
from campaigns.versions import Versions
from worker.engine.systems.base import Parameter, Realised, Result, System
from worker.engine.systems.simulators.fmus.simulator import SHARES
from worker.evidence.scopes import closed_loop, simulators
from worker.evidence.scopes.base import Terms

INTEGRATOR = "DOP853"
"""The reference integrator of closed loops."""
_UNKNOWN = re.compile(r"no digest, its code is not identified: (.+)\.$")
_COVERS = re.compile(r"simulator digest [0-9a-f]{12} (of its description in the campaign file[^;]*)\.$")
_FMU = re.compile(
    r"; (FMI \d\S* co-simulation from \S+ s to \S+ s, communication step (\S+) s,"
    rf" (?:{'|'.join(SHARES.values())})(?: \(.+\))?)\. This"
)


class Recorded(System):
    """It has parameters, results and terms; it evaluates nothing."""

    def __init__(self, campaign: Campaign, catalogue: Catalogue, terms: Terms) -> None:
        known = parameters(campaign, catalogue)
        self.parameters = tuple(
            Parameter(path, entry.unit, value, entry.low, entry.high, entry.text, entry.symbol)
            for path, (entry, value) in known.items()
        )
        self.nominal = np.array([value for _, value in known.values()])
        self.results, self.terms = _results(campaign, catalogue), terms
        if campaign.scenario is not None:
            stated = campaign.scenario.realisations
            self.realisations = Realised(tuple(stated.seeds), stated.combine, bool(seeded(campaign, catalogue)))
        elif campaign.simulator is not None and (entry := catalogue.simulator(campaign.simulator.name)) is not None:
            self.realisations = Realised(undeclared=entry.seeds)

    @property
    def digest(self) -> str:
        return ""

    def _never(self, *_: object, **__: object) -> NoReturn:
        raise TypeError("a recorded system evaluates nothing")

    evaluate = confirm = _never


def systems(campaign: Campaign, catalogue: Catalogue, versions: Versions, scope: str) -> Iterator[Recorded]:
    """The systems that a record may describe; scope: as it has it, which names what is in neither of the others."""
    if campaign.simulator is None:
        found: Sequence[Terms] = [closed_loop.described(campaign, catalogue, INTEGRATOR)]
    else:
        found = [*_simulators(campaign, catalogue, versions, scope)]
    return (Recorded(campaign, catalogue, terms) for terms in found)


def _simulators(campaign: Campaign, catalogue: Catalogue, versions: Versions, scope: str) -> Iterator[Terms]:
    assert campaign.simulator is not None
    entry, calls = catalogue.simulator(campaign.simulator.name), campaign.simulator.calls
    if entry is None:
        return
    name, digest, stepped = (entry.title, entry.name), versions.simulator or "", entry.step is not None
    words, caveat_of = simulators.words_of(stepped), partial(simulators.simulator_caveat, stepped, calls=calls)
    unknown, covers, fmu = (pattern.search(scope) for pattern in (_UNKNOWN, _COVERS, _FMU))
    if unknown is not None:
        of_function = simulators.function_scope(*name, "", unknown[1])
        yield Terms(of_function, words, simulators.function_caveat(unknown[1]), function="in_process")
        yield Terms(of_function, words, caveat_of(unread=unknown[1]), function="isolated")
    function, again = simulators.function_scope(*name, digest), caveat_of()
    for caveat in map(simulators.function_caveat, (None, "")):
        yield Terms(function, words, caveat, function="in_process")
    yield Terms(function, words, again, function="isolated")
    if versions.command and covers is not None:
        yield Terms(
            simulators.simulator_scope(*name, digest, versions.command, covers[1]), words, again, stepped=stepped
        )
    for of_folder in (simulators.OF_FOLDER, ""):  # earlier versions did not state it
        yield Terms(simulators.simulator_scope(*name, digest, covers=of_folder), words, again, stepped=stepped)
        if fmu is not None:
            settings = simulators.simulator_scope(*name, digest, covers=of_folder, settings=fmu[1])
            yield Terms(settings, words, caveat_of(every=float(fmu[2])), stepped=stepped)


def _results(campaign: Campaign, catalogue: Catalogue) -> tuple[Result, ...]:
    if campaign.simulator is not None:
        entry = catalogue.simulator(campaign.simulator.name)
        decides = None if entry is None else entry.result(campaign.criterion.result)
        if decides is None:
            raise KeyError(campaign.criterion.result)
        return (Result(decides.name, decides.title, decides.quantity, decides.unit, decides.worse),)
    criteria = [campaign.criterion.component, *(objective.component for objective in campaign.objectives)]
    entries = [catalogue.component("criterion", name or "") for name in criteria]
    known = [entry for entry in entries if entry is not None]
    names = named(entry.name for entry in known)
    return tuple(Result(n, e.title, e.quantity, e.unit, e.worse or "low") for n, e in zip(names, known, strict=True))
