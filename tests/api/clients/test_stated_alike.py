"""What one place of the command line states of a run, the others state as well: `show`, `follow`, the files of a job."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from campaigns.claims.say import say
from campaigns.results.regression import FindingChange, Regression, Standing
from clearance.cli import VIOLATED, invoke
from tests.given.reported_runs import PARAMETERS, finish_fully
from tests.given.service import Service
from tests.given.submissions import submit

Command = Callable[..., int]
FILES = ("junit", "summary", "sarif")


@pytest.fixture
def command(service: Service, monkeypatch: pytest.MonkeyPatch) -> Command:
    """The command line, with the service's address and a token in its environment."""
    monkeypatch.setenv("CLEARANCE_SERVICE", service.url)
    monkeypatch.setenv("CLEARANCE_TOKEN", service.token())
    monkeypatch.delenv("GITHUB_STEP_SUMMARY", raising=False)
    return lambda *arguments: invoke([*map(str, arguments)])


def places(command: Command, folder: Path, capsys: pytest.CaptureFixture[str], code: int) -> dict[str, str]:
    """What each place states of R-0001, of which the job ends with this code."""
    files = {name: folder / name for name in FILES}
    assert command("follow", "R-0001", *(part for name in FILES for part in (f"--{name}", files[name]))) == code
    found = {"follow": capsys.readouterr().out}
    assert command("show", "R-0001") == 0
    return found | {"show": capsys.readouterr().out} | {name: file.read_text() for name, file in files.items()}


def since(fails: bool) -> Regression:
    """A new violation that the policy fails, or a known one that it accepts, and a finding that is not compared."""
    change = FindingChange(
        standing=Standing.NEW if fails else Standing.SAME, before=None if fails else "F1", now="F1",
        parameters=PARAMETERS, margin=-0.1, fails=fails, statement=say("F1 violates"),
    )  # fmt: skip
    lost = FindingChange(
        standing=Standing.NOT_COMPARED, before="F2", now=None, parameters=PARAMETERS, statement=say("F2 has no value")
    )
    return Regression(
        run="R-0009", position=1, cases=[change, lost], fail_on=["new"] if fails else [], ok=not fails,
        accepted=not fails, statement=say("Changes since R-0009"),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("word", "fails", "code"), [("cleared", True, VIOLATED), ("violated", False, 0)], ids=["fails", "accepts"]
)
def test_what_the_policy_decides_is_stated_by_every_command(
    service: Service, command: Command, tmp_path: Path, capsys: pytest.CaptureFixture[str], word: str, fails: bool,
    code: int,
) -> None:  # fmt: skip
    with service.signed_in() as client:
        submit(client)
    finish_fully(service, word, regression=since(fails))
    texts = places(command, tmp_path, capsys, code)
    stated = texts["follow"].splitlines()[1:]
    assert [line for line in stated if line not in texts["show"].splitlines()] == []
    for line in ("Changes since R-0009", "F2 has no value.", f"The exit code is {code}: "):
        assert line in texts["show"]
