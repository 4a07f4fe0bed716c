"""The printed name of a parameter: its symbol, with its part of the campaign where others have the same symbol.

Two obstacles have the same symbols, and a number must be traceable to one of them: "y of obstacle 1". Files contain the
path, `obstacles.0.position.y`. `frontend/src/format/names.ts` writes the same names.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping

OF = " of "
"""Separates the symbol from the part it belongs to; no symbol has a space."""
_THRESHOLD = re.compile(r"(criterion|objectives\.\d+)\.threshold")
"""The path of a criterion's threshold."""
_PARTS = {
    "vehicle": "the vehicle",
    "controller": "the controller",
    "avoider": "the avoider",
    "start": "the start",
    "goal": "the goal",
    "criterion": "the criterion",
}
_LISTS = {
    "obstacles": "obstacle",
    "environment": "environment",
    "faults": "fault",
    "objectives": "further criterion",
}


def labels(paths: Iterable[str], symbols: Mapping[str, str]) -> dict[str, str]:
    """The name of each path; symbols: of all parameters of the campaign, by path, empty for those without one.

    A threshold is a field of the campaign, and no catalogue has it: its symbol is shown nowhere, and counts nowhere.
    """
    wanted = list(paths)
    shown = {path: symbol for path, symbol in symbols.items() if path in wanted or not _THRESHOLD.fullmatch(path)}
    named = {path: shown.get(path) or path.rpartition(".")[2] for path in (*wanted, *shown)}
    counts = Counter(named.values())
    names = {path: symbol if counts[symbol] == 1 else name_of(path, symbol) for path, symbol in named.items()}
    shared = Counter(names.values())  # two parameters of one part may have the same symbol
    return {path: names[path] if shared[names[path]] == 1 else path for path in wanted}


def name_of(path: str, symbol: str) -> str:
    """The symbol with the part of the campaign that the path is in; the path where that part has no name."""
    part, _, rest = path.partition(".")
    number = rest.partition(".")[0]
    if part in _LISTS and number.isdecimal():
        return f"{symbol}{OF}{_LISTS[part]} {int(number) + 1}"
    return f"{symbol}{OF}{_PARTS[part]}" if part in _PARTS else path


def is_path(label: str) -> bool:
    """Whether a name is a path; no symbol has a dot."""
    return "." in label


def apart(label: str) -> tuple[str, str]:
    """The symbol of a name and the rest of it, which is upright in print: "y" and " of obstacle 1"."""
    symbol, of, part = label.partition(OF)
    return symbol, of + part
