"""The evidence digest of a run: one number over its campaign, every stored evaluation, and all results.

Result, report, sign-off, matrix and audit state it; `evidence_digest` is the only place that computes it. Whoever can
write a record can compute it again: it shows a change only to those who know it from elsewhere, such as a sign-off.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np

from campaigns.documents import digest_of


class Rows(NamedTuple):
    """Evaluations of a stage in their order: points (m, n) and costs (m, k) as 64-bit numbers, status (m,) as bytes,
    each little-endian."""

    position: int
    points: bytes
    costs: bytes
    status: bytes

    @staticmethod
    def of(position: int, points: Any, costs: Any, status: Any) -> Rows:
        return Rows(position, numbers(points), numbers(costs), np.ascontiguousarray(status, dtype=np.uint8).tobytes())


def evidence_digest(campaign: str, evaluations: Iterable[Rows], documents: Mapping[str, Any]) -> str:
    """64 hexadecimal digits. campaign: the digest of its document; evaluations: in the order of the stages, a stage in
    any number of parts; documents: all other results, as JSON."""
    sums: dict[int, list[Any]] = {}
    for position, *columns in evaluations:
        totals = sums.setdefault(position, [hashlib.sha256() for _ in columns])
        for total, column in zip(totals, columns, strict=True):
            total.update(column)
    rows = [[position, *(total.hexdigest() for total in found)] for position, found in sums.items()]
    return digest_of({**documents, "campaign": campaign, "rows": rows})


def numbers(array: Any) -> bytes:
    """Numbers as bytes; every NaN has the same."""
    values = np.ascontiguousarray(array, dtype="<f8")
    return np.where(np.isnan(values), np.nan, values).tobytes()
