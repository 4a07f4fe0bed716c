"""The estimate of P(violation) of a run: the same on every door of a service, and on the command line."""

from __future__ import annotations

import json
import re
from pathlib import Path

import httpx
import pytest

from campaigns.claims.numbers import plain
from campaigns.results import ValidateResult
from campaigns.stored.records import StagePlan
from clearance.cli import VIOLATED, invoke
from tests.given.corrupted_records import estimating, ran
from tests.given.finished_runs import PLAN, Work
from tests.given.service import Service
from tests.given.submissions import submit


def words_of(text: str) -> str:
    return re.sub(r"\s+", " ", re.sub(r"<[^>]+>", "", text))


def test_page_export_and_report_have_the_same_estimate(service: Service, client: httpx.Client) -> None:
    stages = ran("estimated")[1].stages
    (made,) = (s.result for s in stages if s.result is not None and s.result.estimation)
    last = stages[-1].result
    assert isinstance(last, ValidateResult)
    assert last.modes is not None
    run = submit(client, criterion={"threshold": 1.01})
    work = Work(service, [*PLAN[:3], StagePlan("estimate", None, 1000), StagePlan("validate", None, 100)])
    work.nominal()
    work.search(0, 1000)
    work.found()
    work.store.begin(3)
    work.store.finish(3, made, 0.1)
    work.store.begin(4)
    work.store.finish(4, last, 0.1)
    work.conclude()
    stated = made.model_dump(mode="json")
    of_page = client.get(f"/api/v1/runs/{run}/stages").json()[3]["result"]
    of_export = client.get(f"/api/v1/runs/{run}/exports/run.json").json()["stages"][3]["result"]
    assert of_page == stated
    named = last.model_dump(mode="json")["modes"]
    assert client.get(f"/api/v1/runs/{run}/stages").json()[4]["result"]["modes"] == named
    assert client.get(f"/api/v1/runs/{run}/exports/run.json").json()["stages"][4]["result"]["modes"] == named
    assert of_export == stated
    report = words_of(client.get(f"/api/v1/runs/{run}/report.html").text)
    assert words_of(stated["text"]) in report.replace("\u202f", " ")
    assert plain(stated["modes"][0]["distance"], 3) in report
    assert words_of(named["text"])[1:] in report.replace("\u202f", " ")


@pytest.mark.nightly  # by day page, export and report
def test_clearance_run_states_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "campaign.json").write_text(json.dumps(estimating().document()))
    assert invoke(["run", str(tmp_path / "campaign.json"), "--out", str(tmp_path / "out")]) == VIOLATED
    out = " ".join(capsys.readouterr().out.split())
    results = json.loads((tmp_path / "out" / "evidence.json").read_text())["results"]
    (stated,) = (result for result in results if result["stage"] == "estimate")
    assert " ".join(stated["text"].split()) in out
    assert results[-1]["modes"]["text"][1:] in out
    assert invoke(["audit", str(tmp_path / "out")]) == 0
