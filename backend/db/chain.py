"""The hash chain of the audit trail: what a row's hash covers, and how a broken chain is found.

Each row holds the SHA-256 of itself as canonical JSON, which includes the hash of the row before it: whoever changes,
removes, inserts or reorders a row must compute all later hashes again. The chain cannot prove that this was not done:
anyone who may write the database can rewrite the whole of it. A head (number and hash of the newest row) that was noted
elsewhere shows that, and shows rows that are missing at the end. Source: Crosby and Wallach, "Efficient Data Structures
for Tamper-Evident Logging" (USENIX Security 2009), section 2.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, NamedTuple

FIRST = "0" * 64
"""The hash before the first row."""

COVERED = ("id", "at", "user", "via", "action", "subject", "detail", "previous")
MOST = 20
"""Faults that are reported; after a change they can be as many as rows."""


class Head(NamedTuple):
    """The number and the hash of the newest row; 0 in an empty trail."""

    row: int
    hash: str

    def __str__(self) -> str:
        return f"{self.row}:{self.hash}"


def head(text: str) -> Head:
    """The head of `12:HASH`; raises `ValueError`."""
    found = re.fullmatch(r"([0-9]{1,18}):([0-9a-f]{64})", text.strip())
    if found is None:
        raise ValueError(f"invalid head {text[:100]!r}: give NUMBER:HASH, as `clearance trail head` prints it")
    return Head(int(found[1]), found[2])


def digest(row: Mapping[str, Any]) -> str:
    """The hash of a row: keys sorted, no spaces, ASCII only, so that the same values are the same bytes."""
    covered = {name: row[name] for name in COVERED}
    text = json.dumps(covered, sort_keys=True, separators=(",", ":"), ensure_ascii=True, allow_nan=False)
    return hashlib.sha256(text.encode("ascii")).hexdigest()


class Verified(NamedTuple):
    """The outcome: sentences on what is wrong with which row, and the head of the rows that were read."""

    faults: list[str]
    head: Head


def verify(rows: Iterable[Mapping[str, Any]], stored: Head | None = None, noted: Head | None = None) -> Verified:
    """Verify rows in ascending order; stored: the head that the database holds; noted: one that was noted elsewhere."""
    last = Head(0, FIRST)
    found: list[str]
    seen: str | None = FIRST if noted is not None and noted.row == 0 else None

    def passed() -> Iterator[Mapping[str, Any]]:
        nonlocal last, seen
        for row in rows:
            yield row
            last = Head(int(row["id"]), str(row["hash"]))
            if noted is not None and noted.row == last.row:
                seen = last.hash

    found, more = [], 0
    for fault in _broken(passed()):
        found, more = ([*found, fault], more) if len(found) < MOST else (found, more + 1)
    if more:
        found.append(f"and {more:,} more faults")
    if stored is not None and stored != last:
        found.append(_short(last, stored, "the database's own head names"))
    if noted is not None and seen is None:
        found.append(_short(last, noted, "the noted head names"))
    elif noted is not None and seen != noted.hash:
        found.append(f"row {noted.row} has another hash than the noted head: it or a row before it was changed")
    return Verified(found, last)


def _broken(rows: Iterable[Mapping[str, Any]]) -> Iterator[str]:
    before, hash_before = 0, FIRST
    for row in rows:
        number = int(row["id"])
        if number <= before:
            yield f"row {number} follows row {before}: the rows were reordered or repeated"
        elif row["previous"] != hash_before:
            yield _unlinked(before, number)
        try:
            if digest(row) != row["hash"]:
                yield f"row {number} was changed: its hash is not that of its content"
        except (TypeError, ValueError):
            yield f"row {number} was changed: its content has no canonical form"
        before, hash_before = number, str(row["hash"])


def _unlinked(before: int, number: int) -> str:
    """Numbers may have gaps that are older than the chain: only a row that does not link shows a missing one."""
    if number == before + 1:
        return f"row {number} does not follow row {before}: one of the two was replaced, or they were reordered"
    missing = f"row {before + 1} is" if number == before + 2 else f"rows {before + 1} to {number - 1} are"
    return f"{missing} missing before row {number}"


def _short(last: Head, expected: Head, which: str) -> str:
    if expected.row > last.row:
        lost = expected.row - last.row
        rows = "the last row is" if lost == 1 else f"the last {lost} rows are"
        return f"{rows} missing: {which} row {expected.row}, the trail ends with row {last.row}"
    return f"{which} row {expected.row} with another hash than the trail, which ends with row {last.row}"
