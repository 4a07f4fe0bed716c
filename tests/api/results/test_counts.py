"""The numbers of failed, excluded and sampled evaluations are the same everywhere, also where a part is only counted.

A campaign that fails where the inertia is small and excludes where the obstacle is at the start, run once by the real
runner into a service and into the command line's memory.
"""

from __future__ import annotations

import csv
import html
import io
import json
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import httpx
import pytest

from backend.db.queue import Queue
from backend.db.store import RunStore
from campaigns import Campaign
from campaigns.results import Verdict
from clearance import Client
from clearance.cli._report import print_report
from clearance.local.summary import summary
from tests.api.conftest import Fresh, running
from tests.audited import audited
from tests.given.case_campaigns import campaign
from tests.given.service import Service
from worker.engine.stages.parts import offered
from worker.running.catalogue.installed import catalogue
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

FAILING = {"vehicle.J": {"low": 0.0004, "high": 0.06}}
EXCLUDED = {"obstacles.0.position.x": {"low": -0.8, "high": 4.2}}
POST = {"component": "circle", "parameters": {"position": {"x": 4.0, "y": 0.4}, "radius": 0.1}}
STAGES = {
    "sensitivity": {"points": 3},
    "search": [{"method": "direct", "evaluations": 60}, {"method": "monte_carlo", "evaluations": 40}],
    "findings": {"at_most": 1, "evaluations": 4000, "distance": 0.5},
    "validate": {"neighbours": 0, "evaluations": 20_000},
}
FIGURES = {
    "gaps": "{} of these evaluations have no value; the curves have gaps there",
    "bound": "Omitted, because they have no value at one of their bounds: ",
    "sample": "of the {} that have a value, of {} random",
    "draws": "{} of which failed and count as violations",
}
"""What is said where evaluations without a value are left out of a figure, or count in an estimate."""


class Both:
    """A run stored by a service, and in memory as by the command line."""

    def __init__(self, service: RunStore, memory: MemoryStore) -> None:
        self.service, self.memory = service, memory
        self.sample_seed = memory.sample_seed = service.sample_seed

    def __getattr__(self, name: str) -> Any:
        def called(*given: Any, **named: Any) -> Any:
            getattr(self.service, name)(*given, **named)
            return getattr(self.memory, name)(*given, **named)

        return called


@dataclass(frozen=True)
class Ran:
    """The run as it is in the service and as the command line has it."""

    service: Service
    client: httpx.Client
    campaign: Campaign
    memory: MemoryStore
    verdict: Verdict

    def api(self, path: str = "") -> Any:
        answer = self.client.get(f"/api/v1/runs/R-0001{path}")
        assert answer.status_code == 200, answer.text
        return answer.json()

    def text(self, path: str) -> str:
        """A page of the run as its words."""
        found = re.sub(r"<style>.*?</style>", "", self.client.get(f"/api/v1/runs/R-0001{path}").text, flags=re.DOTALL)
        return html.unescape(re.sub(r"\s+", " ", re.sub(r"<[^>]+>", " ", found)))

    @property
    def counts(self) -> dict[str, int]:
        """What the verdict was drawn from."""
        assert self.verdict.evaluations is not None
        return self.verdict.evaluations.model_dump()


SAMPLES = [
    pytest.param({"samples": 140}, id="all", marks=pytest.mark.nightly),  # by day all searches are stored whole
    pytest.param({"samples": 2500, "keep": "lowest"}, id="lowest"),
]


@pytest.fixture(scope="module", params=SAMPLES)
def ran(fresh_sqlite: Fresh, tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest) -> Iterator[Ran]:
    asked = campaign(
        uncertain=FAILING | EXCLUDED,
        scenario__horizon=2.0,
        scenario__step=0.01,
        scenario__obstacles=[POST],
        stages=STAGES | {"certify": request.param},
    )
    with running(fresh_sqlite, tmp_path_factory.mktemp("counts")) as service, pytest.MonkeyPatch.context() as patch:
        service.publish(catalogue().model_dump(mode="json"))
        patch.setattr(offered, "SPOT_CHECKS", 2)
        patch.setattr(offered, "AT_MOST", 2)
        with service.signed_in() as client:
            sent = client.post("/api/v1/runs", json={"campaign": asked.document()})
            assert sent.status_code == 201, sent.text
            memory = MemoryStore()
            verdict = execute(asked, _both(service, memory))
            audited(memory, asked)
            audited(service.engine)
            yield Ran(service, client, asked, memory, verdict)


def _both(service: Service, memory: MemoryStore) -> Any:
    claim = Queue(service.engine).claim("w1")
    assert claim is not None
    return Both(RunStore(service.engine, claim), memory)


def three(told: Any, prefix: str = "") -> tuple[int, int, int]:
    """Evaluations, failed, excluded of a document of the API."""
    return told["evaluations"], told[f"failed{prefix}"], told[f"excluded{prefix}"]


def expected(ran: Ran) -> tuple[int, int, int]:
    return ran.counts["stored"] + ran.counts.get("counted", 0), ran.counts["failed"], ran.counts["excluded"]


def grouped(number: int) -> str:
    """As in a page of which all white space is one blank."""
    return f"{number:,}".replace(",", " ")


@pytest.mark.nightly
def test_the_campaign_fails_excludes_and_samples(ran: Ran) -> None:
    stored, failed, excluded = expected(ran)
    assert failed > 5
    assert excluded > 5
    assert stored == failed + excluded + ran.counts["succeeded"]
    (certified,) = (s for s in ran.api("/stages") if s["kind"] == "certify")
    assert certified["failed"] > 0
    assert certified["excluded"] > 0


@pytest.mark.nightly
def test_the_api_counts_the_same_everywhere(ran: Ran) -> None:
    run, stages = ran.api(), ran.api("/stages")
    (listed,) = ran.client.get("/api/v1/runs").json()["items"]
    (page,) = ran.client.get("/api/v1/runs?sort=-failed").json()["items"]
    for told in (run, listed, page):
        assert three(told, "_evaluations") == expected(ran)
    summed = tuple(sum(stage[key] for stage in stages) for key in ("evaluations", "failed", "excluded"))
    assert summed == tuple(sum(s[key] for s in run["stages"]) for key in ("evaluations", "failed", "excluded"))
    assert summed == expected(ran)
    told = run["summary"]["evaluations"]
    assert told["stored"] == ran.counts["stored"]
    assert (told["stored"] + told.get("counted", 0), told["failed"], told["excluded"]) == expected(ran)
    shown = ran.api("/evaluations")
    assert sum(stage["stored"] for stage in shown["stages"]) == told["stored"]
    assert tuple(sum(s[key] for s in shown["stages"]) for key in ("total", "failed", "excluded")) == expected(ran)
    assert len(shown["failures"]) == min(expected(ran)[1] + expected(ran)[2], 200)


def test_every_result_that_repeats_a_stage_has_its_counts(ran: Ran) -> None:
    stages = {stage["position"]: stage for stage in ran.api("/stages")}
    (validated,) = (s for s in stages.values() if s["kind"] == "validate")
    for row in validated["result"]["comparison"]:
        assert three(row) == three(stages[row["position"]])
    for stage in stages.values():
        if stage["kind"] in ("search", "certify"):
            assert three(stage["result"]) == three(stage)
    (certified,) = (s for s in stages.values() if s["kind"] == "certify")
    sample, told = certified["result"]["sample"], ran.api()["summary"]["statistics"]
    assert sample["samples"] + sample["excluded"] == certified["evaluations"]
    assert {k: sample[k] for k in ("samples", "violations", "failed", "excluded")} == {
        k: told[k] for k in ("samples", "violations", "failed", "excluded")
    }


def test_the_exports_count_the_same(ran: Ran) -> None:
    answer = ran.client.get("/api/v1/runs/R-0001/exports/evaluations.csv")
    rows = list(csv.DictReader(io.StringIO(answer.text, newline="")))
    status = Counter(row["status"] for row in rows)
    assert len(rows) == ran.counts["stored"]
    document = ran.api("/exports/run.json")
    assert three(document["run"], "_evaluations") == expected(ran)
    assert sum(len(stage["rows"]) for stage in document["stages"]) == ran.counts["stored"]
    (certified,) = (s for s in ran.api("/stages") if s["kind"] == "certify")
    drawn = [row.get("draw") for row in rows if row["kind"] == "certify"]
    if not ran.counts.get("counted"):
        assert (len(rows), status["failed"] + status["timeout"], status["excluded"]) == expected(ran)
        assert set(drawn) == {None}
        return
    assert list(map(int, drawn)) == certified["result"]["flights"]
    (stage,) = (s for s in document["stages"] if s["kind"] == "certify")
    assert [row[-1] for row in stage["rows"]] == certified["result"]["flights"]
    assert {row["draw"] for row in rows if row["kind"] != "certify"} == {""}


def test_the_client_reads_every_column_for_what_it_is(ran: Ran) -> None:
    with Client(ran.service.url, ran.service.token("reader")) as client:
        found = client.evaluations("R-0001")
    rows = ran.api("/exports/run.json")["stages"]
    names = list(ran.campaign.uncertain)
    assert (list(found.names), found.criteria) == (names, ("d_min",))
    drawn = bool(ran.counts.get("counted"))
    width = len(names)
    stored = [row[-width - 1 : -1] if drawn else row[-width:] for stage in rows for row in stage["rows"]]
    assert found.points.tolist() == stored
    (certified,) = (s for s in ran.api("/stages") if s["kind"] == "certify")
    expected = certified["result"]["flights"] if drawn else [-1] * certified["stored"]
    assert found.draw[found.kind == "certify"].tolist() == expected
    assert set(found.draw[found.kind != "certify"].tolist()) == {-1}


def test_what_is_only_counted_is_told_by_the_result(ran: Ran) -> None:
    """Stored rows and those beside them are all that the stage made."""
    (certified,) = (s for s in ran.api("/stages") if s["kind"] == "certify")
    beside = (certified["result"]["blocks"] or {}).get("beside", {})
    assert (
        beside.get("evaluations", 0) == ran.counts.get("counted", 0) == certified["evaluations"] - certified["stored"]
    )
    answer = ran.client.get("/api/v1/runs/R-0001/exports/evaluations.csv")
    rows = [row for row in csv.DictReader(io.StringIO(answer.text, newline="")) if row["kind"] == "certify"]
    status = Counter(row["status"] for row in rows)
    assert status["failed"] + beside.get("failed", 0) == certified["failed"]
    assert status["excluded"] + beside.get("excluded", 0) == certified["excluded"]
    assert sum(beside.get("exclusions", {}).values()) == beside.get("excluded", 0)


def test_failed_draws_are_named_wherever_violations_of_the_sample_are(ran: Ran) -> None:
    sample = ran.api()["summary"]["statistics"]
    assert 0 < sample["failed"] <= sample["violations"]
    counted = {"violations": sample["violations"], "failed_samples": sample["failed"], "samples": sample["samples"]}
    (shown,) = ran.client.get("/api/v1/trends", params={"name": ran.campaign.name}).json()["runs"]
    assert {key: shown[key] for key in counted} == counted
    answer = ran.client.post("/api/v1/runs/R-0001/reweighted", json={"uncertain": {}})
    assert answer.status_code == 200, answer.text
    found = answer.json()
    if ran.counts.get("counted"):
        assert found["probability"] is None, "it is not stored whole"
        return
    assert found["failed"] == sample["failed"]
    assert FIGURES["draws"].format(found["failed"]) in found["text"]


def test_the_figures_of_the_report_state_what_has_no_value(ran: Ran) -> None:
    (studied,) = (s["result"]["curves"] for s in ran.api("/stages") if s["kind"] == "sensitivity")
    (found,) = ran.api("/findings")
    through = [] if found["slices"] is None else found["slices"]["curves"]
    gaps = sum(cost is None for curve in [*studied, *through] for cost in curve["costs"])
    assert gaps > 0
    text = ran.text("/report.html")
    assert FIGURES["gaps"].format(gaps) in text
    assert any(None in (curve["costs"][0], curve["costs"][-1]) for curve in studied)
    assert FIGURES["bound"] in text
    sample = ran.api()["summary"]["statistics"]
    valued, whole = sample["samples"] - sample["failed"], sample["samples"]
    assert FIGURES["sample"].format(grouped(valued), grouped(whole)) in text


def test_the_report_counts_the_same(ran: Ran) -> None:
    text = ran.text("/report.html")
    stored, failed, excluded = map(grouped, expected(ran))
    assert f"Total {stored} {failed} {excluded}" in text
    assert f"{failed} of {stored} evaluations failed" in text
    assert f"{failed} evaluations failed: " in text
    assert f"{excluded} evaluations were excluded" in text
    sample = ran.api()["summary"]["statistics"]
    assert f"{grouped(sample['samples'])} random samples" in text
    assert f" {grouped(sample['failed'])} failed " in text
    assert f"{grouped(sample['excluded'])} draws were excluded" in text


def test_the_command_line_counts_the_same(ran: Ran, capsys: pytest.CaptureFixture[str]) -> None:
    told = json.loads(json.dumps(summary(ran.campaign, ran.memory, ran.verdict)))
    summed = tuple(sum(stage[key] for stage in told["stages"]) for key in ("evaluations", "failed", "excluded"))
    assert told["evaluations"] == ran.counts
    assert summed == expected(ran)
    print_report(ran.campaign, ran.memory, ran.verdict, None)
    out = re.sub(r"[│┃\s]+", " ", capsys.readouterr().out)
    stored, failed, excluded = map(grouped, expected(ran))
    assert re.search(rf"all stages \S+ {stored} {failed} {excluded} ", out)
    assert f"Of these, {failed} failed and {excluded} were excluded." in out


def test_absence_of_violations_is_not_claimed_where_evaluations_failed(ran: Ran) -> None:
    """Failed evaluations have no value, whatever the result of the check."""
    for told in (ran.api()["summary"]["checks"], summary(ran.campaign, ran.memory, ran.verdict)["checks"]):
        standing = {check["name"]: check["standing"] for check in told}
        assert standing["evaluations"] == "fails"
        assert standing["minimum"] == "open"
        assert standing["no violation"] in ("open", "fails")
        assert all(check["title"][0].isupper() for check in told)
    text = ran.text("/report.html")
    assert "✓ holds" in text
    lowest = next(check for check in ran.api()["summary"]["checks"] if check["name"] == "minimum")
    but = re.sub(r"\s", " ", lowest["but"])
    assert re.search(rf"{re.escape(lowest['title'])} .*{re.escape(but)} \?", text)


def test_a_run_without_a_verdict_counts_its_stages(service: Service, client: httpx.Client) -> None:
    from campaigns.stored.records import Columns, StagePlan
    from tests.given.finished_runs import Work, search
    from tests.given.submissions import submit

    run = submit(client)
    work = Work(service, [StagePlan("nominal", None, 1), StagePlan("search", "direct", 1000)])
    work.store.begin(1)
    made = search(0, 100)
    made.status[:7] = 3
    work.store.append(1, 0, Columns(made.points, made.costs, made.status, made.seconds, {}))
    told = client.get(f"/api/v1/runs/{run}").json()
    assert three(told, "_evaluations") == (100, 10, 7)
    assert three(told, "_evaluations") == three(told["stages"][1])
