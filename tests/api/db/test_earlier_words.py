"""Runs stored by earlier versions with plain sentences: unchanged text, formatted symbols and units.

`stored/revision-0010.sqlite3.gz` was written by the code of that revision: case 1 with a step of 0.01 s, certify,
Morris and Sobol; R-0001 is violated, R-0002 inconclusive.
"""

from __future__ import annotations

import gzip
import json
import sqlite3
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from pydantic import TypeAdapter

from backend.db.digest import results_digest
from backend.db.engine import connect, default_url, migrate, read
from backend.settings import Settings
from campaigns.claims.spans import Spans, words
from tests.audited import audited
from tests.given.service import Service
from worker.evidence.audit.record import SEAL

STORED = Path(__file__).parents[1] / "stored"
SPANS: TypeAdapter[Spans] = TypeAdapter(Spans)
DIGESTS = {
    1: "f02f52cd80d2834df88b8c56ca1881238204d3216d629829a291d1e74a2081b1",
    2: "e6b6564ac87df296b5e5db7fbfe44f0859c1164e755c201dedb25f00c8b66df5",
}
"""Of the results, by the code that wrote them."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("words")
    stored = gzip.decompress((STORED / "revision-0010.sqlite3.gz").read_bytes())
    (folder / "clearance.sqlite3").write_bytes(stored)
    return folder


@pytest.fixture(scope="module")
def rows(folder: Path) -> dict[str, dict[str, Any]]:
    """The stored rows of each run."""
    with sqlite3.connect(folder / "clearance.sqlite3") as connection:
        found: dict[str, dict[str, Any]] = {}
        for run_id, summary, reason in connection.execute("select id, summary, reason from runs").fetchall():
            results = "select result from stages where run_id = ? order by position"
            stages = [json.loads(row[0]) for row in connection.execute(results, (run_id,)).fetchall()]
            boundaries = "select label, boundary from findings where run_id = ?"
            findings = {label: json.loads(b or "null") for label, b in connection.execute(boundaries, (run_id,))}
            known = {"summary": json.loads(summary), "reason": reason, "stages": stages, "findings": findings}
            found[f"R-{run_id:04d}"] = known
    return found


@pytest.fixture(scope="module")
def client(folder: Path, rows: dict[str, Any]) -> Iterator[httpx.Client]:
    migrate(default_url(folder))
    service = Service(Settings(data=folder, pages=folder / "dist"))
    service.start()
    with service.signed_in() as client:
        yield client
    service.stop()


def texts(stored: Any, found: list[str]) -> list[str]:
    """Every sentence of a stored result, in order."""
    if isinstance(stored, dict):
        for key, value in sorted(stored.items()):
            if key == "text" and isinstance(value, str):
                found.append(value)
            elif key not in ("statement", "holds_for", "limit"):
                texts(value, found)
    elif isinstance(stored, list):
        for item in stored:
            texts(item, found)
    return found


def sentences(answer: Any, found: list[str]) -> list[str]:
    """The plain words of every sentence of an answer, each of which its spans give."""
    if isinstance(answer, dict):
        for key, value in sorted(answer.items()):
            if key == "text" and isinstance(value, str) and "statement" in answer:
                assert words(SPANS.validate_python(answer["statement"])) == value
                found.append(value)
            elif key not in ("statement", "holds_for", "limit"):
                sentences(value, found)
    elif isinstance(answer, list):
        for item in answer:
            sentences(item, found)
    return found


@pytest.mark.parametrize("run", ["R-0001", "R-0002"])
def test_every_sentence_keeps_its_words(run: str, client: httpx.Client, rows: dict[str, dict[str, Any]]) -> None:
    before, detail = rows[run], client.get(f"/api/v1/runs/{run}").json()
    verdict = detail["summary"]
    assert (verdict["sentence"], verdict["scope"]) == (before["summary"]["sentence"], before["summary"]["scope"])
    assert detail["reason"] == before["reason"]
    assert words(SPANS.validate_python(verdict["statement"])) == before["summary"]["sentence"]
    assert f"Scope: {words(SPANS.validate_python(verdict['holds_for']))}" == before["summary"]["scope"]
    assert [(c["name"], c["text"]) for c in verdict["checks"]] == [
        (c["name"], c["text"]) for c in before["summary"]["checks"]
    ]
    stages = [stage["result"] for stage in client.get(f"/api/v1/runs/{run}/stages").json()]
    assert sentences(stages, []) == texts(before["stages"], [])
    assert len(sentences(stages, [])) > 8
    for finding in client.get(f"/api/v1/runs/{run}/findings").json():
        stored = before["findings"][finding["label"]]
        assert (finding["boundary"] or {}).get("text") == (stored or {}).get("text")


def test_symbols_and_units_are_set_as_before(client: httpx.Client) -> None:
    verdict = client.get("/api/v1/runs/R-0001").json()["summary"]
    spans = [*verdict["statement"], *verdict["holds_for"]]
    assert {"kind": "symbol", "name": "d_min", "symbol": "d_min"} in spans
    assert {"kind": "symbol", "name": "vehicle.m", "symbol": "m"} in spans
    assert {"kg", "kg m2", "m", "s"} <= {span["unit"] for span in spans if span["kind"] == "quantity"}
    report = client.get("/api/v1/runs/R-0001/report.html").text
    assert '<i class="v">d</i><sub>min</sub> falls to or below 0.943\u202fm. ' in report
    assert '<i class="v" title="vehicle.m">m</i> 4 to 6\u202fkg, <i class="v" title="vehicle.J">J</i>' in report
    assert "0.04 to 0.06\u202fkg·m²; horizon 15\u202fs" in report
    assert "P(violation) is at most 67.6\u202f% with 95\u202f% confidence" in report


def test_the_audit_follows(folder: Path, client: httpx.Client) -> None:
    engine = connect(default_url(folder))
    for run_id in (1, 2):
        names = {item.name for item in audited(engine, run_id=run_id, lacks={"checks.sample", SEAL, "words"})}
        assert {"sentence.worst", "sentence.methods", "sentence.evaluations"} <= names
    engine.dispose()


def test_sign_offs_stay_bound_to_the_results(folder: Path, client: httpx.Client) -> None:
    """Nothing that is stored changes: by the digest of that revision the results are what a reviewer signed."""
    engine = connect(default_url(folder))
    with read(engine) as reader:
        assert {run_id: results_digest(reader, run_id, evidence=False) for run_id in DIGESTS} == DIGESTS
    engine.dispose()
