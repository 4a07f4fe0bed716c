"""Numbers and names in guides, the change log and decisions are those of the code."""

from __future__ import annotations

import importlib
import re
from pathlib import Path

import typer
from typer.core import TyperGroup

from backend.db import chain
from backend.http import bodies
from campaigns.asked import reading
from campaigns.rules import RULES
from clearance.cli import build

REPOSITORY = Path(__file__).parents[3]


def text(name: str) -> str:
    return (REPOSITORY / name).read_text(encoding="utf-8")


def numbers(pattern: str, *files: str) -> set[int]:
    """What the pattern finds in these files, in each of them at least once."""
    found = {file: re.findall(pattern, text(file)) for file in files}
    assert all(found.values()), found
    return {int(number.replace(",", "")) for of in found.values() for number in of}


def test_the_guide_on_ci_lists_the_checks_that_known_violations_alone_make_fail() -> None:
    listed = re.search(r"violations alone make fail \((.+?)\), and ", text("docs/ci.md").replace("\n", " "))
    assert listed is not None
    assert listed[1].casefold().split(", ") == [rule.title.casefold() for rule in RULES if rule.of_violations]


def test_the_guide_on_operation_has_the_limits_of_lists_and_mappings() -> None:
    places = {
        r"([\d,]+) lists and mappings": reading.MOST_NESTED,
        r"([\d,]+) lists and objects": bodies.MOST_CONTAINERS,
        r"([\d,]+) values as YAML": reading.MOST_VALUES,
        r"nest deeper than (\d+)": reading.DEEPEST,
    }
    assert {place: numbers(place, "docs/operation.md") for place in places} == {p: {n} for p, n in places.items()}


def test_where_a_broken_trail_is_described_the_number_of_rows_is_that_of_the_code() -> None:
    files = ("docs/access.md", "CHANGELOG.md", "clearance/cli/trail.py")
    assert numbers(r"\bfirst (\d+) rows", *files) == {chain.MOST}
    assert [file for file in files if re.search(r"\bevery row that", text(file))] == []


def test_the_versions_of_python_in_the_change_log_are_those_that_the_installation_takes() -> None:
    newest = text("CHANGELOG.md").partition("## [Unreleased]")[2].partition("\n## [")[0]
    stated = set(re.findall(r"Python (3\.\d+) to (3\.\d+)", newest))
    taken = re.search(r"\(3, (\d+)\) <= sys\.version_info\[:2\] <= \(3, (\d+)\)", text("tools/python.sh"))
    assert taken is not None
    assert stated == {(f"3.{taken[1]}", f"3.{taken[2]}")}


def test_every_constant_that_a_decision_names_in_a_file_is_there() -> None:
    named = re.findall(r"\(`([\w/]+\.py)`: `([A-Z][A-Z_]+)`", text("DECISIONS.md"))
    assert named
    for file, name in named:
        module = importlib.import_module(file.removesuffix(".py").replace("/", "."))
        assert hasattr(module, name), (file, name)


def test_the_help_of_a_stated_sample_seed_is_that_of_its_command() -> None:
    """`submit` asks the service which seeds were drawn; `run` has nothing to ask."""
    root = typer.main.get_command(build())
    assert isinstance(root, TyperGroup)
    help_of = {
        command: next(p.help for p in root.commands[command].params if p.name == "sample_seed")  # type: ignore[attr-defined]
        for command in ("run", "submit")
    }
    assert "drew" in help_of["submit"]
    assert "drew" not in help_of["run"]
