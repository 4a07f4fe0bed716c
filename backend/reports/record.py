"""The stored data of a run from which a report is made, read in one snapshot."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import sqlalchemy as sa
from markupsafe import Markup

from backend.catalog.looks import Looks
from backend.catalog.service import bounds, published, snapshot_of
from backend.reports import declared_view
from backend.reports.figures import Case, Quantity
from backend.reports.plot import NOMINAL, WORST
from backend.reports.words import symbol_html
from backend.results import evaluations, likely
from backend.results import service as results
from backend.results.coverage import read as coverage
from backend.results.coverage.schemas import Coverage
from backend.results.schemas import Evaluations, FindingDetail
from backend.runs import service as runs
from backend.runs.components import changed
from backend.runs.question import asked_again
from backend.runs.schemas import RunDetail, RunVerdict, StageDetail
from backend.signoffs import service as signoffs
from backend.signoffs.schemas import Signoffs
from campaigns import Campaign, Catalogue
from campaigns.catalogue import ParameterEntry
from campaigns.checked.check import parameters
from campaigns.results import SearchResult, StageResult, TraceHead, ValidateResult
from campaigns.results.likelihood import MostLikely
from campaigns.results.sample import Certificate
from campaigns.results.unsearched import certificate_of
from campaigns.symbols import labels

MOST_ROWS = 1200
"""Maximum number of points of a flight in a figure."""
FURTHER = ("#7b5ba6", "#0072b2", "#857c00")
"""Colours of the second, third and fourth finding in the figures."""


@dataclass(frozen=True)
class Record:
    run: RunDetail
    campaign: Campaign
    catalogue: Catalogue | None
    """The component descriptions stored with the run; if there are none, the installed ones."""
    changes: list[str] | None
    """Differences of the installed descriptions from the stored ones, as sentences; None if none were stored."""
    known: dict[str, tuple[ParameterEntry, float]]
    """Every parameter by path, with its nominal value; empty without a catalogue."""
    limits: dict[str, tuple[float, float, float]]
    stages: list[StageDetail]
    findings: list[FindingDetail]
    most_likely: MostLikely
    evaluations: Evaluations
    coverage: Coverage
    cases: list[Case]
    nominal: TraceHead | None
    """The metadata of the nominal flight; None until it is stored."""
    signoffs: Signoffs
    looks: Looks
    question: dict[str, int]
    """How many runs ask the same question, by verdict."""
    extends: str = ""
    """What the run extends, if that is no run of this service."""

    @property
    def digest(self) -> str:
        return self.signoffs.digest

    @property
    def of(self) -> Quantity:
        return Quantity(self.run.quantity or "value", self.run.unit, self.run.threshold)

    @property
    def verdict(self) -> RunVerdict | None:
        return self.run.summary

    @property
    def worst(self) -> FindingDetail | None:
        """The finding that the verdict names, of a violated run the worst that is confirmed; without one the lowest."""
        named = self.verdict.worst.finding if self.verdict is not None and self.verdict.worst is not None else None
        return next((f for f in self.findings if f.label == named), self.findings[0] if self.findings else None)

    @property
    def every(self) -> list[StageResult]:
        """The results of all stages that have one."""
        return [stage.result for stage in self.stages if stage.result is not None]

    @property
    def certificate(self) -> Certificate | None:
        """The sample of the certify stage, and where its seed came from."""
        return certificate_of(self.every)

    @property
    def searched(self) -> dict[int, SearchResult]:
        """What the methods found, by the position of their stages."""
        return {s.position: s.result for s in self.stages if isinstance(s.result, SearchResult)}

    @property
    def validated(self) -> ValidateResult | None:
        """What was confirmed by independent means."""
        return next((result for result in self.every if isinstance(result, ValidateResult)), None)

    def entry(self, path: str) -> ParameterEntry | None:
        found = self.known.get(path)
        return None if found is None else found[0]

    def titled(self, method: str) -> str:
        """The title of a search method; its name if neither a search of it has ended nor the catalogue has it."""
        ended = (result.title for result in self.searched.values() if result.method == method)
        entry = None if self.catalogue is None else self.catalogue.method(method)
        return next(ended, method if entry is None else entry.title)

    def symbol(self, path: str) -> str:
        """The name of a parameter: its symbol, with its part if others in the campaign have the same one."""
        return labels([*self.campaign.uncertain, path], {p: entry.symbol for p, (entry, _) in self.known.items()})[path]

    def symbol_html(self, path: str) -> Markup:
        return symbol_html(self.symbol(path), path)

    def words(self, path: str) -> str:
        entry = self.entry(path)
        return entry.text if entry else path


def load(reader: sa.Connection, run_id: int) -> Record:
    """Read all data in one snapshot; 404 if there is no such run."""
    campaign, kept, installed = runs.campaign(reader, run_id), snapshot_of(reader, run_id), published(reader)
    catalogue = kept or installed
    found = results.findings(reader, run_id)
    traced = {flight.name: flight.meta for flight in results.traces(reader, run_id)}
    run = runs.detail(reader, run_id)
    named = None if run.summary is None or run.summary.worst is None else run.summary.worst.finding
    labels = sorted((finding.label for finding in found), key=lambda label: label != named)
    return Record(
        run=run,
        campaign=campaign,
        catalogue=catalogue,
        changes=None if kept is None else changed(kept, installed),
        known={} if catalogue is None else parameters(campaign, catalogue),
        limits=bounds(campaign, catalogue),
        stages=runs.stages(reader, run_id),
        findings=found,
        most_likely=likely.violation(reader, run_id),
        evaluations=evaluations.read(reader, run_id, 100, None),
        coverage=coverage.read(reader, run_id),
        cases=_cases(reader, run_id, labels, _drawable(campaign, traced)),
        nominal=traced.get("nominal"),
        signoffs=signoffs.listed(reader, run_id),
        looks=Looks(kept, installed),
        question=asked_again(reader, run_id),
    )


def _drawable(campaign: Campaign, traced: Mapping[str, TraceHead]) -> set[str]:
    """The stored traces with known positions: flights of the closed loop, and what a simulator declares."""
    return {name for name, head in traced.items() if campaign.scenario is not None or head.scene is not None}


def _cases(reader: sa.Connection, run_id: int, labels: list[str], stored: set[str]) -> list[Case]:
    """The stored flights of the nominal case and the first findings; labels: the worst first, which is drawn last."""
    named = [("nominal", "Nominal", NOMINAL)]
    named += [(label, label, colour) for label, colour in zip(labels[1:4], FURTHER, strict=False)]
    named += [(label, f"Worst, {label}" if len(labels) > 1 else "Worst", WORST) for label in labels[:1]]
    found = []
    for name, label, colour in named:
        if name in stored:
            flight = results.trace(reader, run_id, name, MOST_ROWS)
            head, data, view = flight.meta, flight.data, None
            if head.scene is not None:
                head, data, view = declared_view.drawn(head.scene, head, data)
            found.append(Case(label, colour, head, data, "" if colour in (NOMINAL, WORST) else "4 2", view))
    return found
