"""`clearance verify RUN`: a short independent program says whether a run's verdict follows from its stored data.

The exit code is 0 if it follows, 1 if it does not or is not known to, 3 if there is nothing to verify. The program is
`worker.evidence.audit.verify`; this module reads the files of a folder, or the tables of a database, for it.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from campaigns.unreadable import UNREADABLE
from clearance.cli import VIOLATED, WrongInputError
from clearance.cli._where import DATA, Data, Database, loaded_run

if TYPE_CHECKING:
    import sqlalchemy as sa

    from campaigns.documents import JsonObject
    from worker.evidence.audit.verify import Run


def verify(
    run: Annotated[str, typer.Argument(help="The folder of a `run --out`, or the id of a stored run, such as R-0001.")],
    data: Data = DATA,
    database: Database = "",
) -> None:
    """Check with a short program that a run's verdict follows from its stored evaluations.

    It prints one sentence if it does, or every disagreement with the stated and the recomputed value. The program is
    one file of under 300 lines, written to be read; `clearance audit` compares more.
    """
    from worker.evidence.audit import verify as program

    try:
        follows, sentences = program.verify(_read(run, data, database))
    except UNREADABLE as error:
        why = f"{type(error).__name__}: {error}" if not isinstance(error, OSError | ValueError) else error
        raise WrongInputError(f"{run} is not a run with a verdict that can be read: {why}") from None
    for sentence in sentences:
        typer.echo(f"{sentence[0].upper()}{sentence[1:]}.")
    raise typer.Exit(0 if follows else VIOLATED)


def _read(run: str, data: Path, database: str) -> Run:
    return loaded_run(run, data, database, of_folder, of_database)


def of_folder(folder: Path) -> Run:
    """The run that `clearance run --out` wrote."""
    import numpy as np

    from campaigns.asked.load import load_file
    from worker.evidence.audit.verify import Run

    claims = json.loads((folder / "result.json").read_text(encoding="utf-8"))
    if (folder / "evidence.json").exists():  # the results of the stages, and the components
        claims |= json.loads((folder / "evidence.json").read_text(encoding="utf-8"))
    with (folder / "evaluations.npz").open("rb") as file, np.load(file, allow_pickle=False) as held:
        ks = sorted(int(name.removeprefix("status_")) for name in held.files if name.startswith("status_"))
        points, costs, status = (np.concatenate([held[f"{name}_{k}"] for k in ks]) for name in _COLUMNS)
        stage = np.repeat(ks, [len(held[f"status_{k}"]) for k in ks])
        texts = {k: str(held[f"reasons_{k}"]) if f"reasons_{k}" in held.files else "{}" for k in ks}
        flaky = sum(_flaky(held[f"status_{k}"], json.loads(text)) for k, text in texts.items())
    return Run(load_file(folder / "campaign.json"), claims, stage, points, costs, status, flaky)


def of_database(connection: sa.Connection, run_id: int) -> Run:
    """The stored run; tables are read as they are, of any version."""
    import numpy as np
    import sqlalchemy as sa

    from campaigns.asked.load import load_document
    from worker.evidence.audit.verify import Run

    tables = sa.MetaData()

    def rows(table: str, order: str, **of: Any) -> list[JsonObject]:
        found = sa.select(sa.Table(table, tables, autoload_with=connection)).filter_by(**of)
        return [dict(row) for row in connection.execute(found.order_by(*map(sa.column, order.split()))).mappings()]

    run = next(iter(rows("runs", "id", id=run_id)), None)
    if run is None or run.get("purged") or not run["verdict"]:
        raise ValueError("there is no such run" if run is None else "it was purged, or has no verdict")
    document = rows("campaigns", "digest", digest=run["campaign_digest"])[0]["document"]
    stages = rows("stages", "position", run_id=run_id)
    claims = run["summary"] | {"verdict": run["verdict"], "digest": run["campaign_digest"], "stages": stages}
    claims |= {"findings": rows("findings", "cost label", run_id=run_id), "results": [s["result"] for s in stages]}
    claims |= {"comparison": (stages[-1]["result"] or {}).get("comparison", [])}
    for kept in rows("catalogue_snapshots", "digest", digest=run["snapshot"]) if run.get("snapshot") else []:
        claims["components"] = kept["document"]
    chunks = rows("evaluation_chunks", "position first", run_id=run_id)
    stage = np.repeat(*(np.array([chunk[k] for chunk in chunks], dtype=np.int64) for k in ("position", "count")))
    points, costs, status = (b"".join(chunk[name] for chunk in chunks) for name in _COLUMNS)
    wide, costly = (np.frombuffer(column, "<f8").reshape(len(stage), -1) for column in (points, costs))
    flaky = sum(_flaky(np.frombuffer(c["status"], np.uint8), c["reasons"] or {}, c["first"]) for c in chunks)
    return Run(load_document(document), claims, stage, wide, costly, np.frombuffer(status, np.uint8), flaky)


_COLUMNS = ("points", "costs", "status")


def _flaky(status: Any, reasons: Mapping[str, str], first: int = 0) -> int:
    """How many of these evaluations are ok, but only because a call that had failed was tried again."""
    again = [int(row) - first for row, why in reasons.items() if why.startswith("succeeded when tried again")]
    return sum(0 <= row < len(status) and int(status[row]) == 0 for row in again)
