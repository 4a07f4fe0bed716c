"""Requirements and the matrix as CSV (RFC 4180)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from datetime import UTC, datetime

from backend.http.written import lines as written
from backend.requirements.schemas import RequirementRow, RequirementRun
from backend.requirements.table import EXPORTED
from backend.signoffs.schemas import signed_by
from campaigns.cells import kept
from campaigns.results.verdict import headline

MOST_COLUMNS = 200
"""Attributes with a column of their own."""

_MATRIX = (
    "requirement", "text", "status", "why", "run", "counts", "campaign", "verdict", "quantity", "unit", "threshold",
    "worst", "margin", "p_violation_bound", "campaign_sha256", "code_sha256",
    "evidence_sha256", "date", "signed", "signed_by", "suspect",
    "changes", "role", "p_violation_bound_source", "policy", "excluded_samples", "excluded_fraction",
)  # fmt: skip


def requirements(rows: Iterable[RequirementRow]) -> Iterator[bytes]:
    """All requirements with id, text and status, and the other attributes of their files.

    The most frequent attributes have columns of their own: every row has all columns, and files may name any number.
    One that has the name of a column of the matrix, such as status, is headed `status (file)`.
    """
    listed = list(rows)
    used = Counter(name for row in listed for name in row.attributes)
    more = sorted(name for name, _ in used.most_common(MOST_COLUMNS))
    rest = set(used) - set(more)
    heads = [*EXPORTED]
    for name in more:
        heads.append(name if name not in heads else _free(f"{name} (file)", heads))
    yield written([map(kept, [*heads, *(["other attributes"] if rest else [])])])
    for row in listed:
        values = (row.id, row.text, row.status, row.sentence, row.file or "")
        others = "; ".join(f"{name}: {value}" for name, value in row.attributes.items() if name in rest)
        cells = (*values, *(row.attributes.get(name, "") for name in more), *([others] if rest else []))
        yield written([map(kept, cells)])


def matrix(rows: Iterable[RequirementRow]) -> Iterator[bytes]:
    """A line for each requirement and run, the runs that count first; one line for a requirement without a run, and one
    that states how many older runs are not listed."""
    yield written([_MATRIX])
    for row in rows:
        before = [row.id, row.text, row.status, row.sentence]
        if not row.runs:
            yield written([[*before, *[""] * (len(_MATRIX) - len(before))]])
        for run in row.runs:
            yield written([[*before, *_run(run)]])
        if row.unlisted:
            before[-1] = f"{row.unlisted} older runs are not listed"
            yield written([[*before, *[""] * (len(_MATRIX) - len(before))]])


def _run(run: RequirementRun) -> list[object]:
    signed = "; ".join(f"{signed_by(s)}, {stamp(s.created)}, {s.sentence}" for s in run.signoffs)
    return [
        run.id, run.part, run.campaign_name, headline(run.verdict or run.state, run, None, run.against),
        run.quantity, run.unit,
        run.threshold, run.worst_cost, run.margin, run.upper_bound, run.campaign_digest, run.code or "",
        run.evidence_digest or "",
        stamp(run.finished or run.created), "yes" if run.signed else "no", signed, "yes" if run.suspect else "no",
        "; ".join(run.changes), run.role, run.bound_source or "", run.policy or "",
        run.excluded_samples, run.excluded_fraction,
    ]  # fmt: skip


def _free(head: str, heads: Sequence[str]) -> str:
    return head if head not in heads else _free(f"{head} (file)", heads)


def stamp(at: float) -> str:
    return datetime.fromtimestamp(at, UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
