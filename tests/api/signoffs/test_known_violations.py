"""A violation that another run found is stated wherever a run of the same question and model is."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import Any

import httpx
import pytest
import sqlalchemy as sa
import yaml

from backend.db.engine import read
from backend.db.tables import Base, Finding, Run, Stage
from backend.runs import violations
from backend.runs.violations import against, comes_closer, intending
from backend.runs.within import Found, found
from backend.signoffs import standing
from campaigns.identity.identity import UNSTORED
from campaigns.results.verdict import VerdictWord
from tests.given.at_night import nightly_but
from tests.given.reported_runs import finish_fully
from tests.given.row_changes import changed
from tests.given.service import Service
from tests.given.signed_places import API, PLACES, by_command, ran, sign
from tests.given.submissions import submit

CANCELLED: dict[str, Any] = {"state": "cancelled", "verdict": None, "worst_cost": 0.5}
MODEL = "on the same question and model"
VIOLATES, FOUND = f"R-0001 violates the criterion, {MODEL}", f"R-0001 found a value at or below the threshold, {MODEL}"
BEYOND = f"R-0001 saw beyond the horizon what bars a cleared verdict, {MODEL}"
MANY = f"R-0001, R-0003, R-0004 and 22 more violate the criterion, {MODEL}."
UNCONFIRMED = "1 without a verdict that found a value at or below the threshold"
CASES: dict[str, tuple[Mapping[str, Any], str, str]] = {
    "violated": ({"verdict": "violated"}, VIOLATES, "1 cleared, 1 violated"),
    "of a lower threshold": ({"verdict": "violated", "threshold": 0.4}, VIOLATES, "1 cleared, 1 violated"),
    "cancelled": (CANCELLED, FOUND, f"1 cleared, {UNCONFIRMED}"),
    "failed": (CANCELLED | {"state": "failed", "worst_cost": None, "made_again": 0.4}, FOUND, UNCONFIRMED),
    "running": (CANCELLED | {"state": "running"}, FOUND, UNCONFIRMED),
    "inconclusive": ({"verdict": "inconclusive", "worst_cost": 0.4}, FOUND, "1 cleared, 1 inconclusive"),
    "cleared": ({"threshold": 0.3, "worst_cost": 0.4}, FOUND, "2 cleared"),
    "above": (CANCELLED | {"worst_cost": 0.51}, "", "1 cleared, 1 without a verdict."),
    "of another model": ({"verdict": "violated", "flown": {"code": "b", "model": "b"}}, "", "1 cleared, 1 violated"),
    "of another question": ({"verdict": "violated", "question": "other"}, "", "No other run"),
    "of a higher threshold": (
        {"verdict": "violated", "threshold": 0.9, "worst_cost": 0.8},
        "",
        "1 cleared, 1 violated",
    ),
    "beyond the horizon": ({"verdict": "inconclusive", "later": 0.9}, BEYOND, "1 cleared, 1 inconclusive"),
    "not known beyond it": ({"verdict": "inconclusive", "later": -math.inf}, BEYOND, "1 cleared, 1 inconclusive"),
    "no closer beyond it": ({"verdict": "inconclusive", "later": 2.0}, "", "1 cleared, 1 inconclusive"),
    "a higher threshold, and beyond the horizon": (
        {"verdict": "violated", "threshold": 1.0, "worst_cost": 0.95, "later": 0.9},
        BEYOND,
        "1 cleared, 1 violated",
    ),
    "removed": ({"verdict": "violated", "removed": 1.0}, "", "removed ones included: 1 cleared, 1 violated"),
}
"""Changes of the other run, which has no requirement and another name; what is stated; how often it was asked."""


def of_the_run(client: httpx.Client, run: str) -> dict[str, str]:
    detail, related = (client.get(f"{API}/runs/{run}{rest}").json() for rest in ("", "/related"))
    report = re.sub("<[^>]*>", "", client.get(f"{API}/runs/{run}/report.html").text)
    verdict = " ".join(report.partition("1. Scope of the claim")[0].split())
    return {"run": str(detail["against"]), "related": str(related["against"]), "verdict of the report": verdict}


@pytest.fixture(scope="module")
def again(still: Service, guest: httpx.Client) -> str:
    """A signed run; the first run asked the same under another name, and found what a test has it find."""
    submit(guest, name="renamed", seed=9)
    finish_fully(still)
    run = ran(still, guest)
    sign(guest, run)
    names = [guest.get(f"{API}/runs/{one}").json()["campaign_name"] for one in ("R-0001", run)]
    assert len(set(names)) == 2
    return run


def missing(places: Mapping[str, str], stated: str) -> set[str]:
    """The places that do not state it, or that state something where there is nothing to state."""
    return {place for place, text in places.items() if (stated not in text if stated else MODEL in text)}


@pytest.mark.parametrize("case", CASES)
def test_what_another_run_found_is_stated_of_the_run_and_its_requirement(
    still: Service, guest: httpx.Client, again: str, case: str
) -> None:
    changes, stated, asked = CASES[case]
    with changed(still.engine, sa.update(Run).where(Run.id == 1).values(**changes)):
        assert missing(of_the_run(guest, again), stated) == set()
        report = " ".join(guest.get(f"{API}/runs/{again}/report.html").text.split())
        assert asked in report
        (row,) = guest.get(f"{API}/requirements").json()["items"]
        expected = "violated" if stated == VIOLATES else "inconclusive" if stated else None
        assert expected is None or (row["status"], "R-0001" in row["sentence"]) == (expected, True)
        assert expected is not None or row["status"] not in ("violated", "inconclusive")


@pytest.mark.parametrize("case", nightly_but(("violated", "cancelled", "beyond the horizon", "above"), CASES))
def test_it_is_stated_in_every_place_that_shows_the_sign_off(
    still: Service, guest: httpx.Client, again: str, capsys: pytest.CaptureFixture[str], case: str
) -> None:
    """By day one case for each of the sentences, and one without."""
    changes, stated, _ = CASES[case]
    with changed(still.engine, sa.update(Run).where(Run.id == 1).values(**changes)):
        places = {place: shown(guest, again) for place, shown in PLACES.items()}
        places["show"] = by_command(still, again, capsys)
        assert missing(places, stated) == set()
        argument = yaml.safe_load(guest.get(f"{API}/requirements/export/argument.gsn.yaml").text)
        assert any(name.endswith("R-0001") for name in argument) == bool(stated)
        assert not stated or not any(name.startswith("Sn-") for name in argument)


def test_of_many_runs_a_sentence_names_few_and_the_api_all(service: Service, client: httpx.Client) -> None:
    """The list of runs states it as well, with as many statements for many runs as for few."""
    submit(client, name="renamed", seed=9)
    finish_fully(service, "violated")
    run, statements = ran(service, client), list[str]()
    sa.event.listen(service.engine, "before_cursor_execute", lambda _c, _k, text, *_: statements.append(text))

    def listed() -> tuple[dict[str, str], int]:
        statements.clear()
        rows = client.get(f"{API}/runs").json()["items"]
        return {row["id"]: row["against"] for row in rows}, len(statements)

    stated, few = listed()
    assert stated == {"R-0001": "", run: f"{VIOLATES}."}
    for other in range(3, 27):
        copied(service.engine, other)
    (stated, many), detail = listed(), client.get(f"{API}/runs/{run}").json()
    assert stated[run] == MANY
    assert stated[run] == detail["against"]
    assert detail["against_runs"] == ["R-0001", *(f"R-{other:04d}" for other in range(3, 27))]
    assert many == few
    (row,) = client.get(f"{API}/requirements").json()["items"]
    assert row["sentence"].count("R-00") == 4


def test_a_sign_off_in_knowledge_of_a_violation_stands_until_another_is_found(
    service: Service, client: httpx.Client
) -> None:
    """For a reason; one that states no such knowledge, as of an earlier client, is suspect."""
    submit(client, name="renamed", seed=9)
    finish_fully(service, "violated")
    run = ran(service, client)
    address = f"{API}/runs/{run}/signoffs"
    seen = client.get(address).json()
    assert seen["against"] == {"R-0001": "violates"}
    body = {"name": "Ada", "role": "Review", "digest": seen["digest"], "against": seen["against"]}
    for changes, code in (({}, 422), ({"against": {}, "comment": "x"}, 409)):
        assert client.post(address, json={**body, **changes}).status_code == code
    signed = client.post(address, json={**body, "comment": "Mended in the vehicle."}).json()
    assert (signed["standing"], signed["reasons"]) == ("standing", [])
    assert VIOLATES in signed["sentence"]
    assert sign(client, run)["standing"] == "suspect"
    copied(service.engine, 3)
    later = client.get(address).json()["items"][0]
    assert later["standing"] == "suspect"
    assert later["reasons"] == [VIOLATES.replace("R-0001", "R-0003")]
    with service.engine.begin() as writer:
        writer.execute(sa.update(Run).where(Run.id == 3).values(removed=1.0))
    assert client.get(address).json()["items"][0]["standing"] == "standing"


def test_what_was_seen_beyond_the_horizon_bars_what_is_cleared_without_it() -> None:
    """Closer than any evaluation; where the campaign intends such approaches, at or below the threshold."""

    def speaks(later: float | None, word: VerdictWord = VerdictWord.CLEARED, permits: bool = False) -> bool:
        other = Found(1, "a", "q", VerdictWord.INCONCLUSIVE, UNSTORED, 0.5, 0.9, later)
        return comes_closer(other, Found(2, "a", "q", word, UNSTORED, 0.5, 0.9, permits=permits))

    assert [speaks(later) for later in (None, 1.0, 0.9, 0.8, 0.4, -math.inf)] == [False] * 3 + [True] * 3
    assert [speaks(later, permits=True) for later in (0.8, 0.5, -math.inf)] == [False, True, True]
    assert not any(speaks(0.4, word) for word in (VerdictWord.VIOLATED, VerdictWord.INCONCLUSIVE))


def test_runs_of_a_list_that_ask_the_same_are_compared_once(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    submit(client, name="renamed", seed=9)
    finish_fully(service, "violated")
    runs = [ran(service, client) for _ in range(3)]
    compared: list[tuple[int, int]] = []
    reaches = violations.at_threshold

    def noted(other: Found, one: Found) -> bool:
        compared.append((other.run_id, one.run_id))
        return reaches(other, one)

    monkeypatch.setattr(violations, "at_threshold", noted)
    rows = client.get(f"{API}/runs").json()["items"]
    assert [row["against"] for row in rows if row["id"] in runs] == [f"{VIOLATES}."] * 3
    assert len(compared) == 1


def test_only_what_may_be_contradicted_is_compared(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of most lists nothing more is read than which runs ask the same."""
    for _ in range(3):
        ran(service, client)
    submit(client, criterion={"threshold": 0.1})
    finish_fully(service, "inconclusive")
    monkeypatch.setattr(violations, "found", lambda *_: pytest.fail("read"))
    assert {row["against"] for row in client.get(f"{API}/runs").json()["items"]} == {""}


def test_the_matrix_compares_what_is_beyond_the_horizon_as_pages_do(service: Service, client: httpx.Client) -> None:
    """With the lowest value of the cleared run, also where only an evaluation made again had it."""
    submit(client, name="renamed", seed=9)
    finish_fully(service, "inconclusive")
    run = ran(service, client)
    for again, stated in ((None, True), (0.8, False)):
        with service.engine.begin() as writer:
            writer.execute(sa.update(Run).where(Run.id == 1).values(later=0.9))
            writer.execute(sa.update(Run).where(Run.id == 2).values(made_again=again))
        (row,) = client.get(f"{API}/requirements").json()["items"]
        assert (BEYOND.partition(",")[0] in row["sentence"]) is stated
        assert bool(client.get(f"{API}/runs/{run}").json()["against"]) is stated


def test_only_a_stated_intent_permits_approaches_at_the_end(service: Service, client: httpx.Client) -> None:
    """Not the reason of another one that mentions it."""
    for intended in ({"closest_approach": "A landing."}, {"motion": "See closest_approach."}, {}):
        submit(client, encounter={"intended": intended})
        finish_fully(service)
    with read(service.engine) as reader:
        runs = found(reader)
        assert intending(reader, runs, [replace(runs[0], later=0.9)]) == {1}


def test_a_run_that_violates_itself_needs_no_other(service: Service, client: httpx.Client) -> None:
    submit(client, seed=9)
    finish_fully(service, "violated")
    run = submit(client)
    finish_fully(service, "violated")
    assert set(of_the_run(client, run).values()) & {VIOLATES + "."} == set()


def test_a_list_of_runs_reads_no_row_of_each_for_it(service: Service, client: httpx.Client) -> None:
    """Sign-offs of many runs are compared with the other runs of their questions at once."""
    statements: list[str] = []

    def counted() -> int:
        statements.clear()
        assert client.get(f"{API}/reports").status_code == 200
        return sum("made_again" in one for one in statements)

    sa.event.listen(service.engine, "before_cursor_execute", lambda _c, _k, text, *_: statements.append(text))
    few = 0
    for seed in range(1, 5):
        sign(client, ran(service, client, seed=seed))
        few = few or counted()
    assert counted() == few > 0


def test_runs_of_earlier_versions_are_read_at_once(service: Service, client: httpx.Client) -> None:
    """Such runs did not keep the lowest value of evaluations made again: it is read from their findings."""
    run = ran(service, client)
    with service.engine.begin() as writer:
        writer.execute(sa.update(Run).values(made_again=None))
    copied(service.engine, 2)
    statements: list[str] = []
    sa.event.listen(service.engine, "before_cursor_execute", lambda _c, _k, text, *_: statements.append(text))

    def counted(address: str) -> int:
        statements.clear()
        assert client.get(f"{API}{address}").status_code == 200
        return sum("findings" in one or "stages" in one for one in statements)

    pages = (f"/runs/{run}", f"/runs/{run}/related", f"/runs/{run}/report.html")
    few = [counted(page) for page in pages]
    for other in range(3, 20):
        copied(service.engine, other)
    assert [counted(page) for page in pages] == few
    assert min(few) > 0


def test_a_list_compares_no_run_of_a_campaign_that_nobody_signed(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[int] = []

    def noted(reader: sa.Connection, run_ids: Collection[int]) -> dict[int, list[Found]]:
        asked.extend(run_ids)
        return against(reader, run_ids)

    monkeypatch.setattr(standing, "against", noted)
    for seed in range(1, 4):
        ran(service, client, seed=seed)
    sign(client, "R-0002")
    ran(service, client, seed=2)
    assert client.get(f"{API}/reports").status_code == 200
    assert set(asked) == {2, 4}


def copied(engine: sa.Engine, to: int) -> None:
    """Another run that did and found the same as the first."""
    tables: dict[type[Base], str] = {Run: "id", Stage: "run_id", Finding: "run_id"}
    with engine.begin() as writer:
        for table, key in tables.items():
            for row in writer.execute(sa.select(table.__table__).where(getattr(table, key) == 1)).mappings().all():
                writer.execute(sa.insert(table).values(**{**row, key: to}))
