"""The story of a CI pipeline with real processes: a branch that makes a finding worse fails, one that does not passes.

The branches differ in one gain of the avoider. At last the service is killed.
"""

from __future__ import annotations

import json
import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as Xml

import httpx
import pytest

from campaigns import library, load_file
from clearance.cli import invoke
from tests.faults.processes import alive, kill, until
from tests.faults.serving import Service, long_run, serving, state

STAGES = {
    "sensitivity": None,
    "search": [
        {"method": "direct", "evaluations": 100},
        {"method": "sqp", "evaluations": 100, "starts": [{"vehicle.m": 4.5, "vehicle.J": 0.05}]},
    ],
    "validate": {"neighbours": 20, "evaluations": 20_000},
}
# By day each part: tests/api/clients, tests/api/runs/test_submit_ci.py, tests/unit/engine/stages/test_baseline.py.
pytestmark = pytest.mark.nightly
POLICY = {"fail_on": ["violation", "new_violation", "worse"], "tolerance": 0.001}


def write(folder: Path, branch: str, gain: float) -> Path:
    """The campaign as it is on a branch."""
    document = load_file(library()["unicycle_static"]).document() | {"regression": POLICY, "stages": STAGES}
    document["scenario"]["horizon"] = 4.0
    document["scenario"]["avoider"]["parameters"]["k_rep"] = gain
    file = folder / f"{branch}.json"
    file.write_text(json.dumps(document))
    return file


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service that the tests of this file share."""
    with serving(tmp_path_factory.mktemp("served"), CLEARANCE_THREADS="1") as running:
        yield running


class Job:
    """What a CI job has: the service's address, a token, a folder for its files."""

    def __init__(self, service: Service, folder: Path, token: str, shown: pytest.CaptureFixture[str]) -> None:
        self.address, self.folder, self._shown = service.address(), folder, shown
        self.environment = {"CLEARANCE_SERVICE": self.address, "CLEARANCE_TOKEN": token}

    def submit(self, file: Path, *options: str) -> tuple[int, str]:
        """Exit code and output of `clearance submit`, in this process: tests/api/clients/test_ci_guide.py starts it."""
        self._shown.readouterr()
        with pytest.MonkeyPatch.context() as here:
            for name, value in self.environment.items():
                here.setenv(name, value)
            code = invoke(["submit", str(file), "--label", f"branch={file.stem}", *options])
        shown = self._shown.readouterr()
        return code, shown.out + shown.err

    def ran(self, printed: str) -> tuple[int, str]:
        """Exit code of a command that a file of the job states, in a folder without a database, and the command."""
        with pytest.MonkeyPatch.context() as here:
            here.setenv("CLEARANCE_TOKEN", self.environment["CLEARANCE_TOKEN"])
            here.chdir(self.folder)
            return invoke(shlex.split(printed)[1:]), printed

    def runs(self) -> list[dict[str, Any]]:
        token = {"Authorization": f"Bearer {self.environment['CLEARANCE_TOKEN']}"}
        return list(httpx.get(f"{self.address}/api/v1/runs", headers=token).json()["items"])


def created(service: Service, capsys: pytest.CaptureFixture[str]) -> str:
    """A token of the service."""
    assert invoke(["token", "create", "ci", "--data", str(service.data)]) == 0
    return capsys.readouterr().out.split()[-1]


def test_a_branch_with_a_worse_gain_fails_and_a_good_one_passes(
    service: Service, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    main, slow, good = write(tmp_path, "main", 4.0), write(tmp_path, "slow", 3.0), write(tmp_path, "good", 4.0)
    job, files = (
        Job(service, tmp_path, created(service, capsys), capsys),
        [tmp_path / name for name in ("junit.xml", "summary.md")],
    )
    code, shown = job.submit(main, "--label", "commit=4f2a91c")
    assert code == 0, shown
    compared = ("--baseline", "label:branch=main")
    code, shown = job.submit(slow, *compared, "--junit", str(files[0]), "--summary", str(files[1]))
    assert code == 1, shown
    assert "Baseline: R-0001, " in shown
    cases = {case.get("name"): case for case in Xml.parse(files[0]).iter("testcase")}
    failure = cases["F1 of the baseline"].find("failure")
    assert failure is not None
    assert (failure.get("type"), str(failure.get("message")) in shown) == ("worse", True)
    lines = str(failure.text).splitlines()
    assert lines[-2] == f"{job.address}/runs/R-0002"
    assert {line.partition(" = ")[0] for line in lines[1:-2]} == {"vehicle.m", "vehicle.J"}
    assert cases["verdict"].find("failure") is None, "the verdict is cleared"
    assert "| F1 of R-0001 | **worse** |" in files[1].read_text()
    assert job.ran(lines[-1]) == (0, f"clearance replay --service {job.address} R-0002 1:0")
    assert job.ran(f"clearance audit --service {job.address} R-0002 --replay 5")[0] == 0
    code, shown = job.submit(good, *compared, "--junit", str(files[0]))
    assert code == 0, shown
    assert " R-0001: 1 same." in shown
    assert not [*Xml.parse(files[0]).iter("failure")]
    assert [(run["id"], run["labels"]["branch"]) for run in job.runs()] == [
        ("R-0003", "good"),
        ("R-0002", "slow"),
        ("R-0001", "main"),
    ]


@pytest.mark.nightly  # by day tests/faults/test_serve.py: its backend is killed, and another goes on with the folder
def test_a_service_that_was_killed_continues_when_it_is_started_again(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    main, good = write(tmp_path, "main", 4.0), write(tmp_path, "good", 4.0)
    with serving(tmp_path, CLEARANCE_THREADS="1") as service:
        token = created(service, capsys)
        code, shown = Job(service, tmp_path, token, capsys).submit(main)
        assert code == 0, shown
        family = service.family()
        kill(*family)
        until(lambda: not any(map(alive, family)), "it is gone")
    with serving(tmp_path, CLEARANCE_THREADS="1") as service:
        code, shown = Job(service, tmp_path, token, capsys).submit(good, "--baseline", "label:branch=main")
        assert code == 0, shown
        assert " R-0001: 1 same." in shown


def test_serve_killed_leaves_nothing_behind_and_gives_its_run_back(service: Service) -> None:
    """The last test of this file, of the service that they share."""
    engine, run_id = long_run(service.data)
    family = service.family()
    assert len(family) >= 4
    kill(service.pid)
    until(lambda: not any(map(alive, family)), "nothing is left")
    assert state(engine, run_id).state == "queued"
    engine.dispose()
