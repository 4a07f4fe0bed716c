"""The campaign: what is evaluated, uncertain parameters, criterion, stages, seed; immutable and identified by its
digest.

Only checks that do not depend on the components are made here (types, sizes, intervals); `campaigns.checked.check`
validates units and the components' own limits against the catalogue.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Field, field_validator, model_validator
from pydantic.json_schema import JsonSchemaValue

from campaigns import limits
from campaigns.asked.distributions import Correlation, Uncertain
from campaigns.asked.regression import Baseline, Policy
from campaigns.asked.requirements import Requirements
from campaigns.asked.scenario import MAX_SEED, Part, Realisations, Repeats, Scenario
from campaigns.asked.stages import Search, Stages
from campaigns.asked.values import (
    AS_NUMBER,
    AS_WHOLE,
    DISTINCT,
    MAX_COUNTED,
    MAX_EVALUATIONS,
    Identifier,
    Name,
    Notes,
    Number,
    Path,
    Reason,
    Source,
    Strict,
    Summary,
    Values,
)
from campaigns.documented import UNLESS_EMPTY, UNSTATED, no_default
from campaigns.documents import JsonObject, digest_of

__all__ = [
    "MAX_EVALUATIONS",
    "MAX_SEED",
    "Campaign",
    "Criterion",
    "Part",
    "Realisations",
    "Repeats",
    "Scenario",
    "Search",
    "Simulator",
    "Stages",
]


class Simulator(Strict):
    """A simulator of the installation, by name, and values of its parameters; omitted ones are nominal."""

    name: Identifier
    parameters: Values = {}
    repeats: Annotated[Repeats | None, UNSTATED] = None
    """If omitted, an evaluation is one call."""
    retries: Annotated[int, Field(ge=0, le=10), UNSTATED, AS_WHOLE] = 0
    """How often a call that failed or timed out is tried again."""

    @property
    def calls(self) -> int:
        """Calls per evaluation, without those tried again."""
        return 1 if self.repeats is None else self.repeats.count

    @property
    def combine(self) -> Literal["worst", "mean", "quantile"]:
        """How the calls of an evaluation are combined."""
        return "worst" if self.repeats is None else self.repeats.combine


class Criterion(Strict):
    """An evaluation is clear if the criterion's value stays above `threshold`.

    The value is that of a component over the scenario, or a result of the simulator.
    """

    component: Annotated[Identifier | Literal[""], UNLESS_EMPTY] = "separation"
    """Of a scenario; empty with a simulator."""
    parameters: Values = {}
    result: Annotated[Identifier | None, UNSTATED] = None
    """Of a simulator: the name of the result."""
    threshold: Number
    from_centre: Annotated[bool, UNSTATED] = False
    """Confirms that distances to the obstacles' centres are intended although the threshold is within an obstacle.

    Omitted from the canonical form if not stated, so campaigns without it keep their digests.
    """
    requirements: Annotated[Requirements, UNSTATED] = []
    """What this criterion is evidence for; omitted from the canonical form if empty, as above."""

    @model_validator(mode="before")
    @classmethod
    def _of_a_simulator(cls, document: Any) -> Any:
        """A result takes the place of the component."""
        if isinstance(document, Mapping) and document.get("result") is not None:
            if document.get("component"):
                raise ValueError("give either component (of a scenario) or result (of a simulator), not both")
            return {**document, "component": ""}
        return document


class Encounter(Strict):
    """Conditions of the encounter that the author intentionally does not meet, each with the reason.

    closest_approach: inside the horizon, neither at its start nor at its end (it permits no violation after the end);
    motion: the vehicle moves; avoidance: the avoider makes a difference; influence: an uncertain parameter does.
    """

    intended: dict[Literal["closest_approach", "motion", "avoidance", "influence"], Reason] = {}


class Objective(Part):
    """A further criterion: every evaluation also has its value, and multi-criteria searches include it in their front.

    It has no threshold and no effect on the verdict.
    """


class Published(Strict):
    """A published value, displayed for comparison."""

    label: Name
    value: Number
    at: dict[Path, Number] = {}
    source: Source = ""


def _supported(schema: JsonSchemaValue) -> None:
    """State the least confidence that a new campaign may have; a stored one with less is still read."""
    schema.pop("exclusiveMinimum", None)
    schema["minimum"] = limits.CONFIDENCE_AT_LEAST


class Campaign(Strict):
    """One verification campaign.

    `digest` identifies it: equal campaigns have equal digests, regardless of file format, key order or spelled-out
    defaults.
    """

    version: Annotated[Literal[1], AS_WHOLE] = 1
    name: Name
    summary: Summary = ""
    notes: Notes = ""
    tags: Annotated[list[Annotated[str, Field(pattern=r"^[\w.+-]{1,40}$")]], Field(max_length=20), DISTINCT] = []
    scenario: Annotated[Scenario | None, UNSTATED] = None
    """A closed loop of components. Exactly one of this and `simulator` is given."""
    simulator: Annotated[Simulator | None, UNSTATED] = None
    uncertain: Annotated[dict[Path, Uncertain], Field(min_length=1, max_length=64)]
    correlations: Annotated[list[Correlation], Field(max_length=2016)] = []
    """Of the random samples; pairs that are not listed are uncorrelated."""
    criterion: Criterion
    """It decides the verdict."""
    objectives: Annotated[list[Objective], Field(max_length=8)] = []
    """Further criteria; objectives.0, objectives.1, ... in paths."""
    stages: Annotated[Stages, Field(json_schema_extra=no_default)] = Stages()
    agreement: Annotated[float, Field(gt=0, le=1), AS_NUMBER] = limits.AGREEMENT
    """Fraction of nominal minus worst within which the global methods must agree."""
    target_probability: Annotated[float, Field(gt=0, lt=1), AS_NUMBER] | None = None
    """If given, the bound on P(violation) from the certify stage must be at most this; without that stage, the bound
    from the first plain random search."""
    confidence: Annotated[float, Field(gt=0.5, lt=1, json_schema_extra=_supported), AS_NUMBER] = limits.CONFIDENCE
    encounter: Annotated[Encounter, Field(exclude_if=lambda value: not value.intended)] = Encounter()
    """Omitted from the canonical form if empty, so campaigns without it keep their digests."""
    seed: Annotated[int, Field(ge=0, le=2**53), AS_WHOLE] = 1
    published: Annotated[list[Published], Field(max_length=100)] = []
    regression: Annotated[Policy, Field(exclude_if=lambda value: value.usual, json_schema_extra=no_default)] = Policy()
    """Omitted from the canonical form if usual, so campaigns without it keep their digests."""
    baseline: Annotated[Baseline | None, UNSTATED] = None
    """Added by a launch with a baseline; its findings are evaluated after the nominal case."""

    @model_validator(mode="before")
    @classmethod
    def _chosen(cls, document: Any) -> Any:
        """A campaign that states no search has one, and one that does not state whether it draws a sample draws one;
        `certify: null` draws none."""
        stages = document.get("stages", {}) if isinstance(document, Mapping) else None
        if not isinstance(stages, Mapping):
            return document
        samples = limits.SAMPLE_CLOSED_LOOP if document.get("simulator") is None else limits.SAMPLE
        uncertain = document.get("uncertain")
        parameters = len(uncertain) if isinstance(uncertain, Mapping) else 0
        evaluations = max(limits.SEARCHED, limits.SEARCHED_EACH * parameters)
        usual = {"search": [{"method": limits.SEARCH, "evaluations": evaluations}], "certify": {"samples": samples}}
        return {**document, "stages": {**usual, **stages}}

    @field_validator("uncertain")
    @classmethod
    def _in_order(cls, uncertain: dict[str, Uncertain]) -> dict[str, Uncertain]:
        """The parameters by name, small letters first (m, J): a search's axes must not depend on a file's order."""
        return dict(sorted(uncertain.items(), key=lambda item: item[0].swapcase()))

    @model_validator(mode="after")
    def _one_system(self) -> Campaign:
        if (self.scenario is None) == (self.simulator is None):
            both = "both are" if self.scenario is not None else "neither is"
            raise ValueError(f"give exactly one of scenario and simulator; {both} given")
        if self.simulator is not None and self.criterion.result is None:
            raise ValueError("criterion.result: a simulator's result is required, by name")
        if self.scenario is not None and self.criterion.result is not None:
            raise ValueError("criterion.result: only a simulator has results; a scenario needs criterion.component")
        return self

    @model_validator(mode="after")
    def _attainable(self) -> Campaign:
        certify, target = self.stages.certify, self.target_probability
        if certify is None or certify.until == "samples":
            return self
        if target is None:
            raise ValueError("stages.certify.until: target needs a target_probability")
        least = math.log1p(-self.confidence) / math.log1p(-target) - 1e-9
        if certify.samples < least:
            most = f"at most {MAX_COUNTED:,} may be drawn, so give a higher target_probability"
            raise ValueError(
                f"stages.certify.samples: {certify.samples:,} samples cannot show a probability of {target:g} with "
                f"a confidence of {self.confidence!r}; "
                f"{f'give at least {math.ceil(least):,}' if least <= MAX_COUNTED else most}"
            )
        return self

    @property
    def given_scenario(self) -> Scenario:
        """The scenario; raises `ValueError` for a campaign without one."""
        if self.scenario is None:
            raise ValueError("the campaign names a simulator and has no scenario")
        return self.scenario

    def interval(self, path: str, nominal: float) -> tuple[float, float]:
        """The lowest and the highest value of a parameter with this nominal value, which are equal if it is fixed."""
        uncertain = self.uncertain.get(path)
        return (nominal, nominal) if uncertain is None else uncertain.interval(nominal)

    @property
    def shared(self) -> bool:
        """Whether several workers may fly its sample, and some of it twice: a simulator could give another result then;
        its cluster shares it among machines."""
        certify = self.stages.certify
        return certify is not None and certify.shared and self.simulator is None

    @property
    def digest(self) -> str:
        """SHA-256 over the canonical JSON form, 64 hexadecimal digits."""
        return digest_of(self.document())

    @property
    def seedless(self) -> str:
        """SHA-256 over the canonical form without its seed: equal campaigns that differ only in the seed share it."""
        return seedless(self.document())

    def document(self) -> JsonObject:
        """The campaign as plain JSON values."""
        return self.model_dump(mode="json", by_alias=True)


def seedless(document: Mapping[str, Any]) -> str:
    """The digest of a campaign without its seed, from a stored document."""
    return digest_of({key: value for key, value in document.items() if key != "seed"})
