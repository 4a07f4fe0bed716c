"""The seed of the independent sample: drawn at every launch, repeated on request; how often a question was asked."""

from __future__ import annotations

from typing import Any

import httpx
import pytest
import sqlalchemy as sa

from backend.db.continuation import sample_seed, succeed
from backend.db.engine import read
from backend.db.reset import empty
from backend.db.sample_seeds import settle
from backend.db.tables import Run, Stage
from campaigns import Campaign
from campaigns.asked.text import to_yaml
from campaigns.sample_seed import SampleSeed
from campaigns.versions import Versions
from tests.given.reported_runs import finish_fully
from tests.given.service import Service
from tests.given.small_catalogue import CATALOGUE, campaign
from worker.evidence.audit.record import of_database


def launched(client: httpx.Client, **more: Any) -> int:
    asked = {"campaign": campaign(**more.pop("changes", {})), **more}
    answer = client.post("/api/v1/runs", json=asked)
    assert answer.status_code == 201, answer.text
    return int(answer.json()["id"].removeprefix("R-"))


def seed(service: Service, run: int) -> SampleSeed:
    with read(service.engine) as reader:
        found = sample_seed(reader, run)
    assert found is not None
    return found


def test_every_launch_draws_its_own(service: Service, client: httpx.Client) -> None:
    seeds = [seed(service, launched(client)) for _ in range(5)]
    assert len({one.value for one in seeds}) == 5
    assert not any(one.stated for one in seeds)


def ended(service: Service, run: int, **more: Any) -> None:
    """The run has a verdict."""
    with service.engine.begin() as writer:
        values = {"state": "done", "verdict": "cleared", "finished": 2.0, **more}
        writer.execute(sa.update(Run).where(Run.id == run).values(**values))


def test_a_seed_that_an_earlier_run_drew_is_repeated_and_any_other_is_stated(
    service: Service, client: httpx.Client
) -> None:
    run = launched(client)
    first = seed(service, run).value
    assert seed(service, launched(client, sample_seed=first)).stated, "it has no verdict"
    ended(service, run)
    assert seed(service, launched(client, sample_seed=first)) == SampleSeed(first, stated=False)
    assert seed(service, launched(client, sample_seed=first + 1)) == SampleSeed(first + 1, stated=True)
    assert seed(service, launched(client, sample_seed=first + 1)).stated, "stated before, but drawn by no run"
    assert seed(service, launched(client, sample_seed=first, changes={"agreement": 0.1})).stated, "of another campaign"


EVALUATES = Versions(clearance="1", code="a", model="m", components={"mine.py": "1"}, python="3.11")
OTHERS = {
    "the same": (EVALUATES, False),
    "another search": (EVALUATES.model_copy(update={"code": "b"}), False),
    "another loop": (EVALUATES.model_copy(update={"code": "b", "model": "n"}), True),
    "another component": (EVALUATES.model_copy(update={"components": {"mine.py": "2"}}), True),
    "another package": (EVALUATES.model_copy(update={"python": "3.12"}), True),
    "a command of the campaign file": (EVALUATES.model_copy(update={"command": "fly"}), True),
}


@pytest.mark.parametrize("name", OTHERS)
def test_a_sample_is_new_only_to_the_code_for_which_it_was_drawn(
    service: Service, client: httpx.Client, name: str
) -> None:
    """Else code could be written that passes its points: a run that requested the seed has a stated one, and one that
    continues another draws its own."""
    then, other = OTHERS[name]
    run = launched(client)
    drawn = seed(service, run)
    ended(service, run, flown=then.model_dump(mode="json"))
    requested = launched(client, sample_seed=drawn.value)
    with service.engine.begin() as writer:
        onward = succeed(writer, run, Campaign.model_validate(campaign()), 10, CATALOGUE)
        assert settle(writer, run, EVALUATES) is None, "its own"
        assert settle(writer, requested, EVALUATES) == (SampleSeed(drawn.value, stated=True) if other else None)
        continued = settle(writer, onward, EVALUATES)
    assert (continued is not None) == other
    assert continued is None or (continued.value != drawn.value and not continued.stated)


def test_a_seed_that_was_flown_by_other_code_in_between_is_still_that_of_the_first(
    service: Service, client: httpx.Client
) -> None:
    run = launched(client)
    first = seed(service, run).value
    ended(service, run, flown=EVALUATES.model_dump(mode="json"))
    between = launched(client, sample_seed=first)
    other = OTHERS["another loop"][0].model_dump(mode="json")
    ended(service, between, flown=other, sample_seed_stated=True)
    last = launched(client, sample_seed=first)
    with read(service.engine) as reader:
        assert settle(reader, last, EVALUATES) is None


@pytest.mark.parametrize("requested", [False, True])
def test_a_run_that_begins_again_draws_again_unless_the_seed_was_requested(
    service: Service, client: httpx.Client, requested: bool
) -> None:
    run = launched(client)
    before = seed(service, run)
    if requested:
        ended(service, run, flown=EVALUATES.model_dump(mode="json"))
        run = launched(client, sample_seed=before.value)
    launched(client, sample_seed=before.value)  # a later one that names the seed keeps it for nobody
    with service.engine.begin() as writer:
        empty(writer, run)
    assert (seed(service, run) == before) == requested
    assert not seed(service, run).stated


@pytest.mark.parametrize("bad", [-1, 2**52, 1.5, "1x"])
def test_what_is_no_seed_is_refused(client: httpx.Client, bad: Any) -> None:
    answer = client.post("/api/v1/runs", json={"campaign": campaign(), "sample_seed": bad})
    assert answer.status_code == 422


def test_a_run_that_continues_another_has_its_seed(service: Service, client: httpx.Client) -> None:
    run = launched(client)
    with service.engine.begin() as writer:
        found = succeed(writer, run, Campaign.model_validate(campaign()), 10, CATALOGUE)
    assert seed(service, found) == seed(service, run)


def test_the_runs_that_ask_the_same_question_are_counted(service: Service, client: httpx.Client) -> None:
    run = launched(client)
    launched(client, changes={"name": "Another name", "seed": 7})
    launched(client, changes={"uncertain": {"vehicle.m": {"plus_minus": "10%"}}})
    with service.engine.begin() as writer:
        writer.execute(sa.update(Run).where(Run.id == run).values(verdict="cleared", removed=1.0))
        writer.execute(sa.update(Run).where(Run.id == run).values(removed=None))
    assert client.get(f"/api/v1/runs/R-{run:04d}/related").json()["question"] == {"cleared": 1, "none": 1}


@pytest.mark.parametrize(
    ("stages", "samples"), [({}, 300), ({"certify": None}, None), ({"certify": {"samples": 7}}, 7)]
)
def test_a_campaign_that_does_not_speak_of_a_sample_draws_one(stages: dict[str, Any], samples: int | None) -> None:
    search = {"search": [{"method": "direct", "evaluations": 10}]}
    found = Campaign.model_validate(campaign(stages=search | stages))
    drawn = found.stages.certify
    assert (None if drawn is None else drawn.samples) == samples
    assert ("certify: null" in to_yaml(found)) == (samples is None)
    assert Campaign.model_validate(found.document()).digest == found.digest


@pytest.mark.parametrize(
    ("column", "item"), [("sample_seed", "sample.seed"), ("sample_seed_stated", "sample.drawn_at_launch")]
)
def test_the_audit_compares_the_seed_of_the_sample_with_that_of_the_launch(
    service: Service, client: httpx.Client, column: str, item: str
) -> None:
    run = launched(client)
    finish_fully(service)
    with service.engine.begin() as writer:
        certify = (Stage.run_id == run, Stage.kind == "certify")
        result = writer.scalar(sa.select(Stage.result).where(*certify)) or {}
        own = {"seed": seed(service, run).value, "drawn_at_launch": True}
        writer.execute(sa.update(Stage).where(*certify).values(result={**result, **own}))

    def agrees() -> bool:
        with read(service.engine) as reader:
            stated, launch = of_database(reader, run).twice[item]
        return bool(stated == launch)

    assert agrees()
    with service.engine.begin() as writer:
        writer.execute(sa.update(Run).where(Run.id == run).values({column: 5 if column == "sample_seed" else True}))
    assert not agrees()
