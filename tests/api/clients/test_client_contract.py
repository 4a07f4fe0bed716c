"""Every request that the Python client can make is one of the OpenAPI document: address, parameters, body, answer."""

from __future__ import annotations

import inspect
import json
from typing import Any

import pytest
from pydantic import TypeAdapter

from clearance.client import AsyncClient, Client, calls
from clearance.client.calls import Call
from tests.given.openapi_document import DOCUMENT
from tests.given.small_catalogue import campaign
from tools import generated

LAUNCH = {"name": "n", "tags": ["t"], "labels": {"a": "b"}, "priority": 3}
SOME = ["x"]
REQUESTS: dict[str, Call[Any]] = {
    "submit_run": calls.submit(campaign(), baseline="R-0001", group="g", reuse=True, **LAUNCH),
    "get_run": calls.run("R-0001"),
    "list_runs": calls.run_page(
        q="q", state=SOME, verdict=SOME, tag=SOME, campaign=SOME, owner=SOME, label=SOME, sort="-created", cursor="c"
    ),
    "cancel_run": calls.cancel("R-0001"),
    "retry_run": calls.retry("R-0001"),
    "restart_run": calls.restart("R-0001"),
    "continue_run": calls.carry_on("R-0001"),
    "list_findings": calls.findings("R-0001"),
    "get_most_likely": calls.most_likely_violation("R-0001"),
    "list_signoffs": calls.signoffs("R-0001"),
    "list_traces": calls.traces("R-0001"),
    "get_trace": calls.trace_data("R-0001", "F1", 100),
    "list_exports": calls.exports("R-0001"),
    "stream_events": calls.events("R-0001"),
    "check_campaign": calls.check(campaign()),
    "campaign_schema": calls.schema(),
    "health": calls.health(),
    "submit_sweep": calls.sweep(campaign(), "avoider.d_0", [1, 2], **LAUNCH),
    "get_sweep": calls.read_sweep("S-0001"),
    "cancel_sweep": calls.cancel_sweep("S-0001"),
    "get_sweep_table": calls.sweep_table("S-0001"),
    "get_run_campaign": calls.file("R-0001", "campaign.yaml"),
    "export_file": calls.file("R-0001", "run.json"),
    "get_report": calls.file("R-0001", "report.html"),
    "get_report_pdf": calls.file("R-0001", "report.pdf"),
}
"""By the operation that it is, with every argument given."""


def resolved(schema: dict[str, Any], definitions: dict[str, Any]) -> dict[str, Any]:
    name = schema.get("$ref", "").rsplit("/", 1)[-1]
    return definitions[name] if name else schema


def options(schema: dict[str, Any], definitions: dict[str, Any]) -> list[dict[str, Any]]:
    """The alternatives of a schema."""
    schema = resolved(schema, definitions)
    found = schema.get("anyOf") or schema.get("oneOf")
    return [inner for one in found for inner in options(one, definitions)] if found else [schema]


def refused(theirs: dict[str, Any], ours: dict[str, Any], own: dict[str, Any], where: str = "") -> list[str]:
    """What the service may answer and the client cannot read. theirs: of the OpenAPI document; ours: of the client."""
    known = DOCUMENT["components"]["schemas"]
    found = []
    for given in options(theirs, known):
        attempts = [_unfit(given, wanted, own, where) for wanted in options(ours, own)]
        found += min(attempts, key=len)
    return found


def _unfit(given: dict[str, Any], wanted: dict[str, Any], own: dict[str, Any], where: str) -> list[str]:
    kind, expected = given.get("type"), wanted.get("type")
    if expected is None:
        return []
    if wanted.get("format") == "date-time":
        expected = "number"  # seconds since 1970, which are read as a time
    if kind != expected and (kind, expected) != ("integer", "number"):
        return [f"{where} may be {kind}, and is read as {expected}"]
    if kind == "array":
        pairs = zip(*(one.get("prefixItems") or [one["items"]] for one in (given, wanted)), strict=True)
        return [problem for one, other in pairs for problem in refused(one, other, own, f"{where}[]")]
    if kind != "object":
        return []
    fields, there = wanted.get("properties", {}), given.get("properties", {})
    found = [f"{where}.{name} is not described" for name in fields if name not in there]
    absent = set(wanted.get("required", ())) & set(there) - set(given.get("required", ()))
    found += [f"{where}.{name} may be absent" for name in sorted(absent)]
    for name in fields.keys() & there.keys():
        found += refused(there[name], fields[name], own, f"{where}.{name}")
    inner = wanted.get("additionalProperties")
    if isinstance(inner, dict) and isinstance(given.get("additionalProperties"), dict):
        found += refused(given["additionalProperties"], inner, own, f"{where}{{}}")
    return found


def body_problems(body: dict[str, Any] | None, operation: dict[str, Any]) -> list[str]:
    if body is None:
        return ["a body is required"] if operation.get("requestBody", {}).get("required") else []
    given = operation["requestBody"]["content"]["application/json"]["schema"]
    schema = resolved(given, DOCUMENT["components"]["schemas"])
    unknown = body.keys() - schema["properties"].keys()
    missing = set(schema.get("required", ())) - body.keys()
    return [f"{name} is not in the body" for name in unknown] + [f"{name} is required" for name in missing]


def problems(name: str, call: Call[Any]) -> list[str]:
    """Where a request differs from the operation of this name."""
    operation = DOCUMENT["paths"].get(f"/api/v1{call.path}", {}).get(call.method.lower())
    if operation is None or operation["operationId"] != name:
        return [f"{call.method} {call.path} is not {name}"]
    places: dict[str, set[str]] = {"path": set(), "query": set(), "header": set()}
    for parameter in operation.get("parameters", ()):
        places[parameter["in"]].add(parameter["name"])
    found = [f"{key} is not a query parameter" for key in call.query.keys() - places["query"]]
    if call.place.keys() != places["path"]:
        found.append(f"the path has {places['path']}, given {set(call.place)}")
    if call.key is not None and "Idempotency-Key" not in places["header"]:
        found.append("it takes no Idempotency-Key")
    found += body_problems(call.body, operation)
    (content,) = [a["content"] for status, a in operation["responses"].items() if status.startswith("2")]
    if call.answer is bytes:
        return found
    ours = TypeAdapter(call.answer).json_schema()
    return found + refused(content["application/json"]["schema"], ours, ours.get("$defs", {}), name)


@pytest.mark.parametrize(("name", "call"), REQUESTS.items(), ids=REQUESTS)
def test_a_request_is_one_of_the_document(name: str, call: Call[Any]) -> None:
    assert problems(name, call) == []


def test_every_request_is_compared() -> None:
    made = {
        name for name, function in vars(calls).items()
        if inspect.isfunction(function) and str(function.__annotations__.get("return", "")).startswith("Call[")
    } - {"file"}  # it makes those of `ELSEWHERE`, and one for all exports  # fmt: skip
    assert len(made) + len(calls.ELSEWHERE) + 1 == len(REQUESTS)
    assert {(call.method, call.path) for call in map(calls.file, ["R-0001"] * 4, [*calls.ELSEWHERE, "run.json"])} <= {
        (call.method, call.path) for call in REQUESTS.values()
    }


def test_a_write_may_be_repeated() -> None:
    """It has a key, or doing it twice is the same as doing it once."""
    writes = {name: call.key for name, call in REQUESTS.items() if call.method != "GET"}
    made = {"submit_run", "submit_sweep", "retry_run", "restart_run", "continue_run"}
    assert {name for name, key in writes.items() if key} == made
    assert {name for name, key in writes.items() if not key} == {"cancel_run", "cancel_sweep", "check_campaign"}


@pytest.mark.parametrize(
    ("change", "statement"),
    [
        ({"path": "/runs/{run}/finding"}, "is not list_findings"),
        ({"query": {"most": 1}}, "most is not a query parameter"),
        ({"place": {"name": "R-0001"}}, "the path has"),
        ({"key": "k"}, "no Idempotency-Key"),
        ({"answer": list[int]}, "is read as integer"),
        ({"answer": list[dict[str, int]]}, ""),
    ],
)
def test_a_difference_is_noticed(change: dict[str, Any], statement: str) -> None:
    given = {**vars(calls.findings("R-0001")), **change}
    found = problems("list_findings", Call(**given))
    assert statement in " ".join(found)
    assert bool(found) == bool(statement)


def test_an_unread_field_is_noticed() -> None:
    ours = json.loads(json.dumps(TypeAdapter(REQUESTS["get_run"].answer).json_schema()))
    theirs = {"$ref": "#/components/schemas/RunDetail"}
    ours["properties"]["nothing"] = {"type": "string"}
    ours["properties"]["margin"] = {"type": "number"}
    found = refused(theirs, ours, ours["$defs"], "run")
    assert sorted(sentence.split()[0] for sentence in found) == ["run.margin", "run.nothing"]


def test_a_type_of_an_answer_without_a_schema_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, change in (("required", "id nothing"), ("schema", "Nothing")):
        monkeypatch.setattr(generated, "CLASSES", [generated.CLASSES[0]._replace(**{name: change})])
        with pytest.raises(KeyError, match="othing"):
            generated.answers(DOCUMENT)


def test_both_clients_have_the_same_methods() -> None:
    public = [{name for name in dir(kind) if not name.startswith("_")} for kind in (Client, AsyncClient)]
    assert public[0] == public[1]
    for name in public[0] - {"address", "link", "close"}:
        one, other = getattr(Client, name), getattr(AsyncClient, name)
        assert one.__doc__ == other.__doc__, name
        assert one.__doc__, name
        assert inspect.signature(one.script) == inspect.signature(other.script), name
