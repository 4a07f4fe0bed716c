"""`clearance audit`: it accepts real runs in every form, and detects every corrupted record."""

from __future__ import annotations

import copy
import json
import math
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import sqlalchemy as sa

from backend.db.engine import connect, default_url, write
from backend.db.queue import submit
from backend.db.tables import CampaignRow, CatalogueSnapshot, EvaluationChunk, Run
from campaigns.claims.stages.surroundings import possible_gain
from campaigns.refusals import RefusalCode
from campaigns.results.search import Gap
from clearance.cli import VIOLATED, WRONG_INPUT, invoke
from tests.audited import audited, recorded
from tests.given.at_night import nightly_but
from tests.given.case_campaigns import searching
from tests.given.corrupted_records import (
    CALLS,
    CORRUPTIONS,
    DIRECT,
    RUNS,
    UNKNOWN,
    UNREADABLE,
    Folder,
    ran,
    stored,
    write_called,
    written,
)  # fmt: skip
from tests.given.refused_commands import refused
from tests.migrated import migrated
from worker.engine.stages.parts import claims
from worker.evidence.audit import checks, parts, results
from worker.evidence.audit.binomial import cumulative, upper_bound
from worker.evidence.audit.judge import Item, audit, closing
from worker.evidence.audit.record import MISSING, SEAL, UnreadableError, of_folder
from worker.running.catalogue.installed import catalogue


@pytest.fixture
def database(tmp_path: Path) -> Iterator[sa.Engine]:
    """A database with the cleared run as written by a worker, with searches in two chunks."""
    engine = stored(tmp_path, "cleared")
    yield engine
    engine.dispose()


COMBINED = ("counted noise", "counted correlations", "counted violations", "counted exclusions")
"""What is combined with a counted sample is by day a run of its own: `noisy`, `cleared`, `violated`, `excluded`."""
BY_DAY = RUNS.keys() - set(COMBINED)


@pytest.mark.by_day(4)
@pytest.mark.parametrize("name", nightly_but(BY_DAY, RUNS))
def test_the_verdict_of_every_run_follows(name: str, tmp_path: Path) -> None:
    campaign, store = ran(name)
    items = audited(written(tmp_path / "out", name))
    of_files = [item for item in items if item.name.partition(".")[0] in (SEAL, "files", "identity")]
    assert audited(store, campaign) == [item for item in items if item not in of_files]
    assert {SEAL, "files.rows", "files.evaluations.csv", "files.trace-nominal.csv"} <= {i.name for i in of_files}


@pytest.mark.by_day(4)
@pytest.mark.parametrize("name", nightly_but(BY_DAY, RUNS))
def test_it_follows_where_words_alone_are_stored(name: str, tmp_path: Path) -> None:
    folder = Folder(written(tmp_path / "out", name))
    folder.forget_spans()
    items = folder.items()
    assert all(item.agrees for item in items if item.name not in (SEAL, "words")), closing(items)[1]
    assert {"sentence.worst", "sentence.evaluations", "sentence.methods"} <= {item.name for item in items}


def test_it_follows_in_a_database(database: sa.Engine, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    only = {item.name for item in audited(database)} - {
        item.name for item in audited(ran("cleared")[1], ran("cleared")[0])
    }
    assert {SEAL, "digests.run", "components", "run.upper_bound", "quantity", "worst.finding"} <= only | {"components"}
    assert invoke(["audit", "R-0001", "--data", str(tmp_path)]) == 0
    assert capsys.readouterr().out.lower().endswith(f"{closing([])[1]}.\n")


FURTHER = (
    *("a part with another evaluation", "a part of another family", "a part of too many evaluations"),
    *("a wrong count of a stage", "a wrong count of a method", "another worst in the sentence"),
    *("another threshold in the sentence", "a bound that is not the spans'", "a false count", "a false margin"),
    *("a false threshold", "a false count of draws", "a false count of a method", "cleared changed to violated"),
    *("another worst cost", "few spot checks", "a later encounter of no flight", "few flights simulated on"),
    *("a better best", "a distribution with another bound", "an unknown status", "a cost of another type"),
)
"""Of a kind of which others are tested by day."""
CORRUPTED = [corruption for corruption in CORRUPTIONS if corruption[0] not in FURTHER]
assert len(CORRUPTED) == len(CORRUPTIONS) - len(FURTHER)


@pytest.mark.by_day(24)
@pytest.mark.parametrize("corruption", nightly_but(CORRUPTED, CORRUPTIONS), ids=[c[0] for c in CORRUPTIONS])
def test_a_corrupted_record_does_not_follow(
    corruption: tuple[str, str, Callable[[Folder], Any], str], tmp_path: Path
) -> None:
    _, name, change, item = corruption
    folder = Folder(written(tmp_path / "out", name))
    change(folder)
    items = folder.items()
    follows, sentence = closing(items)
    assert not follows
    assert item in [i.name for i in items if i.agrees is False], sentence
    assert item in sentence


@pytest.mark.by_day(5)
@pytest.mark.parametrize(("name", "change", "item"), [(c[0], *c[2:]) for c in CALLS], ids=[c[1] for c in CALLS])
def test_a_corrupted_record_of_calls_does_not_follow(
    name: str, change: Callable[[Folder], Any], item: str, tmp_path: Path
) -> None:
    write_called(tmp_path, name)
    audited(tmp_path)
    folder = Folder(tmp_path)
    change(folder)
    items = folder.items()
    follows, sentence = closing(items)
    assert not follows
    assert item in [i.name for i in items if i.agrees is False], sentence


@pytest.mark.parametrize(("name", "change"), [c[1:] for c in UNREADABLE], ids=[c[0] for c in UNREADABLE])
def test_a_record_of_another_structure_is_refused(name: str, change: Callable[[Folder], Any], tmp_path: Path) -> None:
    folder = Folder(written(tmp_path / "out", name))
    change(folder)
    with pytest.raises(UnreadableError) as refusal:
        folder.items()
    assert refusal.value.code == RefusalCode.UNREADABLE


@pytest.mark.parametrize(("name", "change"), [c[1:] for c in UNKNOWN], ids=[c[0] for c in UNKNOWN])
def test_without_its_evidence_a_verdict_does_not_follow(
    name: str, change: Callable[[Folder], Any], tmp_path: Path
) -> None:
    folder = Folder(written(tmp_path / "out", name))
    change(folder)
    assert "whole" in [item.name for item in folder.items() if item.agrees is False], "of this version it is forged"
    folder.forget_seal()
    items = {item.name: item.agrees for item in folder.items()}
    assert (items["verdict"], False in items.values()) == (None, False)
    assert not closing(folder.items())[0]


def test_the_closing_sentence_counts_what_disagrees_and_what_is_unknown() -> None:
    right, wrong, unknown, verdict = (
        Item("a", 1, 1), Item("b", 1, 2), Item("c", 1, MISSING), Item("verdict", MISSING, "cleared"),
    )  # fmt: skip
    assert [closing(items) for items in ([right], [right, unknown], [wrong, right, unknown], [right, verdict])] == [
        (True, "the verdict follows from the stored evaluations"),
        (True, "the verdict follows from the stored evaluations; 1 of 2 items could not be audited"),
        (False, "the verdict does not follow from what the run stored: b disagree; 1 of 3 items could not be audited"),
        (False, "it is not known whether the verdict follows; 1 of 2 items could not be audited"),
    ]


def _document(connection: sa.Connection, **changes: Any) -> None:
    document = copy.deepcopy(connection.scalar(sa.select(CampaignRow.document)))
    assert document is not None
    connection.execute(sa.update(CampaignRow).values(document=document | changes))


DATABASE: dict[str, tuple[Callable[[sa.Connection], Any], str]] = {
    "a lowered threshold": (lambda c: c.execute(sa.update(Run).values(threshold=0.1)), "run.threshold"),
    "a dropped chunk": (
        lambda c: c.execute(sa.delete(EvaluationChunk).where(EvaluationChunk.position == 2, EvaluationChunk.first > 0)),
        "stages.2.evaluations",
    ),
    "another verdict": (lambda c: c.execute(sa.update(Run).values(verdict="violated")), "verdict"),
    "another bound": (lambda c: c.execute(sa.update(Run).values(upper_bound=1e-9)), "run.upper_bound"),
    "other components": (
        lambda c: c.execute(sa.update(CatalogueSnapshot).values(document=catalogue().model_dump(mode="json"))),
        "components",
    ),
    "another campaign": (lambda c: _document(c, seed=2), "digests.run"),
}


@pytest.mark.by_day(2)
@pytest.mark.parametrize("corruption", DATABASE)
def test_a_corrupted_database_does_not_follow(corruption: str, database: sa.Engine) -> None:
    change, item = DATABASE[corruption]
    write(database, change, 1.0)
    items = audit(recorded(database))
    assert item in [i.name for i in items if i.agrees is False], closing(items)[1]


def without_evidence(tmp_path: Path, name: str) -> Path:
    """A record as an earlier version wrote it, without what a verdict rests on."""
    folder = Folder(written(tmp_path / "out", name))
    folder.forget_seal()
    folder.write()
    (folder.path / "evidence.json").unlink()
    return folder.path


def test_what_is_not_stored_is_not_auditable_and_never_agrees(tmp_path: Path) -> None:
    folder = without_evidence(tmp_path, "violated")
    items = audit(of_folder(folder))
    unknown = [i for i in items if i.agrees is None]
    assert closing(items)[0], "the finding itself holds what its validation was"
    assert {"results", "checks.motion"} <= {i.name for i in unknown}
    assert all(MISSING in (i.given, i.recomputed) for i in unknown)


def test_a_cleared_verdict_whose_evidence_is_not_stored_cannot_be_recomputed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = without_evidence(tmp_path, "cleared")
    assert invoke(["audit", str(folder), "--json"]) == VIOLATED == 1
    answer = json.loads(capsys.readouterr().out)
    assert not answer["follows"]
    assert {i["agrees"] for i in answer["items"]} == {True, None}
    assert answer["sentence"] == closing(audit(of_folder(folder)))[1]


def test_the_command_prints_the_given_and_the_recomputed_verdict(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = Folder(written(tmp_path / "out", "cleared"))
    assert invoke(["audit", str(folder.path)]) == 0
    assert ", 0 disagree," in capsys.readouterr().out
    folder.set("result/nominal/cost", 0.75)
    folder.items()
    assert invoke(["audit", str(folder.path)]) == 1
    (row,) = [line for line in capsys.readouterr().out.splitlines() if "disagree" in line and "│ nominal.cost" in line]
    assert "0.75" in row
    assert repr(recorded(ran("cleared")[1], ran("cleared")[0]).costs[0, 0].item()) in row


@pytest.mark.parametrize(
    ("name", "spoil", "why"),
    [
        ("result.json", lambda p: p.unlink(), "No such file"),
        ("result.json", lambda p: p.write_text("{"), "is not a readable folder"),
        ("result.json", lambda p: p.write_text("[]"), "is not a readable folder"),
        ("result.json", lambda p: p.write_text('{"digest": "x"}'), "is not that of a run"),
        ("evaluations.npz", lambda p: p.write_bytes(b"PK"), "is not a readable folder"),
        ("campaign.json", lambda p: p.write_text("{}"), "cannot be used"),
    ],
)
def test_what_cannot_be_read_is_wrong_input(
    name: str, spoil: Callable[[Path], Any], why: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = written(tmp_path / "out", "inconclusive")
    spoil(folder / name)
    assert invoke(["audit", str(folder)]) == WRONG_INPUT
    assert why in capsys.readouterr().err


def test_a_run_without_a_verdict_is_wrong_input(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    engine = connect(migrated(tmp_path))
    with engine.begin() as connection:
        submit(connection, searching(DIRECT), name="a", tags=[], owner="", planned=1)
    with pytest.raises(UnreadableError, match="queued") as refusal:
        recorded(engine)
    assert refusal.value.code == RefusalCode.NO_VERDICT
    engine.dispose()
    assert refused(capsys, "audit", "R-0009", "--data", tmp_path) == RefusalCode.NO_RUN
    assert invoke(["audit", "R-0009", "--data", str(tmp_path / "nowhere")]) == WRONG_INPUT
    shutil.rmtree(tmp_path, ignore_errors=True)


def test_a_database_without_tables_is_wrong_input(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    engine = connect(default_url(tmp_path))
    with engine.begin() as connection:
        connection.execute(sa.text("create table other (id integer)"))
    assert refused(capsys, "audit", "R-0001", "--data", tmp_path) == RefusalCode.UNREADABLE
    engine.dispose()


@pytest.mark.parametrize(
    ("wording", "nominal", "known"), [(14, math.nan, False), (13, math.nan, True), (14, 0.9, True)]
)
def test_a_nominal_case_without_a_value_has_no_closest_approach_but_in_earlier_versions(
    wording: int, nominal: float, known: bool
) -> None:
    encounter = {"closest": {"at": "inside"}}
    claims = {"results": [{"encounter": encounter}], "findings": [{"closest": {"at": "start"}}]}
    run: Any = SimpleNamespace(wording=wording, nominal=nominal, claims=claims)
    assert checks._closest(run) == ["inside" if known else "none", "start"]


def test_its_earlier_name_runs_it_for_one_version(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = str(written(tmp_path / "out", "violated"))
    assert invoke(["audit", folder]) == 0
    audited_output = capsys.readouterr()
    assert invoke(["verify", folder]) == 0
    verified = capsys.readouterr()
    assert verified.out == audited_output.out
    assert (audited_output.err, verified.err.count("\n")) == ("", 1)
    assert "`clearance audit`" in verified.err
    assert invoke(["verify", str(tmp_path)]) == WRONG_INPUT


@pytest.mark.parametrize("violations", [0, 1, 7, 299])
@pytest.mark.parametrize("samples", [300, 3000])
def test_its_bound_is_that_of_the_beta_distribution(violations: int, samples: int) -> None:
    for confidence in (0.9, 0.99):
        bound = upper_bound(violations, samples, confidence)
        assert bound == pytest.approx(claims.bound(violations, samples, confidence), rel=1e-10)


@pytest.mark.parametrize(("samples", "share"), [(58, 0.05), (59, 0.05), (3000, 0.05), (10, 0.95), (100, 0.5)])
def test_its_order_is_wilks(samples: int, share: float) -> None:
    below = np.exp(cumulative(samples - 1, samples, share))
    assert int(np.count_nonzero(below <= 0.05)) == claims.order(samples, share, 0.95)
    assert below[-1] == pytest.approx(1.0 - share**samples)


@pytest.mark.parametrize(("best", "lowest"), [(2.0675210081688604e-09, -0.12), (0.5, 0.5 - 1e-13), (3.0, -1e6)])
def test_the_gap_of_direct_ends_at_an_evaluation_whatever_digits_the_sum_loses(best: float, lowest: float) -> None:
    rows = (np.zeros((3, 1)), np.array([best, best + 1.0, 7.0]), np.zeros(3, dtype=np.uint8))
    common = {"quantity": "d", "unit": "m", "ended": [parts.Counts(3, 0, 0)], "reworded": "", "best": [best]}
    runs: list[Any] = [SimpleNamespace(rows=lambda _: rows, wording=wording, **common) for wording in (9, 8)]
    run, earlier = runs
    gap = {"lower_bound": lowest, "gap": best - lowest, "rectangles": 3, "without_value": 0}

    def compared(one: Any, stated: dict[str, float]) -> dict[str, Any]:
        found: dict[str, Any] = parts.written(results._gap(one, 0, parts.read(Gap, stated)))
        return found

    found = compared(run, gap)
    assert found["statement"] == possible_gain(3, 0, "d", lowest, best, "m")
    assert "lower_bound" not in found
    for other, known in ((best - lowest + 0.25, False), (best + 1.0 - lowest, True)):
        wrong = gap | {"gap": other}
        assert "lower_bound" in compared(run, wrong)
        assert ("lower_bound" in compared(earlier, wrong)) is not known
    above = {"lower_bound": best + 0.5, "gap": -0.5}
    assert all("lower_bound" in compared(one, gap | above) for one in runs)
