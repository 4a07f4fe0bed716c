"""Stored evaluations of a sample, simulated or evaluated again to draw them, and the sentence on what was drawn.

Of a scenario this gives the same bits. Of a simulator each is one further call on the machine of the service: the
sentence states how many results differ from the stored ones.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import cast

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


@dataclass
class Tally:
    """Counts what was drawn of the first `size` evaluations of the sample of a stage, for a sentence."""

    stage: str
    size: int
    setting: Setting
    other: str = ""
    """What is other code than that of the run, a sentence."""

    def count(self, answer: FlightReply, stored: float | None, drawn: bool) -> None:
        """One answer, the stored cost, and whether there is a line of it."""
        self.other = self.other or self.setting.other_code(Identity.model_validate(answer["identity"]))

    def words(self) -> str:
        """The text that describes what is drawn."""
        raise NotImplementedError


@dataclass(frozen=True)
class Again:
    """Evaluates again: `together` at a time before they are drawn, until `patience` [s] is over."""

    live: Live
    setting: Setting
    tally: type[Tally]
    together: int = TOGETHER
    patience: float = math.inf
    needs: str = ""
    """The version of the simulator that the run needs; empty if it was not recorded."""

    def answer(self, values: Mapping[str, float], seed: int | None) -> FlightReply:
        """The response of the process; raises `LiveError`."""
        document, digest = self.setting.document, self.setting.digest
        if self.setting.clears:
            return self.live.simulate(document, digest, values, ROWS, seed)
        request = {"campaign": document, "simulator": self.needs, "parameters": dict(values)}
        found: CaseReply = self.live.ask(digest, request | {"rows": ROWS})
        return found


def of_run(reader: sa.Connection, live: Live, setting: Setting) -> Again:
    """The evaluator for a setting's run; live: the process that simulates its scenario or evaluates its simulator."""
    if setting.clears:
        return Again(live, setting, _Flights)
    needs = reader.scalar(sa.select(Run.needs).where(Run.id == number(setting.run))) or ""
    return Again(live, setting, _Cases, 1, PATIENCE, needs)


@dataclass
class _Flights(Tally):
    failed: int = 0

    def count(self, answer: FlightReply, stored: float | None, drawn: bool) -> None:
        super().count(answer, stored, drawn)
        self.failed += answer["status"] != "ok"

    def words(self) -> str:
        lost = f" {self.failed} failed and end at the failure." if self.failed else ""
        text = f"Thin: the first {self.size} flights of the sample of {self.stage}, as drawn.{lost} {self.other}"
        return text.rstrip()


@dataclass
class _Cases(Tally):
    evaluated: int = 0
    drawn: int = 0
    same: int = 0
    why: str = ""
    """The first reason why one of them could not be drawn."""

    def count(self, answer: FlightReply, stored: float | None, drawn: bool) -> None:
        super().count(answer, stored, drawn)
        called = cast(CaseReply, answer)
        self.evaluated += 1
        self.drawn += drawn
        self.same += called["cost"] == stored
        if not drawn:
            self.why = self.why or called["reason"] or called["untraced"] or "its trace has no positions"

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
