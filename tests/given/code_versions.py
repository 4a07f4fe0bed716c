"""The code of stored test runs, and a different one, as workers publish them."""

from __future__ import annotations

import hashlib
from typing import Any

from campaigns import Campaign
from campaigns.identity.code import CLOSED_LOOP, SIMULATOR, code_of, component_key
from campaigns.identity.identity import identity_of
from campaigns.stages.found import declared
from campaigns.versions import Code, CodeParts, Processor, Versions
from tests.given.small_catalogue import CATALOGUE, campaign

PACKAGES, PYTHON = {"numpy": "2.4.6", "scipy": "1.17.1"}, "3.11.7"


def parts(catalogue: dict[str, Any], edition: str = "") -> CodeParts:
    """The code of everything in a catalogue's document; in another edition, that of the vehicles differs."""

    def digest(name: str) -> str:
        return hashlib.sha256(name.encode()).hexdigest()

    components = [component_key(one["role"], one["name"]) for one in catalogue["components"]]
    return CodeParts(
        packages=PACKAGES | {"Python": PYTHON, "cma": "4.4.4"},
        systems={kind: digest(kind) for kind in (CLOSED_LOOP, SIMULATOR)},
        stages={kind: digest(kind) for kind in declared()},
        methods={one["name"]: digest(one["name"]) for one in catalogue["methods"]},
        components={key: digest(key + edition if key.startswith("vehicle") else key) for key in components},
    )


def code(document: dict[str, Any], edition: str = "") -> Code:
    """What a run of the campaign stores of its code."""
    digest = code_of(Campaign.model_validate(document), parts(CATALOGUE.model_dump(mode="json"), edition))
    vehicle = hashlib.sha256(edition.encode()).hexdigest()[:16]
    known = {"worker.engine.problem.problem": "0" * 16, "worker.engine.components.vehicles.unicycle": vehicle}
    return Code(digest or "", known)


def edited(catalogue: dict[str, Any] | None = None) -> dict[str, Any]:
    """The document of a catalogue that a worker with another vehicle publishes."""
    document = CATALOGUE.model_dump(mode="json") if catalogue is None else catalogue
    return {**document, "code": parts(document, "edited").model_dump(mode="json")}


CODE, OTHER = code(campaign()), code(campaign(), "edited")
VERSIONS = Versions(
    code=CODE.digest,
    loop="0123456789abcdef",
    packages=PACKAGES,
    clearance="0.1.0",
    python=PYTHON,
    system="Linux x86_64",
    cpu=Processor(model="A CPU", target="znver4", features=""),
    lanes=8,
    step=0.005,
    integrator="RK4",
)
IDENTITY = identity_of(VERSIONS, "")
OTHER_IDENTITY = identity_of(VERSIONS.model_copy(update={"code": OTHER.digest}), "")
"""Of runs by `CODE` and by `OTHER`."""
