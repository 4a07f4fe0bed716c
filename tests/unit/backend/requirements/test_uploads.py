"""Files that would take time or memory of the service are read by a process that is ended."""

from __future__ import annotations

import sys
from typing import get_args

import pytest

from backend.http.errors import RefusedError
from backend.requirements import uploads
from backend.requirements.reqif import MOST_ATTRIBUTES
from backend.requirements.schemas import FileKind

HEAD = b"<REQ-IF>"
OBJECT = b'<SPEC-OBJECT IDENTIFIER="a" DESC="Keep 0.5 m."/>'
MANY = b"<A " + b" ".join(b'a%d="1"' % i for i in range(MOST_ATTRIBUTES + 1)) + b"/>"


def test_every_kind_is_read_by_the_process() -> None:
    files = {"csv": b"id,text,owner\nR-1,Keep 0.5 m.,ada\n", "reqif": HEAD + OBJECT + b"</REQ-IF>"}
    assert files.keys() == set(get_args(FileKind))
    for kind in get_args(FileKind):
        (found,), skipped = uploads.read(kind, files[kind], "", "")
        assert (found.text, skipped) == ("Keep 0.5 m.", 0)


@pytest.mark.parametrize(
    ("inside", "sentence"),
    [
        (MANY, "64 XML attributes"),
        (b"<" + b"n" * 201 + b"/>", "200 characters"),
        (b"<a " + b"n" * 201 + b'="1"/>', "200 characters"),
        (OBJECT * 2, "more than once"),
    ],
    ids=["attributes", "name of an element", "name of an attribute", "twice"],
)
def test_a_strange_file_is_refused_in_a_sentence(inside: bytes, sentence: str) -> None:
    with pytest.raises(RefusedError, match=sentence) as refused:
        uploads.read("reqif", HEAD + inside + b"</REQ-IF>", "", "")
    assert refused.value.status == 422


CHILD = "import backend.requirements.reading as r; r.SECONDS = 1; r.read = {}; r.main()"
"""The process with another reader."""


@pytest.mark.by_day(1)
@pytest.mark.parametrize(
    "program",
    [
        "while True: pass",
        CHILD.format("lambda *given: [0 for _ in iter(int, 1)]"),
        CHILD.format("lambda *given: bytes(r.MEMORY)"),
    ],
    ids=["does not end", "processor time", "memory"],
)
def test_a_process_beyond_its_limits_is_ended(program: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(uploads, "READER", (sys.executable, "-c", program))
    monkeypatch.setattr(uploads, "LIMIT", 0.5 if program.startswith("while") else uploads.LIMIT)
    with pytest.raises(RefusedError, match="512 MB") as refused:
        uploads.read("csv", b"id,text\n", "", "")
    assert refused.value.status == 422


def test_the_process_has_none_of_our_settings(monkeypatch: pytest.MonkeyPatch) -> None:
    program = "import os, json; print(json.dumps({'refused': ' '.join(os.environ)}))"
    monkeypatch.setattr(uploads, "READER", (sys.executable, "-c", program))
    monkeypatch.setenv("CLEARANCE_WEBHOOK_SECRET", "secret")
    with pytest.raises(RefusedError, match="PATH") as refused:
        uploads.read("csv", b"id,text\n", "", "")
    assert "CLEARANCE" not in refused.value.detail
