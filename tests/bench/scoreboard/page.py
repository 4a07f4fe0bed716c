"""The page of the score board: what was measured where, the bars, and a table for each part."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from tests.bench.scoreboard import niching, published
from tests.bench.scoreboard.bbob import SLOW
from tests.bench.scoreboard.contestants import LIMITS, SHORT, Contestant
from tests.bench.scoreboard.parts import Table
from tests.bench.scoreboard.peers import PEERS

WIDEST = 8
"""Columns of a table; more are divided by budget."""


def markdown(found: Mapping[str, Any]) -> str:
    """The whole page."""
    lines = ["# Score board", "", *_about(found), "", "## Bars", "", *_bars(found["bars"])]
    for name, part in found["parts"].items():
        lines += ["", f"## {part['title']}", "", part["text"], "", *tables(part["table"], part["shown"])]
        lines += ["", published.TEXT, "", *tables(published.TABLE, "")] * (name == "bbob")
        lines += ["", f"{_cells(part)}, {part['seconds']:.0f} s of processes.", *_errors(part["errors"])]
    return "\n".join([*lines, "", *_repeat(found), ""])


def _cells(part: Mapping[str, Any]) -> str:
    missing = f", {part['missing']:,} of them not measured" if part["missing"] else ""
    return f"{part['cells']:,} cells{missing}"


def _about(found: Mapping[str, Any]) -> list[str]:
    limits = ", ".join(f"{Contestant(name).title} {most}" for name, most in LIMITS.items())
    seconds = sum(part["seconds"] for part in found["parts"].values())
    peers = [f"| {PEERS[name].title} | {text or 'not installed'} |" for name, text in found["peers"].items()]
    return [
        f"Half for {found['half']}. Page of commit {found['commit']}, from cells that this commit would measure again "
        f"alike and that took {seconds:,.0f} s of processes. {_seeds(found)} where a part has no instances. "
        f"{found['machine']}.",
        "",
        "Every figure is a mean over all seeds or instances; - means that a method takes no part there or that a cell "
        "of it has no figures or is not measured; a peer that raised counts with what it had evaluated until then, and "
        "the line below the table says how many cells raised; bold is the best. n is the number of parameters. "
        f"Costly methods take at most {SHORT} n evaluations; evaluations of a run are at most: {limits}; these take "
        f"part in one instance of BBOB, in up to {SLOW} dimensions. "
        "A method whose points depend on its budget has a run for each budget. A failed evaluation has no value for "
        "our methods; a peer is given the highest value so far. Peers that spend tens of milliseconds of their own on "
        "an evaluation take part in BBOB only.",
        "",
        "| peer | version |",
        "|---|---|",
        *peers,
    ]


def _seeds(found: Mapping[str, Any]) -> str:
    fewer = f", {niching.SEEDS} of niching," if "niching" in found["parts"] and found["seeds"] > niching.SEEDS else ""
    return f"{found['seeds']} seeds{fewer}"


def _bars(bars: Sequence[Mapping[str, Any]]) -> list[str]:
    rows = [
        f"| {bar['part']} | {bar['statement']} | {_demanded(bar)} | {_figure(bar['measured'])} | {bar['verdict']} |"
        for bar in bars
    ]
    met = sum(bar["verdict"] == "met" for bar in bars)
    missed = sum(bar["verdict"] == "missed" for bar in bars)
    text = f"{met} met, {missed} missed, {len(bars) - met - missed} not measured."
    return [text, "", "| part | bar | at least | measured | |", "|---|---|---|---|---|", *rows]


def _demanded(bar: Mapping[str, Any]) -> str:
    return f"{bar['least']:.3f}" + (f" to {bar['most']:.3f}" if bar["most"] is not None else "")


def tables(table: Table, shown: str) -> list[str]:
    """The columns that begin with `shown`, as one table or, if they are many, one for each budget or method."""
    columns = [column for column in table if column.startswith(shown) and table[column]]
    if not columns:
        return ["Not measured."]
    if len(columns) <= WIDEST:
        return _table(table, columns)
    lines: list[str] = []
    if not any(" @ " in column for column in columns):
        for name in dict.fromkeys(method for column in columns for method in table[column]):
            lines += [f"{Contestant(name).title}:", "", *_by_group({c: table[c][name] for c in columns}), ""]
    for budget in sorted({column.split(" @ ")[1] for column in columns if " @ " in column}, key=int):
        lines += [f"{budget} n:", "", *_table(table, [c for c in columns if c.endswith(f" @ {budget}")]), ""]
    return lines[:-1]


def _table(table: Table, columns: Sequence[str]) -> list[str]:
    names = list(dict.fromkeys(method for column in columns for method in table[column]))
    decides = next((column for column in reversed(columns) if column.startswith("all")), columns[-1])
    names.sort(key=lambda name: -table[decides].get(name, -1.0))
    ends = {column.split(" @ ")[1] for column in columns if " @ " in column}
    heads = [c.split(" @ ")[0] if len(ends) == 1 else f"{c.replace(' @ ', ', ')}{' n' * (' @ ' in c)}" for c in columns]
    lines = [f"| method | {' | '.join(heads)} |", f"|---|{'---|' * len(columns)}"]
    best = {column: max(table[column].values(), default=0.0) for column in columns}
    for name in names:
        cells = [_figure(table[c].get(name), best[c]) for c in columns]
        lines.append(f"| {name if name in published.TITLES else Contestant(name).title} | {' | '.join(cells)} |")
    return lines


def _by_group(figures: Mapping[str, float]) -> list[str]:
    """The figures of one method, whose columns are `GROUP, FIGURE`: a row for each group."""
    groups: dict[str, dict[str, float]] = {}
    for column, value in figures.items():
        group, _, name = column.rpartition(", ")
        groups.setdefault(group, {})[name] = value
    names = list(dict.fromkeys(name for of in groups.values() for name in of))
    counts = {name for of in groups.values() for name, value in of.items() if value > 1}
    rows = [
        f"| {group} | {' | '.join(f'{of[n]:,.0f}' if n in counts and n in of else _figure(of.get(n)) for n in names)} |"
        for group, of in groups.items()
    ]
    return [f"| | {' | '.join(names)} |", f"|---|{'---|' * len(names)}", *rows]


def _errors(errors: Mapping[str, Sequence[Any]]) -> list[str]:
    """What was raised, by method: how often, and one example."""
    lines = [f"- {name}: {count} cells raised, such as {text}" for name, (count, text) in errors.items()]
    return ["", *lines] if lines else []


def _repeat(found: Mapping[str, Any]) -> list[str]:
    return ["## To repeat a cell", "", "```sh", f"{found['example']} --again", "```"] * bool(found["example"])


def _figure(value: float | None, best: float | None = None) -> str:
    if value is None:
        return "-"
    return f"**{value:.3f}**" if best and value == best else f"{value:.3f}"
