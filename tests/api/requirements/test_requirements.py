"""The matrix of requirements and runs: what is evidence, what makes it suspect; import and export; who may."""

from __future__ import annotations

import csv
import gzip
import hashlib
import io
import json
import os
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import httpx
import pytest
import sqlalchemy as sa
import yaml

from backend.db import purge
from backend.db.rows import made_again, plain
from backend.db.tables import Audit, CatalogueDocument, Run, Stage, SweepRun
from backend.db.tables import Finding as FindingRow
from backend.requirements import uploads
from backend.signoffs.texts import OTHER_TEXT
from campaigns.results import Finding, ValidateResult
from campaigns.results.finding import Calls
from campaigns.results.validate import SpotChecks
from campaigns.runs import run_number
from tests.given.at_night import nightly_but
from tests.given.code_versions import CODE, OTHER, edited
from tests.given.databases import AT_NIGHT
from tests.given.joined_users import joined
from tests.given.problem_documents import problem
from tests.given.reported_runs import finding, finish_fully, validated
from tests.given.requirement_rows import AT, ran, row, sign, stating
from tests.given.row_changes import changed
from tests.given.service import Service, until
from tests.given.small_catalogue import campaign
from tests.given.submissions import submit, swept

WRITTEN = (Path(__file__).parents[1] / "requirements" / "written.reqif").read_bytes()
PUBLIC = os.environ.get("CLEARANCE_REQIF_EXAMPLES", "")
"""A folder of public ReqIF files, see `tests.unit.backend.requirements.test_requirement_files`."""
SHIPPED = Path(__file__).parents[1] / "requirements" / "public"
TOOLS = {
    "polarion.reqif": ({"id_attribute": "IDENTIFIER"}, 58),
    "reqif_studio.reqif": ({"id_attribute": "IDENTIFIER"}, 137),
    "doors.reqif": ({"text_attribute": "_3ca983d9-5ec5-4752-898f-37ab52beafd0"}, 1),
}
"""Files of other tools, with the attributes to name (their ids are anonymous), and how many requirements they have."""
TEXT = "Keep 0.5 m."


def sent(client: httpx.Client, content: bytes, name: str = "a.csv", kind: str = "csv", **more: str) -> httpx.Response:
    return client.post(f"{AT}/files", params={"name": name, "kind": kind, **more}, content=content)


@pytest.mark.nightly
def test_sign_offs_of_runs_that_speak_against_it_are_stated(service: Service, client: httpx.Client) -> None:
    """They need not state the requirement, nor be of a campaign of their own."""
    violating = submit(client)
    finish_fully(service, "violated")
    sign(client, violating)
    ran(service, client, "REQ-1", seed=2)
    variant = submit(client)
    finish_fully(service, "violated")
    swept(client, [1.0, 2.0])
    with service.engine.begin() as writer:
        writer.execute(sa.update(SweepRun).where(SweepRun.value == 1.0).values(run_id=run_number(variant)))
    found = {one["id"]: one for one in row(client, "REQ-1")["runs"]}
    assert (found[violating]["part"], found[violating]["signed"]) == ("violation", True)
    lines = csv.DictReader(io.StringIO(client.get(f"{AT}/export/matrix.csv").text))
    signed = {line["run"]: (line["signed"], line["signed_by"][:12]) for line in lines}
    assert signed[violating] == ("yes", "Grace Hopper")
    assert (found[variant]["part"], found[variant]["changes"]) == ("violation", []), "it is compared with no campaign"


@AT_NIGHT
def test_a_requirement_is_met_by_signed_evidence_until_something_changes(
    service: Service, client: httpx.Client
) -> None:
    assert client.get(AT).json() == {"items": [], "next_cursor": None, "total": 0, "compared": True}
    assert sent(client, f"id,text\nREQ-1,{TEXT}\nREQ-2,Arrive.\n".encode()).status_code == 201
    assert [(one["id"], one["status"], one["runs"]) for one in client.get(AT).json()["items"]] == [
        ("REQ-1", "no evidence", []),
        ("REQ-2", "no evidence", []),
    ]
    run = submit(client, criterion=stating({"id": "REQ-1", "text": TEXT}))
    assert row(client, "REQ-1")["status"] == "no verdict"
    finish_fully(service)
    assert row(client, "REQ-1")["status"] == "unsigned"
    sign(client, run)
    met = row(client, "REQ-1")
    assert met["status"] == "met", met["sentence"]
    (edge,) = met["runs"]
    assert (edge["id"], edge["verdict"], edge["part"], edge["signed"], edge["suspect"]) == (
        run, "cleared", "evidence", True, False,
    )  # fmt: skip
    assert edge["margin"] == pytest.approx(0.8)
    assert (edge["signoffs"][0]["name"], edge["signoffs"][0]["own"]) == ("Grace Hopper", True)
    assert edge["campaign_digest"] == client.get(f"/api/v1/runs/{run}").json()["campaign_digest"]
    with changed(service.engine, sa.update(CatalogueDocument).values(document=edited())):
        suspect = row(client, "REQ-1")
        assert (suspect["status"], suspect["runs"][0]["suspect"]) == ("suspect", True)
        (change,) = suspect["runs"][0]["changes"]
        assert change in suspect["sentence"]
        assert f" {CODE.digest[:12]}, here it is {OTHER.digest[:12]}" in change
    assert row(client, "REQ-1")["status"] == "met"
    with changed(service.engine, sa.update(FindingRow).values(cost=1.2999999999999998)):
        assert row(client, "REQ-1")["status"] == "unsigned", "the sign-off is of other results"
    with changed(service.engine, sa.update(Run).values(flown=None)):
        unknown = row(client, "REQ-1")
        assert (unknown["status"], len(unknown["runs"][0]["changes"])) == ("suspect", 1)
    assert client.put(AT, json={"id": "REQ-1", "text": "Keep 0.6 m."}).status_code == 200
    assert row(client, "REQ-1")["runs"][0]["changes"] == [OTHER_TEXT]


def test_a_newer_campaign_makes_a_sign_off_suspect_and_its_verdict_counts(
    service: Service, client: httpx.Client
) -> None:
    sign(client, ran(service, client, "REQ-1"))
    assert row(client, "REQ-1")["status"] == "met"
    submit(client, criterion=stating("REQ-1", threshold=0.6))
    (change,) = row(client, "REQ-1")["runs"][0]["changes"]
    assert change.endswith(" R-0002")
    finish_fully(service, "violated")
    found = row(client, "REQ-1")
    assert (found["status"], [one["part"] for one in found["runs"]]) == ("violated", ["violation", "other"])
    sign(client, ran(service, client, "REQ-1"))
    found = row(client, "REQ-1")
    assert found["status"] == "met"
    assert "lowered since, R-0002 " in found["sentence"]


@pytest.mark.nightly
def test_a_violation_is_neither_outrun_nor_hidden(service: Service, client: httpx.Client) -> None:
    ran(service, client, "REQ-1", verdict="violated")
    for changes in ({"seed": 2}, {"stages": {"search": [{"method": "direct", "evaluations": 10}]}}):
        sign(client, ran(service, client, "REQ-1", **changes))
        assert row(client, "REQ-1")["status"] == "violated"
    sign(client, ran(service, client, "REQ-1", name="Another"))
    found = row(client, "REQ-1")
    assert (found["status"], [one["part"] for one in found["runs"]]) == (
        "violated", ["evidence", "evidence", "violation", "other"],
    )  # fmt: skip
    client.delete("/api/v1/runs/R-0001", params={"reason": "wrong bounds"})
    found = row(client, "REQ-1")
    assert (found["status"], found["removed"], found["total"]) == ("met", 1, 3)
    assert " R-0001 " in found["sentence"]


@pytest.mark.nightly
@AT_NIGHT
def test_a_run_that_is_no_evidence_can_still_speak_against_it(service: Service, client: httpx.Client) -> None:
    """Cancelled, with the requirement left out, of a sweep, or with another threshold; and no goal is supported."""
    ran(service, client)
    sign(client, ran(service, client, "REQ-1", seed=2))
    assert row(client, "REQ-1")["status"] == "met"
    first = sa.update(Run).where(Run.id == 1)
    with changed(service.engine, first.values(state="cancelled", verdict=None, worst_cost=0.5)):
        found = row(client, "REQ-1")
        assert (found["status"], found["total"]) == ("inconclusive", 1), found["sentence"]
        assert [(one["id"], one["part"]) for one in found["runs"]] == [("R-0002", "evidence"), ("R-0001", "violation")]
        assert "threshold" in found["runs"][1]["role"], "it has no verdict that violates"
        argument = yaml.safe_load(client.get(f"{AT}/export/argument.gsn.yaml").text)
        assert not [name for name in argument if name.startswith("Sn-")]
    with changed(service.engine, first.values(verdict="violated")):
        assert row(client, "REQ-1")["status"] == "violated", "it does not state the requirement"
    with changed(service.engine, first.values(verdict="violated", threshold=0.4, worst_cost=0.3)):
        assert row(client, "REQ-1")["status"] == "violated"
    with changed(service.engine, first.values(verdict="violated", threshold=0.9, worst_cost=0.8)):
        assert row(client, "REQ-1")["status"] == "met"


@AT_NIGHT
def test_what_speaks_against_a_requirement_needs_no_verdict_of_its_own_run(
    service: Service, client: httpx.Client
) -> None:
    """A violation of a variant, or of a run that does not state it, and a value that a cancelled run found."""
    ran(service, client)
    run = submit(client, criterion=stating("REQ-1"), seed=2)
    assert row(client, "REQ-1")["status"] == "no verdict"
    other, own = (sa.update(Run).where(Run.id == run_id) for run_id in (1, 2))
    with changed(service.engine, other.values(verdict="violated", worst_cost=0.3)):
        found = row(client, "REQ-1")
        assert (found["status"], [one["part"] for one in found["runs"]]) == ("violated", ["evidence", "violation"])
        assert ("R-0001 violates it" in found["sentence"], run in found["sentence"]) == (True, True)
    with changed(service.engine, other.values(state="cancelled", verdict=None, worst_cost=0.5)):
        assert row(client, "REQ-1")["status"] == "inconclusive"
    with changed(service.engine, own.values(state="cancelled", worst_cost=0.5)):
        found = row(client, "REQ-1")
        assert found["status"] == "inconclusive", found["sentence"]
        assert [(one["id"], one["part"]) for one in found["runs"]] == [(run, "violation")]
    with changed(service.engine, own.values(state="cancelled", worst_cost=0.6)):
        assert row(client, "REQ-1")["status"] == "no verdict"


@pytest.mark.nightly
@AT_NIGHT
def test_what_only_the_first_evaluations_found_counts_and_outlives_a_purge(
    service: Service, client: httpx.Client
) -> None:
    """A violation of the nominal case or the sensitivity study, of a run that was cancelled before any search."""
    sign(client, ran(service, client, "REQ-1"))
    assert row(client, "REQ-1")["status"] == "met"
    submit(client, seed=2)
    with service.engine.begin() as writer:
        values = {"run_id": 2, "position": 0, "kind": "nominal", "planned": 1, "evaluations": 1, "best": 0.4}
        writer.execute(sa.insert(Stage).values(**values))
        writer.execute(sa.update(Run).where(Run.id == 2).values(state="cancelled", finished=1.0))
    assert row(client, "REQ-1")["status"] == "inconclusive"
    assert client.delete("/api/v1/runs/R-0002", params={"reason": "A trial."}).status_code == 200
    named = "R-0002 found a value"
    assert named in row(client, "REQ-1")["sentence"]
    assert purge.purge(service.engine, 2, 0.0, "operator")
    assert named in row(client, "REQ-1")["sentence"]


@pytest.mark.nightly
def test_a_value_that_only_validation_saw_counts_and_outlives_a_purge(service: Service, client: httpx.Client) -> None:
    """In a call, at half the step, by the reference integrator or in a spot check, of a run of any verdict."""
    calls = Calls(values=[0.9, 0.4], violating=1, failed=0, confidence=0.95, low=0.0, high=1.0, statement=())
    spot = SpotChecks(
        checked=1, compared=1, largest=0.5, median=0.5, violating=1, lowest_reference=0.4, at=None, statement=()
    )
    case = finding().validation
    assert case is not None
    seen: list[tuple[ValidateResult, list[Finding]]] = [
        (validated().model_copy(update={"nominal": case.model_copy(update={"repeats": calls})}), []),
        (validated().model_copy(update={"spot_checks": spot}), []),
        (validated(), [finding().model_copy(update={"validation": case.model_copy(update={"repeats": calls})})]),
    ]
    sign(client, ran(service, client, "REQ-1"))
    submit(client, seed=2)
    for result, findings in seen:
        assert row(client, "REQ-1")["status"] == "suspect", "a newer campaign has no verdict yet"
        with service.engine.begin() as writer:
            made_again(writer, 2, result, findings)
            writer.execute(sa.update(Run).where(Run.id == 2).values(state="cancelled", finished=1.0))
        assert row(client, "REQ-1")["status"] == "inconclusive"
        unconfirmed = client.get("/api/v1/runs/R-0002").json()["unconfirmed"]
        assert [span["value"] for span in unconfirmed if span["kind"] == "quantity"] == [0.4, 0.5]
        with service.engine.begin() as writer:
            writer.execute(sa.update(Run).where(Run.id == 2).values(made_again=None, worst_cost=None))
    with service.engine.begin() as writer:  # by a worker of an earlier version, which keeps no such value
        ended = {"kind": "validate", "state": "done", "planned": 1, "result": plain(seen[0][0])}
        writer.execute(sa.insert(Stage).values(run_id=2, position=9, **ended))
    assert row(client, "REQ-1")["status"] == "inconclusive"
    with service.engine.begin() as writer:
        writer.execute(sa.update(Run).where(Run.id == 2).values(state="done", verdict="inconclusive"))
    assert purge.due(service.engine, 0.0) == []
    assert client.delete("/api/v1/runs/R-0002", params={"reason": "A trial."}).status_code == 200
    assert purge.purge(service.engine, 2, 0.0, "operator")
    assert "R-0002 found a value" in row(client, "REQ-1")["sentence"]


def test_variants_of_a_sweep_are_named_where_they_alone_state_a_requirement(client: httpx.Client) -> None:
    swept(client, [1.5, 2.5], campaign=campaign(criterion=stating("REQ-1")))
    found = row(client, "REQ-1")
    assert (found["status"], found["sweeps"]) == ("no evidence", 2)
    assert "variants of sweeps" in found["sentence"]


@pytest.mark.nightly
def test_the_text_of_a_requirement_is_that_of_runs_that_count(service: Service, client: httpx.Client) -> None:
    sign(client, ran(service, client, {"id": "REQ-1", "text": TEXT}))
    better = submit(client, name="Z", criterion=stating({"id": "REQ-1", "text": "Keep 50 m."}))
    finish_fully(service)
    sign(client, better)
    found = row(client, "REQ-1")
    assert (found["text"], found["status"]) == ("Keep 50 m.", "suspect")
    assert OTHER_TEXT in found["sentence"]
    with changed(service.engine, sa.update(Run).where(Run.id == 2).values(removed=1.0)):
        assert (row(client, "REQ-1")["text"], row(client, "REQ-1")["status"]) == (TEXT, "met")


def test_ids_that_look_the_same_name_each_other(service: Service, client: httpx.Client) -> None:
    sign(client, ran(service, client, "REQ-1"))
    ran(service, client, "req\u20111", verdict="violated", name="Z")
    assert client.put(AT, json={"id": "REQ-10", "text": TEXT}).status_code == 200
    assert "form of characters: 'req\u20111'." in row(client, "REQ-1")["sentence"]
    assert "form of characters: 'REQ-1'." in row(client, "req\u20111")["sentence"]
    assert "form of characters" not in row(client, "REQ-10")["sentence"]


def test_a_trend_names_the_requirements_of_each_run(client: httpx.Client) -> None:
    submit(client)
    submit(client, criterion=stating("REQ-2", "REQ-1"))
    runs = client.get("/api/v1/trends", params={"name": campaign()["name"]}).json()["runs"]
    assert [one["requirements"] for one in runs] == [[], ["REQ-1", "REQ-2"]]


def test_report_and_run_name_their_requirements(service: Service, client: httpx.Client) -> None:
    run = ran(service, client, {"id": "REQ-1", "text": "Keep <0.5> m."}, "REQ-2")
    text = client.get(f"/api/v1/runs/{run}/report.html").text
    assert 'id="requirements"' in text
    assert '<td class="b">REQ-1</td><td>Keep &lt;0.5&gt; m.</td>' in text
    assert "not given" in text
    assert client.get(f"/api/v1/runs/{run}").json()["campaign"]["criterion"]["requirements"][1] == {"id": "REQ-2"}
    without = ran(service, client)
    assert 'id="requirements"' not in client.get(f"/api/v1/runs/{without}/report.html").text


@pytest.mark.nightly
def test_a_run_of_a_sweep_is_no_evidence_and_changes_nothing(service: Service, client: httpx.Client) -> None:
    sign(client, ran(service, client, "REQ-1"))
    asked = campaign(criterion=stating("REQ-1"))
    body = {"campaign": asked, "path": "avoider.d_0", "values": [1.0, 2.0]}
    assert client.post("/api/v1/sweeps", json=body).status_code == 201
    finish_fully(service, "violated")
    found = row(client, "REQ-1")
    assert (found["status"], found["sweeps"], found["total"]) == ("met", 2, 1)


@pytest.mark.nightly  # by day texts that are changed one by one: tests/api/signoffs/test_standing.py
def test_a_requirement_without_text_in_its_campaign_is_that_of_the_sign_off(
    service: Service, client: httpx.Client
) -> None:
    sent(client, b"id,text\nREQ-1,Keep clear.\n")
    sign(client, ran(service, client, "REQ-1"))
    assert row(client, "REQ-1")["status"] == "met"
    sent(client, b"id,text\nREQ-1,Keep clear.\n")
    assert row(client, "REQ-1")["status"] == "met", "imported again with the same text"
    sent(client, b"id,text\nREQ-1,Keep very clear.\n")
    assert row(client, "REQ-1")["status"] == "suspect"


@AT_NIGHT
def test_a_reqif_file_is_written_back_byte_by_byte(client: httpx.Client) -> None:
    """Those of other tools, see `requirements/public/README.md`, and those of a folder."""
    files: dict[str, tuple[bytes, dict[str, str], int]] = {"written.reqif": (WRITTEN, {}, 2)}
    for name, (named, count) in TOOLS.items():
        files[name] = gzip.decompress((SHIPPED / f"{name}.gz").read_bytes()), named, count
    for name, (content, named, count) in files.items():
        answer = sent(client, content, name, "reqif", **named)
        assert answer.status_code == 201, answer.text
        assert len(answer.json()["added"]) == count
        written_back(client, answer, name, content)
    for name, (named, _) in TOOLS.items():  # without those attributes the sentence says how
        assert any(value in str(problem(sent(client, files[name][0], name, "reqif"), 422)) for value in named.values())


@pytest.mark.skipif(not PUBLIC, reason="CLEARANCE_REQIF_EXAMPLES names no folder")
def test_public_reqif_files_are_written_back_byte_by_byte(client: httpx.Client) -> None:
    taken = 0
    for file in sorted(Path(PUBLIC).rglob("*.reqif"))[:40]:
        answer = sent(client, file.read_bytes(), "x.reqif", "reqif")
        if answer.status_code == 201:
            written_back(client, answer, "x.reqif", file.read_bytes())
            taken += 1
        else:
            problem(answer, 422)
    assert taken > 5


def written_back(client: httpx.Client, answer: httpx.Response, name: str, content: bytes) -> None:
    file = answer.json()["file"]
    again = client.get(f"{AT}/files/{file['id']}/content")
    assert again.content == content
    assert name in again.headers["content-disposition"]
    assert client.delete(f"{AT}/files/{file['id']}").status_code == 204


def test_an_import_states_what_it_has_done_and_replaces_its_earlier_file(
    service: Service, client: httpx.Client
) -> None:
    first = sent(client, WRITTEN, "sys.reqif", "reqif").json()
    assert (first["added"], first["changed"], first["gone"], first["skipped"]) == (["SYS-1", "SYS-2"], [], [], 1)
    second = sent(
        client, WRITTEN.replace(b"60 s", b"50 s").replace(b'"SYS-1"', b'"SYS-3"'), "sys.reqif", "reqif"
    ).json()
    assert (second["added"], second["changed"], second["gone"]) == (["SYS-3"], ["SYS-2"], ["SYS-1"])
    (file,) = client.get(f"{AT}/files").json()
    assert (file["id"], file["requirements"], file["kind"]) == (first["file"]["id"], 2, "reqif")
    assert [one["id"] for one in client.get(AT).json()["items"]] == ["SYS-2", "SYS-3"]
    assert row(client, "SYS-3")["attributes"] == {"Level": "DAL A, DAL B"}
    for refused in (
        client.put(AT, json={"id": "SYS-2", "text": "x"}),
        client.delete(AT, params={"requirement": "SYS-2"}),
    ):
        assert "sys.reqif" in str(problem(refused, 409)["detail"])
    assert client.delete(f"{AT}/files/{file['id']}").status_code == 204
    problem(client.get(f"{AT}/files/{file['id']}/content"), 404)
    assert client.get(AT).json()["total"] == 0
    with service.engine.connect() as reader:
        actions = reader.execute(sa.select(Audit.action, Audit.detail).where(Audit.action.startswith("req"))).all()
    assert [action for action, _ in actions] == ["requirements.imported"] * 2 + ["requirements.deleted"]
    assert actions[1].detail["gone"] == {"count": 1, "ids": ["SYS-1"]}


def test_a_deleted_requirement_that_a_run_violates_stays_a_row(service: Service, client: httpx.Client) -> None:
    assert client.put(AT, json={"id": "REQ-1", "text": TEXT}).json()["registered"] is True
    ran(service, client, {"id": "REQ-1", "text": "Keep 0.4 m."}, verdict="violated")
    assert client.delete(AT, params={"requirement": "REQ-1"}).status_code == 204
    problem(client.delete(AT, params={"requirement": "REQ-1"}), 404)
    left = row(client, "REQ-1")
    assert (left["status"], left["registered"], left["text"]) == ("violated", False, "Keep 0.4 m.")


UNACCEPTABLE = [
    (b"id,text\nA,x\nA,y\n", "csv", "the id 'A' occurs more than once"),
    (b"id,text\n" + b"a" * 121 + b",x\n", "csv", "at most 120 characters"),
    (b"id,text\nA," + b"x" * 20_001 + b"\n", "csv", "at most 20000 characters"),
    (b"id,text\nA,x\x07\n", "csv", "without control characters"),
    (b"<!DOCTYPE x><REQ-IF/>", "reqif", "document type declaration"),
    (WRITTEN, "csv", "no column for the id"),
]
"""By day one of each kind of file; what is acceptable in a file is tested with its readers."""


@pytest.mark.by_day(1)
@pytest.mark.parametrize("file", nightly_but(UNACCEPTABLE[3:5], UNACCEPTABLE), ids=lambda v: v[2])
def test_a_file_that_is_not_acceptable_changes_nothing(guest: httpx.Client, file: tuple[bytes, str, str]) -> None:
    content, kind, statement = file
    assert statement in str(problem(sent(guest, content, kind=kind), 422)["detail"])
    assert guest.get(f"{AT}/files").json() == []


def test_a_file_that_is_too_large_is_refused(guest: httpx.Client) -> None:
    refused = problem(sent(guest, b"x" * 8_000_001), 413)
    assert "at most 8,000,000 bytes" in str(refused["detail"])
    problem(guest.post("/api/v1/campaigns/check", content=b"x" * 2_000_001), 413)


@pytest.mark.nightly
def test_exports_have_every_requirement_and_run(service: Service, client: httpx.Client) -> None:
    sent(client, WRITTEN, "sys.reqif", "reqif")
    sign(client, ran(service, client, "SYS-1", "OTHER"))
    wider = {"vehicle.m": {"plus_minus": "30%"}}
    ran(service, client, "OTHER", name="Second", verdict="violated", uncertain=wider)
    answer = client.get(f"{AT}/export/matrix.csv")
    assert answer.headers["content-disposition"] == 'attachment; filename="matrix.csv"'
    lines = list(csv.DictReader(io.StringIO(answer.text)))
    assert [(line["requirement"], line["status"], line["run"], line["verdict"], line["signed"]) for line in lines] == [
        ("OTHER", "violated", "R-0002", "violated", "no"),
        ("OTHER", "violated", "R-0001", "cleared", "yes"),
        ("SYS-1", "met", "R-0001", "cleared", "yes"),
        ("SYS-2", "no evidence", "", "", ""),
    ]
    assert lines[0]["campaign_sha256"] == client.get("/api/v1/runs/R-0002").json()["campaign_digest"]
    listed = list(csv.DictReader(io.StringIO(client.get(f"{AT}/export/requirements.csv").text)))
    assert [line["id"] for line in listed] == ["OTHER", "SYS-1", "SYS-2"]
    assert listed[1]["Level"] == "DAL A, DAL B"
    argument = yaml.safe_load(client.get(f"{AT}/export/argument.gsn.yaml").text)
    goals = [argument[name] for name in argument["S-all-requirements"]["supportedBy"]]
    assert [goal["status"] for goal in goals] == ["violated", "met", "no evidence"]
    (solution,) = [node for name, node in argument.items() if name.startswith("Sn-")]
    run = client.get("/api/v1/runs/R-0001").json()
    assert (solution["claim"], solution["digest"]) == (run["reason"], f"sha256 {run['campaign_digest']}")
    assert client.get(solution["url"].replace("/runs/", "/api/v1/runs/")).status_code == 200
    again = client.get(f"{AT}/export/requirements.reqif").content
    refused = problem(sent(client, again, "again.reqif", "reqif"), 409)
    assert "such as SYS-1 from sys.reqif" in str(refused["detail"])
    assert sent(client, again, "sys.reqif", "reqif").json()["unchanged"] == 2


@pytest.mark.nightly
def test_pages_by_id_and_words(client: httpx.Client) -> None:
    lines = "".join(f"R%{i},Text {i} é\n" for i in range(7))
    sent(client, f"id,text\n{lines}".encode())
    found, cursor = [], None
    while True:
        page = client.get(AT, params={"limit": 3} | ({"cursor": cursor} if cursor else {})).json()
        assert page["total"] == 7
        found += [one["id"] for one in page["items"]]
        cursor = page["next_cursor"]
        if cursor is None:
            break
    assert found == [f"R%{i}" for i in range(7)]
    assert [one["id"] for one in client.get(AT, params={"q": "text R%3"}).json()["items"]] == ["R%3"]
    for bad in ("zz", "00"):
        problem(client.get(AT, params={"cursor": bad}), 422)


@pytest.mark.nightly
def test_viewers_read_and_engineers_change(still: Service, guest: httpx.Client) -> None:
    with joined(still, guest, "viewer") as (_, viewer), joined(still, guest, "engineer") as (_, engineer):
        assert viewer.get(AT).status_code == 200
        assert viewer.get(f"{AT}/export/matrix.csv").status_code == 200
        problem(sent(viewer, b"id,text\nA,x\n"), 403)
        problem(viewer.put(AT, json={"id": "A", "text": "x"}), 403)
        file = sent(engineer, b"id,text\nA,x\n").json()["file"]
        problem(viewer.delete(f"{AT}/files/{file['id']}"), 403)
        assert engineer.delete(f"{AT}/files/{file['id']}").status_code == 204


def test_a_text_that_somebody_else_has_changed_is_not_overwritten(client: httpx.Client) -> None:
    """Nor deleted; without the header as in earlier versions."""

    def put(text: str, **headers: str) -> httpx.Response:
        return client.put("/api/v1/requirements", json={"id": "MATCH-1", "text": text}, headers=headers)

    read = put("first").headers["etag"]
    (row,) = client.get("/api/v1/requirements", params={"q": "MATCH-1"}).json()["items"]
    assert row["etag"] == read
    changed = put("second", **{"If-Match": read})
    assert (changed.status_code, changed.headers["etag"]) == (200, changed.json()["etag"])
    gone = client.delete("/api/v1/requirements", params={"requirement": "MATCH-1"}, headers={"If-Match": read})
    for refused in (put("third", **{"If-Match": read}), gone):
        assert "MATCH-1 " in str(problem(refused, 412, "changed")["detail"])
    assert put("third").json()["text"] == "third"
    now = {"If-Match": put("third").headers["etag"]}
    assert client.delete("/api/v1/requirements", params={"requirement": "MATCH-1"}, headers=now).status_code == 204


def test_the_trail_has_digests_and_differences_instead_of_texts(service: Service, client: httpx.Client) -> None:
    long = "Keep 0.5 m. " * 1500
    for text in (long, long + "Keep 0.4 m."):
        assert client.put(AT, json={"id": "R-1", "text": text}).status_code == 200
    assert client.delete(AT, params={"requirement": "R-1"}).status_code == 204
    with service.engine.connect() as reader:
        rows = dict(reader.execute(sa.select(Audit.action, Audit.detail)).all())
    changed = rows["requirement.changed"]
    assert changed["before"]["characters"] == len(long)
    assert changed["text"]["sha256"] == hashlib.sha256((long + "Keep 0.4 m.").encode()).hexdigest()
    assert "Keep 0.4 m." in changed["difference"]
    assert all(len(json.dumps(rows[f"requirement.{done}"])) < 1200 for done in ("added", "changed", "deleted"))


def test_files_have_a_queue_of_their_own(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """A launch does not wait for them."""
    go, waits = tmp_path / "go", "import pathlib, sys, threading as t\nwhile not pathlib.Path(sys.argv[1]).exists(): "
    end = 't.Event().wait(0.02)\nprint(\'{"refused": "strange"}\')'
    monkeypatch.setattr(uploads, "READER", (sys.executable, "-c", waits + end, str(go)))
    imports = service.app.state.capacities.imports
    most = (imports.at_once + imports.waiting) // 2
    with ThreadPoolExecutor(most + 1) as threads:
        slow = [threads.submit(sent, client, b"id,text\na,b\n", f"{i}.csv") for i in range(most + 1)]
        until(lambda: imports.inside == most and any(one.done() for one in slow))
        assert submit(client)
        go.touch()
    assert sorted(one.result().status_code for one in slow) == [422] * most + [503]
