"""The identity of a run: what could have changed a number of it, as digests, and the differences between two.

`identity_of` makes it of the versions stored with a run, `installed` of what workers publish; whatever compares runs
with each other, or a run with an installation, compares identities.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from pydantic import ConfigDict, computed_field

from campaigns.asked.spec import Campaign
from campaigns.catalogue import Catalogue
from campaigns.documented import Documented
from campaigns.identity.code import OBJECTIVES, code_of, model_of
from campaigns.versions import CodeParts, Versions, differing, short

ENGINE, LOOP, PYTHON = "engine", "compiled loop", "Python"
COMPONENTS, SIMULATORS = "components", "simulators"
"""Where own files are: `components/my_robot.py`, `simulators/pendulum`."""

UNREAD = "unidentified-"
"""How the digest of a function begins that uses something that cannot be read exactly."""


def unread(digest: str) -> str:
    """The digest of a function of which this is what could be read."""
    return f"{UNREAD}{digest}"


def is_read(digest: str | None) -> bool:
    """Whether the digest of a simulator identifies it."""
    return bool(digest) and not str(digest).startswith(UNREAD)


MOST = 3
"""Modules named in a clause."""


class Identity(Documented):
    """What could have changed a number of a run, as digests in hexadecimal digits."""

    model_config = ConfigDict(frozen=True)
    engine: str | None = None
    """Of the engine and the parts of it that the campaign uses; null if an earlier version did not store it."""
    evaluating: str | None = None
    """Of the part of the engine that evaluates a case, without stages and search methods; null if not stored."""
    loop: str | None = None
    """Of the compiled closed loop: every function and constant in it; null for a simulator, or if not stored."""
    files: dict[str, str] = {}
    """Of each own file that the run used, without comments and docstrings, and of its simulator:
    `components/my_robot.py`, `simulators/pendulum`."""
    packages: dict[str, str] = {}
    """The version of Python, and of each package that can change a number."""
    machine: str = ""
    """The kind of machine: system, and what the compiler made code for. Costs of other kinds agree within 1e-9."""
    unidentified: tuple[str, ...] = ()
    """What was not stored or cannot be read exactly: nothing rules out that it has changed."""

    @computed_field  # type: ignore[prop-decorator]
    @property
    def digest(self) -> str | None:
        """The digest of engine, loop, own files and packages; null unless all of them are identified."""
        if self.unidentified:
            return None
        named = {ENGINE: self.engine, LOOP: self.loop or "", **self.files, **self.packages}
        return hashlib.sha256("".join(f"{name}:{named[name]};" for name in sorted(named)).encode()).hexdigest()

    @property
    def digests(self) -> dict[str, str]:
        """The digests of the engine and of each own file, by name."""
        return ({ENGINE: self.engine} if self.engine else {}) | self.files

    @property
    def text(self) -> str:
        """The digests in one line, shortened."""
        whole = f"sha256 {short(self.digest)}" if self.digest else f"not identified ({', '.join(self.unidentified)})"
        return f"{whole}: {', '.join(f'{name} {short(digest)}' for name, digest in self.digests.items())}".rstrip(": ")


UNSTORED = Identity(unidentified=(ENGINE,))
"""Of a run that has not begun, or of which nothing was stored."""


@dataclass(frozen=True)
class Change:
    """Something that two identities have differently: digests, or versions; empty where only the other one has it."""

    name: str
    before: str
    after: str
    modules: tuple[str, ...] = ()
    """The modules of the engine that differ, if known."""

    @property
    def text(self) -> str:
        """A clause."""
        if self.name in (ENGINE, LOOP):
            what = "code" if self.name == ENGINE else "loop"
            return f"the {what} digest was {short(self.before)}, here it is {short(self.after)}{_named(self.modules)}"
        if self.name.startswith((f"{COMPONENTS}/", f"{SIMULATORS}/")):
            return f"{self.name} {'is new' if not self.before else 'has changed' if self.after else 'is gone'}"
        return f"{self.name} was {self.before}, here it is {self.after}"

    @property
    def names(self) -> tuple[str, ...]:
        """The files that differ: the modules, if known, else the name."""
        return self.modules or (self.name,)


def identity_of(versions: Versions, simulator: str) -> Identity:
    """The identity of a run with these versions; simulator: the name of the one that it evaluates, or empty."""
    files = {f"{COMPONENTS}/{name}": digest for name, digest in versions.components.items()}
    missing = [] if versions.code else [ENGINE]
    if simulator:
        if is_read(versions.simulator):
            files[f"{SIMULATORS}/{simulator}"] = versions.simulator or ""
        else:
            missing.append(f"{SIMULATORS}/{simulator}")
    cpu = None if versions.cpu is None else versions.cpu.target or versions.cpu.model
    return Identity(
        engine=versions.code,
        evaluating=versions.model,
        loop=versions.loop,
        files=dict(sorted(files.items())),
        packages=({PYTHON: versions.python} if versions.python else {}) | versions.packages,
        machine=", ".join(filter(None, [versions.system, cpu, versions.evaluator])),
        unidentified=tuple(missing),
    )


def installed(campaign: Campaign, catalogue: Catalogue, then: Identity) -> Identity:
    """The identity that a run of the campaign would have now, as far as workers publish it.

    then: that of an earlier run, for what is not published: which own files and packages the campaign uses, and the
    compiled loop, which follows from them. An own file that is not installed is not in it.
    """
    code: CodeParts | None = catalogue.code
    own = {f"{COMPONENTS}/{name}": digest for name, digest in catalogue.own.items()}
    simulator = simulator_of(campaign)
    now = identity_of(
        Versions(
            code=code_of(campaign, code),
            model=model_of(campaign, code),
            loop=then.loop,
            simulator=catalogue.digests.get(simulator),
        ),
        simulator,
    )
    files = now.files | {name: own[name] for name in then.files if name in own}
    published = {} if code is None else code.packages
    packages = {name: published.get(name, version) for name, version in then.packages.items()}
    return now.model_copy(update={"files": dict(sorted(files.items())), "packages": packages, "machine": then.machine})


def simulator_of(campaign: Campaign | Mapping[str, object]) -> str:
    """The name of the simulator of a campaign, or of its document; empty if it has none."""
    if isinstance(campaign, Campaign):
        return "" if campaign.simulator is None else campaign.simulator.name
    stated = campaign.get("simulator")
    return str(stated.get("name") or "") if isinstance(stated, Mapping) else ""


def changes(then: Identity, now: Identity, modules: Sequence[str] = ()) -> list[Change]:
    """What is known to differ; what either did not store is not compared, nor is the machine.

    modules: those of the engine that differ, if known.
    """
    found = list(_changes(then, now, modules))
    if not found and then.loop and now.loop and then.loop != now.loop:  # else it follows from what has changed
        found.append(Change(LOOP, then.loop, now.loop))
    return found


def _changes(then: Identity, now: Identity, modules: Sequence[str]) -> Iterator[Change]:
    if then.engine and now.engine and then.engine != now.engine:
        yield Change(ENGINE, then.engine, now.engine, tuple(modules))
    unread = {*then.unidentified, *now.unidentified}
    for name in differing(then.files, now.files):
        # Without the engine's digest those of own components were not stored either.
        if name not in unread and (ENGINE not in unread or name.startswith(f"{SIMULATORS}/")):
            yield Change(name, then.files.get(name, ""), now.files.get(name, ""))
    for name, version in then.packages.items():
        if now.packages.get(name, version) != version:
            yield Change(name, version, now.packages[name])


def differences(then: Identity, now: Identity, modules: Sequence[str] = ()) -> list[str]:
    """Why numbers of one may differ from those of the other, as clauses; an engine that was not stored is not compared,
    and anything else that is not identified may have changed."""
    unread = dict.fromkeys(name for name in then.unidentified + now.unidentified if name != ENGINE)
    return [change.text for change in changes(then, now, modules)] + [f"{name} is not identified" for name in unread]


def same(then: Identity, now: Identity) -> bool:
    """Whether both are identified and nothing differs."""
    return not (then.unidentified or now.unidentified or changes(then, now))


def unsound(then: Identity, now: Identity) -> list[str]:
    """Why evaluations of one may differ from those of the other, as clauses; empty if they cannot.

    Stages and search methods may be others: they choose points, and evaluate none.
    """
    same_engine = {"engine": None, "unidentified": tuple(name for name in then.unidentified if name != ENGINE)}
    found = differences(then.model_copy(update=same_engine), now)
    if then.evaluating is None:
        return [*found, "what evaluated them was not stored"]
    return found if then.evaluating == now.evaluating else [*found, "the code that evaluates has changed"]


def may_equal(then: Identity, now: Identity) -> bool:
    """Whether both may have evaluated the same model: False only if a file of it is known to differ.

    Other packages make no other model, nor do other stages and search methods.
    """
    others = {change.name for change in changes(then, now)} - {LOOP, *then.packages}
    model, here = ((of.evaluating or "").partition(OBJECTIVES)[0] for of in (then, now))
    return not (others - {ENGINE} if model and model == here else others)


def _named(modules: Sequence[str]) -> str:
    if not modules:
        return ""
    rest = len(modules) - MOST
    return f" (modules: {', '.join(modules[:MOST])}{f' and {rest} more' if rest > 0 else ''})"
