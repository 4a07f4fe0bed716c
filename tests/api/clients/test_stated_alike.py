"""What one place states of a run, the others state as well: `show`, `follow`, the files of a CI job, the page."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree as Xml

import pytest
import sqlalchemy as sa

from backend.db.queue import Queue
from backend.db.store import RunStore
from backend.db.tables import Run
from backend.webhooks.body import ended
from campaigns.claims.lowest_value import unconfirmed
from campaigns.claims.numbers import signed
from campaigns.claims.say import say
from campaigns.claims.spans import words
from campaigns.results.regression import FindingChange, Regression, Standing
from clearance.cli import INTERNAL, VIOLATED
from tests.given.reported_runs import PARAMETERS, PLAN, finish_fully
from tests.given.service import Service
from tests.given.small_catalogue import campaign
from tests.given.submissions import submit
from tests.given.ways_to_store import WAYS

Command = Callable[..., int]
FILES = ("junit", "summary", "sarif")


def places(command: Command, folder: Path, capsys: pytest.CaptureFixture[str], code: int) -> dict[str, str]:
    """What each place states of R-0001, of which the job ends with this code."""
    files = {name: folder / name for name in FILES}
    assert command("follow", "R-0001", *(part for name in FILES for part in (f"--{name}", files[name]))) == code
    found = {"follow": capsys.readouterr().out}
    assert command("show", "R-0001") == 0
    return found | {"show": capsys.readouterr().out} | {name: file.read_text() for name, file in files.items()}


def since(fails: bool) -> Regression:
    """A new violation that the policy fails, or a known one that it accepts, and a finding that is not compared."""
    change = FindingChange(
        standing=Standing.NEW if fails else Standing.SAME, before=None if fails else "F1", now="F1",
        parameters=PARAMETERS, margin=-0.1, fails=fails, statement=say("F1 violates"),
    )  # fmt: skip
    lost = FindingChange(
        standing=Standing.NOT_COMPARED, before="F2", now=None, parameters=PARAMETERS, statement=say("F2 has no value")
    )
    return Regression(
        run="R-0009", position=1, cases=[change, lost], fail_on=["new"] if fails else [], ok=not fails,
        accepted=not fails, statement=say("Changes since R-0009"),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("word", "fails", "code"), [("cleared", True, VIOLATED), ("violated", False, 0)], ids=["fails", "accepts"]
)
def test_what_the_policy_decides_is_stated_by_every_command(
    service: Service, command: Command, tmp_path: Path, capsys: pytest.CaptureFixture[str], word: str, fails: bool,
    code: int,
) -> None:  # fmt: skip
    with service.signed_in() as client:
        submit(client)
    finish_fully(service, word, regression=since(fails))
    texts = places(command, tmp_path, capsys, code)
    stated = texts["follow"].splitlines()[1:]
    assert [line for line in stated if line not in texts["show"].splitlines()] == []
    made = since(fails)
    assert all(text in texts["show"] for text in (made.text, made.cases[1].text, f" {code}: "))


@pytest.mark.parametrize("state", ["cancelled", "failed"])
@pytest.mark.parametrize(
    ("lowest", "way"),
    [(0.2, "ahead"), (0.5, "counted"), (0.4999999999, "in order"), (0.6, "ahead")],
    ids=["below", "at", "just below", "above"],
)
def test_a_value_at_or_below_the_threshold_is_stated_wherever_the_run_without_verdict_is(
    service: Service, command: Command, tmp_path: Path, capsys: pytest.CaptureFixture[str], state: str, lowest: float,
    way: str,
) -> None:  # fmt: skip
    """In whichever way its evaluation was stored when the run ended."""
    with service.signed_in() as client:
        run = submit(client, criterion=campaign()["criterion"] | {"requirements": ["SYS-1"]})
        claim = Queue(service.engine).claim("w")
        assert claim is not None
        store = RunStore(service.engine, claim)
        store.plan(PLAN)
        store.begin(2)
        WAYS[way](store, 2, [0.9, lowest])
        with service.engine.begin() as writer:
            writer.execute(sa.update(Run).values(state=state, error="It ended.", finished=1.0))
        texts = places(command, tmp_path, capsys, 130 if state == "cancelled" else INTERNAL)
        stated = words(unconfirmed(state, lowest, 0.5, "m"))
        assert (stated == "") == (lowest > 0.5)
        detail = client.get(f"/api/v1/runs/{run}").json()
        report = re.sub("<[^>]*>", "", client.get(f"/api/v1/runs/{run}/report.html").text)
        trend = client.get("/api/v1/trends", params={"name": detail["campaign_name"]}).json()["runs"][0]
    numbers = [span["value"] for span in detail["unconfirmed"] if span["kind"] == "quantity"]
    assert numbers == ([lowest, 0.5] if stated else []), "the page writes them"
    found = " ".join(report.replace("\u202f", " ").split())
    with service.engine.connect() as reader:
        message = str(json.loads(ended(reader, 1, ""))["data"]["unconfirmed"])
    for name, text in (texts | {"report": found, "trend": trend["unconfirmed"], "webhook": message}).items():
        assert stated in text, name
        assert ("lowest value found" in text) == bool(stated), name
    cases = {str(case.get("name")): case[0] for case in Xml.fromstring(texts["junit"]).iter("testcase")}
    verdict, requirement = cases["verdict"], cases["requirement: SYS-1"]
    assert stated in str(verdict.get("message"))
    expected = ("failure", "inconclusive") if stated else ("error", state)
    assert (requirement.tag, requirement.get("type")) == expected
    assert stated in str(requirement.get("message"))
    assert command("runs") == 0
    assert f"{signed(lowest - 0.5)} m" in capsys.readouterr().out


@pytest.mark.parametrize("state", ["done", "cancelled"])
def test_what_a_run_extends_is_stated_wherever_the_run_is(
    service: Service, command: Command, tmp_path: Path, capsys: pytest.CaptureFixture[str], state: str
) -> None:
    with service.signed_in() as client:
        submit(client)
    finish_fully(service)
    with service.signed_in() as client:
        submit(client, name="earlier")
    with service.engine.begin() as writer:
        values = {"continues": 2} if state == "done" else {"continues": 2, "state": state, "verdict": None}
        writer.execute(sa.update(Run).where(Run.id == 1).values(**values))
    for name, text in places(command, tmp_path, capsys, 0 if state == "done" else 130).items():
        assert "Extends R-0002." in text, name
