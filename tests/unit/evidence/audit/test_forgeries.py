"""Forged records, of which every digest was computed again: the audit rejects each, or documents what it trusts."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from campaigns import CampaignError
from campaigns.asked.load import load_document
from campaigns.claims import sureness as templates
from campaigns.claims.spans import words
from campaigns.rules import SAME_COST
from tests.given.at_night import nightly_but
from tests.given.case_campaigns import searching
from tests.given.corrupted_records import CALLS, CORRUPTIONS, DIRECT, SHORT, Folder, copied, made, write_called, written
from tests.given.forgeries import FORGERIES, Forgery, accepted, bolder, changed, places, sentences, trusted
from worker.evidence.audit.judge import closing
from worker.evidence.audit.record import SEAL, UnreadableError, of_folder
from worker.evidence.audit.sentences import SPANS
from worker.evidence.verdicts.sureness import FORMER, FORMER_LOW, LOW, Model, chance
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

FURTHER = (
    *("a bolder end of the findings", "a bolder certificate", "a bolder grid", "a bolder validation"),
    *("bolder statistics", "a proof beside the counts", "a proof beside a finding", "a proof beside a stage"),
    *("a proof beside a check", "another horizon in the scope", "another step in the scope"),
    *("another vehicle in the scope", "no check of the encounter", "a smaller difference of a lower case"),
    *("a deviation of the sample", "a distribution function", "a smaller sample that suffices", "a slice"),
    *("a count that is absent", "no allowance", "a reason of what succeeded", "a horizon of the campaign"),
    *("a lower end", "an effective sample size", "fewer draws", "another independent sample"),
    *("a Gram matrix of positivity", "a Gram matrix of a limit", "a finer scale of V", "a trim", "no limit"),
    "a noise seed of a counted draw",
)
"""Of a kind of which others are tested by day."""
BY_DAY = [forgery for forgery in FORGERIES if forgery.text not in FURTHER]
assert len(BY_DAY) == len(FORGERIES) - len(FURTHER)


@pytest.mark.by_day(35)
@pytest.mark.parametrize("forgery", nightly_but(BY_DAY, FORGERIES), ids=[f.text for f in FORGERIES])
def test_a_forgery_is_rejected_or_documented(forgery: Forgery, tmp_path: Path) -> None:
    folder = Folder(written(tmp_path / "out", forgery.run))
    forgery.change(folder)
    assert accepted(folder) == bool(forgery.trusted)
    assert not forgery.trusted or trusted(forgery.trusted)


@pytest.mark.by_day(4)
@pytest.mark.parametrize("forgery", nightly_but(FORGERIES[::12], FORGERIES), ids=[f.text for f in FORGERIES])
def test_without_new_digests_every_forgery_is_rejected(forgery: Forgery, tmp_path: Path) -> None:
    folder = Folder(written(tmp_path / "out", forgery.run))
    forgery.change(folder)
    try:
        items = folder.items()
    except (UnreadableError, CampaignError):
        return
    assert [item for item in items if item.agrees is False and item.name.startswith((SEAL, "files."))]


def test_a_name_stated_twice_is_no_record(tmp_path: Path) -> None:
    """One reader takes the first, another one the last."""
    folder = Folder(written(tmp_path / "out", "violated"))
    file = folder.path / "result.json"
    file.write_text('{"verdict": "cleared", ' + file.read_text().lstrip().removeprefix("{"))
    with pytest.raises(UnreadableError, match="a name twice"):
        of_folder(folder.path)


@pytest.mark.nightly
def test_other_criteria_in_the_table_are_those_of_the_evaluations(tmp_path: Path) -> None:
    document = searching(DIRECT, **SHORT).document() | {"objectives": [{"component": "goal_miss"}]}
    store = MemoryStore()
    execute(load_document(document), store, threads=1)
    folder = Folder(copied(made(load_document(document), store), tmp_path))
    assert accepted(folder)
    table = folder.path / "evaluations.csv"
    head, *rows = (line.split(",") for line in table.read_text().splitlines())
    at = head.index("goal_miss [m]")
    table.write_text("\n".join(",".join([*row[:at], "0.0", *row[at + 1 :]]) for row in [head, *rows]) + "\n")
    assert not accepted(folder)


RECORDS = ("cleared", "violated", "noisy", "excluded", "alone", "counted", "estimated", "attracted")


@pytest.mark.nightly
@pytest.mark.parametrize("name", nightly_but(("violated",), RECORDS))
def test_bolder_words_in_any_sentence_are_rejected_or_documented(name: str, tmp_path: Path) -> None:
    """The same words in the spans of a sentence and in its text."""
    path = written(tmp_path / "out", name)
    original = {file.name: file.read_bytes() for file in path.iterdir()}
    for part, place in sentences(Folder(path)):
        for file, content in original.items():
            (path / file).write_bytes(content)
        folder = Folder(path)
        at = bolder(folder, part, place)
        assert trusted(at) or not accepted(folder), at


@pytest.mark.by_day(5)
@pytest.mark.parametrize("name", ["checks", "findings", "results", "stages"])
@pytest.mark.parametrize("value", [None, [], 7, [{}]])
def test_a_record_of_another_form_is_refused(name: str, value: Any, tmp_path: Path) -> None:
    folder = Folder(written(tmp_path / "out", "violated"))
    (folder.evidence if name == "results" else folder.result)[name] = value
    assert not accepted(folder)


def passes(folder: Folder) -> None:
    """A check of the motion that holds, in the form of the others."""
    made = {"name": "sampling", "code": "sampling", "title": "Motion of the obstacles"}
    folder.result["checks"].append(folder.result["checks"][0] | made)


def slower(folder: Folder) -> None:
    """Another rate of the obstacle in the description of its component."""
    (one,) = (c for c in folder.evidence["components"]["components"] if c["name"] == "orbiting_circle")
    one["rate"]["times"] = 0.0


@pytest.mark.by_day(1)
@pytest.mark.parametrize(
    ("change", "name"), [(lambda _: None, "checks.sampling"), (passes, "checks.sampling"), (slower, "components")]
)
def test_a_cleared_run_whose_check_of_sampling_is_removed_or_holds_is_rejected(
    change: Callable[[Folder], None], name: str, tmp_path: Path
) -> None:
    folder = Folder(written(tmp_path / "out", "aliased"))
    change(folder)
    folder.reseal()
    items = folder.items()
    assert not closing(items)[0]
    assert name in [item.name for item in items if item.agrees is False]


# By day every fourth; `test_a_corrupted_record_does_not_follow` has one of every kind, without new digests.
@pytest.mark.by_day(8)
@pytest.mark.parametrize("corruption", nightly_but(CORRUPTIONS[::4], CORRUPTIONS), ids=[c[0] for c in CORRUPTIONS])
def test_a_corruption_with_new_digests_is_rejected(
    corruption: tuple[str, str, Callable[[Folder], Any], str], tmp_path: Path
) -> None:
    _, name, change, _ = corruption
    folder = Folder(written(tmp_path / "out", name))
    change(folder)
    assert not accepted(folder)


# By day every third; `test_a_corrupted_record_of_calls_does_not_follow` has all of them, without new digests.
@pytest.mark.by_day(2)
@pytest.mark.parametrize("call", nightly_but(CALLS[::3], CALLS), ids=[c[1] for c in CALLS])
def test_forged_calls_are_rejected(call: tuple[str, str, Callable[[Folder], Any], str], tmp_path: Path) -> None:
    name, _, change, _ = call
    write_called(tmp_path, name)
    folder = Folder(tmp_path)
    change(folder)
    assert not accepted(folder)


OTHER = {
    "A search can miss a worse case": "A search may miss a worse one",
    " samples drawn from": " flights drawn from",
    "nothing is claimed between these points": "between these points nothing is known",
    ", the worst case found has": ", the worst one found has",
}
"""Words of a verdict, a sample and a grid as other templates write them."""


def test_a_record_of_an_earlier_version_of_the_templates_is_not_forged(tmp_path: Path) -> None:
    """Its sentences cannot be made again, which the audit states; its numbers are judged."""
    folder = Folder(written(tmp_path / "out", "cleared"))
    for name in ("result", "evidence"):
        text = json.dumps(vars(folder)[name])
        for today, earlier in OTHER.items():
            text = text.replace(today, earlier)
        setattr(folder, name, json.loads(text))
    assert not accepted(folder)
    del folder.result["versions"]["wording"]
    assert accepted(folder)
    (words,) = [item for item in folder.items() if item.name == "words"]
    assert words.agrees is None
    assert "sentences" in closing(folder.items())[1]
    folder.result["statistics"]["upper_bound"] /= 2
    assert not accepted(folder)


def test_a_record_of_an_earlier_version_states_no_chance_of_a_lower_case(tmp_path: Path) -> None:
    """What it cannot state is not missed; the same record of this version is rejected without it."""
    folder = Folder(written(tmp_path / "out", "alone"))
    assert folder.result.pop("sureness")["landscapes"] > 0
    assert not accepted(folder)
    folder.result["versions"]["wording"] = 2
    assert accepted(folder)


@pytest.mark.by_day(1)
@pytest.mark.parametrize("stated", [{"start_seconds": 0.1}, {"slots": 2}])
def test_no_chance_is_accepted_of_evaluations_side_by_side(stated: dict[str, Any], tmp_path: Path) -> None:
    """Records of earlier versions keep theirs."""
    folder = Folder(write_called(tmp_path, "alone"))
    assert folder.result["sureness"]["chance"] > 0
    assert accepted(folder)
    folder.evidence["results"][0]["measured"] |= stated
    assert not accepted(folder)
    versions, wording = folder.result["versions"], folder.result["versions"]["wording"]
    versions["wording"] = wording - 1
    assert accepted(folder)
    versions["wording"] = wording
    del folder.result["sureness"]
    assert accepted(folder)


def test_no_chance_is_accepted_of_a_search_that_was_asked_for_several_at_once(tmp_path: Path) -> None:
    folder = Folder(written(tmp_path / "out", "alone"))
    folder.campaign["stages"]["search"][0]["options"] = {"at_once": 2}
    assert not accepted(folder)
    del folder.result["sureness"]
    assert accepted(folder)


@pytest.mark.parametrize("by", [FORMER, FORMER_LOW])
def test_a_chance_by_the_coefficients_of_an_earlier_version_is_accepted(tmp_path: Path, by: Model) -> None:
    folder = Folder(written(tmp_path / "out", "alone"))
    stated, costs = folder.result["sureness"], folder.arrays["costs_2"][:, 0]
    nominal = float(costs.min()) + stated["lower"] / SAME_COST.value
    assert stated["chance"] == pytest.approx(chance(costs, nominal, LOW))
    former = chance(costs, nominal, by)
    sentence = templates.sureness(former, stated["lower"], "m", by.landscapes)
    stated |= {"chance": former, "landscapes": by.landscapes}
    stated |= {"statement": SPANS.dump_python(sentence, mode="json"), "text": words(sentence)}
    assert accepted(folder)
    stated |= {"landscapes": LOW.landscapes}
    assert not accepted(folder)


@pytest.mark.by_day(3)
@pytest.mark.parametrize("count", [2, pytest.param(300, marks=[pytest.mark.nightly, pytest.mark.timeout(1200)])])
@pytest.mark.parametrize(
    "name", ["cleared", "violated", "inconclusive", "noisy", "excluded", "alone", "counted", "estimated", "attracted"]
)
def test_any_other_value_is_rejected_or_documented(name: str, count: int, tmp_path: Path) -> None:
    path = written(tmp_path / "out", name)
    original = {file.name: file.read_bytes() for file in path.iterdir()}
    for part, place in places(Folder(path), 7, count):
        for file, content in original.items():
            (path / file).write_bytes(content)
        folder = Folder(path)
        at = changed(folder, part, place)
        assert trusted(at) or not accepted(folder), at
