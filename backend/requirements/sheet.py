"""Requirements and the matrix as CSV (RFC 4180)."""

from __future__ import annotations

import csv
import io
from collections import Counter
from collections.abc import Iterable, Iterator
from datetime import UTC, datetime

from backend.http.written import lines as written
from backend.requirements.reqif import CannotRead, Read
from backend.requirements.schemas import RequirementRow, RequirementRun
from backend.signoffs.schemas import signed_by
from campaigns.cells import plain
from campaigns.results.verdict import headline

IDS = ("id", "requirement", "requirement id", "uid", "reqif.foreignid")
TEXTS = ("text", "description", "statement", "object text", "reqif.text")
"""Headers of the columns, in any case."""
MOST_COLUMNS = 200
"""Attributes with a column of their own."""

_MATRIX = (
    "requirement", "text", "status", "why", "run", "counts", "campaign", "verdict", "quantity", "unit", "threshold",
    "worst", "margin", "p_violation_bound", "campaign_sha256", "code_sha256",
    "evidence_sha256", "date", "signed", "signed_by", "suspect",
    "changes",
)  # fmt: skip


def read(content: bytes, id_name: str = "", text_name: str = "") -> tuple[list[Read], int]:
    """The requirements of a file, in its order, and how many lines without a text were skipped; raises `CannotRead`.

    Separated by commas or semicolons, with a header.
    """
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise CannotRead(f"the file is not UTF-8 text (byte {error.start}): save it as CSV UTF-8") from None
    if "\0" in text:
        raise CannotRead("the file contains null characters: save it as CSV UTF-8")
    header = text.split("\n", 1)[0]
    lines = csv.reader(
        io.StringIO(text, newline=""), delimiter=";" if header.count(";") > header.count(",") else ",", strict=True
    )
    try:
        return _requirements(lines, id_name, text_name)
    except csv.Error as error:
        raise CannotRead(f"line {lines.line_num} is not readable as CSV: {error}") from None


def _requirements(lines: Iterator[list[str]], id_name: str, text_name: str) -> tuple[list[Read], int]:
    header = [name.strip() for name in next(lines, [])]
    key = _column(header, (id_name,) if id_name else IDS, "id")
    text = _column(header, (text_name,) if text_name else TEXTS, "text")
    found, skipped = [], 0
    for number, cells in enumerate(lines, 2):
        line = [plain(cell) for cell in cells]
        if not any(cell.strip() for cell in line):
            continue
        if len(line) != len(header):
            raise CannotRead(f"row {number} has {len(line)} columns, the header has {len(header)}")
        if not line[text].strip():
            skipped += 1
            continue
        rest = {header[i]: cell for i, cell in enumerate(line) if i not in (key, text) and header[i] and cell.strip()}
        found.append(Read(line[key].strip(), line[text].strip(), rest))
    if not found:
        raise CannotRead("the file has no row with a text")
    return found, skipped


def _column(header: list[str], names: Iterable[str], what: str) -> int:
    wanted = [name.lower() for name in names]
    for name in wanted:
        for i, heading in enumerate(header):
            if heading.lower() == name:
                return i
    raise CannotRead(
        f"no column for the {what}: the header has {', '.join(header)[:200] or 'nothing'}; it needs {wanted[0]!r}, or "
        "name the column"
    )


def requirements(rows: Iterable[RequirementRow]) -> Iterator[bytes]:
    """All requirements with id, text and status, and the other attributes of their files.

    The most frequent attributes have columns of their own: every row has all columns, and files may name any number.
    """
    listed = list(rows)
    fixed = ("id", "text", "status", "why", "file")
    used = Counter(name for row in listed for name in row.attributes if name not in fixed)
    more = sorted(name for name, _ in used.most_common(MOST_COLUMNS))
    rest = set(used) - set(more)
    yield written([[*fixed, *more, *(["other attributes"] if rest else [])]])
    for row in listed:
        values = (row.id, row.text, row.status, row.sentence, row.file or "")
        others = "; ".join(f"{name}: {value}" for name, value in row.attributes.items() if name in rest)
        yield written([[*values, *(row.attributes.get(name, "") for name in more), *([others] if rest else [])]])


def matrix(rows: Iterable[RequirementRow]) -> Iterator[bytes]:
    """A line for each requirement and run, the runs that count first; one line for a requirement without a run."""
    yield written([_MATRIX])
    for row in rows:
        before = [row.id, row.text, row.status, row.sentence]
        if not row.runs:
            yield written([[*before, *[""] * (len(_MATRIX) - len(before))]])
        for run in row.runs:
            yield written([[*before, *_run(run)]])


def _run(run: RequirementRun) -> list[object]:
    numbers = (run.threshold, run.worst_cost, run.margin, run.upper_bound)
    signed = "; ".join(f"{signed_by(s)}, {_date(s.created)}, {s.sentence}" for s in run.signoffs)
    return [
        run.id, run.part, run.campaign_name, headline(run.verdict or run.state, run.not_sampled),
        run.quantity, run.unit,
        *("" if number is None else repr(number) for number in numbers), run.campaign_digest, run.code or "",
        run.evidence_digest or "",
        _date(run.finished or run.created), "yes" if run.signed else "no", signed, "yes" if run.suspect else "no",
        "; ".join(run.changes),
    ]  # fmt: skip


def _date(at: float) -> str:
    return datetime.fromtimestamp(at, UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
