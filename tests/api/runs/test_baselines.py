"""The baseline of a launch: which run it is, what is refused, what a reused verdict is."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db.baselines import none_found
from backend.db.queue import Queue
from backend.db.rows import plain
from backend.db.tables import CatalogueDocument, CatalogueSnapshot, Run
from backend.runs import reuse
from backend.runs.submission import AT_LAUNCH
from campaigns.claims.say import say
from campaigns.results.regression import FindingChange, Regression, Standing
from tests.given.code_versions import CODE, IDENTITY, VERSIONS, edited
from tests.given.newer_forms import in_form
from tests.given.problem_documents import problem
from tests.given.reported_runs import PARAMETERS, finish_fully
from tests.given.service import Service
from tests.given.small_catalogue import campaign
from tests.given.submissions import swept


def launched(client: httpx.Client, key: str = "", **fields: Any) -> dict[str, Any]:
    given = {"campaign": campaign(), **fields}
    answer = client.post("/api/v1/runs", json=given, headers={"Idempotency-Key": key} if key else {})
    assert answer.status_code == 201, answer.text
    return dict(answer.json())


def refused(client: httpx.Client, **fields: Any) -> str:
    answer = client.post("/api/v1/runs", json={"campaign": campaign(), **fields})
    (error,) = problem(answer, 422)["errors"]
    assert error["field"] in ("baseline", "campaign.baseline")
    return str(error["message"])


def finished(service: Service, client: httpx.Client, verdict: str = "cleared", **fields: Any) -> str:
    run = str(launched(client, **fields)["id"])
    finish_fully(service, verdict)
    return run


def test_the_findings_of_the_baseline_are_in_the_campaign_of_the_run(service: Service, client: httpx.Client) -> None:
    finished(service, client)
    found = launched(client, baseline="R-0001", text=None)
    assert found["baseline"] == {"asked": "R-0001", "run": "R-0001", "sentence": "Baseline: R-0001."}
    run = client.get(f"/api/v1/runs/{found['id']}").json()
    assert run["baseline"] == found["baseline"]
    given = run["campaign"]["baseline"]
    assert (given["run"], given["threshold"], len(given["cases"])) == ("R-0001", 0.5, 2)
    assert given["cases"][0] == {
        "label": "F1", "parameters": PARAMETERS, "point": [1.0, 1.0], "cost": 1.3, "difference": 2e-4,
        "realisation": None,
    }  # fmt: skip
    assert [stage["kind"] for stage in run["plan"]][:2] == ["nominal", "baseline"]
    assert run["plan"][1]["description"] == "the findings of R-0001"
    assert run["campaign_digest"] != client.get("/api/v1/runs/R-0001").json()["campaign_digest"]
    file = client.get(f"/api/v1/runs/{found['id']}/campaign.yaml").text
    assert "baseline" not in file, "it can be submitted again"


def test_a_label_selects_the_newest_run_of_the_same_question(service: Service, client: httpx.Client) -> None:
    main = {"labels": {"branch": "main"}}
    finished(service, client, **main)
    finished(service, client, **main)
    finished(service, client, labels={"branch": "slow"})
    finished(service, client, campaign=campaign(name="Another"), **main)
    launched(client, **main)  # it has not ended
    claim = Queue(service.engine).claim("w1")
    assert claim is not None
    Queue(service.engine).fail(claim, "the trim has no solution")  # it has no findings
    found = launched(client, baseline="label:branch=main")
    sentence = found["baseline"].pop("sentence")
    assert found["baseline"] == {"asked": "label:branch=main", "run": "R-0002"}
    assert sentence.startswith("Baseline: R-0002, ")
    assert " branch=main " in sentence
    client.delete("/api/v1/runs/R-0002", params={"reason": "wrong"})
    assert launched(client, baseline="label: branch = main")["baseline"]["run"] == "R-0001"


def test_no_label_selects_a_run_that_a_newer_version_describes(service: Service, client: httpx.Client) -> None:
    for _ in range(2):
        finished(service, client, labels={"branch": "main"})
    with service.engine.begin() as writer:
        described_by_newer(writer, 2)
    assert launched(client, baseline="label:branch=main")["baseline"]["run"] == "R-0001"


def test_no_label_selects_a_variant_of_a_sweep(service: Service, client: httpx.Client) -> None:
    main = {"labels": {"branch": "main"}}
    finished(service, client, **main)
    swept(client, [1.5, 2.5], **main)
    for _ in range(2):
        finish_fully(service, "violated")
    assert launched(client, baseline="label:branch=main")["baseline"]["run"] == "R-0001"
    assert launched(client, baseline="R-0002")["baseline"]["run"] == "R-0002", "named, it is what is compared with"


def test_a_label_that_no_run_has_is_stated(client: httpx.Client) -> None:
    found = launched(client, baseline="label:branch=main")
    assert found["baseline"]["run"] is None
    assert found["baseline"]["sentence"] == none_found("label:branch=main")
    run = client.get(f"/api/v1/runs/{found['id']}").json()
    assert run["baseline"] == found["baseline"]
    assert "baseline" not in run["campaign"]


@pytest.mark.parametrize(
    ("given", "statement"),
    [
        ("R-0042", "R-0042 cannot be the baseline: there is no such run"),
        ("main", "invalid baseline 'main': give a run such as R-0001, or label:KEY=VALUE"),
        ("../R-0001", "invalid baseline '../R-0001'"),
        ("label:branch", "invalid baseline 'label:branch': invalid label 'branch': give KEY=VALUE"),
        ("R-999999999999999", "there is no such run"),
    ],
)
def test_what_is_no_run_is_refused(client: httpx.Client, given: str, statement: str) -> None:
    assert statement in refused(client, baseline=given)
    assert client.get("/api/v1/runs").json()["items"] == []


def test_runs_that_cannot_be_compared_are_refused(service: Service, client: httpx.Client) -> None:
    launched(client)
    sentences = [refused(client, baseline="R-0001")]
    client.post("/api/v1/runs/R-0001/cancel")
    sentences.append(refused(client, baseline="R-0001"))
    finished(service, client)
    other = campaign()
    other["uncertain"] = {"start.x": {"low": 0.0, "high": 1.0}}
    sentences.append(refused(client, campaign=other, baseline="R-0002"))
    client.delete("/api/v1/runs/R-0002", params={"reason": "wrong"})
    sentences.append(refused(client, baseline="R-0002"))
    client.post("/api/v1/runs/R-0002/restore")
    written = client.get(f"/api/v1/runs/{launched(client, baseline='R-0002')['id']}").json()["campaign"]
    assert refused(client, campaign=written) == AT_LAUNCH
    assert sentences == [
        "R-0001 cannot be the baseline: it is queued; wait until it has ended, or give another",
        "R-0001 cannot be the baseline: it has no findings to compare with; give another run",
        "R-0002 cannot be the baseline: it varies none of the parameters of this campaign",
        "R-0002 cannot be the baseline: it was removed; restore it on its page, or give another",
    ]


def test_a_repeated_request_has_the_same_baseline_whatever_has_changed(service: Service, client: httpx.Client) -> None:
    finished(service, client, labels={"branch": "main"})
    first = launched(client, "k1", baseline="label:branch=main")
    finish_fully(service)
    finished(service, client, labels={"branch": "main"})
    client.delete("/api/v1/runs/R-0001", params={"reason": "wrong"})
    again = launched(client, "k1", baseline="label:branch=main")
    assert (again["id"], again["baseline"], again["reused"]) == (first["id"], first["baseline"], None)
    given = {"campaign": campaign(), "baseline": "R-0001"}
    answer = client.post("/api/v1/runs", json=given, headers={"Idempotency-Key": "k1"})
    problem(answer, 422)


def test_a_verdict_is_reused_for_the_same_campaign_and_code(service: Service, client: httpx.Client) -> None:
    service.compare()
    finished(service, client)
    found = launched(client, "k1", reuse=True, labels={"build": "2"})
    assert (found["id"], found["verdict"], found["labels"]) == ("R-0001", "cleared", {})
    assert found["reused"].startswith("R-0001 is reused: ")
    assert f"(sha256 {str(IDENTITY.digest)[:12]})" in found["reused"]
    assert launched(client, "k1", reuse=True, labels={"build": "2"})["reused"] == found["reused"]
    assert launched(client)["reused"] is None, "only on request"


def described_by_newer(writer: sa.Connection, run: int) -> None:
    """A newer version has stored the descriptions of the components of a run, in a form that this one cannot read."""
    document: Any = writer.scalar(sa.select(CatalogueSnapshot.document).limit(1))
    changed = in_form(document, "one more field")
    writer.execute(sa.insert(CatalogueSnapshot).values(digest="newer", document=changed, created=0.0))
    writer.execute(sa.update(Run).where(Run.id == run).values(snapshot="newer"))


CHANGES: dict[str, Callable[[sa.Connection], object]] = {
    "other code": lambda c: c.execute(sa.update(CatalogueDocument).values(document=edited())),
    "no stored code": lambda c: c.execute(sa.update(Run).values(flown=None)),
    "an own component has changed": lambda c: c.execute(
        sa.update(Run).values(flown={"code": CODE.digest, "components": {"my_robot.py": "0" * 16}})
    ),
    "another package": lambda c: c.execute(
        sa.update(Run).values(
            flown=VERSIONS.model_copy(update={"packages": {"numpy": "2.5.0"}}).model_dump(mode="json")
        )
    ),
    "no stored descriptions": lambda c: c.execute(sa.update(Run).values(snapshot=None)),
    "descriptions of a newer form": lambda c: described_by_newer(c, 1),
    "removed": lambda c: c.execute(sa.update(Run).values(removed=1.0)),
    "cancelled": lambda c: c.execute(sa.update(Run).values(state="cancelled", verdict=None)),
}


@pytest.mark.by_day(3)
@pytest.mark.parametrize("change", CHANGES)
def test_a_verdict_on_anything_else_is_not_reused(service: Service, client: httpx.Client, change: str) -> None:
    service.compare()
    finished(service, client)
    with service.engine.begin() as writer:
        CHANGES[change](writer)
    found = launched(client, reuse=True)
    assert (found["id"], found["reused"], found["state"]) == ("R-0002", None, "queued")


@pytest.mark.by_day(1)
@pytest.mark.parametrize("newer", ["cleared", "inconclusive"])
def test_no_newer_verdict_is_reused_in_place_of_a_violation(service: Service, client: httpx.Client, newer: str) -> None:
    service.compare()
    violated = finished(service, client, "violated")
    cleared = finished(service, client, newer)
    assert launched(client, reuse=True)["id"] == violated
    with service.engine.begin() as writer:
        seed = writer.scalar(sa.select(Run.sample_seed).where(Run.id == int(cleared[2:])))
    assert launched(client, reuse=True, sample_seed=seed)["reused"] is None, "the violation has another sample"
    assert client.delete(f"/api/v1/runs/{violated}", params={"reason": "wrong"}).is_success
    assert launched(client, reuse=True)["id"] == cleared


def test_nothing_is_reused_if_a_run_without_a_verdict_found_a_violation(service: Service, client: httpx.Client) -> None:
    service.compare()
    found, _ = finished(service, client), finished(service, client)
    with service.engine.begin() as writer:
        lower = {"state": "cancelled", "verdict": None, "worst_cost": Run.threshold}
        writer.execute(sa.update(Run).where(Run.id == int(found[2:])).values(lower))
    assert launched(client, reuse=True)["reused"] is None


SPEAKING: dict[str, dict[str, Any]] = {
    "violated": {"verdict": "violated"},
    "cancelled": {"state": "cancelled", "verdict": None, "worst_cost": 0.5},
    "of another model": {"verdict": "violated", "flown": {"code": "b", "model": "b"}},
    "above the threshold": {"state": "cancelled", "verdict": None, "worst_cost": 0.51},
    "removed": {"verdict": "violated", "removed": 1.0},
}


@pytest.mark.parametrize("older", [True, False])
@pytest.mark.parametrize("spoken", SPEAKING)
def test_nothing_is_reused_against_another_run_of_the_same_question(
    service: Service, client: httpx.Client, spoken: str, older: bool
) -> None:
    """Its seed and its name are others, and so is the digest of its campaign."""
    service.compare()
    other: dict[str, Any] = {"campaign": campaign(seed=9, name="renamed")}
    runs = [finished(service, client, **fields) for fields in ([other, {}] if older else [{}, other])]
    speaking = int(runs[0 if older else 1][2:])
    with service.engine.begin() as writer:
        writer.execute(sa.update(Run).where(Run.id == speaking).values(**SPEAKING[spoken]))
    reused = launched(client, reuse=True)["reused"]
    assert (reused is None) == (spoken in ("violated", "cancelled"))


@pytest.mark.by_day(1)
@pytest.mark.parametrize("workers", [(), (0.0,), (4e9, 0.0)], ids=["none", "one that has not", "one of two"])
def test_nothing_is_reused_until_every_worker_has_compared_its_files(
    service: Service, client: httpx.Client, workers: tuple[float, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(reuse, "PATIENCE", 0.2)
    finished(service, client)
    for at in workers:
        service.compare(at)
    assert launched(client, reuse=True)["reused"] is None


def test_a_reused_verdict_has_the_same_baseline(service: Service, client: httpx.Client) -> None:
    service.compare()
    finished(service, client, labels={"branch": "main"})
    compared = finished(service, client, baseline="R-0001")
    found = launched(client, reuse=True, baseline="label:branch=main")
    assert (found["id"], found["baseline"]["run"]) == (compared, "R-0001")
    finished(service, client, labels={"branch": "main"})
    assert launched(client, reuse=True, baseline="label:branch=main")["reused"] is None, "it is another baseline"


def test_the_changes_are_in_the_run_the_report_and_the_export(service: Service, client: httpx.Client) -> None:
    finished(service, client)
    run = finished(service, client, baseline="R-0001")
    lost = "F2 of R-0001 is not compared: vehicle.m = 6.5 is outside the bounds 4 to 6 of this campaign"
    known: dict[str, Any] = {"parameters": PARAMETERS, "margin_before": 0.9}
    worse = FindingChange(
        standing=Standing.WORSE, before="F1", now="F1", evaluation=0, margin_again=0.8, margin=0.8, change=-0.1,
        tolerance=0.001, fails=True, statement=say("F1 of R-0001 is worse"), **known,
    )  # fmt: skip
    gone = FindingChange(standing=Standing.NOT_COMPARED, before="F2", now=None, statement=say(lost), **known)
    told = "Changes of the findings since R-0001: 1 worse, 1 not compared. The policy of the campaign fails: <b>."
    made = Regression(
        run="R-0001", position=1, cases=[worse, gone], fail_on=["worse"], ok=False, quantity="d_min", unit="m",
        statement=say(told),
    )  # fmt: skip
    with service.engine.begin() as writer:
        summary = writer.scalar(sa.select(Run.summary).where(Run.id == 2))
        writer.execute(sa.update(Run).where(Run.id == 2).values(summary=summary | {"regression": plain(made)}))
    stored = client.get(f"/api/v1/runs/{run}").json()["summary"]["regression"]
    assert stored == made.model_dump(mode="json")
    assert client.get(f"/api/v1/runs/{run}/exports/run.json").json()["run"]["summary"]["regression"] == stored
    report = client.get(f"/api/v1/runs/{run}/report.html").text
    assert "<h3>Since the baseline R-0001</h3>" in report
    assert "worse, fails" in report
    assert "+0.90000" in report
    assert "\u22120.100" in report
    assert " fails: &lt;b&gt;." in report
    assert lost in report.replace("\u202f", " ")
    assert "Since the baseline" not in client.get("/api/v1/runs/R-0001/report.html").text


@pytest.mark.nightly
def test_a_report_says_why_nothing_was_compared(service: Service, client: httpx.Client) -> None:
    finished(service, client, baseline="label:branch=main")
    report = client.get("/api/v1/runs/R-0001/report.html").text
    assert none_found("label:branch=main") in report
    cancelled = launched(client, baseline="R-0001")["id"]
    client.post(f"/api/v1/runs/{cancelled}/cancel")
    report = client.get(f"/api/v1/runs/{cancelled}/report.html").text
    assert "Baseline: R-0001. " in report
