"""The OpenAPI document, its operations, and conformance of responses."""

from __future__ import annotations

import json
import re
from typing import Any

import httpx

from backend.http.schema import UNIX_TIME
from tools import openapi

JSON = "application/problem+json"

TEXT = openapi.text()
DOCUMENT = json.loads(TEXT)

OPERATIONS = [
    (path, method, operation) for path, methods in DOCUMENT["paths"].items() for method, operation in methods.items()
]


def conforms(value: Any, schema: dict[str, Any], where: str = "") -> None:
    """Hold a value against the few words of JSON Schema that decide the generated types."""
    if "$ref" in schema:
        schema = DOCUMENT["components"]["schemas"][schema["$ref"].rsplit("/", 1)[-1]]
    for choice in ("anyOf", "oneOf"):
        if choice in schema:
            for option in schema[choice]:
                try:
                    return conforms(value, option, where)
                except AssertionError:
                    continue
            raise AssertionError(f"{where}: {value!r} fits none")
    kinds = {"object": dict, "array": list, "string": str, "integer": int, "number": (int, float), "boolean": bool}
    if schema.get("type") == "null":
        assert value is None, where
    elif "type" in schema:
        assert isinstance(value, kinds[schema["type"]]), f"{where}: {value!r} is no {schema['type']}"
    if schema.get("type") == "number":  # 2001 to 2096: no other number of an answer is this large
        time, marked = 1e9 <= value < 4e9, schema.get("format") == UNIX_TIME
        assert time == marked or value == 0.0, f"{where}: {value!r}; a time is an Instant, and nothing else is"
    if "enum" in schema:
        assert value in schema["enum"], where
    if isinstance(value, dict):
        assert set(schema.get("required", [])) <= value.keys(), where
        for key, inner in value.items():
            rule = schema.get("properties", {}).get(key, schema.get("additionalProperties", True))
            assert rule is not False, f"{where}.{key} is not described"
            if isinstance(rule, dict):
                conforms(inner, rule, f"{where}.{key}")
    if isinstance(value, list) and isinstance(schema.get("items"), dict):
        for i, inner in enumerate(value):
            conforms(inner, schema["items"], f"{where}.{i}")
    return None


def held(answer: httpx.Response, operation: dict[str, Any], elsewhere: bool = False) -> None:
    """The answer is one of those that the operation declares, its problem's type and its headers included.

    elsewhere: what was put into its path made it the address of something else, or of nothing.
    """
    status = str(answer.status_code)
    assert answer.status_code < 500 or status == "503", answer.text[:400]
    if answer.status_code >= 400:
        assert answer.headers["content-type"] == JSON
        assert answer.json()["status"] == answer.status_code
        assert len(answer.content) < 100_000
        answer.content.decode()
    if elsewhere:
        return
    assert status in operation["responses"], (status, answer.text[:300])
    declared = operation["responses"][status]
    if answer.status_code >= 400:
        assert answer.json()["type"] in declared["x-problem-types"]
    for header in ("Location", "ETag", "Retry-After"):
        assert header not in answer.headers or header in declared["headers"]


def filled(path: str) -> str:
    """A path that the route has: `{run}` becomes x1, and `{rest:path}` x1/x2."""
    return re.sub(r"{[a-z]+}", "x1", re.sub(r"{[a-z]+:path}", "x1/x2", path))
