"""Many evaluations are stored in chunks of a few thousand, whose rows are those of the whole."""

from __future__ import annotations

import numpy as np
import pytest

from backend.db.rows import MOST_ROWS, as_columns, chunk_rows
from campaigns.stored.records import Columns, join


@pytest.mark.parametrize("count", [0, 1, MOST_ROWS, MOST_ROWS + 1, 2 * MOST_ROWS + 3])
def test_chunks_together_are_the_whole(count: int) -> None:
    first, random = 70, np.random.default_rng(1)
    reasons = {first + i: f"failed {i}" for i in (MOST_ROWS - 1, MOST_ROWS, 2 * MOST_ROWS) if i < count}
    status = np.array([first + i in reasons for i in range(count)], dtype=np.uint8)
    costs = np.where(status[:, None] == 1, np.nan, random.random((count, 2)))
    given = Columns(random.random((count, 3)), costs, status, random.random(count), reasons)
    rows = chunk_rows(5, 2, first, given)
    assert [row["first"] for row in rows] == list(range(first, first + count, MOST_ROWS))
    assert sum(row["count"] for row in rows) == count
    assert all(row["count"] <= MOST_ROWS and (row["run_id"], row["position"]) == (5, 2) for row in rows)
    for row in rows:
        assert all(row["first"] <= int(index) < row["first"] + row["count"] for index in row["reasons"])
    found = join([as_columns(_Row(row)) for row in rows])
    assert (found is None) == (count == 0)
    if found is not None:
        for column, other in zip(found[:4], given[:4], strict=True):
            assert column.tobytes() == other.tobytes()
        assert found.reasons == reasons


class _Row:
    """The values as a row of the database."""

    def __init__(self, values: dict[str, object]) -> None:
        self.__dict__.update(values)
