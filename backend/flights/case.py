"""A case of a stored run with other parameters: read and validated, and the response.

What-if requests of scenarios (`service`) and of simulators (`backend/cases`) share it.
"""

from __future__ import annotations

from dataclasses import dataclass

import sqlalchemy as sa

from backend.catalog.criteria import criteria
from backend.catalog.schemas import CriterionOut
from backend.catalog.service import described
from backend.db.tables import Finding
from backend.flights.schemas import FlightAnswer, FlightValue
from backend.http.errors import RefusedError
from backend.runs import identity
from campaigns import Campaign, Catalogue, Problem, thin
from campaigns.checked import orders, texts
from campaigns.checked.check import installed, parameters, parts
from campaigns.identity.identity import UNSTORED, Identity
from campaigns.results.trace import TraceColumn, TraceHead
from campaigns.runs import run_name
from campaigns.stored.replies import FlightReply

NOMINAL = "nominal"


@dataclass(frozen=True)
class Case:
    """A flight of a run, or a case of its simulator, ready to be simulated."""

    run_id: int
    campaign: Campaign
    threshold: float
    criteria: list[CriterionOut]
    like: str
    values: dict[str, float]
    """Parameters that are not nominal, by path."""
    seed: int | None
    simulator: str = ""
    """The version of the simulator that it needs; empty for a flight, and if it was not recorded."""


def case(
    reader: sa.Connection,
    run_id: int,
    campaign: Campaign,
    like: str,
    values: dict[str, float],
    seed: int | None = None,
) -> Case:
    """The case `like` with these parameters; raises `RefusedError` for an unknown finding or parameter, or a value
    outside limits."""
    catalogue = described(reader, run_id)
    base = _like(reader, run_id, like)
    _permit(campaign, catalogue, base, values)
    return Case(
        run_id=run_id,
        campaign=campaign,
        threshold=campaign.criterion.threshold,
        criteria=criteria(campaign.document(), catalogue),
        like=like,
        values=base | dict(values),
        seed=seed,
    )


def response(reader: sa.Connection, wanted: Case, answer: FlightReply, drawn: str | None, rows: int) -> FlightAnswer:
    meta, deciding = answer["meta"], wanted.criteria[0]
    then, now = identity.of_run(reader, wanted.run_id) or UNSTORED, Identity.model_validate(answer["identity"])
    values = [FlightValue(**one.model_dump(), value=meta["values"].get(one.name)) for one in wanted.criteria]
    return FlightAnswer(
        run=run_name(wanted.run_id),
        status=answer["status"],
        reason=answer["reason"],
        cost=answer["cost"],
        threshold=wanted.threshold,
        margin=answer["margin"],
        quantity=deciding.quantity,
        unit=deciding.unit,
        criteria=values,
        like=wanted.like,
        parameters=meta["parameters"],
        seed=wanted.seed,
        code_changes=identity.names(identity.apart(reader, then, now)),
        code_known=not (then.unidentified or now.unidentified),
        drawn=drawn,
        trace=TraceHead.model_validate(meta),
        columns=[TraceColumn.model_validate(column) for column in answer["columns"]],
        data=_thinned(answer, rows) if rows else {},
    )


def _thinned(answer: FlightReply, rows: int) -> dict[str, list[float | None]]:
    """About `rows` rows, including those around the closest approach."""
    data, closest = answer["data"], answer["meta"].get("closest")
    time = data[next(column["name"] for column in answer["columns"] if column["group"] == "time")]
    at = 0 if closest is None else min(range(len(time)), key=lambda row: abs(time[row] - closest["time"]))
    kept = [int(row) for row in thin.around(len(time), rows, at)]
    return {name: [column[row] for row in kept] for name, column in data.items()}


def _like(reader: sa.Connection, run_id: int, label: str) -> dict[str, float]:
    """The parameters of the finding, bit-identical; empty for the nominal case."""
    if label == NOMINAL:
        return {}
    rows = reader.execute(sa.select(Finding.label, Finding.parameters).where(Finding.run_id == run_id)).all()
    known = {row.label: row.parameters for row in rows}
    if label not in known:
        there = ", ".join([NOMINAL, *sorted(known, key=lambda name: (len(name), name))])
        raise RefusedError("unknown-finding", f"{run_name(run_id)} has no finding {label!r}: choose one of {there}")
    return dict(known[label])


def _permit(campaign: Campaign, catalogue: Catalogue | None, base: dict[str, float], values: dict[str, float]) -> None:
    """Check all paths and values; components that the catalogue does not describe are checked by the simulation.

    Raises `RefusedError`.
    """
    if catalogue is None or any(
        catalogue.component(role, part.component) is None for _, _, role, part in parts(campaign)
    ):
        return
    known = parameters(campaign, catalogue)
    unknown = [path for path in values if path not in known]
    if unknown:
        errors = [
            Problem(f"parameters.{path}", texts.number(values[path]), f"no such parameter; {texts.known(path, known)}")
            for path in unknown
        ]
        what = "simulator" if campaign.scenario is None else "scenario"
        detail = f"the {what} has no parameter {unknown[0]!r}; {texts.known(unknown[0], known)}"
        raise RefusedError("unknown-parameter", detail, errors)
    outside = [path for path, value in values.items() if not known[path][0].low <= value <= known[path][0].high]
    if outside:
        errors = [Problem(f"parameters.{p}", texts.number(values[p]), texts.limits(known[p][0])) for p in outside]
        detail = f"{outside[0]} is given as {texts.number(values[outside[0]])}: {texts.limits(known[outside[0]][0])}"
        raise RefusedError("outside-limits", detail, errors)
    case = {path: nominal for path, (_, nominal) in known.items()} | base | values
    bounds = {path: (value, value) for path, value in case.items()}
    if values and (errors := list(orders.broken(installed(campaign, catalogue), bounds))):
        raise RefusedError("outside-limits", str(errors[0]), errors)
