"""The identity of the code of a run: what the engine and the parts that the campaign uses mean, as one digest.

Workers publish the digests of their parts (`CodeParts`); service and worker combine them alike, so that "the same code"
has one meaning wherever two runs, or a run and an installation, are compared.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator

from campaigns.asked.spec import Campaign
from campaigns.checked.check import parts
from campaigns.stages.plan import plan
from campaigns.versions import CodeParts

CLOSED_LOOP, SIMULATOR = "closed loop", "simulator"
"""The kinds of systems."""
OBJECTIVES = "+"
"""In the digest of a model, before what objectives add to it."""


def component_key(role: str, name: str) -> str:
    """The key of a component in `CodeParts.components`."""
    return f"{role} {name}"


def code_of(campaign: Campaign, known: CodeParts | None) -> str | None:
    """The code digest that a run of the campaign has with these parts, 64 hexadecimal digits; None if a part is
    missing or unknown."""
    if known is None:
        return None
    stages = (known.stages.get(kind) for kind in sorted({stage.kind for stage in plan(campaign)}))
    methods = (known.methods.get(name) for name in sorted({search.method for search in campaign.stages.search}))
    return _combined([*_evaluating(campaign, known, True), *stages, *methods])


def model_of(campaign: Campaign, known: CodeParts | None) -> str | None:
    """The digest of the parts of the code that evaluate a case; None if no part is known. Objectives decide nothing, so
    that theirs is a digest of its own behind it."""
    if known is None:
        return None
    model, objectives = (_combined(_evaluating(campaign, known, of)) for of in (False, True))
    return model if model is None or not campaign.objectives else f"{model}{OBJECTIVES}{objectives}"


def _combined(digests: Iterable[str | None]) -> str | None:
    found = list(digests)
    return None if None in found else hashlib.sha256("".join(f"{digest};" for digest in found).encode()).hexdigest()


def _evaluating(campaign: Campaign, known: CodeParts, objectives: bool) -> Iterator[str | None]:
    yield known.systems.get(CLOSED_LOOP if campaign.simulator is None else SIMULATOR)
    evaluating = [p for p in parts(campaign) if objectives or not p[0].startswith("objectives.")]
    used = {component_key(role, part.component) for *_, role, part in evaluating}
    yield from (known.components.get(name) for name in sorted(used))
    if campaign.simulator is not None:
        yield known.simulators.get(campaign.simulator.name, "")
