"""A violation that another run found within other bounds is stated of every run that has its case within its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db.engine import migrate, read
from backend.db.purge import beyond, violates
from backend.db.questions import alike, boxes, store
from backend.db.tables import Question, Run
from backend.runs import violations
from campaigns import Catalogue
from campaigns.asked.load import load_document
from campaigns.results import Finding
from tests.given.at_night import nightly_but
from tests.given.databases import BOTH, as_of
from tests.given.reported_runs import finish_fully
from tests.given.service import Service
from tests.given.signed_places import API, PLACES, by_command, ran, sign
from tests.given.small_catalogue import CATALOGUE, campaign, parameter
from tests.given.submissions import submit
from tests.given.verdict_evidence import finding

INSIDE = "in a case within these bounds, on the same model"
VIOLATES, FOUND = "R-0001 violates the criterion", "R-0001 found a value at or below the threshold"
BEYOND = "R-0001 saw beyond the horizon what bars a cleared verdict"
CANCELLED: dict[str, Any] = {"state": "cancelled", "verdict": None, "worst_cost": 0.4}
NARROW = {"vehicle.m": {"low": 4.5, "high": 6.0}, "vehicle.J": {"low": 0.05, "high": 0.06}}
CORNER = {"vehicle.J": {"low": 0.05, "high": 0.06}}
"""The mass is 6 kg."""
WIDE = {"vehicle.m": {"low": 1.0, "high": 9.0}, "vehicle.J": {"low": 0.05, "high": 0.07}}
HEAVY = {"component": "unicycle", "parameters": {"m": 6.0}}
FAR = {"vehicle.m": {"low": 6.5, "high": 9.0}, "vehicle.J": {"low": 0.04, "high": 0.06}}


def case(mass: float, inertia: float, cost: float = 0.4, confirmed: bool = True) -> Finding:
    return finding(cost, confirmed, parameters={"vehicle.m": mass, "vehicle.J": inertia}, point=[0.5, 0.5])


@dataclass(frozen=True)
class Other:
    """The other run: its bounds, its vehicle, its worst cases, changes of its row."""

    uncertain: dict[str, Any]
    stated: str
    cases: Sequence[Finding] = (case(5.0, 0.05),)
    changes: dict[str, Any] = field(default_factory=lambda: {"verdict": "violated"})
    vehicle: dict[str, Any] | None = None


CASES = {
    "narrower": Other(NARROW, VIOLATES),
    "narrower, cancelled": Other(NARROW, FOUND, (), CANCELLED),
    "narrower, beyond the horizon": Other(NARROW, BEYOND, (), {"verdict": "inconclusive", "later": 0.9}),
    "a corner": Other(CORNER, VIOLATES, vehicle=HEAVY),
    "wider, in a case within these bounds": Other(WIDE, VIOLATES),
    "wider, in a case at these bounds": Other(WIDE, VIOLATES, (case(8.0, 0.05), case(6.0, 0.06))),
    "wider, in a case that was not confirmed": Other(
        WIDE, FOUND, (case(8.0, 0.05), case(5.0, 0.05, confirmed=False)), {"verdict": "inconclusive"}
    ),
    "wider, in a case above its threshold and below this one": Other(
        WIDE, FOUND, (case(5.0, 0.05, 0.45),), {"verdict": "cleared", "threshold": 0.3, "worst_cost": 0.45}
    ),
    "wider, elsewhere": Other(WIDE, "", (case(6.1, 0.05), case(5.0, 0.061), case(5.0, 0.05, 1.0))),
    "elsewhere": Other(FAR, "", (case(7.0, 0.05),), vehicle=HEAVY | {"parameters": {"m": 7.0}}),
    "of another model": Other(NARROW, "", changes={"verdict": "violated", "flown": {"code": "b", "model": "b"}}),
    "above the threshold": Other(NARROW, "", (case(5.0, 0.05, 0.6),), CANCELLED | {"worst_cost": 0.6}),
    "removed": Other(NARROW, "", changes={"verdict": "violated", "removed": 1.0}),
}


def found_by(service: Service, client: httpx.Client, other: Other) -> None:
    scenario = campaign()["scenario"] | ({} if other.vehicle is None else {"vehicle": other.vehicle})
    submit(client, name="renamed", uncertain=other.uncertain, scenario=scenario)
    finish_fully(service, found=[one.model_copy(update={"label": f"F{i}"}) for i, one in enumerate(other.cases, 1)])
    with service.engine.begin() as writer:
        writer.execute(sa.update(Run).where(Run.id == 1).values(worst_cost=None, made_again=None))
        writer.execute(sa.update(Run).where(Run.id == 1).values(**other.changes))


@pytest.mark.parametrize("name", CASES)
def test_what_another_run_found_within_other_bounds_is_stated_also_once_it_is_removed(
    service: Service, client: httpx.Client, name: str
) -> None:
    """While it is listed, of the run and its requirement; then of the requirement, which is met."""
    other = CASES[name]
    found_by(service, client, other)
    run = ran(service, client)
    assert client.get(f"{API}/runs/{run}").json()["against"] == (f"{other.stated}, {INSIDE}." if other.stated else "")
    assert other.stated or sign(client, run)["standing"] == "standing"
    (row,) = client.get(f"{API}/requirements").json()["items"]
    found = "violated" if other.stated == VIOLATES else "inconclusive" if other.stated else "met"
    assert (row["status"], "R-0001" in row["sentence"]) == (found, bool(other.stated) or name == "removed")
    assert not other.stated or "within" in row["sentence"]
    with service.engine.begin() as writer:
        removed = {"removed": 1.0, "made_again": 0.4 if other.stated == FOUND else None}
        writer.execute(sa.update(Run).where(Run.id == 1).values(**removed))
    sign(client, run, "Ada Lovelace")
    (row,) = client.get(f"{API}/requirements").json()["items"]
    assert (row["status"], "R-0001" in row["sentence"]) == ("met", bool(other.stated) or name == "removed")


PLACED = (
    "narrower",
    "narrower, cancelled",
    "narrower, beyond the horizon",
    "wider, in a case within these bounds",
)
"""Of each sentence one, and one whose bounds are not all inside."""


@pytest.mark.parametrize("name", nightly_but(PLACED, (name for name, other in CASES.items() if other.stated)))
def test_what_another_run_found_within_other_bounds_is_stated_in_every_place(
    service: Service, client: httpx.Client, capsys: pytest.CaptureFixture[str], name: str
) -> None:
    other = CASES[name]
    found_by(service, client, other)
    run = ran(service, client)
    stated = f"{other.stated}, {INSIDE}"
    seen = client.get(f"{API}/runs/{run}/signoffs").json()
    body = {"name": "Ada", "role": "Review", "comment": "x", "digest": seen["digest"], "against": seen["against"]}
    assert client.post(f"{API}/runs/{run}/signoffs", json=body).status_code == 201
    places = {place: shown(client, run) for place, shown in PLACES.items()} | {"show": by_command(service, run, capsys)}
    assert {place for place, text in places.items() if stated not in text} == set()
    (listed,) = [one for one in client.get(f"{API}/runs").json()["items"] if one["id"] == run]
    assert listed["against"] == f"{stated}."


def test_a_sentence_tells_which_run_has_the_same_bounds(service: Service, client: httpx.Client) -> None:
    found_by(service, client, CASES["narrower"])
    submit(client, seed=9)
    finish_fully(service, "violated")
    run = ran(service, client)
    same = "R-0002 violates the criterion, on the same question and model"
    assert client.get(f"{API}/runs/{run}").json()["against"] == f"{same}; {VIOLATES}, {INSIDE}."


def test_a_wider_run_does_not_speak_of_what_a_narrower_one_did_not_ask(service: Service, client: httpx.Client) -> None:
    """The sweep over a value speaks against the campaign that varies it, and not the reverse."""
    run = ran(service, client)
    submit(client, uncertain=NARROW)
    finish_fully(service)
    with service.engine.begin() as writer:
        writer.execute(sa.update(Run).where(Run.id == 1).values(verdict="violated"))
    assert client.get(f"{API}/runs/R-0002").json()["against"] == ""
    with service.engine.begin() as writer:
        writer.execute(sa.update(Run).where(Run.id == 1).values(verdict="cleared"))
        writer.execute(sa.update(Run).where(Run.id == 2).values(verdict="violated"))
    assert client.get(f"{API}/runs/{run}").json()["against"].startswith("R-0002 violates")
    (row,) = client.get(f"{API}/requirements").json()["items"]
    assert row["sentence"].endswith("R-0002 violates it. R-0001 is cleared, but has that case within its bounds.")


@BOTH
def test_only_what_asks_alike_is_kept_for_a_requirement(service: Service, client: httpx.Client) -> None:
    found_by(service, client, CASES["narrower"])
    submit(client, scenario=campaign()["scenario"] | {"horizon": 20})
    finish_fully(service, "violated")
    submit(client, name="Without a question")
    finish_fully(service, "violated")
    with service.engine.begin() as writer:
        writer.execute(sa.update(Run).where(Run.id == 3).values(question=None, bounds=None))
    ran(service, client)
    with read(service.engine) as reader:
        assert set(reader.scalars(sa.select(Run.id).where(violates()))) == {1, 2, 3}
    with service.engine.begin() as writer:  # above its own threshold, and below that of the requirement
        higher = {"verdict": "cleared", "threshold": 0.3, "worst_cost": 0.4, "made_again": 0.4}
        writer.execute(sa.update(Run).where(Run.id < 4).values(**higher))
    with read(service.engine) as reader:
        assert set(reader.scalars(sa.select(Run.id).where(violates()))) == {1}
    assert [run.id for run in beyond(service.engine, 0).runs] == [2, 3]


def test_a_case_is_that_of_the_obstacles_as_its_run_lists_them(service: Service, client: httpx.Client) -> None:
    """Two runs of one question may list them in another order."""
    near, far = ({"component": "circle", "parameters": {"position": {"x": x, "y": x}, "radius": 0.5}} for x in (4, 9))

    def changes(high: float, *obstacles: Any) -> dict[str, Any]:
        bounds = {
            f"obstacles.{i}.radius": {"low": 0.1, "high": high if o is near else 0.9} for i, o in enumerate(obstacles)
        }
        return {"scenario": campaign()["scenario"] | {"obstacles": list(obstacles)}, "uncertain": bounds}

    submit(client, **changes(0.9, near, far))
    finish_fully(service)
    submit(client, **changes(0.9, far, near))
    large_near = {"obstacles.0.radius": 0.2, "obstacles.1.radius": 0.8}
    finish_fully(service, "violated", found=[finding(0.4, True, parameters=large_near, point=[0.5, 0.5])])
    run = ran(service, client, **changes(0.5, near, far))
    assert client.get(f"{API}/runs/{run}").json()["against"] == ""
    run = ran(service, client, **changes(0.85, near, far))
    assert client.get(f"{API}/runs/{run}").json()["against"] == f"R-0002 violates the criterion, {INSIDE}."


@pytest.mark.parametrize(
    ("inertia", "stated"), [(0.07, ""), (None, f"{VIOLATES}, {INSIDE}."), (0.05, f"{VIOLATES}, {INSIDE}.")]
)
def test_defaults_are_those_of_the_components_of_each_run(
    service: Service, client: httpx.Client, inertia: float | None, stated: str
) -> None:
    """Also where components with another default, or with fewer parameters, were asked the same question before."""
    mass = {"vehicle.m": {"low": 4.0, "high": 6.0}}
    for change in ({"parameters": [parameter("m"), parameter("J", default=0.07)]}, {"parameters": [parameter("m")]}):
        document = CATALOGUE.model_dump()
        document["components"][0] |= change
        before = Catalogue.model_validate(document)
        with service.engine.begin() as writer:
            earlier = store(writer, load_document(campaign(uncertain=mass)), before)
    vehicle = {"component": "unicycle", "parameters": {"m": 5.0} | ({} if inertia is None else {"J": inertia})}
    submit(
        client,
        uncertain={"vehicle.m": {"low": 4.5, "high": 5.5}},
        scenario=campaign()["scenario"] | {"vehicle": vehicle},
    )
    finish_fully(service, "violated")
    run = ran(service, client, uncertain=mass)
    with read(service.engine) as reader:
        assert reader.scalar(sa.select(Run.question).where(Run.id == 2)) == earlier["question"]
    assert client.get(f"{API}/runs/{run}").json()["against"] == stated


@pytest.mark.parametrize("changing", [1, 2])
def test_bounds_that_are_left_of_another_question_are_not_used(
    service: Service, client: httpx.Client, changing: int
) -> None:
    """A worker of an earlier version that has other components stores the question alone."""
    found_by(service, client, CASES["narrower"])
    run = ran(service, client)
    with service.engine.begin() as writer:
        other = store(writer, load_document(campaign(uncertain=WIDE)), None)
        writer.execute(sa.update(Run).where(Run.id == changing).values(question=other["question"]))
    assert client.get(f"{API}/runs/{run}").json()["against"] == ""


@pytest.mark.parametrize("changing", [1, 2])
def test_a_question_that_a_worker_stores_meanwhile_is_no_fault(
    service: Service, client: httpx.Client, monkeypatch: pytest.MonkeyPatch, changing: int
) -> None:
    """On PostgreSQL the statements of a transaction that writes see what others commit between them."""
    found_by(service, client, CASES["narrower"])
    ran(service, client)
    seen = violations._seen_within
    with service.engine.begin() as writer:

        def meanwhile(*given: Any) -> Any:
            found = seen(*given)
            writer.execute(sa.update(Run).where(Run.id == changing).values(question="0" * 64))
            return found

        monkeypatch.setattr(violations, "_seen_within", meanwhile)
        assert violations.against(writer, [2]) == {}


@BOTH
def test_bounds_of_stored_runs_are_kept_by_the_migration(service: Service, client: httpx.Client) -> None:
    found_by(service, client, CASES["narrower"])
    run = ran(service, client)
    rows = sa.select(Question.__table__).order_by(Question.digest)
    with service.engine.begin() as writer:
        before = writer.execute(rows).all()
        as_of(writer, "0034")
    migrate(service.engine.url.render_as_string(hide_password=False))
    with read(service.engine) as reader:
        assert reader.execute(rows).all() == before
        one, other = reader.execute(sa.select(Run.question, Run.bounds).order_by(Run.id)).all()
        assert set(alike(reader, [one.question])) == {one.question, other.question}
        assert len({box.kin for box in boxes(reader, [one.bounds, other.bounds]).values()}) == 1
    assert client.get(f"{API}/runs/{run}").json()["against"] == f"{VIOLATES}, {INSIDE}."
