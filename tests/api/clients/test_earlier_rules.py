"""That earlier rules cleared a run is stated wherever the run is called cleared, and it answers no new question."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import httpx
import pytest
import sqlalchemy as sa

from backend.db.tables import Run
from backend.runs.reuse import reusable
from backend.webhooks.body import ended
from campaigns import Campaign
from campaigns.claims.wording import CLEARING
from campaigns.results.verdict import by_earlier_rules
from tests.faults.processes import REPOSITORY
from tests.given.databases import AT_NIGHT, POSTGRESQL
from tests.given.requirement_rows import AT, ran, row, sign
from tests.given.service import Service

MARK, SENTENCE = ": earlier rules", by_earlier_rules("R-0001")
FILES = ("junit", "summary", "sarif")


def written(service: Service, version: int | None) -> None:
    """Let the verdict of the run be of this version of the sentences; None: of one that stored none."""
    with service.engine.begin() as writer:
        summary = dict(writer.scalar(sa.select(Run.summary)) or {})
        provenance = {k: v for k, v in summary["provenance"].items() if k != "wording"}
        summary["provenance"] = provenance if version is None else provenance | {"wording": version}
        writer.execute(sa.update(Run).values(summary=summary))


def marked(service: Service, client: httpx.Client) -> dict[str, bool]:
    """Whether each place states it, as a field or a word next to the verdict."""
    with service.engine.connect() as reader:
        message = json.loads(ended(reader, 1, ""))["data"]
    (listed,) = client.get("/api/v1/runs").json()["items"]
    run = client.get("/api/v1/runs/R-0001").json()
    trends = client.get("/api/v1/trends", params={"name": listed["campaign_name"]}).json()
    report = client.get("/api/v1/runs/R-0001/report.html").text
    exported = client.get("/api/v1/runs/R-0001/exports/run.json").json()["run"]
    picture = client.get("/api/v1/runs/R-0001/exports/worst-case.svg").text
    requirement = row(client, "REQ-1")
    return {
        "list": listed["earlier_rules"],
        "run": run["earlier_rules"],
        "sentence of the run": run["rules"] == SENTENCE,
        "trend": trends["runs"][0]["earlier_rules"],
        "report": client.get("/api/v1/reports").json()["items"][0]["earlier_rules"],
        "printed report": f"Cleared{MARK}" in report,
        "sentence of the printed report": SENTENCE in report,
        "requirement": requirement["runs"][0]["earlier_rules"],
        "sentence of the requirement": "earlier version" in requirement["sentence"],
        "matrix": f"cleared{MARK}" in client.get(f"{AT}/export/matrix.csv").text,
        "argument": f"R-0001 is cleared{MARK}" in client.get(f"{AT}/export/argument.gsn.yaml").text,
        "export": exported["earlier_rules"],
        "sentence of the export": exported["rules"] == SENTENCE,
        "picture": f"cleared{MARK}" in picture,
        "webhook": message["earlier_rules"],
    }


VERSIONS = (None, CLEARING - 1, CLEARING)


@AT_NIGHT
def test_every_place_states_that_earlier_rules_cleared_a_run(service: Service, client: httpx.Client) -> None:
    sign(client, ran(service, client, "REQ-1"))
    for version in VERSIONS:
        written(service, version)
        found = marked(service, client)
        assert found == dict.fromkeys(found, version != CLEARING), version


@POSTGRESQL
def test_postgresql_reads_the_version_of_the_rules(service: Service, client: httpx.Client) -> None:
    """As the list and the matrix select it; all other places have it from them."""
    ran(service, client, "REQ-1")
    for version in VERSIONS:
        written(service, version)
        (listed,) = client.get("/api/v1/runs").json()["items"]
        assert listed["earlier_rules"] is (version != CLEARING), version
        assert row(client, "REQ-1")["runs"][0]["earlier_rules"] is (version != CLEARING), version


@pytest.mark.parametrize("verdict", ["violated", "inconclusive"])
def test_other_verdicts_are_not_marked(service: Service, client: httpx.Client, verdict: str) -> None:
    sign(client, ran(service, client, "REQ-1", verdict=verdict))
    written(service, None)
    assert set(marked(service, client).values()) == {False}


@pytest.mark.parametrize("version", [CLEARING - 1, CLEARING])
def test_every_command_states_it(
    service: Service, command: Callable[..., int], tmp_path: Path, capsys: pytest.CaptureFixture[str], version: int
) -> None:
    with service.signed_in() as client:
        ran(service, client, "REQ-1")
    written(service, version)
    files = {name: tmp_path / name for name in FILES}
    assert command("follow", "R-0001", *(part for name in FILES for part in (f"--{name}", files[name]))) == 0
    found = {"follow": capsys.readouterr().out} | {name: file.read_text() for name, file in files.items()}
    assert command("show", "R-0001") == 0
    found["show"] = capsys.readouterr().out
    command("runs")
    assert (MARK in capsys.readouterr().out) == (version < CLEARING)
    assert {k: (MARK in text, SENTENCE in text) for k, text in found.items()} == dict.fromkeys(
        found, (version < CLEARING,) * 2
    )
    passed = found["junit"].count(SENTENCE)
    assert passed == (3 if version < CLEARING else 0), "verdict, criterion and requirement"


@pytest.mark.parametrize(("verdict", "version", "answers"), [
    ("cleared", CLEARING, True), ("cleared", CLEARING - 1, False), ("cleared", None, False), ("violated", None, True),
])  # fmt: skip
def test_what_earlier_rules_cleared_answers_no_new_question(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch, verdict: str, version: int | None,
    answers: bool,
) -> None:  # fmt: skip
    ran(service, client, "REQ-1", verdict=verdict)
    written(service, version)
    monkeypatch.setattr("backend.runs.reuse.same", lambda *_: True)
    campaign = Campaign.model_validate(client.get("/api/v1/runs/R-0001").json()["campaign"])
    with service.engine.connect() as reader:
        assert reusable(reader, campaign) == (1 if answers else None)


def test_what_states_a_verdict_and_what_it_lacks_states_the_rules() -> None:
    schemas = json.loads((REPOSITORY / "frontend" / "openapi.json").read_text(encoding="utf-8"))["components"][
        "schemas"
    ]
    shown = {name: set(schema.get("properties", ())) for name, schema in schemas.items()}
    both = {name for name, fields in shown.items() if {"verdict", "not_sampled"} <= fields}
    assert {name for name in both if "earlier_rules" not in shown[name]} == {"RunVerdict"}, "that has its versions"
