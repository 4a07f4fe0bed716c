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
    return _combined([*_evaluating(campaign, known), *stages, *methods])


def model_of(campaign: Campaign, known: CodeParts | None) -> str | None:
    """The digest of the parts of the code that evaluate a case; None if no part is known."""
    return None if known is None else _combined(_evaluating(campaign, known))


def _combined(digests: Iterable[str | None]) -> str | None:
    found = list(digests)
    return None if None in found else hashlib.sha256("".join(f"{digest};" for digest in found).encode()).hexdigest()


def _evaluating(campaign: Campaign, known: CodeParts) -> Iterator[str | None]:
    yield known.systems.get(CLOSED_LOOP if campaign.simulator is None else SIMULATOR)
    used = {component_key(role, part.component) for *_, role, part in parts(campaign)}
    yield from (known.components.get(name) for name in sorted(used))
    if campaign.simulator is not None:
        yield known.simulators.get(campaign.simulator.name, "")
