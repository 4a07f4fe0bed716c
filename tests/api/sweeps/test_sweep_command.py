"""`clearance submit --sweep` against a real service."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import httpx
import pytest
import sqlalchemy as sa
import yaml

from backend.db.queue import Queue
from backend.db.tables import Run
from clearance.cli import INTERNAL, INTERRUPTED, WRONG_INPUT, _sweep, invoke
from clearance.client import drivers
from tests.given.reported_runs import SEARCHED, finish_fully
from tests.given.service import Service
from tests.given.small_catalogue import campaign

Submit = Callable[..., int]


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "campaign.yaml"
    path.write_text(yaml.safe_dump(campaign()))
    return path


@pytest.fixture
def submit(service: Service, file: Path, monkeypatch: pytest.MonkeyPatch) -> Submit:
    """Run the command; its pauses between two requests are the work of a worker, one step each."""
    monkeypatch.setenv("CLEARANCE_TOKEN", service.token())

    def run(*arguments: str, work: Iterator[object] | None = None) -> int:
        monkeypatch.setattr(drivers, "time", SimpleNamespace(sleep=lambda _: next(work or iter(()))))
        return invoke(["submit", str(file), "--service", service.url, *arguments])

    return run


def steps(service: Service, verdicts: tuple[str, ...]) -> Iterator[object]:
    for verdict in verdicts:
        if verdict == "failed":
            claim = Queue(service.engine).claim("w")
            assert claim is not None
            Queue(service.engine).fail(claim, "the state diverged.")
        else:
            finish_fully(service, verdict)
        yield


ENDS: dict[tuple[str, ...], int] = {
    ("cleared", "cleared"): 0,
    ("cleared", "inconclusive"): 2,
    ("violated", "failed"): 1,
    ("failed", "cleared"): INTERNAL,
}


def test_the_worst_run_decides(submit: Submit, service: Service, capsys: Any, tmp_path: Path) -> None:
    for verdicts, code in ENDS.items():
        assert submit("--sweep", "avoider.d_0=2,1", "--out", str(tmp_path), work=steps(service, verdicts)) == code
        statement = capsys.readouterr()
        lines = statement.out.splitlines()
        assert [line.partition("  R-")[0] for line in lines] == ["avoider.d_0 = 1", "avoider.d_0 = 2"]
        assert ": 2 queued\n" in statement.err
        for verdict, line in zip(verdicts, lines[::-1], strict=True):
            if verdict == "failed":
                assert line.endswith("; the state diverged.")
            else:
                assert f"{verdict}, worst margin +0.8 m, P(violation) at most 0.0999 % (95 % confidence)" in line
        assert (tmp_path / "sweep.csv").read_text().count("\n") == 3


def test_a_line_states_what_its_bound_rests_on(submit: Submit, service: Service, capsys: Any) -> None:
    def work() -> Iterator[object]:
        with service.engine.begin() as writer:
            writer.execute(sa.update(Run).where(Run.id == 2).values(sample_seed_stated=True))
        finish_fully(service)
        finish_fully(service)
        finish_fully(service, statistics=SEARCHED.model_copy(update={"excluded": 1000}))
        yield None

    submit("--sweep", "avoider.d_0=1,2,3", work=work())
    lines = capsys.readouterr().out.splitlines()
    found = [[source for source, text in _sweep.SOURCES.items() if text in line] for line in lines]
    assert found == [[], ["certify_stated"], ["search"]]
    assert [f"25 %{_sweep.EXCLUDED})" in line for line in lines] == [False, False, True]


def test_progress_counts_each_run_once_and_lines_state_removed_runs(
    submit: Submit, service: Service, client: httpx.Client, capsys: Any
) -> None:
    def work() -> Iterator[object]:
        for verdict in ("cleared", "violated", "inconclusive"):
            finish_fully(service, verdict)
            if verdict == "violated":
                client.delete("/api/v1/runs/R-0002", params={"reason": "wrong"})
            yield

    submit("--sweep", "avoider.d_0=2,1,3", work=work())
    statement = capsys.readouterr()
    progress = [line.partition(": ")[2] for line in statement.err.splitlines() if line.startswith("S-0001: ")]
    counts = [sum(int(part.split()[0]) for part in line.split(", ")) for line in progress]
    assert set(counts) == {3}, progress
    assert not any("done" in line for line in progress)
    ends = [line.endswith("; removed from the lists") for line in statement.out.splitlines()]
    assert sum(ends) == 1


def test_only_its_number_or_its_json(submit: Submit, client: httpx.Client, capsys: Any) -> None:
    assert submit("--sweep", "avoider.d_0=2,1", "--no-wait", "--name", "Range", "--tag", "a") == 0
    assert capsys.readouterr().out == "S-0001\n"
    assert client.get("/api/v1/runs/R-0001").json()["tags"] == ["a"]
    client.post("/api/v1/sweeps/S-0001/cancel")
    cancelled = (client.post("/api/v1/sweeps/S-0002/cancel") for _ in range(1))
    assert submit("--sweep", "avoider.d_0=2,1", "--json", work=cancelled) == INTERRUPTED
    assert json.loads(capsys.readouterr().out)["states"] == {"cancelled": 2}


WRONG = {
    "avoider.d_0": "invalid sweep",
    "=1,2": "invalid sweep",
    "avoider.d_0=": "invalid sweep",
    "avoider.d_0=1,,2": "invalid value ''",
    "avoider.d_0=1,much": "invalid value 'much'",
    "avoider.d_0=1,nan": "invalid value 'nan'",
    "vehicle.m=1,2": "is uncertain",
    "avoider.d_0=1": "at least 2",
    "avoider.d_0=1,5000": "must be within",
}


def test_a_wrong_sweep_is_refused_with_a_sentence(submit: Submit, service: Service, capsys: Any) -> None:
    for given, statement in WRONG.items():
        assert submit("--sweep", given) == WRONG_INPUT
        assert statement in capsys.readouterr().err
    assert service.rows()["runs"] == 0
