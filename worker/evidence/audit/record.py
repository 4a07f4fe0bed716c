"""A stored run, from a folder or a database: its campaign, all evaluations, and the claims of its record.

Data that the version of the run did not store are absent from the claims.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import sqlalchemy as sa

from campaigns import Campaign, CampaignError, Catalogue, load_file
from campaigns.asked.load import load_document
from campaigns.asked.regression import Baseline
from campaigns.asked.scenario import Repeats
from campaigns.checked.check import parameters
from campaigns.checked.question import question
from campaigns.claims.earlier import throughout
from campaigns.documents import JsonObject, digest_of
from campaigns.refusals import Refusal, RefusalCode
from campaigns.results import earlier
from campaigns.results.base import EXCLUDED, FLAKY, OK
from campaigns.runs import run_name
from campaigns.stored.digest import Rows, evidence_digest
from campaigns.unreadable import UNREADABLE
from campaigns.versions import Versions, undigested
from worker.evidence.audit import files
from worker.evidence.audit.limits import EACH, GRANTED

MALFORMED = (TypeError, ValueError, LookupError, AttributeError, ArithmeticError, AssertionError, StopIteration)
"""How reading a record of another form ends, and judging one by rules that need what it does not have."""


class Missing(str):
    """Why a value cannot be compared."""


MISSING: Any = Missing("not stored by the version that made this run")

SEAL = "evidence_digest"
COLUMNS = ("points", "costs", "status")
FIXED = {"code", "model", "loop", "simulator", "components", "packages", "clearance", "python", "step", "command"}
"""Versions that are the same from the first stage to the last; a run may move to another machine."""


class UnreadableError(Refusal):
    """There is no such run, or it cannot be audited; the message states why."""


class Record(NamedTuple):
    """One run. twice: data stored twice, as stated and as required; for every evaluation the stage (m,), the point of
    the unit cube (m, n), the costs (m, k), and the status (m,): 0 ok, 3 excluded; flaky: how many evaluations are ok
    only because a call was tried again; exclusions: how many were excluded for each reason."""

    campaign: Campaign
    claims: JsonObject
    twice: dict[str, tuple[str, str]]
    stage: Any
    points: Any
    costs: Any
    status: Any
    flaky: Any = MISSING
    exclusions: Mapping[str, int] = {}


def flaky(status: Any, reasons: Mapping[Any, str], first: int = 0) -> int:
    """How many of these evaluations (m,), the first of which has this index, are ok with the reason of an earlier
    failure."""
    rows = [int(row) - first for row, why in reasons.items() if why.startswith(FLAKY)]
    return sum(0 <= row < len(status) and status[row] == OK for row in rows)


def exclusions(status: Any, reasons: Mapping[Any, str], first: int = 0) -> Counter[str]:
    """How many of these evaluations (m,), the first of which has this index, are excluded for each reason."""
    by_row = {int(row) - first: why for row, why in reasons.items()}
    return Counter(by_row.get(row, "") for row in np.flatnonzero(status == EXCLUDED).tolist())


def of_folder(folder: Path) -> Record:
    """The run that `clearance run --out` wrote; raises `UnreadableError` and `CampaignError`."""
    try:
        claims, file = _read(folder / "result.json"), folder / "evidence.json"
        campaign_digest, evidence = claims["digest"], _read(file) if file.exists() else {}
        misplaced = sorted((claims.keys() & files.EVIDENCE) | (evidence.keys() - files.EVIDENCE))
        sealed, raw = claims.pop(SEAL, None), {"result": dict(claims), **evidence}
        claims |= {k: Catalogue.model_validate(v) if k == "components" else v for k, v in evidence.items()}
        if {"stages", "findings"} <= claims.keys():  # without them it is not a record, which the audit reports
            kinds = [stage["kind"] for stage in claims["stages"]]
            results = earlier.brought_up(kinds, claims.get("results", []), claims["findings"])
            claims["results"], claims["findings"] = results
        with (folder / "evaluations.npz").open("rb") as packed, np.load(packed, allow_pickle=False) as arrays:
            positions = sorted(int(name[7:]) for name in arrays.files if name.startswith("status_"))
            stage = np.repeat(positions, [len(arrays[f"status_{k}"]) for k in positions])
            rows = [np.concatenate([arrays[f"{name}_{k}"] for k in positions]) for name in COLUMNS]
            reasons = {k: _reasons(arrays, k) for k in positions}
            again = sum(flaky(arrays[f"status_{k}"], reasons[k]) for k in positions)
            left_out = sum((exclusions(arrays[f"status_{k}"], reasons[k]) for k in positions), Counter[str]())
            columns = [Rows.of(k, *(arrays[f"{name}_{k}"] for name in COLUMNS)) for k in positions]
        document = _read(folder / "campaign.json")
        twice = {SEAL: (sealed or MISSING, _digest(document, columns, raw) if sealed else MISSING)}
        twice |= {"files.misplaced": (misplaced, [])} if sealed else {}
    except UNREADABLE as error:
        saved = (folder / "run.json").exists() and not (folder / "result.json").exists()  # by `clearance export`
        exported = " (of a run of a service: `clearance audit R-0001 --service URL`)" if saved else ""
        raise UnreadableError(
            f"{folder} is not a readable folder of `clearance run --out`: {error}{exported}"
        ) from None
    campaign = load_file(folder / "campaign.json")
    try:
        twice |= files.compared(folder, claims, campaign, rows, stage, reasons) if sealed else {}
    except UNREADABLE as error:
        raise UnreadableError(f"the files of {folder} are not those of a run: {error}") from None
    twice = {"digests.result": (campaign_digest, campaign.digest), **twice}
    return Record(campaign, throughout(claims), twice, stage, rows[0], rows[1], rows[2], again, left_out)


def of_database(connection: sa.Connection, run_id: int) -> Record:
    """The stored run; raises as `of_folder` does. Tables are read as they are, of any version."""
    try:
        return _of_database(connection, run_id)
    except CampaignError:
        raise
    except sa.exc.NoSuchTableError as error:  # also of a database that no service has used yet
        message = f"{run_name(run_id)} cannot be audited: this database has no table {error}"
        raise UnreadableError(message, RefusalCode.UNREADABLE) from None
    except (LookupError, ValueError, TypeError, sa.exc.NoResultFound) as error:
        message = f"what is stored of {run_name(run_id)} is not of a run: {type(error).__name__}: {error}"
        raise UnreadableError(message, RefusalCode.UNREADABLE) from None


def _of_database(connection: sa.Connection, run_id: int) -> Record:
    from backend.db.digest import EVIDENCE, current_digest  # late: the audit of a folder loads no database

    tables, name = sa.MetaData(), run_name(run_id)

    def rows(table: str, order: str, **of: Any) -> list[JsonObject]:
        found = sa.select(sa.Table(table, tables, autoload_with=connection)).filter_by(**of)
        return [dict(row) for row in connection.execute(found.order_by(*map(sa.column, order.split()))).mappings()]

    run = next(iter(rows("runs", "id", id=run_id)), None)
    if run is None:
        raise UnreadableError(f"{name} cannot be audited: there is no such run in this database", RefusalCode.NO_RUN)
    if run.get("purged") or not run["verdict"]:
        why = "it was purged" if run.get("purged") else f"it is {run['state']} and has no verdict"
        raise UnreadableError(f"{name} cannot be audited: {why}", RefusalCode.NO_VERDICT)
    campaign_row = rows("campaigns", "digest", digest=run["campaign_digest"])[0]
    campaign = load_document(campaign_row["document"], name)
    stages = rows("stages", "position", run_id=run_id)
    claims = run["summary"] | {"run": run, "verdict": run["verdict"], "reason": run["reason"], "stages": stages}
    results, found = [stage["result"] for stage in stages], rows("findings", "cost", run_id=run_id)
    results, found = earlier.brought_up([stage["kind"] for stage in stages], results, found)
    claims |= {"results": results, "findings": found}
    claims["comparison"] = (stages[-1]["result"] or {}).get("comparison", MISSING)
    provenance = run["summary"].get("provenance", {})
    summary, sealed = provenance.get("digest", MISSING), provenance.get(EVIDENCE)
    twice: dict[str, tuple[Any, Any]]
    twice = {f"digests.{k}": (v, campaign.digest) for k, v in (("run", run["campaign_digest"]), ("summary", summary))}
    twice[SEAL] = (MISSING, MISSING) if sealed is None else (sealed, current_digest(connection, run_id))
    flown = run.get("flown") or {}
    if unknown := undigested(flown, begun=True):
        twice["begun"] = (MISSING, Missing(unknown))
    twice |= {f"versions.{k}": (provenance[k], v) for k, v in flown.items() if k in FIXED & provenance.keys()}
    written = Versions.of(flown or provenance).wording or 0
    twice |= _launched(connection, rows, run_id, campaign, written)
    twice["run.summary.verdict"] = (run["summary"].get("verdict", MISSING), run["verdict"])
    for sampled in (result for result in results if result and result.get("drawn_at_launch") is not None):
        drawn = {"seed": sampled.get("seed"), "drawn_at_launch": sampled["drawn_at_launch"]}
        launched = {"seed": run.get("sample_seed"), "drawn_at_launch": not run.get("sample_seed_stated")}
        stored = run.get("sample_seed") is not None or sealed is not None  # earlier versions stored none
        twice |= {f"sample.{k}": (drawn[k], launched[k]) for k in drawn if stored}
    for kept in rows("catalogue_snapshots", "digest", digest=run["snapshot"]) if run.get("snapshot") else []:
        claims["components"] = Catalogue.model_validate(kept["document"])
        twice["components"] = (kept["digest"], digest_of(kept["document"]))
        if run.get("question") is not None:  # earlier versions stored it with the campaign, and computed it otherwise
            twice["question"] = (run["question"], question(campaign, claims["components"]))
    chunks = rows("evaluation_chunks", "position first", run_id=run_id)
    stage = np.repeat(*(np.array([chunk[k] for chunk in chunks], dtype=np.int64) for k in ("position", "count")))
    whole = {name: b"".join(chunk[name] for chunk in chunks) for name in COLUMNS}
    points, costs = (np.frombuffer(whole[k], "<f8").reshape(max(len(stage), 1), -1) for k in ("points", "costs"))
    status = np.frombuffer(whole["status"], np.uint8)
    reasons = [(np.frombuffer(c["status"], np.uint8), c["reasons"] or {}, c["first"]) for c in chunks]
    again, left_out = sum(flaky(*of) for of in reasons), sum((exclusions(*of) for of in reasons), Counter[str]())
    return Record(campaign, throughout(claims), twice, stage, points, costs, status, again, left_out)


def _launched(
    connection: sa.Connection, rows: Callable[..., list[Any]], run_id: int, campaign: Campaign, written: int
) -> dict[str, tuple[Any, Any]]:
    """The baseline of the campaign, and that of the run's launch, as its own run has it now."""
    baseline = campaign.baseline
    known = sa.inspect(connection).has_table("run_baselines")
    launched = next(iter(rows("run_baselines", "run_id", run_id=run_id)), None) if known else None
    if launched is None or baseline is None:
        return {}
    found: dict[str, tuple[Any, Any]] = {"baseline.run": (baseline.run, run_name(launched["baseline"] or 0))}
    other = next(iter(rows("runs", "id", id=launched["baseline"])), None)
    cases = rows("findings", "cost", run_id=launched["baseline"])
    if other is None or not cases:
        return found | {"baseline.cases": (MISSING, Missing("its results were deleted since"))}
    names = ("label", "cost", "point", "parameters")
    stated = sorted([*(getattr(case, name) for name in names), case.called] for case in baseline.cases)
    stored = sorted([*(case[name] for name in names), _called(case, other["threshold"], written)] for case in cases)
    if written >= EACH:
        found |= _there(rows, baseline, other, cases)
    return found | {
        "baseline.digest": (baseline.digest, other["campaign_digest"]),
        "baseline.threshold": (baseline.threshold, other["threshold"]),
        "baseline.cases": (stated, stored),
    }


def _there(
    rows: Callable[..., list[Any]], baseline: Baseline, other: Any, cases: list[Any]
) -> dict[str, tuple[Any, Any]]:
    """The values that the campaign of the baseline's own run did not vary, and the calls of its evaluations and
    findings. One that an earlier version wrote states none of these."""
    there = load_document(rows("campaigns", "digest", digest=other["campaign_digest"])[0]["document"], baseline.run)
    found: dict[str, tuple[Any, Any]] = {}
    if baseline.repeats is not None or there.simulator is None:
        own = there.simulator and (there.simulator.repeats or Repeats(count=1))
        calls = {case.label: case.calls and [case.calls.made, case.calls.low] for case in baseline.cases}
        found["baseline.calls"] = (calls, {case["label"]: _calls(case, other["threshold"]) for case in cases})
        then, now = (each and each.model_dump(mode="json") for each in (baseline.repeats, own))
        found["baseline.repeats"] = (then, now)
    snapshots = rows("catalogue_snapshots", "digest", digest=other["snapshot"]) if other.get("snapshot") else []
    if baseline.fixed is not None and snapshots:
        known = parameters(there, Catalogue.model_validate(snapshots[0]["document"]))
        values = {path: value for path, (_, value) in known.items() if path not in there.uncertain}
        found["baseline.fixed"] = (dict(baseline.fixed), values)
    if baseline.parts is not None:
        found["baseline.parts"] = (dict(baseline.parts), _components(there))
    return found


def _components(campaign: Campaign) -> dict[str, str]:
    """The listed components of a scenario, with what they act on."""
    scenario, found = campaign.scenario, {}
    for name in ("obstacles", "environment", "faults"):
        for i, part in enumerate(getattr(scenario, name, [])):
            on = getattr(part, "on", "")
            found[f"{name}.{i}"] = part.component + (f" on {on}" if on else "")
    return found


def _calls(finding: Any, threshold: float) -> list[Any] | None:
    """How many independent calls were made of a finding, and the values of those that violate."""
    values = ((finding["validation"] or {}).get("repeats") or {}).get("values")
    return None if values is None else [len(values), sorted(v for v in values if v is not None and v <= threshold)]


def _called(finding: Any, threshold: float, written: int) -> float | None:
    """The value of a violation that only independent calls show; before `GRANTED` a baseline did not have it."""
    values = ((finding["validation"] or {}).get("repeats") or {}).get("values") or []
    low = [value for value in values if value is not None and value <= threshold]
    return max(low, default=None) if written >= GRANTED and finding["cost"] > threshold else None


def _read(file: Path) -> Any:
    """The document of a file; raises `ValueError` if a name is stated twice, of which each reader takes another."""

    def once(pairs: list[tuple[str, Any]]) -> Any:
        twice = [name for name, times in Counter(name for name, _ in pairs).items() if times > 1]
        if twice:
            raise ValueError(f"{file.name} states a name twice: {', '.join(twice)}")
        return dict(pairs)

    return json.loads(file.read_text(encoding="utf-8"), object_pairs_hook=once)


def _digest(campaign: Any, columns: list[Rows], documents: Any) -> str:
    try:
        return evidence_digest(digest_of(campaign), columns, documents)
    except ValueError as error:
        return f"none: {error}"


def _reasons(arrays: Any, stage: int) -> dict[str, str]:
    name = f"reasons_{stage}"
    return dict(json.loads(str(arrays[name]))) if name in arrays.files else {}
