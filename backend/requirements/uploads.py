"""Has uploaded files read by a process of their own, so that no file takes memory or time of the service."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections import Counter
from collections.abc import Sequence

from pydantic import TypeAdapter, ValidationError

from backend.http.errors import RefusedError
from backend.requirements.reqif import CannotRead, Read
from backend.requirements.schemas import FileKind
from campaigns import Problem
from campaigns.asked.requirements import RequirementId
from campaigns.asked.values import Notes

READER = (sys.executable, "-P", "-m", "backend.requirements.reading")
LIMIT = 30.0
"""Time limit of a file [s], its processor time has a lower one; on a busy machine the process waits for a core."""

_TOO_MUCH = "reading the file takes more than 10 s or 512 MB, which is the limit: export fewer requirements at a time"
_ID: TypeAdapter[str] = TypeAdapter(RequirementId)
_TEXT: TypeAdapter[str] = TypeAdapter(Notes)


def read(kind: FileKind, content: bytes, id_name: str, text_name: str) -> tuple[list[Read], int]:
    """The requirements of a file; 422 with a sentence for a file that is not acceptable."""
    try:
        found, skipped = _read(kind, content, id_name, text_name)
        _check(found)
    except CannotRead as error:
        raise RefusedError("unreadable", f"{error}", [Problem("file", "", f"{error}")]) from None
    return found, skipped


def _read(kind: FileKind, content: bytes, id_name: str, text_name: str) -> tuple[list[Read], int]:
    head = json.dumps({"kind": kind, "id": id_name, "text": text_name}).encode() + b"\n"
    environment = {key: value for key, value in os.environ.items() if not key.startswith("CLEARANCE_")}
    try:
        ended = subprocess.run(READER, input=head + content, capture_output=True, timeout=LIMIT, env=environment)
    except subprocess.TimeoutExpired:
        raise CannotRead(_TOO_MUCH) from None
    if ended.returncode < 0 or b"MemoryError" in ended.stderr:  # ended by a limit
        raise CannotRead(_TOO_MUCH)
    if ended.returncode:
        raise RuntimeError(f"the process that reads files failed: {ended.stderr[-2000:].decode(errors='replace')}")
    answer = json.loads(ended.stdout)
    if "refused" in answer:
        raise CannotRead(answer["refused"])
    return [Read(*one) for one in answer["found"]], answer["skipped"]


def _check(found: Sequence[Read]) -> None:
    twice = next((key for key, count in Counter(one.id for one in found).items() if count > 1), None)
    if twice is not None:
        raise CannotRead(
            f"the id {twice[:80]!r} occurs more than once: name the attribute that holds unique ids; in a ReqIF file "
            "IDENTIFIER is the object's own"
        )
    for one in found:
        for adapter, value, what in ((_ID, one.id, "id"), (_TEXT, one.text, "text")):
            try:
                adapter.validate_python(value)
            except ValidationError as error:
                reason = error.errors()[0]["msg"].removeprefix("Value error, ")
                raise CannotRead(f"the {what} of {one.id[:80]!r} is not acceptable: {reason}") from None
