"""Writes the rows as text for a terminal, as Markdown and as JSON, all with the same content.

`TITLES` has the titles of the tables.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict

from rich.console import Console
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from campaigns.claims.numbers import count, number
from worker.running.reproduce.compare import Reproduction, Row, Value
from worker.running.reproduce.published import D_MIN

TITLES = {
    "4.1": "Local optimisation, unicycle",
    "4.2": "Local optimisation, Pioneer 3-DX",
    "4.3": "Local optimisation, UAV, static obstacle",
    "4.4": "Local optimisation, UAV, moving obstacle",
    "5.1": "Genetic algorithm, unicycle",
    "5.2": "GLOBAL, unicycle",
    "5.3": "DIRECT, unicycle",
    "5.4": "Worst case, Pioneer 3-DX",
    "5.5": "Worst-case parameters, Pioneer 3-DX",
    "5.6": "Genetic algorithm, UAV, static obstacle",
    "5.7": "GLOBAL, UAV, static obstacle",
    "5.8": "DIRECT, UAV, static obstacle",
    "5.9": "Worst case, UAV, moving obstacle",
    "5.10": "Worst-case parameters, UAV, moving obstacle",
    "7.1": "Local optimisation, UAV, decision-making avoidance",
    "7.2": "Worst case, UAV, decision-making avoidance",
    "7.3": "Worst-case parameters, UAV, decision-making avoidance",
}

HEADINGS = ("", "Published", "Ours", "Difference", "Model", "Evaluations", "Time", "Agrees")

INTRODUCTION = (
    "Published: S. Srikanthakumar's values. Model: known values of the reconstructed model. Gains and geometry that "
    "the source leaves out were fitted to its results, so agreement of a nominal or worst case shows the quality of "
    "the fit. A row agrees if ours is within the tolerance of the model's value and, if the model column gives a point "
    "and a percentage, within that percentage of each range of the point; – if no tolerance is stated. Evaluations "
    "and times: published / ours."
)


def document(made: Reproduction) -> dict[str, object]:
    """Everything as plain JSON values; times in seconds."""
    return {
        "rows": [asdict(row) | {"difference": row.difference} for row in made.rows],
        "counts": counts(made),
        "seconds": made.seconds,
        "compile_seconds": made.compile_seconds,
    }


def counts(made: Reproduction) -> dict[str, int]:
    """Numbers of rows that agree, disagree, have no tolerance, are not available, and that must agree but do not."""
    rows = made.rows
    return {
        "rows": len(rows),
        "agree": sum(r.agrees is True for r in rows),
        "disagree": sum(r.agrees is False for r in rows),
        "undecided": sum(r.agrees is None and r.available for r in rows),
        "not_available": sum(not r.available for r in rows),
        "broken": sum(r.broken for r in rows),
    }


def summary(made: Reproduction) -> str:
    n = counts(made)
    outcome = "all rows that must agree do" if n["broken"] == 0 else f"{n['broken']} rows that must agree do not"
    return (
        f"{n['rows']} rows: {n['agree']} agree, {n['disagree']} disagree, {n['undecided']} have no tolerance, "
        f"{n['not_available']} are not available; {outcome}. "
        f"Computed in {made.seconds:.1f} s, plus {made.compile_seconds:.1f} s to compile or load the loops."
    )


def print_text(made: Reproduction, console: Console) -> None:
    """Print tables for a terminal, with notes below each."""
    for table, rows in _tables(made):
        shown = Table(title=escape(table), title_justify="left", expand=False)
        for i, heading in enumerate(HEADINGS):
            shown.add_column(heading, justify="left" if i in (0, 7) else "right", overflow="fold")
        notes = _notes(rows)
        for row in rows:
            style = "red" if row.broken else "yellow" if row.agrees is False else "dim" if not row.available else ""
            shown.add_row(*(escape(cell) for cell in _cells(row, notes, "\n")), style=style)
        console.print(shown)
        for note, letter in notes.items():
            console.print(Text(f"  {letter}) {note}", style="dim"))
        console.print()
    console.print(Text(INTRODUCTION, style="dim"))
    console.print(Text(summary(made), style="red" if counts(made)["broken"] else "bold"))


def markdown(made: Reproduction) -> str:
    """The tables and notes as Markdown."""
    lines = ["# Published and reproduced", "", INTRODUCTION, "", summary(made), ""]
    for table, rows in _tables(made):
        notes = _notes(rows)
        lines += [f"## {table}", "", f"| {' | '.join(HEADINGS)} |", "|---|" + "---:|" * 6 + "---|"]
        lines += [f"| {' | '.join(_cells(row, notes, '<br>'))} |" for row in rows]
        lines += ["", *(f"{letter}) {note}  " for note, letter in notes.items()), ""]
    return "\n".join(lines)


def _tables(made: Reproduction) -> Iterator[tuple[str, list[Row]]]:
    """The rows grouped for display: by table, in the text, curves, Monte Carlo samples, reconstruction."""
    groups: dict[str, list[Row]] = {}
    for row in made.rows:
        groups.setdefault(_group(row), []).append(row)
    yield from groups.items()


def _group(row: Row) -> str:
    if row.table[0].isdigit():
        return f"Table {row.table}. {TITLES[row.table]}"
    if row.table.startswith("figure"):
        return "Monte Carlo" if row.method else "Whether d_min rises or falls with one parameter, the others nominal"
    return "In the text" if row.table.startswith("section") else "Reconstructed models only, not published"


def _notes(rows: list[Row]) -> dict[str, str]:
    """A letter for each distinct note, by its text."""
    found = dict.fromkeys(row.note for row in rows if row.note)
    return {note: _letter(i) for i, note in enumerate(found)}


def _letter(i: int) -> str:
    return chr(ord("a") + i) if i < 26 else f"{chr(ord('a') + i // 26 - 1)}{chr(ord('a') + i % 26)}"


def _cells(row: Row, notes: dict[str, str], line: str) -> tuple[str, ...]:
    unit = f" [{row.unit}]" if row.unit and row.quantity != D_MIN else ""
    where = "" if row.table[0].isdigit() or row.table == "reconstruction" else f"{row.table}: "
    name = where + row.row + unit + (f" {notes[row.note]})" if row.note else "")
    ours = _value(row.ours) if row.available else "not available"
    return (
        name,
        _with_place(_value(row.published), row.published_at, line),
        _with_place(ours, row.ours_at, line),
        "" if row.difference is None else f"{row.difference:+.4f}".replace("-", "−"),
        _model(row, line),
        _pair(
            *(None if s.evaluations is None else count(s.evaluations) for s in (row.published_spent, row.ours_spent))
        ),
        _pair(*(_time(s.time) for s in (row.published_spent, row.ours_spent))),
        "–" if row.agrees is None else "yes" if row.agrees else "NO" if row.must else "no",
    )


def _model(row: Row, line: str) -> str:
    parts = [_value(row.model)] if row.model is not None else []
    if row.tolerance is not None:
        parts.append(f"± {number(row.tolerance)}")
    text = " ".join(parts)
    if row.place is not None and row.model_at is not None:
        return _with_place(text, row.model_at, line) + f" ± {100 * row.place:g} %"
    return text


def _with_place(value: str, at: dict[str, float] | None, line: str) -> str:
    if at is None:
        return value
    return f"{value}{line}[{', '.join(number(v) for v in at.values())}]"


def _pair(published: str | None, ours: str | None) -> str:
    return "" if published is None and ours is None else f"{published or '–'} / {ours or '–'}"


def _time(spent: str | float | None) -> str | None:
    return f"{spent:.2f} s" if isinstance(spent, float) else spent


def _value(value: Value) -> str:
    if value is None:
        return ""
    return value if isinstance(value, str) else f"{value:.7g}"
