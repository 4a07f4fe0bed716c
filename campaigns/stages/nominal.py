"""The nominal stage: one evaluation with every parameter at its nominal value."""

from __future__ import annotations

from campaigns.results.nominal import NominalResult
from campaigns.stages.declared import Declared

stage = Declared(
    kind="nominal",
    order=0,
    title="Nominal",
    result=NominalResult,
    planned=lambda campaign: [(None, 1)],
    description=lambda campaign: "every parameter nominal",
)
