"""Files that know a column of the run list: three at most, its fields in the API, its order, its entry of `TABLE`.

What else a run's field is for does not count: filters, the page of a run, the texts of a value wherever it is.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from backend.runs.schemas import RunSummary
from tests.given.source_texts import texts

ROOT = Path(__file__).parents[3]
TABLE = "frontend/src/runs/columns.tsx"
LIST = ("backend/runs/schemas.py", "backend/runs/listing.py")
"""The fields of a run as in the list, and where they are read for it."""
SOURCES = ("backend/**/*.py", "clearance/**/*.py", "frontend/src/**/*.ts*")
GENERATED = ("frontend/src/client/", "clearance/client/answers.py")
TEXT = (ROOT / TABLE).read_text("utf-8")
ENTRY = re.compile(r"^  (\w+): (\{.*\},\n|\{\n(?:    .*\n)+  \},\n)", re.MULTILINE)
FUNCTION = re.compile(r"^function (\w+)\(.*\n(?:(?: .*|)\n)+?\}\n", re.MULTILINE)


def entries() -> dict[str, str]:
    """The text of each column, by its key."""
    return dict(ENTRY.findall(TEXT[TEXT.index("const TABLE = {") : TEXT.index("} as const satisfies")]))


def shown(key: str) -> set[str]:
    """The fields that its cell shows, its unit aside."""
    drawn = entries()[key]
    drawn += "".join(found[0] for found in FUNCTION.finditer(TEXT) if re.search(rf"\b{found[1]}\b", drawn))
    fields = {*re.findall(r"\brun\.(\w+)", drawn), key, *re.findall(r"\bsort: '(\w+)'", drawn)}
    return (fields & RunSummary.model_fields.keys()) - {"unit"}


def parts(key: str) -> set[str]:
    """The modules of the list with a component that no other column has."""
    found = set()
    for names, module in re.findall(r"import \{ (.+) \} from '\./(\w+)'", TEXT):
        for name in re.findall(r"\b(?!type )\w+\b(?=,|$)", names):
            if [other for other, entry in entries().items() if re.search(rf"\b{name}\b", entry)] == [key]:
                found.add(f"frontend/src/runs/{module}.tsx")
    return found


def searched() -> dict[str, str]:
    """By path, the text of every file that is searched."""
    return {
        path: text for path, text in texts(*SOURCES).items() if not path.startswith(GENERATED) and ".test." not in path
    }


def knowing(key: str) -> list[str]:
    """The files that compare with its key, have an entry of that key, name its order, or a field of the list that its
    cell shows."""
    field = "|".join(sorted(shown(key))) or "(?!)"
    sort = "".join(re.findall(r"\bsort: '(\w+)'", entries()[key])) or "(?!)"
    column = re.compile(rf"^  {key}: [{{(]|\bcol\w*(?:\.key)?\W{{1,6}}'{key}'", re.MULTILINE)
    order = re.compile(
        rf"[\"']-{sort}[\"']|\b[sS]ort\b\W{{1,5}}[\"']{sort}[\"']|^    \"{sort}\": (?:sa|Run)\.", re.MULTILINE
    )
    known = re.compile(rf"^    (?:{field}): |[\"'](?:{field})[\"']|\brow\.(?:{field})\b", re.MULTILINE)
    found = parts(key)
    for path, text in searched().items():
        if path not in LIST and key not in text and sort not in text:
            continue  # neither pattern can be in it
        patterns = [order, *([column] if path.startswith("frontend/src/runs/") else [])]
        patterns += [known] if path in LIST else []
        found |= {path} if any(pattern.search(text) for pattern in patterns) else set()
    return sorted(found)


@pytest.mark.parametrize("key", entries())
def test_a_column_is_known_in_few_files(key: str) -> None:
    files = knowing(key)
    assert {TABLE, "backend/runs/schemas.py"} <= set(files)
    assert len(files) <= 3, files


def test_every_column_is_counted() -> None:
    assert len(entries()) == len(re.findall(r"\bname: '", TEXT)) - 1  # `REMOVAL` has no key in `TABLE`
