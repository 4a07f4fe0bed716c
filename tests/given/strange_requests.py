"""Requests with values that break parsers, drivers and databases, for any operation of the OpenAPI document."""

from __future__ import annotations

import base64
import json
from functools import cache
from typing import Any

from hypothesis import strategies as st

from tests.given.openapi_document import OPERATIONS
from tests.given.small_catalogue import campaign

DIGITS = "@digits@"
"""Stands for a number of 5,000 digits, which Python's own writer refuses."""

TEXTS = [
    *("", " ", "0", "-1", "1", "2", "nan", "inf", "1e400", "true", "null", "F1", "R-0001", "D-0001"),
    *("R-٣٣٣٣", "R-٠٠٠١", "D-٠٠٠١", "F٣", "²", "１", "\0", "a\0b", "R-0001\0", "é", "%", "..", "a/b", "\n"),
    *("9" * n for n in (10, 15, 19, 20, 400, 5000)),
    *("R-" + "9" * n for n in (9, 15, 16, 5000)),
    *("D-" + "9" * n for n in (9, 10)),
    *(str(2**n + k) for n in (31, 32, 53, 62, 63, 64) for k in (-1, 0)),
    *("x" * 300, "x" * 17_000, "v" * 64),
    "00000000-0000-4000-8000-000000000000",
]  # fmt: skip
VALUES: list[Any] = [
    *(None, True, 0, -1, 1, 2**31 - 1, 2**31, 2**32, 2**53, 2**63 - 1, 2**63, 2**64, -(2**63) - 1, 10**300, DIGITS),
    *(1e308, float("inf"), float("nan"), "", "\0", "a\0", "\ud800", "x\udfff", "٣", "x" * 300, "x" * 50_000, "R-٠٠٠١"),
    *([], {}, [None] * 600, ["\ud800"] * 60, {"\ud800": 1}, {"\0": "\0"}, {str(i): i for i in range(300)}, [[[[[]]]]]),
    *([2**64], {"x": 2**64}, {"x": ["a\0"]}, [DIGITS]),
]  # fmt: skip
SORTS = ("-created", "created", "name", "-worst", "tags", "duration")
HEADERS: dict[str, list[bytes]] = {
    "Idempotency-Key": [b"\xff\xfe", b"k" * 128, b"k" * 129, b"", b"\xc2\xb2"],
    "Last-Event-ID": [b"9" * 400, b"nan", b"inf", b"-1", b"\xb2", b"x" * 2000, b"1e400"],
    "If-None-Match": [b"\xff", b"*", b'W/"x"' * 500],
    "Accept-Encoding": [b"\xff", b"br;q=\xb2"],
    "Content-Type": [b"\xff", b"application/json; charset=\xff", b"application/yaml", b"text/csv", b""],
    "Authorization": [b"Bearer \xff", b"Bearer " + b"x" * 5000, b"\xff", b"Basic x"],
    "Origin": [b"http://[", b"null", b"\xff", b"http://x:99999999"],
}
SIGNED = "0" * 64
BODIES: dict[tuple[str, str], dict[str, Any]] = {
    ("post", "/runs"): {"campaign": campaign(), "name": "n", "tags": ["t"], "text": "x: 1", "priority": 0},
    ("post", "/campaigns/check"): {"campaign": campaign()},
    ("post", "/campaigns/preview"): {"campaign": campaign()},
    ("post", "/drafts"): {"name": "n", "tags": ["t"], "text": "x"},
    ("put", "/drafts/{draft}"): {"name": "n", "tags": [], "text": "x", "version": 1, "run": "R-0001"},
    ("post", "/runs/cancel"): {"runs": ["R-0001"]},
    ("post", "/runs/remove"): {"runs": ["R-0003"], "reason": "r"},
    ("post", "/runs/restore"): {"runs": ["R-0001"]},
    ("patch", "/runs/{run}"): {"name": "n", "tags": ["t"], "notes": "n", "pinned": False, "notes_before": ""},
    ("post", "/runs/{run}/signoffs"): {"name": "n", "role": "r", "comment": "c", "digest": SIGNED},
    ("post", "/runs/{run}/signoffs/{signoff}/withdraw"): {"reason": "r"},
    ("patch", "/runs/{run}/views/{key}"): {
        "flight": "F1", "time": 1.0, "eye": {"position": [0, 0, 0], "target": [0, 0, 0]}, "speed": 1.0,
        "layers": {"trail": "whole", "axes": ["value", "none", "none"]}, "what_if": {"vehicle.m": 5.0},
    },
}  # fmt: skip


def cursors() -> st.SearchStrategy[str]:
    """Cursors of the right form with values of the wrong kind."""

    def made(parts: tuple[Any, ...]) -> str:
        text = json.dumps(parts).replace(f'"{DIGITS}"', "9" * 400)
        return base64.urlsafe_b64encode(text.encode()).decode().rstrip("=")

    return st.tuples(st.sampled_from(SORTS), st.booleans(), st.sampled_from(VALUES), st.sampled_from(VALUES)).map(made)


@cache
def places(document: str) -> list[tuple[Any, ...]]:
    """Every location in a body, as keys from the root."""
    found: list[tuple[Any, ...]] = []

    def walk(value: Any, at: tuple[Any, ...]) -> None:
        found.append(at)
        pairs = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
        for key, inner in pairs:
            walk(inner, (*at, key))

    walk(json.loads(document), ())
    return found


def replaced(document: Any, at: tuple[Any, ...], value: Any) -> Any:
    if not at:
        return value
    made = dict(document) if isinstance(document, dict) else list(document)
    made[at[0]] = replaced(made[at[0]], at[1:], value)
    return made


@st.composite
def bodies(draw: st.DrawFn, whole: dict[str, Any]) -> bytes:
    """A body with an invalid value at one location, or no body."""
    text = json.dumps(whole)
    if draw(st.integers(0, 9)) == 0:
        return draw(
            st.sampled_from([b"", b"{", b"\xff", b"[" * 50_000, b"9" * 5000, text.encode("utf-16"), b'"\\ud800"'])
        )
    made = replaced(whole, draw(st.sampled_from(places(text))), draw(st.sampled_from(VALUES)))
    return json.dumps(made).replace(f'"{DIGITS}"', "9" * 5000).encode()


@st.composite
def requests(draw: st.DrawFn, path: str, method: str, operation: dict[str, Any]) -> dict[str, Any]:
    """A request to the operation, strange in its path, query, headers and body."""
    query: list[tuple[str, str]] = []
    elsewhere = False
    for parameter in operation.get("parameters", []):
        name, kind = parameter["name"], parameter["in"]
        wild = st.sampled_from(TEXTS)
        if kind == "path":
            known = {
                "run": ["R-0001", "R-0002"],
                "draft": ["D-0001"],
                "signoff": ["1"],
                "name": ["F1"],
                "flight": ["F1"],
            }
            value = draw(st.sampled_from(known.get(name, ["x"])) | wild)
            if path.endswith("report.pdf") and value.startswith("R-000"):
                value = "R-9999"  # a browser would be started
            elsewhere |= value in ("", "..") or "/" in value
            path = path.replace(f"{{{name}}}", quoted(value))
        elif kind == "query":
            values = draw(st.lists(cursors() | wild if name == "cursor" else wild, max_size=2))
            if name == "wait" or (name == "run" and path.endswith("/events")):
                values = [v for v in values if not v.isdecimal() or len(v) > 9 or int(v) > 30]
            query += [(name, value) for value in values]
            if draw(st.integers(0, 14)) == 0:
                query += [(name, "x")] * draw(st.sampled_from([60, 199, 3000]))
    headers = {}
    if draw(st.booleans()):
        name = draw(st.sampled_from(list(HEADERS)))
        headers[name] = draw(st.sampled_from(HEADERS[name]))
    whole = BODIES.get((method, path_of(operation)))
    content = None if whole is None else draw(bodies(whole))
    if content is not None:
        headers.setdefault("Content-Type", b"application/json")
    target = f"{path}?{'&'.join(f'{k}={quoted(v)}' for k, v in query)}"[:60_000]  # as long as an address can be sent
    asked = {"method": method.upper(), "url": target, "headers": headers, "content": content}
    return asked | {"extensions": {"elsewhere": elsewhere}}


def quoted(value: str) -> str:
    return "".join(f"%{byte:02x}" if not chr(byte).isalnum() or byte > 127 else chr(byte) for byte in value.encode())


def path_of(operation: dict[str, Any]) -> str:
    return next(p for p, _, o in OPERATIONS if o is operation).removeprefix("/api/v1")
