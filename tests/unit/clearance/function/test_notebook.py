"""The notebook of docs/examples: its cells run in order, and its stored outputs are those that they give."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

from tests.notebooks import executed

pytestmark = pytest.mark.nightly

NOTEBOOK = Path(__file__).parents[4] / "docs" / "examples" / "parachute.ipynb"
COUNT = r"(\d[\d  ]*) evaluations"
NUMBER = r"[-−+]?\d[\d .]*(?:e[-+]?\d+)?"


def shown(outputs: list[dict[str, Any]]) -> str:
    """The text of outputs without drawings, whose points are compared by no one."""
    found = []
    for output in outputs:
        data = output.get("data", {"text/plain": output.get("text", [])})
        found += ["".join(data[kind]) for kind in ("text/plain", "text/html") if kind in data]
    return re.sub(r"<svg.*?</svg>|<[^>]*>", " ", "\n".join(found), flags=re.DOTALL)


def counts(text: str) -> list[int]:
    """The numbers of evaluations that are stated."""
    return [int(re.sub(r"\D", "", number)) for number in re.findall(COUNT, text)]


def test_the_stored_outputs_are_those_of_its_cells(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    document = json.loads(NOTEBOOK.read_text(encoding="utf-8"))
    cells = [cell for cell in document["cells"] if cell["cell_type"] == "code"]
    stored = [shown(cell["outputs"]) for cell in cells]
    found = [shown(outputs) for outputs in executed(document)]
    assert any("<svg" in "".join(o.get("data", {}).get("text/html", [])) for c in cells for o in c["outputs"])
    for one, other in zip(stored, found, strict=True):
        assert re.sub(NUMBER, "#", one) == re.sub(NUMBER, "#", other)
        assert counts(one) == pytest.approx(counts(other), rel=0.4), "they vary from run to run by a tenth"
    assert [cell["execution_count"] for cell in cells] == list(range(1, len(cells) + 1))
    assert "Violated" in stored[1]
    assert counts(stored[1])
    assert "Cleared" in stored[3]
