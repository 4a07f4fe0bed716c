"""A run as a Markdown summary, for the page of a CI job."""

from __future__ import annotations

import re
from pathlib import Path
from urllib.parse import quote

from campaigns.claims.numbers import NONE, signed
from campaigns.results.regression import FindingChange, Regression
from clearance.cli import INCONCLUSIVE, INTERNAL, INTERRUPTED, VIOLATED
from clearance.cli._ended import EndedRun, sureness

SIGNS = {0: "✅", VIOLATED: "❌", INCONCLUSIVE: "❔", INTERNAL: "⚠️", INTERRUPTED: "⚠️"}
"""Of the exit codes: a job that fails never opens with a tick."""
_CODE = str.maketrans({"`": "'", "|": "\\|", "\n": " "})
"""What would end a piece of code in a table."""
_SPECIAL = re.compile(r"([\\`*_{}\[\]<>|#~])")


def write(file: Path, ended: EndedRun) -> None:
    """Append to the file, as CI services expect it of the steps of a job."""
    with file.open("a", encoding="utf-8") as out:
        out.write(markdown(ended))


def markdown(ended: EndedRun) -> str:
    """The summary: what the exit code means, the verdict and its sentence, the changes since the baseline."""
    verdict = ended.verdict
    run = f"[{_text(ended.run)}]({ended.link})" if ended.link else _text(ended.run)
    lines = [f"## {SIGNS[ended.code]} {_text(ended.campaign)}: {_text(ended.outcome)}"]
    if verdict is None:
        lines.append(f"{run or 'The run'} {_text(ended.state)}. {_text(ended.error)}".rstrip())
        lines.append(_text(ended.unconfirmed))
    else:
        stated = ", ".join(filter(None, [f"**{ended.headline.capitalize()}**", run]))
        lines.append(f"{stated}. {_text(verdict.reason)}")
        lines += [_text(line) for line in sureness(verdict)]
    lines += [_text(note) for note in ended.notes]
    if ended.labels:
        lines.append("Labels: " + ", ".join(f"{_text(key)} = {_text(value)}" for key, value in ended.labels.items()))
    if ended.identity is not None:
        lines.append(f"Code: `{ended.identity.text.translate(_CODE)}`")
    if ended.picture:
        lines.append(f"![The worst case]({quote(ended.picture)})")
    if verdict is not None and verdict.regression is not None:
        lines += [f"### Since {_text(verdict.regression.run)}", _text(verdict.regression.text)]
        lines.append("\n".join(_table(ended, verdict.regression)))
    return "\n\n".join(filter(None, lines)) + "\n\n"


def _table(ended: EndedRun, regression: Regression) -> list[str]:
    unit = f" [{_text(regression.unit)}]" if regression.unit else ""
    heads = [
        "Finding",
        "",
        f"Margin in {_text(regression.run)}, to the threshold here{unit}",
        "Same case here",
        "Lowest here",
        "Change",
        "",
    ]
    rows = [_row(ended, regression, case) for case in regression.cases]
    return [_line(heads), _line(["---", "---", "---:", "---:", "---:", "---:", "---"]), *map(_line, rows)]


def _row(ended: EndedRun, regression: Regression, case: FindingChange) -> list[str]:
    name = f"{case.before} of {regression.run}" if case.before else f"{case.now}"
    margins = (case.margin_before, case.margin_again, case.margin, case.change)
    shown = (NONE if margin is None else signed(margin) for margin in margins)
    standing = f"**{case.standing}**" if case.fails else str(case.standing)
    command = ended.command(case).translate(_CODE)
    return [_text(name), standing, *shown, f"`{command}`" if command and case.fails else ""]


def _line(cells: list[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _text(text: str) -> str:
    """Text in which Markdown and HTML see nothing but words."""
    return _SPECIAL.sub(r"\\\1", " ".join(text.split())).replace("&", "&amp;")
