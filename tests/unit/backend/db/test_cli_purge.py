"""`clearance purge`: lists what would be deleted, asks, deletes, and compacts the file."""

from __future__ import annotations

import re
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest
import sqlalchemy as sa
import typer

from backend.db.engine import connect, default_url
from backend.db.queue import Queue, submit
from backend.db.store import RunStore
from backend.db.tables import EvaluationChunk, Run
from campaigns.stored.records import Columns, StagePlan
from clearance.cli import WRONG_INPUT, build, invoke
from tests.faults.cases import campaign
from tests.migrated import migrated

OLDEST, TRIAL = "long ago", "a trial"


@pytest.fixture(scope="module")
def stored(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with three runs of 100,000 evaluations (4 MB each), two of them removed 100 and 10 days ago."""
    folder = tmp_path_factory.mktemp("stored")
    engine = connect(migrated(folder))
    with engine.begin() as writer:
        for name in (OLDEST, "lately", "kept"):
            submit(writer, campaign(), name=name, tags=[], owner="", planned=1)
    for _ in range(3):
        claim = Queue(engine).claim("w")
        assert claim is not None
        store = RunStore(engine, claim)
        store.plan([StagePlan("search", "direct", 100_000)])
        number = 100_000
        random = np.random.default_rng(claim.run_id).random((number, 4))
        columns = Columns(random[:, :2], random[:, 2:3], np.zeros(number, np.uint8), random[:, 3], {})
        store.append(0, 0, columns)
        Queue(engine).fail(claim, "it was stopped")
    with engine.begin() as writer:
        for run_id, days in ((1, 100), (2, 10)):
            values = {"removed": Run.created - days * 86400, "removed_by": "ada", "removed_reason": TRIAL}
            writer.execute(sa.update(Run).where(Run.id == run_id).values(**values))
    engine.dispose()
    return folder


@pytest.fixture
def data(stored: Path, tmp_path: Path) -> Path:
    """A copy of it."""
    return shutil.copytree(stored, tmp_path / "data")


def left(data: Path) -> list[int]:
    """The runs that have evaluations."""
    engine = connect(default_url(data))
    with engine.connect() as reader:
        found = list(reader.scalars(sa.select(EvaluationChunk.run_id).distinct().order_by(EvaluationChunk.run_id)))
    engine.dispose()
    return found


def test_a_dry_run_and_a_no_delete_nothing(
    data: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert invoke(["purge", "--dry-run", "--data", str(data)]) == 0
    statement = capsys.readouterr().out
    (line,) = [line for line in statement.splitlines() if line.startswith("R-")]
    run, removed, size, why = line.split("  ")
    assert (run, removed.split()[-1], why) == ("R-0001", "ada", f"{OLDEST}: {TRIAL}")
    assert re.findall(r"\d[\d,.]+", size) == ["100,000", "3.3"]
    assert "1 run, 3.3 MB" in statement
    assert "dry run" in statement
    monkeypatch.setattr("typer.confirm", lambda _: False)
    assert invoke(["purge", "--data", str(data)]) == 0
    assert "Nothing was deleted." in capsys.readouterr().out
    assert left(data) == [1, 2, 3]


def test_without_confirmation_nothing_is_deleted(
    data: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.stdin", open("/dev/null"))  # noqa: SIM115
    assert invoke(["purge", "--data", str(data)]) == WRONG_INPUT
    sys.stdin.close()
    assert "--yes" in capsys.readouterr().err
    assert left(data) == [1, 2, 3]


def test_old_runs_are_purged_and_their_space_is_freed(data: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = data / "clearance.sqlite3"
    assert invoke(["purge", "--yes", "--data", str(data)]) == 0
    statement = capsys.readouterr().out
    assert "1 run purged." in statement
    before, after = (float(size) for size in re.findall(r"reduced from ([0-9.]+) MB to ([0-9.]+) MB", statement)[0])
    assert before - after == pytest.approx(3.3, abs=0.2)
    assert file.stat().st_size == pytest.approx(1e6 * after, abs=1e5)
    assert left(data) == [2, 3]
    assert invoke(["purge", "--older-than", "1w", "--yes", "--data", str(data)]) == 0
    assert left(data) == [3]
    capsys.readouterr()
    assert invoke(["purge", "--older-than", "0d", "--data", str(data)]) == 0
    assert left(data) == [3]


def test_a_file_that_is_in_use_is_made_smaller_another_time(
    data: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("backend.db.engine.BUSY_TIMEOUT", 0.05)
    from backend.db import purge

    real = purge.reclaim

    def while_somebody_writes(engine: sa.Engine) -> purge.Space:
        other = connect(default_url(data))
        with other.begin():
            return real(engine)

    monkeypatch.setattr(purge, "reclaim", while_somebody_writes)
    assert invoke(["purge", "--yes", "--data", str(data)]) == 0
    assert "`clearance purge`" in capsys.readouterr().err
    monkeypatch.setattr(purge, "reclaim", real)
    assert left(data) == [2, 3]
    size = (data / "clearance.sqlite3").stat().st_size
    assert invoke(["purge", "--yes", "--data", str(data)]) == 0
    assert (data / "clearance.sqlite3").stat().st_size < size - 3e6


def test_a_file_is_made_smaller_when_no_run_is_executed_and_it_is_worth_it(
    data: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """As a purge at night must not stop the workers from storing, nor rewrite a large file for little."""
    file, engine = data / "clearance.sqlite3", connect(default_url(data))
    with engine.begin() as writer:
        writer.execute(sa.update(Run).where(Run.id == 3).values(state="running"))
    size = file.stat().st_size
    assert invoke(["purge", "--yes", "--data", str(data)]) == 0
    assert (left(data), file.stat().st_size) == ([2, 3], size)
    assert "3.3 MB of the" in capsys.readouterr().out
    with engine.begin() as writer:
        writer.execute(sa.update(Run).where(Run.id == 3).values(state="done"))
    engine.dispose()
    assert invoke(["purge", "--yes", "--data", str(data)]) == 0
    assert file.stat().st_size < size - 3e6


@pytest.mark.parametrize("given", ["90", "d", "-1d", "1.5d", "90 d", "90m"])
def test_what_is_no_length_of_time_is_refused(data: Path, capsys: pytest.CaptureFixture[str], given: str) -> None:
    assert invoke(["purge", f"--older-than={given}", "--data", str(data)]) == WRONG_INPUT
    assert "give 90d for days" in capsys.readouterr().err


RETENTION = {
    option.opts[0]: option.envvar
    for option in typer.main.get_command(build()).commands["purge"].params  # type: ignore[attr-defined]
    if str(option.envvar).startswith("CLEARANCE_RETENTION_")
}
"""The options that state what is deleted, and their variables."""


@pytest.mark.parametrize("number", ["50", "0", "50000000000"])
@pytest.mark.parametrize("option", RETENTION)
def test_a_bare_number_deletes_nothing(
    data: Path, option: str, number: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """50 for 50GB would be 50 bytes, which no run has: all of them would go."""
    assert set(RETENTION) == {"--older-than", "--size"}
    assert invoke(["purge", option, number, "--yes", "--data", str(data)]) == WRONG_INPUT
    monkeypatch.setenv(RETENTION[option], number)
    assert invoke(["purge", "--yes", "--data", str(data)]) == WRONG_INPUT
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.count(f"{option} ") == 2
    assert left(data) == [1, 2, 3]


@pytest.mark.by_day(1)
@pytest.mark.parametrize("unit", ["B", "kB", "MB", "GB", "TB"])
def test_the_help_names_every_unit_of_a_size(unit: str, data: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["purge", "--help"]) == 0
    assert re.search(rf"\b{unit}\b", capsys.readouterr().out)
    assert invoke(["purge", "--size", f"{10**18 - 1}{unit}", "--yes", "--data", str(data)]) == 0
