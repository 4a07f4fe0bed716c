"""Which code a run uses: the modules of the engine that its system, stages, methods and components import.

A change to any of them may change a number, and a change to nothing else does: sentences (`campaigns.claims`),
verdicts, the audit and what runs processes are not reached.
"""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Iterable, Iterator
from functools import cache
from typing import NamedTuple

from campaigns import Campaign
from campaigns.checked.check import parts
from campaigns.identity.code import CLOSED_LOOP, SIMULATOR, code_of, component_key, model_of
from campaigns.identity.identity import PYTHON
from campaigns.stages.found import declared
from campaigns.stages.plan import plan
from campaigns.versions import Code, CodeParts, Versions
from worker.engine.problem.evaluate import InProcess
from worker.engine.problem.problem import Problem
from worker.engine.reference.reference import Reference
from worker.engine.stages.found import stages
from worker.engine.systems.closed_loop.system import ClosedLoop
from worker.engine.systems.simulators.called import Called
from worker.engine.systems.simulators.command import CommandSimulator
from worker.engine.systems.simulators.declared.fmu import DescribedFmu
from worker.engine.systems.simulators.declared.simulator import Simulator
from worker.engine.systems.simulators.fmus.simulator import FmuSimulator
from worker.engine.systems.simulators.functions import Isolated
from worker.running.catalogue import installed
from worker.running.catalogue.files import PythonFunction
from worker.running.runs import sources
from worker.running.runs.meaning import Meaning, meanings
from worker.running.runs.sources import within

ENGINE = "worker.engine"
WORDS = "campaigns.claims"
"""Makes sentences of numbers, never numbers."""


_SIMULATORS = (Called, CommandSimulator, Isolated, FmuSimulator)


class Used(NamedTuple):
    """Modules of ours and of guests, and the third-party packages that they import."""

    modules: frozenset[str]
    packages: frozenset[str]


def code(campaign: Campaign) -> Code:
    """The code of this installation that a run of the campaign uses; its digest is empty if a part is missing."""
    modules = used(campaign).modules
    known = loaded()
    return Code(code_of(campaign, code_parts()) or "", {name: known[name].digest for name in sorted(modules)})


def installation() -> Code:
    """All code that a run may use, for comparing what a run used with it."""
    found = {name: one.digest for name, one in sorted(loaded().items()) if not within(name, WORDS)}
    found = {name: digest for name, digest in found.items() if within(name, ENGINE) or not within(name, "worker")}
    found = {name: digest for name, digest in found.items() if not within(name, sources.OWN)}
    whole = "".join(f"{name}:{digest};" for name, digest in found.items())
    return Code(hashlib.sha256(whole.encode()).hexdigest(), found)


def packages(campaign: Campaign) -> dict[str, str]:
    """The versions of the packages that a run of the campaign uses."""
    reached = used(campaign)
    guests = {e.dist.name for name, _, e in _added() if e.dist is not None and name in reached.modules}
    simulator = None if campaign.simulator is None else installed.simulators().get(campaign.simulator.name)
    without = set() if isinstance(simulator, DescribedFmu) else {sources.FMPY}  # reached by every kind of simulator
    names = (reached.packages | guests) - without
    return {name: v for name, v in sources.LOADED.packages.items() if name in names}


def versions(campaign: Campaign) -> Versions:
    """The code and packages of this installation that a run of the campaign uses, as known without opening its
    system."""
    used = [installed.components().get((role, part.component)) for *_, role, part in parts(campaign)]
    return Versions(
        code=code(campaign).digest or None,
        model=model_of(campaign, code_parts()),
        python=platform.python_version(),
        packages=packages(campaign),
        components=sources.own(installed.own_modules(component for component in used if component is not None)),
    )


@cache
def code_parts() -> CodeParts:
    """The digests of this installation by part, and the versions of its packages."""
    return CodeParts(
        packages={PYTHON: platform.python_version()} | sources.LOADED.packages,
        systems={kind: _digest(roots) for kind, roots in _systems().items()},
        stages={kind: _digest(_of_stage(kind)) for kind in stages()},
        methods={name: _digest([installed.source_of(m).__name__]) for name, m in installed.methods().items()},
        components={
            component_key(role, name): _digest(_with_package(installed.source_of(component).__name__))
            for (role, name), component in installed.components().items()
        },
        simulators={
            name: digest for name, home in _guests().items() if (digest := _digest(_with_package(home)))
        },
    )  # fmt: skip


def used(campaign: Campaign) -> Used:
    """What a run of the campaign uses; parts that are not installed are left out."""
    roots = list(_systems()[CLOSED_LOOP if campaign.simulator is None else SIMULATOR])
    for kind in {stage.kind for stage in plan(campaign)} & stages().keys():
        roots += _of_stage(kind)
    for component in (installed.components().get((role, part.component)) for *_, role, part in parts(campaign)):
        roots += [] if component is None else _with_package(installed.source_of(component).__name__)
    for method in (installed.methods().get(search.method) for search in campaign.stages.search):
        roots += [] if method is None else _with_package(installed.source_of(method).__name__)
    if campaign.simulator is not None and campaign.simulator.name in _guests():
        roots += _with_package(_guests()[campaign.simulator.name])
    return closure(frozenset(roots))


def choosing(kind: str, method: str | None) -> frozenset[str]:
    """The modules that choose the points of a stage."""
    methods = [] if method is None else [installed.source_of(installed.methods()[method]).__name__]
    return closure(frozenset([*_of_stage(kind), *methods])).modules


@cache
def closure(roots: frozenset[str]) -> Used:
    """The loaded modules of these names and those that they import, directly or not; the operator's own left out."""
    found, others, waiting = set[str](), set[str](), [name for name in roots if name in loaded()]
    while waiting:
        name = waiting.pop()
        if name not in found:
            found.add(name)
            modules, packages = _reached(name)
            waiting += modules
            others |= packages
    return Used(frozenset(name for name in found if not within(name, sources.OWN)), frozenset(others))


@cache
def _reached(name: str) -> Used:
    """What one module imports directly."""
    modules, packages = set[str](), set[str]()
    for one in loaded()[name].imports:
        base = _absolute(name, one.module)
        homes = [home for home in _home(base, one.name) if not within(home, WORDS)]
        modules |= set(homes)
        packages |= set() if homes else {base.partition(".")[0]}
    return Used(frozenset(modules), frozenset(packages))


def _home(base: str, name: str) -> Iterator[str]:
    """The module that an imported name comes from: behind the door of a package, that in which it is defined."""
    known = loaded()
    if name and f"{base}.{name}" in known:
        yield f"{base}.{name}"
    elif base in known:
        behind = [one for one in known[base].imports if one.here == name] if name and _is_package(base) else []
        for one in behind:
            yield from _home(_absolute(base, one.module), one.name)
        if not behind:
            yield base


def _absolute(name: str, module: str) -> str:
    """The whole name of a module that is imported in the module `name`."""
    level = len(module) - len(module.lstrip("."))
    if not level:
        return module
    package = name.split(".") if _is_package(name) else name.split(".")[:-1]
    return ".".join([*package[: len(package) - level + 1], *filter(None, [module[level:]])])


def _digest(roots: Iterable[str]) -> str:
    """The digest of the closure of these modules; empty if no module is known."""
    known, modules = loaded(), sorted(closure(frozenset(roots)).modules)
    whole = "".join(f"{name}:{known[name].digest};" for name in modules)
    return hashlib.sha256(whole.encode()).hexdigest() if whole else ""


@cache
def _systems() -> dict[str, list[str]]:
    """The modules that evaluate, by the kind of system."""
    return {
        CLOSED_LOOP: [each.__module__ for each in (Problem, InProcess, ClosedLoop, Reference)],
        SIMULATOR: [each.__module__ for each in (Problem, InProcess, *_SIMULATORS)],
    }


def _of_stage(kind: str) -> list[str]:
    return [stages()[kind].run.__module__, declared()[kind].planned.__module__, plan.__module__]


@cache
def _guests() -> dict[str, str]:
    """The modules of simulators that other packages add, by the simulators' names."""
    return {
        name: installed.source_of(simulator).__name__
        for name, simulator in installed.simulators().items()
        if isinstance(simulator, Simulator) or (isinstance(simulator, PythonFunction) and "module" in simulator.place)
    }


def _with_package(home: str) -> list[str]:
    """A module, with the whole package if another one's: it may load any part of itself."""
    places = [name for name, _, _ in _added() if within(home, name)]
    return [home, *(name for name in (loaded() if places else ()) if any(within(name, place) for place in places))]


_added = cache(sources.added_places)


@cache
def loaded() -> dict[str, Meaning]:
    """The meaning of every module as this process loaded it."""
    return meanings(sources.LOADED.files)


@cache
def _is_package(name: str) -> bool:
    return any(other.startswith(f"{name}.") for other in loaded())
