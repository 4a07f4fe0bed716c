"""Stored evaluations of a sample, simulated or evaluated again to draw them, and the sentence on what was drawn.

Of a scenario this gives the same bits. Of a simulator each is one further call on the machine of the service: the
sentence states how many results differ from the stored ones.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol, cast

import sqlalchemy as sa

from backend.db.tables import Run
from backend.runs.service import number
from backend.scenes.base.setting import Setting
from backend.scenes.live.live import Live
from campaigns.identity.identity import Identity
from campaigns.stored.replies import CaseReply, FlightReply

ROWS = 200
"""Maximum number of points of a line."""
TOGETHER = 6
"""Number of flights drawn per batch."""
PATIENCE = 60.0
"""Time after which no further case of a simulator is evaluated [s]: a call may take long."""


ONE = "1 result differs from the stored one."


class Tally(Protocol):
    """Counts what was drawn, for a sentence."""

    def count(self, answer: FlightReply, stored: float | None, drawn: bool) -> None:
        """One answer, the stored cost, and whether there is a line of it."""

    def words(self) -> str:
        """The text that describes what is drawn."""


class Again(Protocol):
    """Evaluates again: so many at a time before they are drawn, until `patience` [s] is over."""

    @property
    def together(self) -> int: ...
    @property
    def patience(self) -> float: ...

    def answer(self, values: Mapping[str, float], seed: int | None) -> FlightReply:
        """The response of the process; raises `LiveError`."""

    def tally(self, stage: str, size: int) -> Tally:
        """An empty count of the first `size` evaluations of the sample of a stage."""


def of_run(reader: sa.Connection, live: Live, setting: Setting) -> Again:
    """The evaluator for a setting's run; live: the process that simulates its scenario or evaluates its simulator."""
    if setting.clears:
        return _OfScenario(live, setting)
    run_id = number(setting.run)
    needs = reader.scalar(sa.select(Run.needs).where(Run.id == run_id)) or ""
    return _OfSimulator(live, setting, needs)


@dataclass(frozen=True)
class _OfScenario:
    live: Live
    setting: Setting
    together: int = TOGETHER
    patience: float = math.inf

    def answer(self, values: Mapping[str, float], seed: int | None) -> FlightReply:
        return self.live.simulate(self.setting.document, self.setting.digest, values, ROWS, seed)

    def tally(self, stage: str, size: int) -> Tally:
        return _Flights(stage, size, self.setting)


@dataclass
class _Flights:
    stage: str
    size: int
    setting: Setting
    failed: int = 0
    other: str = ""
    """What is other code than that of the run, a sentence."""

    def count(self, answer: FlightReply, stored: float | None, drawn: bool) -> None:
        self.failed += answer["status"] != "ok"
        self.other = self.other or self.setting.other_code(Identity.model_validate(answer["identity"]))

    def words(self) -> str:
        lost = f" {self.failed} failed and end at the failure." if self.failed else ""
        text = f"Thin: the first {self.size} flights of the sample of {self.stage}, as drawn.{lost} {self.other}"
        return text.rstrip()


@dataclass(frozen=True)
class _OfSimulator:
    live: Live
    setting: Setting
    needs: str
    """The version of the simulator that the run needs; empty if it was not recorded."""
    together: int = 1
    patience: float = PATIENCE

    def answer(self, values: Mapping[str, float], seed: int | None) -> CaseReply:
        request = {"campaign": self.setting.document, "simulator": self.needs, "parameters": dict(values)}
        found: CaseReply = self.live.ask(self.setting.digest, request | {"rows": ROWS})
        return found

    def tally(self, stage: str, size: int) -> Tally:
        return _Cases(stage, size, self.setting)


@dataclass
class _Cases:
    stage: str
    size: int
    setting: Setting
    evaluated: int = 0
    drawn: int = 0
    same: int = 0
    why: str = ""
    """The first reason why one of them could not be drawn."""
    other: str = ""
    """What is other code than that of the run, a sentence."""

    def count(self, answer: FlightReply, stored: float | None, drawn: bool) -> None:
        called = cast(CaseReply, answer)
        self.evaluated += 1
        self.drawn += drawn
        self.same += called["cost"] == stored
        if not drawn:
            self.why = self.why or called["reason"] or called["untraced"] or "its trace has no positions"
        self.other = self.other or self.setting.other_code(Identity.model_validate(answer["identity"]))

    def words(self) -> str:
        return " ".join(self._sentences())

    def _sentences(self) -> list[str]:
        all_of = f"the first {self.evaluated} of the sample of {self.stage}"
        within = "" if self.evaluated == self.size else f", as many as were evaluated within {PATIENCE:g} s"
        found = [f"Thin: {all_of}{within}, each evaluated again by one call."]
        if self.drawn < self.evaluated:
            found.append(f"{self.evaluated - self.drawn} of them cannot be drawn: {self.why.rstrip('.')}.")
        if self.same == self.evaluated:
            found.append("All results equal the stored ones.")
        else:
            differ = self.evaluated - self.same
            found.append(f"{differ} results differ from the stored ones." if differ > 1 else ONE)
        return [*found, self.other] if self.other else found
