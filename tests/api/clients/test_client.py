"""The Python client against a real service: the guide's ten lines, both clients, every answer read."""

from __future__ import annotations

import re
import threading
from collections.abc import Iterator
from pathlib import Path

import anyio
import numpy as np
import pytest
import yaml

from clearance import Client
from clearance.client import InvalidCampaignError, InvalidRequestError, NotFoundError, NotSignedInError, RunFailedError
from tests.faults.processes import REPOSITORY
from tests.given.reported_runs import finish_fully
from tests.given.service import Service, until
from tests.given.small_catalogue import campaign

PAGE = (REPOSITORY / "docs" / "client.md").read_text(encoding="utf-8")
WHOLE, ASYNC = re.findall(r"^```python\n(.*?)^```$", PAGE, re.M | re.S)


@pytest.fixture
def client(service: Service) -> Iterator[Client]:
    with Client(service.url, service.token(), patience=5.0) as made:
        yield made


def worked(service: Service, verdict: str) -> threading.Thread:
    """Ends the next run as a worker would, once it is queued."""

    def work() -> None:
        until(lambda: service.rows()["runs"])
        finish_fully(service, verdict)

    thread = threading.Thread(target=work, daemon=True)
    thread.start()
    return thread


@pytest.mark.nightly
def test_ten_lines_do_a_whole_campaign(
    service: Service, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("pandas")
    monkeypatch.chdir(tmp_path)
    Path("campaign.yaml").write_text(yaml.safe_dump(campaign()))
    lines = WHOLE.replace("http://127.0.0.1:8000", service.url)
    assert len([line for line in lines.splitlines() if line]) <= 10
    known = {"token": service.token()}
    worker = worked(service, "violated")
    exec(compile(lines, "client.md", "exec"), known)
    worker.join(30)
    told = capsys.readouterr().out.splitlines()
    assert told[0].startswith("violated d_min stayed above 0.5 m")
    assert told[1] == "F1 0.8 {'vehicle.m': 6.0, 'vehicle.J': 0.06}"
    table = known["table"]
    assert len(table) == 1000  # type: ignore[arg-type]
    assert {"vehicle.m", "vehicle.J", "d_min", "status", "method"} <= set(table.columns)  # type: ignore[attr-defined]
    assert len(list(Path("results").iterdir())) == 5
    assert '<p class="eyebrow">' in Path("report.html").read_text()


def test_the_asynchronous_lines_of_the_guide(service: Service, client: Client) -> None:
    client.submit(campaign(), labels={"branch": "main"})
    client.submit(campaign())
    known: dict[str, object] = {}
    exec(compile(ASYNC, "client.md", "exec"), known)
    found = anyio.run(known["verdicts"], service.url, service.token("other"))  # type: ignore[arg-type]
    assert found == {"R-0001": None}


def test_what_is_read_of_a_run(service: Service, client: Client) -> None:
    assert client.submit(campaign(tags=["own"]), tags=[]).tags == []
    with pytest.raises(InvalidRequestError, match="no text"):
        client.submit(campaign(), group="x\udce9")
    queued = client.submit(campaign(), priority=2, group="g", tags=["t"], labels={"a": "b"})
    assert (queued.group, queued.superseded, queued.labels, queued.tags) == ("g", [], {"a": "b"}, ["t"])
    finish_fully(service)
    done = client.wait(queued)
    assert (done.ended, done.verdict) == (True, "cleared")
    assert done.summary is not None
    assert [check.standing for check in done.summary.checks][:1] == ["holds"]
    assert str(done.created.tzinfo) == "UTC"
    found = client.evaluations(done)
    assert found.points.shape == (1000, 2)
    assert np.isfinite(found.costs).sum() + len(found.reasons) == 1000
    with service.signed_in() as browser:
        rows = browser.get(f"/api/v1/runs/{done.id}/exports/run.json").json()["stages"][2]["rows"]
    assert found.points.tolist() == [row[-2:] for row in rows], "to the bit"
    trace = client.trace(done, "F1")
    assert (trace.complete, trace.units["separation"]) == (True, "m")
    assert np.isnan(trace["separation"][-1])
    assert [info.name for info in client.traces(done)] == ["nominal", "F1", "F2"]
    assert [finding.label for finding in client.findings(done)] == ["F1", "F2"]
    assert {file.media_type for file in client.exports(done)} >= {"text/csv", "image/svg+xml"}
    assert client.cancel(done).state == "done", "one that has ended is unchanged"
    assert [run.id for run in client.runs(state="done")] == [done.id]
    assert client.check(campaign()).ok
    assert client.schema()["title"] == "Campaign"
    assert client.health().status == "ok"


def test_the_list_is_read_page_after_page(service: Service, client: Client) -> None:
    for _ in range(3):
        client.submit(campaign())
    cursor, seen = None, []
    while True:
        page = client.run_page(cursor=cursor, limit=2)
        seen += [run.id for run in page.items]
        cursor = page.next_cursor
        if cursor is None:
            break
    assert seen == [run.id for run in client.runs()] == ["R-0003", "R-0002", "R-0001"]


def test_a_sweep_is_followed_to_its_end(service: Service, client: Client, tmp_path: Path) -> None:
    sweep = client.sweep(campaign(), "avoider.d_0", [1, 2], name="Both")
    assert (sweep.id, sweep.runs, sweep.ended) == ("S-0001", 2, False)
    assert client.cancel_sweep(sweep).states == {"cancelled": 2}
    assert client.wait_sweep(sweep).ended
    assert client.export_sweep(sweep, tmp_path / "s.csv").read_text().startswith("avoider.d_0")


def test_refusals_have_their_types(service: Service, client: Client) -> None:
    other = campaign()
    other["scenario"]["vehicle"]["component"] = "hovercraft"
    with pytest.raises(InvalidCampaignError, match="hovercraft") as caught:
        client.submit(other)
    assert caught.value.problems[0].field == "scenario.vehicle.component"
    assert not client.check(other).ok
    with pytest.raises(NotFoundError, match="'R-0042'"):
        client.run("R-0042")
    with pytest.raises(NotFoundError):
        client.run("../tokens")
    with Client(service.url, "clr_wrong", patience=0.0) as stranger, pytest.raises(NotSignedInError):
        stranger.run("R-0001")


def test_a_run_without_a_verdict_is_an_error_of_a_search(service: Service, client: Client) -> None:
    def cancelled() -> None:
        until(lambda: service.rows()["runs"])
        with Client(service.url, service.token("second")) as other:
            other.cancel("R-0001")

    thread = threading.Thread(target=cancelled, daemon=True)
    thread.start()
    with pytest.raises(RunFailedError) as failed:
        client.search(campaign())
    assert (failed.value.run, failed.value.state) == ("R-0001", "cancelled")
    thread.join(30)


def test_the_same_key_is_the_same_run(client: Client) -> None:
    assert client.submit(campaign(), key="k").id == client.submit(campaign(), key="k").id == "R-0001"
    with pytest.raises(InvalidRequestError, match="Idempotency-Key"):
        client.submit(campaign(), key="k", priority=1)
