"""The terms in which claims describe a system and its evaluations; a package may state those of its own simulator."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from campaigns.claims.spans import Spans

Condition = Literal["closest approach", "motion", "avoidance"]
"""Evidence that an encounter took place, by the names of the verdict's checks."""


@dataclass(frozen=True)
class Scope:
    """The text of a verdict's scope: what is evaluated, its settings (may be empty), and its version."""

    what: Spans
    settings: Spans
    version: str
    distances: Spans = ()
    """To what distances to obstacles are measured; of a criterion that does not compute them, it is not stated."""


@dataclass(frozen=True)
class Words:
    """Terms used in sentences for an evaluation and its confirmation."""

    one: str
    agree: str
    """The clause for agreement: `the step-halving check and DOP853 agree`."""
    disagrees: str
    every: str
    """`all integrations`."""
    again: str
    """`simulated again at half the step and with the reference integrator`."""
    reference: str
    """The means that random evaluations are compared with."""
    check: str = "validation"
    """The name of the verdict's check that covers the confirmation."""
