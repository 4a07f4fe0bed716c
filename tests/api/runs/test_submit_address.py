"""Labels, baseline and reuse in the address of a submission: a YAML body has no place for them."""

from __future__ import annotations

from typing import Any

import httpx
import pytest
import yaml

from tests.given.problem_documents import problem
from tests.given.reported_runs import finish_fully
from tests.given.service import Service
from tests.given.small_catalogue import campaign

YAML = {"Content-Type": "application/yaml"}
Query = dict[str, str | list[str]]


def submitted(client: httpx.Client, query: Query, key: str = "", json: dict[str, Any] | None = None) -> httpx.Response:
    """A submission as YAML, or as JSON if that is given."""
    headers = {"Idempotency-Key": key} if key else {}
    if json is not None:
        return client.post("/api/v1/runs", params=query, json={"campaign": campaign(), **json}, headers=headers)
    text = yaml.safe_dump(campaign())
    return client.post("/api/v1/runs", params=query, content=text, headers=headers | YAML)


def message(answer: httpx.Response, field: str) -> str:
    (error,) = problem(answer, 422)["errors"]
    assert error["field"] == field
    return str(error["message"])


def test_a_yaml_body_takes_labels_and_a_baseline_from_the_address(service: Service, client: httpx.Client) -> None:
    first = submitted(client, {"label": ["branch=main", "commit=4f2a91c"]})
    assert first.status_code == 201, first.text
    assert first.json()["labels"] == {"branch": "main", "commit": "4f2a91c"}
    finish_fully(service, "cleared")
    second = submitted(client, {"label": "branch=wider", "baseline": "label:branch=main"}).json()
    assert second["labels"] == {"branch": "wider"}
    assert (second["baseline"]["asked"], second["baseline"]["run"]) == ("label:branch=main", "R-0001")
    assert client.get("/api/v1/runs/R-0002").json()["campaign"]["baseline"]["run"] == "R-0001"
    service.compare()
    assert submitted(client, {"reuse": "true"}).json()["id"] == "R-0001"


def test_json_takes_them_from_the_address_or_the_body_but_each_once(client: httpx.Client) -> None:
    given = submitted(client, {"label": "branch=main"}, json={"baseline": "label:branch=none"})
    assert given.status_code == 201, given.text
    assert given.json()["labels"] == {"branch": "main"}
    assert given.json()["baseline"]["run"] is None
    twice = submitted(client, {"label": "branch=main"}, json={"labels": {"branch": "main"}})
    assert "give it once" in message(twice, "labels")
    assert "give it once" in message(submitted(client, {"baseline": "R-0001"}, json={"baseline": "R-0001"}), "baseline")


@pytest.mark.parametrize(
    ("query", "field", "statement"),
    [
        ({"label": "main"}, "label", "give KEY=VALUE"),
        ({"label": ["branch=a", "branch=b"]}, "label", "given twice"),
        ({"label": "1=a"}, "label", "invalid label key"),
        ({"label": "a=\n"}, "label", "readable text"),
        ({"label": "a=b\tc"}, "label", "readable text"),
        ({"baseline": ""}, "baseline", "at least 1 character"),
        ({"baseline": "x" * 301}, "baseline", "at most 300 characters"),
        ({"baseline": "main"}, "baseline", "invalid baseline"),
        ({"reuse": "perhaps"}, "reuse", "boolean"),
    ],
)
def test_what_is_not_allowed_is_refused_with_its_name(
    client: httpx.Client, query: Query, field: str, statement: str
) -> None:
    assert statement in message(submitted(client, query), field)
    assert client.get("/api/v1/runs").json()["items"] == []


def test_the_address_is_part_of_what_a_key_repeats(client: httpx.Client) -> None:
    first = submitted(client, {"label": "branch=main"}, key="k")
    assert first.json()["id"] == submitted(client, {"label": "branch=main"}, key="k").json()["id"] == "R-0001"
    for other in ({"label": "branch=slow"}, {}):
        refused = problem(submitted(client, other, key="k"), 422)
        assert "made R-0001" in refused["detail"]
