"""What guides and the score board say of kinds of problems, seeds and cells that raised is what was measured."""

from __future__ import annotations

import re
from collections import defaultdict
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.bench.scoreboard import __main__ as board
from tests.bench.scoreboard import cells, niching, page, peers, sureness
from tests.bench.scoreboard.bars import JUDGED
from tests.bench.scoreboard.parts import Request
from tests.bench.scoreboard.searches import Evaluations
from tests.given.kept_cells import kept_rows
from tests.given.landscapes import KINDS
from worker.evidence.verdicts.sureness import LOW, MODEL

DOCS = cells.ROOT / "docs"
GUIDE = (DOCS / "methods.md").read_text(encoding="utf-8")


def test_the_guide_on_methods_has_what_each_kind_states_and_what_came_true() -> None:
    (paragraph,) = (text for text in GUIDE.split("\n\n") if text.startswith("What is right on the mean"))
    stated = re.findall(r"([A-Za-z][A-Za-z -]*) \((\d+) %, (\d+) %\)", paragraph.replace("\n", " "))
    table = {column: by["auto"] for column, by in sureness.PART.table(kept_rows(sureness.PART)).items() if by}
    found = {kind: [f"{100 * table[f'{kind}, {name}']:.0f}" for name in ("stated", "came true")] for kind in KINDS}
    named = {kind: figures for name, *figures in stated for kind in KINDS if name.startswith(kind.split()[0])}
    assert len(stated) == len(named) == len(KINDS)
    assert named == found


def test_the_decision_on_statements_has_the_boards_figure_of_today() -> None:
    decisions = (cells.ROOT / "DECISIONS.md").read_text(encoding="utf-8")
    stated = re.search(r"meets it again \(([\d.]+) %\)", decisions)
    table = sureness.PART.table(kept_rows(sureness.PART))
    assert stated is not None
    assert stated[1] == f"{100 * table['7 to 13 %, came true']['auto']:.1f}"


def seeds_of(part: str) -> int:
    """The most cells that a method has on a problem of the whole board."""
    counts: defaultdict[tuple[str, str], int] = defaultdict(int)
    for cell in board.PARTS[part].cells(Request("judging", ("auto", "contrast_racing"), board.SEEDS)):
        counts[cell.problem, cell.method] += 1
    return max(counts.values())


def test_the_board_states_the_seeds_of_the_parts_that_have_no_instances() -> None:
    text = (DOCS / "scoreboard.md").read_text(encoding="utf-8")
    stated = re.search(r" (\d+) seeds, (\d+) of niching, where", text)
    assert stated is not None
    assert {seeds_of(name) for name in ("landscapes", "loops", "falsification", "verdicts")} == {int(stated[1])}
    assert seeds_of("niching") == int(stated[2]) == niching.SEEDS


def board_text(tmp_path: Path, only: str, seeds: int) -> list[str]:
    """The lines of a board without anything measured."""
    words = ["--only", only, "--seeds", f"{seeds}", "--methods", "auto", "--half", "judging", "--stored"]
    return page.markdown(board.main(words, tmp_path)).splitlines()


def test_the_first_lines_of_the_board_are_those_that_its_program_writes(tmp_path: Path) -> None:
    guide = (DOCS / "scoreboard.md").read_text(encoding="utf-8").splitlines()
    made = board_text(tmp_path, "niching", board.SEEDS)
    assert guide[4] == made[4]
    assert guide[2].split(". ")[2] == made[2].split(". ")[2]
    assert "niching" not in board_text(tmp_path, "landscapes", board.SEEDS)[2]
    assert "niching" not in board_text(tmp_path, "niching", niching.SEEDS)[2]


def test_a_peer_that_raised_counts_with_what_it_had_evaluated(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def raises(evaluations: Evaluations, dimension: int, budget: int, seed: int) -> None:
        evaluations(np.full(dimension, 0.5))
        raise ValueError("midway")

    monkeypatch.setattr(cells, "code", lambda names: "one version")
    monkeypatch.setitem(peers.PEERS, "nlopt_crs", replace(peers.PEERS["nlopt_crs"], search=raises))
    words = ["--only", "landscapes", "--half", "setting", "--seeds", "1", "--processes", "1", "--budgets", "2"]
    found: dict[str, Any] = board.main([*words, "--methods", "nlopt_crs"], tmp_path)
    part = found["parts"]["landscapes"]
    assert part["errors"] == {"nlopt_crs": [10, "ValueError: midway"]}
    assert all("nlopt_crs" in by for by in part["table"].values())
    assert re.search(r"^- nlopt_crs: 10 .*midway$", page.markdown(found), re.MULTILINE)


def test_the_landscapes_of_the_estimate_have_the_stated_parameters() -> None:
    """The numbers in the sentence are those of the landscapes on which the coefficients were set."""
    asked = Request("setting", (JUDGED,), (LOW.landscapes + MODEL.landscapes) // 34)
    dimensions = [cell.dimension for cell in sureness.PART.cells(asked)]
    for of in (LOW, MODEL):
        assert of.parameters is not None
        fewest, most = of.parameters
        own = [n for n in dimensions if fewest <= n <= most]
        assert (len(own), min(own), max(own)) == (of.landscapes, fewest, most)
