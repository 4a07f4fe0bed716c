"""A part of a record that is absent disagrees, whatever its sentences state: every part that a version omits for some
runs, in each kind of run that has it, and what else every record has."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from campaigns.results.base import Result
from tests.given.at_night import nightly_but
from tests.given.corrupted_records import Folder, write_called, written
from worker.evidence.audit.record import UnreadableError

TRUSTED_BY_DESIGN = {
    *("violation", "unknown", "realisation", "parameters", "call_seconds", "slots", "start_seconds"),
    "line",  # also of a boundary; tests/unit/clearance/cli/test_known_regions.py leaves out that of a basin
}
"""Of basins, of the encounter, and times of calls: whether a run has them is taken as given."""


WORDS = {"values", "statement", "text", "components"}
CALLED = "calls:"
"""Before the name of a run of a simulator."""
MEMBERS = "members"
"""Which evaluations a member requested is taken as given; that a search by several has members is not."""


def omitted() -> set[str]:
    """The names of all fields that are omitted for some values."""
    forms, found = [Result], set[str]()
    while forms:
        form = forms.pop()
        forms += form.__subclasses__()
        found |= {name for name, field in form.model_fields.items() if field.exclude_if is not None}
    return found


def parts(document: Any, names: set[str], path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The paths of everything of these names that is not empty."""
    if isinstance(document, dict | list):
        for key, value in document.items() if isinstance(document, dict) else enumerate(document):
            if key in WORDS or MEMBERS in path:
                continue
            if key in names and value not in (None, [], {}, ""):
                yield (*path, key)
            yield from parts(value, names, (*path, key))


def rejected(folder: Folder) -> bool:
    """Whether the audit rejects the record, with digests computed again, for more than its words."""
    try:
        if "files" in folder.evidence:
            folder.reseal()
        wrong = [item.name for item in folder.items() if item.agrees is False]
    except UnreadableError:
        return True
    return any(not name.startswith(("words", "names", "sentence", "evidence_digest")) for name in wrong)


def change(folder: Folder, at: tuple[Any, ...], empty: bool = False) -> Folder:
    """The record without a part, or with an empty one."""
    above: Any = vars(folder)
    for key in at[:-1]:
        above = above[key]
    if not empty:
        del above[at[-1]]
    else:
        above[at[-1]] = type(above[at[-1]])() if isinstance(above[at[-1]], list) or at[-1] == "files" else None
    return folder


def record(folder: Path, name: str) -> Path:
    if name.startswith(CALLED):
        return write_called(folder, name.removeprefix(CALLED))
    return written(folder / "out", name)


IN_PARTS = ("cleared", "since", "alone", "counted target", "calls:calls")


@pytest.mark.by_day(1)
@pytest.mark.parametrize("name", nightly_but(("since", "calls:calls"), IN_PARTS))
def test_a_part_that_is_absent_disagrees_whatever_the_sentences_state(name: str, tmp_path: Path) -> None:
    path, seen = record(tmp_path, name), set[str]()
    original = {file.name: file.read_bytes() for file in path.iterdir() if file.is_file()}
    for part in ("result", "evidence"):
        for at in parts(getattr(Folder(path), part), omitted() - TRUSTED_BY_DESIGN):
            place = ".".join([part, *("#" if isinstance(key, int) else key for key in at)])
            if place not in seen:
                seen.add(place)
                for file, content in original.items():
                    (path / file).write_bytes(content)
                assert rejected(change(Folder(path), (part, *at))), place
    assert seen


REQUIRED = (
    ("cleared", ("evidence", "results", 5, "encounter", "beyond")),
    ("cleared", ("evidence", "results", 5, "encounter", "beyond", "cut_short")),
    ("since", ("evidence", "results", -1, "basins")),
    ("calls:calls", ("evidence", "results", 0, "measured")),
    ("calls:differs", ("evidence", "results", 0, "measured")),
    ("cleared", ("evidence", "results", 0, "parameters")),
    ("cleared", ("evidence", "files")),
    ("cleared", ("result", "findings", 0, "granted")),
    ("alone", ("evidence", "results", 2, "members")),
)
WITHOUT = [(*place, empty) for place in REQUIRED for empty in (False, True)]
# By day each is left out; of those that are empty, one is of a result and one of the record itself.
REMOVED = [one for one in WITHOUT if not one[2] or one[1][-1] in ("beyond", "files")]


@pytest.mark.by_day(4)
@pytest.mark.parametrize("without", nightly_but(REMOVED, WITHOUT))
def test_what_every_record_has_is_required(without: tuple[str, tuple[Any, ...], bool], tmp_path: Path) -> None:
    name, at, empty = without
    assert rejected(change(Folder(record(tmp_path, name)), at, empty))


def test_one_evaluation_measures_no_noise(tmp_path: Path) -> None:
    """The first stage with one evaluation of which the record states that it repeats."""
    folder = Folder(record(tmp_path, "calls:alone"))
    measured = folder.evidence["results"][0]["measured"]
    folder.shorten(0, len(folder.arrays["status_0"]) - 1)
    measured |= {"points": 1, "evaluations": 1, "spread": None, "deviation": None}
    folder.reseal()
    wrong = {item.name for item in folder.items() if item.agrees is False}
    assert {"results.0.measured.points", "results.0.measured.evaluations"} <= wrong
