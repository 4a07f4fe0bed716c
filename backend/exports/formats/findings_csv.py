"""The nominal case and every finding as CSV, one row each, with the values of all criteria."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import starmap

import sqlalchemy as sa

from backend.exports.format import Format, whole, words
from backend.exports.sheet import headings, sheet
from backend.http.written import headed, lines
from backend.results import service as results
from backend.runs import service as runs
from campaigns.results.base import Status
from campaigns.results.nominal import NominalCase
from campaigns.results.unsearched import certificate_of, unsearched

LIKELY = ("standard deviations", "density of the highest", "draws no more likely")
"""How likely a finding is under the stated distributions; empty where all points of the box are equally likely."""


def findings_csv(reader: sa.Connection, run_id: int) -> Iterator[bytes]:
    """One row for the nominal case and each finding, with every criterion's value, even without a stored flight.

    A finding's value is the one to state for it, `evaluated` the one that the search found.
    The last column has the units of the columns whose headers have none: their names are as scripts know them.
    """
    run = runs.detail(reader, run_id)
    found = {finding.label: finding for finding in results.findings(reader, run_id)}
    # A simulator's trace shows one call, which may differ from the stored evaluation.
    flies = run.campaign.get("scenario") is not None
    flights = {flight.name: flight.meta for flight in results.traces(reader, run_id)} if flies else {}
    paths = list(run.campaign["uncertain"])
    heads = list(starmap(headed, headings(run.criteria)))
    columns = [
        "margin",
        "closest at [s]",
        "speed there [m/s]",
        "validated",
        "found by",
        *paths,
        "evaluated",
        *LIKELY,
        "noise seed",
        "units",
    ]
    yield lines([["flight", *heads, *columns]])
    parameters = sheet(reader, run_id, runs.campaign(reader, run_id)).parameters
    units = "; ".join(f"{name} [{unit}]" for name, unit in [("margin", run.unit), *parameters] if unit)
    made = [stage.result for stage in runs.stages(reader, run_id) if stage.result is not None]
    certificate = certificate_of(made)
    # Without a cost until its stage is done.
    failed = NominalCase(cost=None, margin=None, status=Status.FAILED)
    nominal = next((result.at_nominal for result in made if result.at_nominal is not None), failed)
    for name in dict.fromkeys([*flights, *(["nominal"] if nominal.cost is not None else []), *found]):
        head, finding = flights.get(name), found.get(name)
        cost, of = (finding.cost, finding.parameters) if finding else (nominal.cost, nominal.parameters)
        if head is not None:
            cost, of = head.cost, finding.parameters if finding else head.parameters
        values = head.values if head is not None and head.values else {run.criteria[0].name: cost}
        criterion_values = [values.get(criterion.name) for criterion in run.criteria]
        evaluated = finding.cost if finding else None
        if finding and finding.granted != finding.cost:
            criterion_values[0] = finding.granted
        value = criterion_values[0]
        known = None if value is None or run.threshold is None else value - run.threshold
        margin = finding.margin if finding else known
        by = (" ".join(finding.methods) or unsearched(finding.validation, certificate)) if finding else ""
        drawn = finding.validation.realisation if finding and finding.validation else None
        ok = finding.validation.ok if finding and finding.validation else None
        at = [head.approach.time, head.approach.speed] if head is not None and head.approach else [None, None]
        likely = None if finding is None else finding.likelihood
        stated = [None] * len(LIKELY) if likely is None else [likely.distance, likely.density, likely.tail]
        row = [
            name,
            *criterion_values,
            margin,
            *at,
            ok,
            by,
            *(of.get(p) for p in paths),
            evaluated,
            *stated,
            drawn,
            units,
        ]
        yield lines([row])


export = Format(
    file="findings.csv",
    order=4,
    media_type="text/csv",
    words=words(
        "Findings, CSV",
        "Nominal flight and every finding: all criteria, closest approach, parameters, validation",
        ("Findings, CSV", "Nominal case and every finding: result, parameters, validation"),
    ),
    made=lambda engine, run_id: whole(engine, run_id, findings_csv),
    needs="findings",
)
