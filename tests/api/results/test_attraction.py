"""The region of attraction of a run: the same on every door of a service, and on the command line."""

from __future__ import annotations

import json
import re
from pathlib import Path

import httpx
import pytest

from backend.reports.charts import SECTION
from campaigns.stored.records import StagePlan
from clearance.cli import INCONCLUSIVE, invoke
from tests.given.corrupted_records import attracting, in_a_second, ran
from tests.given.finished_runs import PLAN, Work
from tests.given.service import Service
from tests.given.submissions import submit


def words_of(text: str) -> str:
    return " ".join(re.sub(r"<[^>]+>", "", text).replace("&lt;", "<").split())


def test_page_export_and_report_have_the_same_region(service: Service, client: httpx.Client) -> None:
    (made,) = (s.result for s in ran("attracted")[1].stages if s.result is not None and s.result.attraction)
    run = submit(client, criterion={"threshold": 1.01})
    work = Work(service, [*PLAN[:3], StagePlan("attraction", None, 0)])
    work.nominal()
    work.search(0, 1000)
    work.found()
    work.store.begin(3)
    work.store.finish(3, made, 0.1)
    work.conclude()
    stated = made.model_dump(mode="json")
    of_page = client.get(f"/api/v1/runs/{run}/stages").json()[3]["result"]
    of_export = client.get(f"/api/v1/runs/{run}/exports/run.json").json()["stages"][3]["result"]
    assert of_page == stated
    assert of_export == stated
    report = client.get(f"/api/v1/runs/{run}/report.html").text
    for span in stated["statement"]:
        assert span.get("text", "")[1:].strip() in words_of(report)
    assert report.count(SECTION) == len(stated["sections"]) == 6


@pytest.mark.nightly  # by day it states an estimate: test_estimate.py
def test_clearance_run_states_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    in_a_second(monkeypatch)
    (tmp_path / "campaign.json").write_text(json.dumps(attracting().document()))
    assert invoke(["run", str(tmp_path / "campaign.json"), "--out", str(tmp_path / "out")]) == INCONCLUSIVE
    out = " ".join(capsys.readouterr().out.split())
    results = json.loads((tmp_path / "out" / "evidence.json").read_text())["results"]
    (stated,) = (result for result in results if result["stage"] == "attraction")
    assert " ".join(stated["text"].split())[1:] in out
    assert invoke(["audit", str(tmp_path / "out")]) == 0
