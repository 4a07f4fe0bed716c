"""A run as it was stored: its campaign, every evaluation, and what its record claims; of a folder or a database.

What a form or an earlier version does not hold is absent from the claims. Start reading at `Record`.
"""

from __future__ import annotations

import json
import zipfile
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import sqlalchemy as sa

from campaigns import Campaign, Catalogue, load_file
from campaigns.asked.load import load_document
from campaigns.asked.snapshot import digest_of

MISSING: Any = "not stored by the version that made this run"
"""What is not stored, or cannot be recomputed without something that is not."""


class UnreadableError(Exception):
    """There is no such run, or nothing that could be audited; the message is a sentence."""


class Columns(NamedTuple):
    """The evaluations of one stage: points (m, n) on the unit cube, costs (m, k), status (m,): 0 ok, 3 excluded."""

    points: Any
    costs: Any
    status: Any


class Record(NamedTuple):
    """One run. `components`: the part of the catalogue that its campaign uses; `columns`: by stage."""

    campaign: Campaign
    components: Catalogue | None
    columns: dict[int, Columns]
    claims: dict[str, Any]


def at(value: Any, *path: str | int) -> Any:
    """What is at this path of nested claims; `MISSING` where there is nothing."""
    for key in path:
        inside = key in value if isinstance(value, dict) else isinstance(value, list) and int(key) < len(value)
        value = value[key] if inside and value else MISSING
    return value


def of_folder(folder: Path) -> Record:
    """The run that `clearance run --out` wrote; raises `UnreadableError` and `CampaignError`."""
    try:
        result = json.loads((folder / "result.json").read_text(encoding="utf-8"))
        file = folder / "evidence.json"
        evidence = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
        with np.load(folder / "evaluations.npz", allow_pickle=False) as arrays:
            held = {int(name[7:]) for name in arrays.files if name.startswith("points_")}
            columns = {k: Columns(*(arrays[f"{name}_{k}"] for name in Columns._fields)) for k in held}
        components = Catalogue.model_validate(evidence["components"]) if evidence else None
        claims = evidence | result | {"digests": {"result": result["digest"]}}
    except (OSError, ValueError, KeyError, TypeError, zipfile.BadZipFile) as error:
        raise UnreadableError(f"{folder} is no folder of a `clearance run --out` that can be read: {error}") from None
    return Record(load_file(folder / "campaign.json"), components, columns, claims)


def of_database(connection: sa.Connection, run_id: int) -> Record:
    """The stored run; raises `UnreadableError` and `CampaignError`. Tables are read as they are, of any version."""
    tables, name = sa.MetaData(), f"R-{run_id:04d}"

    def rows(table: str, order: str, **of: Any) -> list[dict[str, Any]]:
        found = sa.select(sa.Table(table, tables, autoload_with=connection)).filter_by(**of)
        return [dict(row) for row in connection.execute(found.order_by(*map(sa.column, order.split()))).mappings()]

    run = next(iter(rows("runs", "id", id=run_id)), None)
    if run is None or run.get("purged") or not run["verdict"]:
        why = "there is no such run in this database" if run is None else f"it is {run['state']} and has no verdict"
        raise UnreadableError(f"{name} cannot be audited: {'it was purged' if run and run.get('purged') else why}")
    campaign = load_document(rows("campaigns", "digest", digest=run["campaign_digest"])[0]["document"], name)
    kept = rows("catalogue_snapshots", "digest", digest=run["snapshot"])[0] if run.get("snapshot") else None
    stages, chunks = rows("stages", "position", run_id=run_id), dict[int, list[Columns]]()
    for row in rows("evaluation_chunks", "position first", run_id=run_id):
        points, costs = (np.frombuffer(row[k], dtype="<f8").reshape(row["count"], -1) for k in ("points", "costs"))
        chunks.setdefault(row["position"], []).append(Columns(points, costs, np.frombuffer(row["status"], np.uint8)))
    digests = {"run": run["campaign_digest"], "summary": at(run["summary"], "provenance", "digest")}
    claims = run["summary"] | {"verdict": run["verdict"], "reason": run["reason"], "run": run, "digests": digests}
    claims |= {"stages": stages, "results": [stage["result"] for stage in stages]}
    claims |= {"findings": rows("findings", "cost", run_id=run_id)}
    claims["comparison"] = at(claims["results"][-1], "comparison")
    if kept:
        claims |= {"components": kept["digest"], "components stored": digest_of(kept["document"])}
    columns = {k: Columns(*map(np.concatenate, zip(*held, strict=True))) for k, held in chunks.items()}
    return Record(campaign, Catalogue.model_validate(kept["document"]) if kept else None, columns, claims)
