"""The versions behind a run: code, compiled loop, packages, machine.

They cover everything outside the campaign that can change a number. They are stored when the first stage of a run
begins; other versions can neither resume nor extend that run. `campaigns.identity` compares them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import ConfigDict

from campaigns.documented import UNLESS_EMPTY, UNLESS_NONE, Documented

SHORT = 12
"""Digits of a digest in a message."""


@dataclass(frozen=True)
class Code:
    """The code of an installation that can change a number of a run, without comments and docstrings."""

    digest: str
    """SHA-256 over the digests of the modules, 64 hexadecimal digits."""
    modules: dict[str, str]
    """The digest of each module by its name."""


class OtherCode(ValueError):
    """The run was begun by other code, packages or components; the message states the differences as clauses."""


class CodeParts(Documented):
    """The digests of an installation's code by part, each with everything that it imports, without documentation."""

    model_config = ConfigDict(frozen=True)
    systems: dict[str, str]
    """By kind: see `campaigns.identity.code`."""
    stages: dict[str, str]
    methods: dict[str, str]
    components: dict[str, str]
    """By role and name: "vehicle unicycle"."""
    simulators: dict[str, str] = {}
    """Of other packages, by name."""
    packages: Annotated[dict[str, str], UNLESS_EMPTY] = {}
    """The versions of Python and of third-party packages that can change a number; not published by earlier
    versions."""


class Processor(Documented):
    """The processor, and the features of it that the compiler used."""

    model_config = ConfigDict(frozen=True)
    model: str = ""
    target: str = ""
    features: str = ""


class Versions(Documented):
    """The versions behind a run, as loaded when its first stage began; None or empty: not stored by earlier
    versions."""

    model_config = ConfigDict(frozen=True)
    code: str | None = None
    """Digest of the engine and of the parts of it that the campaign uses; see `campaigns.identity.code`."""
    model: Annotated[str | None, UNLESS_NONE] = None
    """The same without stages and search methods: what evaluates a case. None: not stored by earlier versions."""
    loop: str | None = None
    """Digest of the compiled closed loop: every function and constant in it, by value."""
    packages: dict[str, str] = {}
    """Version of each package that can change a number."""
    clearance: str | None = None
    wording: Annotated[int | None, UNLESS_NONE] = None
    """Which templates made its sentences, see `campaigns.claims.wording.WORDING`;
    None: not stored by earlier versions."""
    python: str | None = None
    system: str | None = None
    cpu: Processor | None = None
    lanes: int | None = None
    """Simulations that one call of the loop runs in lockstep."""
    components: Annotated[dict[str, str], UNLESS_EMPTY] = {}
    """Digest of the file of each of the operator's own components in the run, without comments and docstrings."""
    simulator: Annotated[str | None, UNLESS_NONE] = None
    """Digest of the simulator, in place of the loop's: everything of it that could change a number."""
    evaluator: Annotated[str | None, UNLESS_NONE] = None
    """What evaluated the simulator on other machines, of which the processors are not recorded."""
    command: Annotated[str | None, UNLESS_NONE] = None
    """The command line of the simulator, if the campaign file gave it instead of the installation."""
    step: float | None = None
    """[s]"""
    integrator: str | None = None

    @staticmethod
    def of(document: Any) -> Versions:
        """The versions from a stored document; fields missing in earlier versions stay empty."""
        known = document if isinstance(document, dict) else {}
        cpu = known.get("cpu")
        return Versions.model_validate({**known, "cpu": cpu if isinstance(cpu, dict) else None})


OTHER_POINTS = "its method requests other points than where it was begun"
"""How a worker says why it leaves a run to others, whose code does not differ; what differs follows."""

NOT_INSTALLED = "is not in this installation"
"""What is said of a component, method or simulator that a worker does not have."""

UNDIGESTED = (
    "it was begun by a version of Clearance that stored no digests of its code: nothing shows which code computed its "
    "first results, nor that later ones are of the same"
)
"""What the provenance of such a run states."""


def undigested(flown: Any, begun: bool) -> str | None:
    """The sentence if no digest was stored when a run began; flown: its document of versions, begun: whether it has."""
    return UNDIGESTED if begun and Versions.of(flown).code is None else None


def other_code(run: str, clauses: list[str]) -> str:
    """The message that refuses to resume a run."""
    return (
        f"{run} was begun by other code: {'; '.join(clauses)}. One run must not mix the results of two: "
        "start the campaign again as a new run"
    )


def differing(then: dict[str, str], now: dict[str, str]) -> list[str]:
    """The modules that only one has, or that are not the same in both, in order."""
    return sorted(name for name in {**then, **now} if then.get(name) != now.get(name))


def short(digest: str) -> str:
    """The first digits of a digest, enough to distinguish it by eye."""
    return digest[:SHORT]
