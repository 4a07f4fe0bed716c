"""The catalogue as data: which components, methods and simulators an installation has, with units, bounds and text.

The worker publishes it to the database; the API, the launch form and `campaigns.checked.check` read nothing else.
"""

from __future__ import annotations

import hashlib
from typing import Annotated, Literal

from pydantic import BeforeValidator, ConfigDict

from campaigns.documented import UNSTATED, Documented
from campaigns.documents import JsonObject
from campaigns.effort import Descents, Iterations
from campaigns.looks import MethodLook, ObstacleLook, VehicleLook, readable
from campaigns.versions import CodeParts

Kind = Literal["component", "method", "simulator"]
"""What another package or the operator may add."""

Role = Literal["vehicle", "controller", "avoider", "obstacle", "environment", "fault", "criterion"]


class Entry(Documented):
    model_config = ConfigDict(extra="forbid", frozen=True)


class ParameterEntry(Entry):
    """A number a component takes: its name in the campaign, symbol, unit, own limits, default and one line of text."""

    name: str
    symbol: str
    unit: str
    low: float
    high: float
    default: float | None
    """None: required in the campaign."""
    text: str


class ReachEntry(Entry):
    """The largest distance of an obstacle's surface from its centre.

    `times` the root of the sum of squares of the parameters that it is `of`.
    """

    of: list[str]
    times: float

    def __str__(self) -> str:
        return f"{self.times:g} times {' and '.join(self.of)}"


class RateEntry(Entry):
    """How fast an obstacle turns [rad/s]: within pi over the rate it turns by at most half a turn.

    `times` the product of the magnitudes of the parameters that it is `of`, over those of `per`; on a path of straight
    `legs`, pi times that product over the length of the shortest one.
    """

    of: list[str]
    per: list[str] = []
    times: float = 1.0
    legs: list[str] = []
    """The corners of the path, as the names of parameters before the axis."""
    used: str = ""
    """The parameter that states how many legs are used; empty: all."""

    def __str__(self) -> str:
        top = " times ".join([f"{self.times:g}", *self.of])
        return f"{top} over {' and '.join(self.per or self.legs)}" if self.per or self.legs else top


class OrderEntry(Entry):
    """The product of the parameters `low` is below `times` that of `high`, or `equal` to it, in every simulation."""

    low: list[str]
    high: list[str]
    text: str
    """Why, and what to do."""
    times: float = 1.0
    equal: bool = True

    def __str__(self) -> str:
        factor = [f"{self.times:g}"] if self.times != 1.0 or not self.high else []
        low, high = _product(self.low) or "1", " ".join([*factor, *filter(None, [_product(self.high)])])
        return f"{low} {'<=' if self.equal else '<'} {high}"


def _product(names: list[str]) -> str:
    return " ".join(f"{name}{'²' * (names.count(name) > 1)}" for name in dict.fromkeys(names))


class ComponentEntry(Entry):
    """A component as a campaign names it. `starts` are the start states of a vehicle."""

    role: Role
    name: str
    title: str
    dimension: int | None
    """2 or 3 for a component in the plane or in space; None if it fits both."""
    frame: Literal["enu", "ned"] = "enu"
    """The axes of a vehicle's world: x east, y north, z up, or x north, y east, z down."""
    written_in: Literal["", "enu", "ned"] = ""
    """The axes assumed by any other component; empty if it is independent of them. A vehicle has `frame`."""
    moving: bool = False
    """Whether an obstacle moves by itself."""
    parameters: list[ParameterEntry]
    starts: list[ParameterEntry] = []
    goals: list[ParameterEntry] = []
    """The parameters that define the goal of an avoider."""
    fits: list[str] = []
    """The vehicles that a controller supports; empty for everything else."""
    demand: str = ""
    """The demand of an avoider: force or velocity."""
    demands: list[str] = []
    """The kinds of demand that a controller follows."""
    about_trim: Annotated[list[str], UNSTATED] = []
    """The states of the polynomial model of a controller and its vehicle about trim; omitted if it has none."""
    inputs: list[str] = []
    """The inputs of a vehicle, to which actuator faults apply."""
    path: str = ""
    """The part of the loop that a fault affects: perception, timing, navigation, actuator."""
    unit: str = ""
    """The unit of a criterion's value."""
    quantity: str = ""
    """The short name of a criterion's value, such as d_min."""
    worse: Literal["", "low", "high"] = ""
    """Which end of a criterion is sought; one that is worse when low may decide."""
    of: Literal["", "obstacles", "goal", "flight"] = ""
    """What a criterion measures; one of the goal needs a goal with a position."""
    measured_to: Literal["", "centre", "surface", "none"] = ""
    """The point of an obstacle to which a criterion measures distances; none if it measures none, empty if it is not
    one of obstacles or does not state it."""
    computed_by: Annotated[str, UNSTATED] = ""
    """The digest of the file that declares a criterion of the operator's or of a package, and of those of the operator
    or of that package that it imports, without comments and docstrings; omitted for other components, and in snapshots
    of earlier versions."""
    own_rule: Annotated[bool, UNSTATED] = False
    """Whether a criterion excludes flights at their start by a rule of its own; omitted if it excludes those that start
    at or below the threshold, and in snapshots of earlier versions."""
    reach: ReachEntry | None = None
    """The largest distance of a point inside an obstacle from its centre; None if the obstacle does not declare it."""
    rate: RateEntry | None = None
    """How fast an obstacle turns; None if it does not move, or does not declare it."""
    unswitched: Annotated[bool, UNSTATED] = False
    """Whether a fault or environment of another source than Clearance reads the time and does not declare at which
    instants it changes abruptly; omitted if not, and in snapshots of earlier versions."""
    orders: Annotated[list[OrderEntry], UNSTATED] = []
    """What its parameters must satisfy together; omitted without any, so that older snapshots keep their digests."""
    look: Annotated[ObstacleLook | VehicleLook | None, UNSTATED] = None
    """How an obstacle or a vehicle is drawn; omitted if not declared."""
    text: str
    """Equations, symbols and source, as the component's own file states them."""


def _rank(stated: object) -> object:
    """Earlier versions stated ranks by situation."""
    return min(stated.values(), default=0) if isinstance(stated, dict) else stated


class MethodEntry(Entry):
    """A search method: what it does and guarantees, and its options as JSON Schema."""

    name: str
    title: str
    kind: Literal["global", "local", "random", "multi"]
    """Global methods must agree before anything is cleared; random ones draw from the distributions; multi ones search
    for the Pareto front of several criteria."""
    text: str
    how: str
    """A few words for a table: how it searches."""
    source: str
    evaluations: int
    """The usual budget."""
    starts: bool = False
    """Whether it starts from points given in the campaign."""
    family: Annotated[str, UNSTATED] = ""
    """The principle by which it searches. Methods of one family do not confirm each other; omitted if not declared."""
    families: Annotated[dict[str, dict[str, str]], UNSTATED] = {}
    """The family by option and value, where an option decides it; omitted if none does."""
    apart: Annotated[dict[str, str], UNSTATED] = {}
    """Families of its members, by method, that do not use the others' evaluations; omitted without any."""
    together: Annotated[dict[str, str], UNSTATED] = {}
    """Families of its members that use them, by method: no method of these confirms it; omitted without any."""
    whole_budget: Annotated[bool, UNSTATED] = False
    """Whether it uses its whole budget; omitted if it may end by its own rule."""
    own_rule: Annotated[str, UNSTATED] = ""
    """The options, separated by spaces, with which it may end by its own rule all the same, unless they have their
    defaults; omitted if it has none."""
    most_parameters: Annotated[dict[str, dict[str, int]], UNSTATED] = {}
    """The largest number of uncertain parameters by option and value, where a value limits it; omitted if none does."""
    effort: Annotated[Iterations | Descents | None, UNSTATED] = None
    """How many evaluations it takes until its own rule ends it; omitted if not declared."""
    parallel: Annotated[str, UNSTATED] = ""
    """How many points it requests at a time, in a few words; omitted if not declared."""
    at_once: Annotated[str, UNSTATED] = ""
    """The option that states that number; omitted if it has none."""
    takes: Annotated[str, UNSTATED] = ""
    """The option that states the time of an evaluation [s]; omitted if it has none."""
    suits: Annotated[str, UNSTATED] = ""
    """What it is for, in a few words; omitted if not declared."""
    drawback: Annotated[str, UNSTATED] = ""
    """By how much others are better, in figures, if no problem of the score board prefers it; else omitted."""
    proposed: Annotated[int, BeforeValidator(_rank), UNSTATED] = 0
    """Its rank among the methods that are proposed, from 1; omitted if it is never proposed."""
    confirms: Annotated[int, UNSTATED] = 0
    """Evaluations per parameter below which its parts that are apart may be too small to confirm each other; omitted
    without any."""
    options: JsonObject
    look: Annotated[MethodLook | None, BeforeValidator(readable), UNSTATED] = None
    """Its colours and marker; omitted if not declared."""


class ResultEntry(Entry):
    """A number that an evaluation of a simulator gives; one that is worse when low may decide."""

    name: str
    title: str
    quantity: str
    """Its short name, such as d_min."""
    unit: str
    worse: Literal["low", "high"]
    text: str = ""


class SimulatorEntry(Entry):
    """A simulator as a campaign names it: its parameters, of which `default` is the nominal value, and results."""

    name: str
    title: str
    text: str
    parameters: list[ParameterEntry]
    results: list[ResultEntry]
    step: Annotated[str | None, UNSTATED] = None
    """The name of its step, which is halved when cases are confirmed; of an FMU the communication step; omitted if it
    declares none."""
    seeds: Annotated[dict[str, str], UNSTATED] = {}
    """Parameters of its function that select a realisation of noise and that it does not declare, by name with the
    value that every call has."""

    @property
    def version(self) -> str:
        """Its name with a digest of this declaration: a run is claimed only by a worker with the same.

        Without its words, by an edit of which no campaign means something else.
        """
        document = self.model_dump_json(
            exclude={
                "title": True,
                "text": True,
                "parameters": {"__all__": {"symbol", "text"}},
                "results": {"__all__": {"title", "quantity", "text"}},
            }
        )
        return self._digested(document)

    @property
    def versions(self) -> list[str]:
        """Its version, and the one of which runs were submitted by earlier versions, whose digest had the words."""
        return [self.version, self._digested(self.model_dump_json())]

    def _digested(self, document: str) -> str:
        return f"{self.name}@{hashlib.sha256(document.encode()).hexdigest()[:16]}"

    def result(self, name: str | None) -> ResultEntry | None:
        """The result of that name, or None."""
        return next((r for r in self.results if r.name == name), None)


class UnusableEntry(Entry):
    """What was skipped because it cannot be used."""

    file: str
    """The file in its folder; empty for a package without one."""
    line: int | None
    """The line of the mistake; None if it has none."""
    name: str
    """The name that a campaign would use, as far as it is known."""
    text: str
    """What stands there, what was expected, and what to do: one sentence."""
    kind: Kind = "component"

    def __str__(self) -> str:
        where = f"{self.file}, line {self.line}" if self.line else self.file
        return f"{where}: {self.text}" if where else self.text


class Catalogue(Entry):
    """All that a campaign may name, and the version of the code that offers it."""

    version: str
    components: list[ComponentEntry]
    methods: list[MethodEntry]
    simulators: Annotated[list[SimulatorEntry], UNSTATED] = []
    """Omitted if there is none, so that older snapshots keep their digests."""
    digests: Annotated[dict[str, str], UNSTATED] = {}
    """Of the files of simulators, by name, when this was published; not in snapshots, and omitted if empty."""
    own: Annotated[dict[str, str], UNSTATED] = {}
    """Of the files of the operator's own components, by file, when this was published; not in snapshots."""
    code: Annotated[CodeParts | None, UNSTATED] = None
    """Of the code, by part, when this was published; not in snapshots."""
    unusable: Annotated[list[UnusableEntry], UNSTATED] = []
    """What was skipped, when this was published; not in snapshots, and omitted if there is none."""

    @property
    def versions(self) -> list[str]:
        """Of its simulators."""
        return [version for entry in self.simulators for version in entry.versions]

    def why_not(self, kind: Kind, name: str, text: str) -> str:
        """Why nothing has that name: the sentence of what was skipped under it, else `text`.

        A package that was skipped may have declared it under another name than that of its entry point.
        """
        skipped = [u for u in self.unusable if u.kind == kind]
        named = next((u for u in skipped if u.name == name), None)
        if named is not None:
            return f"it cannot be used: {named}"
        packages = [str(u) for u in skipped if not u.file]
        return f"{text} (or it is in what was skipped: {packages[0]})" if packages else text

    def component(self, role: Role, name: str) -> ComponentEntry | None:
        """The component of that role and name, or None."""
        return next((c for c in self.components if c.role == role and c.name == name), None)

    def method(self, name: str) -> MethodEntry | None:
        """The method of that name, or None."""
        return next((m for m in self.methods if m.name == name), None)

    def simulator(self, name: str) -> SimulatorEntry | None:
        """The simulator of that name, or None."""
        return next((s for s in self.simulators if s.name == name), None)
