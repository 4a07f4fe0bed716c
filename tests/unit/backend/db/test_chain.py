"""The hash chain of the audit trail: what is changed, missing or reordered is found and named."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from typing import Any

import pytest

from backend.db.chain import COVERED, FIRST, MOST, Head, digest, head, verify
from tests.given.chain_faults import rows_of

Rows = list[dict[str, Any]]


def made(number: int = 6) -> Rows:
    rows: Rows = []
    for i in range(1, number + 1):
        detail = {"é": "α\u2028", "margin": -0.1875, "n": i, "nested": {"b": [1, None, True], "a": 1e-300}}
        row = {"id": i, "at": 1.8e9 + i / 3, "user": "ada", "via": "link", "action": "run.edited", "subject": "R-0001"}
        row |= {"detail": detail, "previous": rows[-1]["hash"] if rows else FIRST}
        rows.append(row | {"hash": digest(row)})
    return rows


def changed(rows: Rows, index: int, again: bool = False, **values: Any) -> None:
    rows[index] |= values
    if again:
        rows[index]["hash"] = digest(rows[index])


def test_an_unbroken_chain_has_no_fault_and_its_head_is_the_last_row() -> None:
    rows = made()
    assert verify(rows) == ([], Head(6, rows[-1]["hash"]))
    assert verify([]) == ([], Head(0, FIRST))
    assert verify(rows, stored=Head(6, rows[-1]["hash"]), noted=Head(3, rows[2]["hash"])).faults == []
    assert verify(rows, noted=Head(0, FIRST)).faults == []


def test_a_row_read_back_from_json_has_the_same_hash() -> None:
    rows = [json.loads(json.dumps(row)) for row in made()]
    assert verify(rows).faults == []


@pytest.mark.parametrize("column", [name for name in COVERED if name not in ("id", "previous")])
def test_a_change_of_any_column_is_found(column: str) -> None:
    rows = made()
    changed(rows, 2, **{column: {"other": 1} if column == "detail" else 5.0 if column == "at" else "other"})
    assert rows_of(verify(rows).faults) == [[3]]


BREAKS: list[tuple[Callable[[Rows], Any], list[str]]] = [
    (lambda r: r.pop(2), ["row 3 is missing before row 4"]),
    (lambda r: [r.pop(2), r.pop(2)], ["rows 3 to 4 are missing before row 5"]),
    (lambda r: r.pop(0), ["row 1 is missing before row 2"]),
    # The hash computed again hides the change in the row itself, and shows in the next one.
    (lambda r: changed(r, 2, again=True, user="eve"), ["row 4 does not follow row 3"]),
    (lambda r: r.insert(3, copy.deepcopy(r[2])), ["row 3 follows row 3: the rows were reordered or repeated"]),
    (lambda r: r.__setitem__(slice(2, 4), [r[3], r[2]]), ["row 3 is missing before row 4", "row 3 follows row 4",
                                                        "rows 4 to 4"]),
    (lambda r: changed(r, 2, detail={"bad": float("nan")}), ["row 3 was changed: its content has no canonical form"]),
    (lambda r: changed(r, 5, hash="0" * 64), ["row 6 was changed"]),
]  # fmt: skip


@pytest.mark.parametrize(("broken", "statement"), BREAKS)
def test_what_is_broken_is_named(broken: Callable[[Rows], Any], statement: list[str]) -> None:
    rows = made()
    broken(rows)
    faults = verify(rows).faults
    assert faults
    assert faults[0].startswith(statement[0])


def test_two_rows_that_swapped_their_contents_are_found() -> None:
    rows = made()
    rows[2], rows[3] = {**rows[3], "id": 3}, {**rows[2], "id": 4}
    found = rows_of(verify(rows).faults)
    assert [3, 2] in found, "it does not follow"
    assert [3] in found, "it was changed"


def test_rows_missing_at_the_end_are_found_by_a_head_only() -> None:
    rows = made()
    last = Head(6, rows[-1]["hash"])
    del rows[4:]
    assert verify(rows).faults == [], "the chain alone cannot show it"
    assert rows_of(verify(rows, stored=last).faults) == [[2, 6, 4]]
    assert rows_of(verify(rows, noted=last).faults) == [[2, 6, 4]]
    assert rows_of(verify(rows, noted=Head(5, FIRST)).faults) == [[5, 4]], "one is missing"


def test_a_chain_that_was_computed_again_is_found_by_a_noted_head_only() -> None:
    rows, honest = made(), made()
    before = FIRST
    for row in rows:
        row["user"] = "eve" if row["id"] == 2 else row["user"]
        row["previous"] = before
        row["hash"] = before = digest(row)
    assert verify(rows).faults == [], "whoever may write the database can do this"
    assert verify(rows, noted=Head(1, honest[0]["hash"])).faults == [], "row 1 is the same"
    assert rows_of(verify(rows, noted=Head(4, honest[3]["hash"])).faults) == [[4]]


def test_every_fault_has_its_sentence() -> None:
    changed_row, without_a_form, short = made(), made(), made(4)
    changed(changed_row, 2, user="eve")
    changed(without_a_form, 2, detail={"n": float("nan")})
    orders = [[0, 1, 1, 3], [0, 1, 4], [0, 1, 5]]
    repeated, gap, gaps = ([copy.deepcopy(made()[k]) for k in order] for order in orders)
    unlinked, last = made(), Head(6, made()[-1]["hash"])
    changed(unlinked, 2, again=True, previous=FIRST)
    faults = [verify(rows).faults for rows in (changed_row, without_a_form, repeated, gap, gaps, unlinked)]
    heads = [verify(short, stored=last), verify(short, noted=last), verify(short, noted=Head(5, FIRST))]
    heads += [verify(short, noted=Head(4, FIRST)), verify(short, stored=Head(3, FIRST))]
    assert [found[0] for found in (*faults, *(head.faults for head in heads))] == [
        "row 3 was changed: its hash is not that of its content",
        "row 3 was changed: its content has no canonical form",
        "row 2 follows row 2: the rows were reordered or repeated",
        "rows 3 to 4 are missing before row 5",
        "rows 3 to 5 are missing before row 6",
        "row 3 does not follow row 2: one of the two was replaced, or they were reordered",
        "the last 2 rows are missing: the database's own head names row 6, the trail ends with row 4",
        "the last 2 rows are missing: the noted head names row 6, the trail ends with row 4",
        "the last row is missing: the noted head names row 5, the trail ends with row 4",
        "row 4 has another hash than the noted head: it or a row before it was changed",
        "the database's own head names row 3 with another hash than the trail, which ends with row 4",
    ]


def test_numbers_with_gaps_are_no_fault_while_the_rows_link() -> None:
    rows = made(2)
    rows[1]["id"] = 9
    rows[1]["hash"] = digest(rows[1])
    assert verify(rows).faults == []
    assert "row 5" in verify(rows, noted=Head(5, FIRST)).faults[0]


def test_many_faults_are_shortened() -> None:
    rows = made(50)
    for row in rows:
        row["user"] = "eve"
    faults = verify(rows).faults
    assert len(faults) == MOST + 1
    assert faults[-1] == "and 30 more faults"


@pytest.mark.parametrize("text", ["", "x", "12", "12:", "-1:" + "0" * 64, "12:" + "0" * 63, "12:" + "G" * 64, "1" * 40])
def test_a_head_that_is_none_is_refused_with_a_sentence(text: str) -> None:
    with pytest.raises(ValueError, match="clearance trail head"):
        head(text)


def test_a_head_is_read_as_it_is_printed() -> None:
    one = Head(12, "ab" * 32)
    assert head(f" {one}\n") == one
