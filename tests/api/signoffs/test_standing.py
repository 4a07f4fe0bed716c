"""What makes a sign-off suspect is stated in every place that shows it, and so is the run that carries it on."""

from __future__ import annotations

from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.catalog.installation import NO_CODE, no_worker
from backend.db import purge
from backend.db.tables import (
    CatalogueDocument,
    EvaluationChunk,
    Finding,
    Requirement,
    Run,
    RunRequirement,
    Signoff,
    Stage,
    Sweep,
    SweepRun,
    Trace,
)
from backend.requirements.standing import ONLY_OWN
from backend.signoffs.present import NOT_STORED, changed_campaign
from backend.signoffs.repeats import OTHER_CODE, OTHER_RESULTS, other_sample
from backend.signoffs.standing import not_carried
from backend.signoffs.texts import CHANGED_TEXT, LATER_TEXT, OTHER_TEXT
from campaigns.identity.identity import Change
from tests.given.at_night import nightly_but
from tests.given.code_versions import CODE, OTHER, VERSIONS, edited
from tests.given.databases import AT_NIGHT
from tests.given.reported_runs import finding, finish_fully
from tests.given.row_changes import changed
from tests.given.service import Service
from tests.given.signed_places import API, PLACES, REQUIREMENT, by_command, on_the_run, ran, sign, word
from tests.given.submissions import submit


@pytest.fixture
def signed(service: Service, client: httpx.Client) -> str:
    """A signed run of a requirement that is met."""
    word(client, "Keep 0.5 m.")
    run = ran(service, client)
    sign(client, run)
    return run


LONG_AGO = 1.7e9
FLOWN = VERSIONS.model_dump(mode="json") | {"code": CODE.digest}
EDITED = sa.update(CatalogueDocument).values(document=edited())
NOTHING = sa.update(CatalogueDocument).values(document={k: v for k, v in edited().items() if k != "code"})
SUSPECT: dict[str, tuple[sa.Update, str]] = {
    "code": (EDITED, Change("engine", CODE.digest, OTHER.digest).text),
    "no worker": (NOTHING, NO_CODE),
    "no live worker": (sa.update(CatalogueDocument).values(published=LONG_AGO), no_worker(LONG_AGO)),
    "code not stored": (sa.update(Run).values(flown=None), NOT_STORED),
    "own component": (
        sa.update(Run).values(flown=FLOWN | {"components": {"a.py": "0"}}),
        Change("components/a.py", "0", "").text,
    ),
    "text": (
        sa.update(Requirement).values(text="Keep 0.6 m."),
        CHANGED_TEXT,
    ),
    "stated text": (
        sa.update(RunRequirement).values(text="Keep 0.4 m."),
        OTHER_TEXT,
    ),
}  # fmt: skip


@pytest.mark.parametrize("cause", nightly_but(("code", "no live worker"), SUSPECT))  # by day one place: tests below
def test_suspect_is_stated_in_every_place(
    service: Service, client: httpx.Client, signed: str, cause: str, capsys: pytest.CaptureFixture[str]
) -> None:
    change, reason = SUSPECT[cause]
    before = client.get(f"{API}/runs/{signed}/exports/run.json").headers["etag"]
    with changed(service.engine, change):
        for place, shown in PLACES.items():
            found = shown(client, signed)
            assert "suspect" in found.lower(), place
            assert reason in found, place
        assert reason in by_command(service, signed, capsys)
        assert client.get(f"{API}/runs/{signed}/exports/run.json").headers["etag"] != before
        assert client.get(f"{API}/requirements").json()["items"][0]["status"] == "suspect"
    for place, shown in PLACES.items():
        found = shown(client, signed)
        assert "of these results" in found, place
        assert "suspect" not in found.lower().replace(",no,", ""), place


def test_a_newer_campaign_is_stated_in_every_place(service: Service, client: httpx.Client, signed: str) -> None:
    submit(client, criterion={"threshold": 0.6, "requirements": [REQUIREMENT]})
    for place, shown in PLACES.items():
        assert changed_campaign(2) in shown(client, signed), place


def test_a_text_that_is_changed_back_is_the_signed_one(service: Service, client: httpx.Client, signed: str) -> None:
    """And one that is no longer registered is not: the campaign states none."""
    word(client, "Keep 0.6 m.")
    assert CHANGED_TEXT in on_the_run(client, signed)
    sign(client, signed, "Ada Lovelace")
    assert [one["standing"] for one in client.get(f"{API}/runs/{signed}/signoffs").json()["items"]] == [
        "suspect", "standing",
    ]  # fmt: skip
    assert client.get(f"{API}/requirements").json()["items"][0]["status"] == "met", "one sign-off is valid"
    word(client, " Keep  0.5 m.")
    assert [one["standing"] for one in client.get(f"{API}/runs/{signed}/signoffs").json()["items"]] == [
        "standing", "suspect",
    ]  # fmt: skip
    assert client.get(f"{API}/requirements").json()["items"][0]["status"] == "met"
    assert client.delete(f"{API}/requirements", params={"requirement": REQUIREMENT}).status_code == 204
    assert client.get(f"{API}/requirements").json()["items"][0]["status"] == "suspect"


def test_a_text_that_was_not_signed_is_suspect_though_the_campaign_states_it(
    service: Service, client: httpx.Client
) -> None:
    """The registered text was another one when it was signed, and is that of the campaign since."""
    word(client, "Keep 5 m.")
    run = submit(client, criterion={"threshold": 0.5, "requirements": [{"id": REQUIREMENT, "text": "Keep 0.5 m."}]})
    finish_fully(service)
    sign(client, run)
    assert f"{REQUIREMENT}: {OTHER_TEXT}" in on_the_run(client, run)
    word(client, "Keep 0.5 m.")
    assert f"{REQUIREMENT}: {CHANGED_TEXT}" in on_the_run(client, run)
    assert client.get(f"{API}/requirements").json()["items"][0]["status"] == "suspect"


def test_a_sign_off_without_stored_texts_is_judged_by_its_time(
    service: Service, client: httpx.Client, signed: str
) -> None:
    """As earlier versions stored it: a text that was changed back was changed all the same."""
    with service.engine.begin() as writer:
        writer.execute(sa.update(Signoff).values(texts=sa.null()))
    assert on_the_run(client, signed).startswith("of these results")
    word(client, "Keep 0.6 m.")
    word(client, "Keep 0.5 m.")
    assert f"{REQUIREMENT}: {LATER_TEXT}" in on_the_run(client, signed)


@pytest.mark.nightly
@AT_NIGHT
def test_a_repetition_carries_the_sign_off_on(service: Service, client: httpx.Client, signed: str) -> None:
    again = ran(service, client)
    _divide(service, 2)
    for run in (signed, again):
        for place, shown in PLACES.items():
            if run == again or place not in (
                "matrix",
                "matrix.csv",
                "argument",
            ):  # there, the newest run is the evidence
                assert f"repeated by {again}, bit by bit" in shown(client, run), (place, run)
    (one,) = client.get(f"{API}/runs/{again}/signoffs").json()["items"]
    assert (one["run"], one["standing"], one["repeated_by"]) == (signed, "carried on", again)
    (row,) = client.get(f"{API}/requirements").json()["items"]
    assert row["status"] == "met"
    assert f"repeats {signed} bit by bit" in row["sentence"]
    with changed(service.engine, EDITED):
        for place, shown in PLACES.items():
            assert "suspect" in shown(client, again).lower(), place
    sign(client, again)
    assert [one["run"] for one in client.get(f"{API}/runs/{again}/signoffs").json()["items"]] == [again], "shown once"
    third = ran(service, client)
    assert [one["run"] for one in client.get(f"{API}/runs/{third}/signoffs").json()["items"]] == [again], "the newest"


def _divide(service: Service, run_id: int) -> None:
    """Store the evaluations of a run in two chunks where there was one: when they are stored is a matter of time."""
    with service.engine.begin() as writer:
        row = (
            writer.execute(sa.select(EvaluationChunk.__table__).where(EvaluationChunk.run_id == run_id))
            .mappings()
            .one()
        )
        half, names = row["count"] // 2, ("points", "costs", "status", "seconds")
        sizes = {name: len(row[name]) // row["count"] * half for name in names}
        first = {name: row[name][: sizes[name]] for name in names} | {"count": half}
        rest = {name: row[name][sizes[name] :] for name in names} | {"count": row["count"] - half, "first": half}
        writer.execute(sa.delete(EvaluationChunk).where(EvaluationChunk.run_id == run_id))
        writer.execute(sa.insert(EvaluationChunk), [dict(row) | first, dict(row) | rest])


def _bit(service: Service, name: str) -> bytes:
    """A column of the evaluations of the second run with one bit changed."""
    with service.engine.connect() as reader:
        data = bytearray(
            reader.scalar(sa.select(getattr(EvaluationChunk, name)).where(EvaluationChunk.run_id == 2)) or b""
        )
    data[-1] ^= 1
    return bytes(data)


OF_SECOND = {
    "another verdict": sa.update(Run).where(Run.id == 2).values(verdict="inconclusive"),
    "another sentence": sa.update(Run).where(Run.id == 2).values(reason="Another."),
    "other code": sa.update(Run).where(Run.id == 2).values(flown={"code": "0" * 64}),
    "code not stored": sa.update(Run).where(Run.id == 2).values(flown=None),
    "another component": sa.update(Run).where(Run.id == 2).values(flown=FLOWN | {"components": {"a.py": "0"}}),
    "another package": sa.update(Run).where(Run.id == 2).values(flown=FLOWN | {"packages": {"numpy": "2.4.7"}}),
    "another loop": sa.update(Run).where(Run.id == 2).values(flown=FLOWN | {"loop": "0"}),
    "another finding": sa.update(Finding).where(Finding.run_id == 2).values(cost=1.2999999999999998),
    "another stage": sa.update(Stage).where(Stage.run_id == 2, Stage.kind == "search").values(best=1.0),
    "a parameter named as a working time": sa.update(Finding)
    .where(Finding.run_id == 2, Finding.label == "F1")
    .values(parameters=finding().parameters | {"seconds": 3.0}),
    "another description": sa.update(Run).where(Run.id == 2).values(snapshot=None),
    "another trace": sa.update(Trace).where(Trace.run_id == 2).values(data=b"\0" * 301 * 10 * 8),
    "removed": sa.update(Run).where(Run.id == 2).values(removed=1.0),
    "the signed one removed": sa.update(Run).where(Run.id == 1).values(removed=1.0),
    "results of the signed one changed": sa.update(Stage).where(Stage.run_id == 1).values(evaluations=7),
    "withdrawn": sa.update(Signoff).values(withdrawn=1.0, withdrawn_by="local", withdrawn_reason="x"),
}


def carried(client: httpx.Client) -> bool:
    items = client.get(f"{API}/runs/R-0002/signoffs").json()["items"]
    return bool([one for one in items if one["run"] == "R-0001"])


@pytest.mark.nightly
@pytest.mark.parametrize("every", nightly_but((3,), (1, 3)))
def test_what_is_no_repetition_carries_nothing(service: Service, client: httpx.Client, signed: str, every: int) -> None:
    """One change after the other, each undone."""
    ran(service, client)
    assert carried(client)
    chunks = sa.update(EvaluationChunk).where(EvaluationChunk.run_id == 2)
    bits = {name: chunks.values({name: _bit(service, name)}) for name in ("points", "costs", "status")}
    for what, change in list((OF_SECOND | bits).items())[::every]:
        with changed(service.engine, change):
            assert not carried(client), what
            assert "repeated by" not in on_the_run(client, signed), what
        assert carried(client), what


OTHER_CAMPAIGN: dict[str, dict[str, Any]] = {
    "seed": {"seed": 2},
    "threshold": {"criterion": {"threshold": 0.4, "requirements": [REQUIREMENT]}},
    "another requirement": {"criterion": {"threshold": 0.5, "requirements": [REQUIREMENT, "SYS-2"]}},
    "another text": {"criterion": {"threshold": 0.5, "requirements": [{"id": REQUIREMENT, "text": "Keep 0.4 m."}]}},
    "name": {"name": "Another"},
}


@pytest.mark.by_day(1)
@pytest.mark.parametrize("what", nightly_but(("threshold", "another text"), OTHER_CAMPAIGN))
def test_another_campaign_is_no_repetition(service: Service, client: httpx.Client, signed: str, what: str) -> None:
    submit(client, **{"criterion": {"threshold": 0.5, "requirements": [REQUIREMENT]}, **OTHER_CAMPAIGN[what]})
    finish_fully(service)
    assert not carried(client)


def test_a_variant_of_a_sweep_is_no_repetition(service: Service, client: httpx.Client, signed: str) -> None:
    """It is not compared with the campaign, so that what makes the signed run suspect would not show."""
    ran(service, client)
    with service.engine.begin() as writer:
        names = {"name": "s", "campaign_name": "c", "path": "p", "title": "t", "unit": "m", "created": 1.0}
        sweep = writer.execute(sa.insert(Sweep).values(owner="local", **names).returning(Sweep.id)).scalar_one()
        writer.execute(sa.insert(SweepRun).values(sweep_id=sweep, run_id=2, position=0, value=1.0))
    assert not carried(client)
    assert "repeated by" not in on_the_run(client, signed)


NOT_CARRIED: dict[str, tuple[sa.Update, str]] = {
    "another sample": (sa.update(Run).where(Run.id == 1).values(sample_seed=7), other_sample(7)),
    "the same sample": (sa.update(Run).values(sample_seed=7), OTHER_RESULTS),
    "other code": (sa.update(Run).where(Run.id == 2).values(flown=FLOWN | {"loop": "0"}), OTHER_CODE),
}


@pytest.mark.nightly
@pytest.mark.parametrize("what", nightly_but(("another sample",), NOT_CARRIED))
def test_why_a_sign_off_is_not_carried_on_is_stated(
    service: Service, client: httpx.Client, signed: str, what: str, capsys: pytest.CaptureFixture[str]
) -> None:
    again = ran(service, client)
    change, reason = NOT_CARRIED[what]
    other = sa.update(EvaluationChunk).where(EvaluationChunk.run_id == 2).values(costs=_bit(service, "costs"))
    with service.engine.begin() as writer:
        for statement in (other, change):
            writer.execute(statement)
    clause = not_carried(signed, reason)
    assert client.get(f"{API}/runs/{again}/signoffs").json()["not_carried"] == clause
    assert client.get(f"{API}/runs/{signed}/signoffs").json()["not_carried"] is None
    assert clause in client.get(f"{API}/requirements").json()["items"][0]["sentence"]
    assert clause in PLACES["report"](client, again)
    assert clause in by_command(service, again, capsys)
    sign(client, again, "Ada Lovelace")
    assert client.get(f"{API}/runs/{again}/signoffs").json()["not_carried"] is None


def test_who_signed_independently_counts_only_while_valid(service: Service, client: httpx.Client, signed: str) -> None:
    """The text changes after an independent sign-off, and who launched the run signs the new one."""
    with service.engine.begin() as writer:
        writer.execute(sa.update(Signoff).values(account="ada", user="ada", name=""))
    assert ONLY_OWN not in client.get(f"{API}/requirements").json()["items"][0]["sentence"]
    word(client, "Keep 0.6 m.")
    sign(client, signed)
    (row,) = client.get(f"{API}/requirements").json()["items"]
    assert row["status"] == "met"
    assert ONLY_OWN in row["sentence"]


@pytest.mark.nightly
def test_times_and_machine_are_no_difference(service: Service, client: httpx.Client, signed: str) -> None:
    ran(service, client)
    with service.engine.begin() as writer:
        summary = dict(writer.scalar(sa.select(Run.summary).where(Run.id == 2)) or {})
        summary["provenance"] = {**summary["provenance"], "cpu": {"model": "Another CPU", "target": "", "features": ""}}
        writer.execute(sa.update(Run).where(Run.id == 2).values(summary=summary, worker="w9", started=1.0))
        writer.execute(sa.update(Stage).where(Stage.run_id == 2).values(seconds=99.0, finished=5.0))
    assert carried(client)


def test_a_run_that_was_purged_carries_nothing_and_the_one_before_does(
    service: Service, client: httpx.Client, signed: str
) -> None:
    for _ in range(2):
        ran(service, client)
    assert "repeated by R-0003" in on_the_run(client, signed)
    assert client.delete(f"{API}/runs/R-0003", params={"reason": "x"}).status_code == 200
    assert "repeated by R-0002" in on_the_run(client, signed)
    refused = client.delete(f"{API}/runs/{signed}", params={"reason": "x"})
    assert (refused.status_code, "Grace Hopper" in refused.text) == (409, True)


AGAINST = ("verdict", "cancelled", "cleared at a lower threshold", "a stage")


@pytest.mark.by_day(1)
@pytest.mark.parametrize("found", nightly_but(("verdict", "a stage"), AGAINST))
def test_what_a_run_against_it_found_is_not_lost_with_the_run(
    service: Service, client: httpx.Client, found: str
) -> None:
    """It asks the same and states no requirement: nobody takes it by size, and once removed it is named."""
    word(client, "Keep 0.5 m.")
    against = submit(client, criterion={"threshold": 0.5 if found in ("verdict", "cancelled") else 0.1})
    finish_fully(service)
    signed = ran(service, client)
    sign(client, signed)
    assert [one.id for one in purge.beyond(service.engine, 0).runs] == [1]
    values: dict[str, object] = {"worst_cost": 0.3, "verdict": "violated" if found == "verdict" else "cleared"}
    if found == "cancelled":
        values |= {"verdict": None, "state": "cancelled"}
    of = sa.update(Run).where(Run.id == 1).values(**values)
    if found == "a stage":
        of = sa.update(Stage).where(Stage.run_id == 1, Stage.kind == "search").values(best=0.3)
    with service.engine.begin() as writer:
        writer.execute(of)
    (row,) = client.get(f"{API}/requirements").json()["items"]
    assert row["status"] == ("violated" if found == "verdict" else "inconclusive")
    assert purge.beyond(service.engine, 0).runs == []
    assert client.delete(f"{API}/runs/{against}", params={"reason": "A trial."}).status_code == 200
    (row,) = client.get(f"{API}/requirements").json()["items"]
    verb = "violated it" if found == "verdict" else "found a value"
    assert f"{against} {verb}" in row["sentence"]
