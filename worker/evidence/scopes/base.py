"""The terms in which claims describe one system, as data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from campaigns.claims.spans import Spans
from campaigns.claims.terms import Condition, Scope, Words


@dataclass(frozen=True)
class Terms:
    """The terms of one system."""

    scope: Scope
    words: Words
    caveat: str = ""
    """Sentences that a "cleared" verdict must add about what was not checked."""
    shows: tuple[Condition, ...] = ()
    """The evidence of an encounter that the system can give; the verdict has only these checks of it."""
    bars: tuple[tuple[str, Spans], ...] = ()
    """Reasons that rule out "cleared" for any result: the check's code and the sentence."""
    function: Literal["", "in_process", "isolated"] = ""
    """Where a Python function is called; empty for any other system."""
    stepped: bool = False
    """Whether it is a simulator of which single calls are confirmed at half its step, too."""
    obstacles: tuple[str, ...] = ()
    """The titles of a scenario's obstacles, in order."""
    declares: str = ""
    """The distance that a criterion of obstacles declares, as a clause; empty if it declares none."""
    own_rule: bool = False
    """Whether the criterion excludes flights at their start by another rule than its threshold."""
    followed: bool = True
    """Whether the closest approach is known beyond what is simulated; not that of a criterion without distances."""
