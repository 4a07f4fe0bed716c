"""A folder of a run of which one file is damaged: every command reads it or refuses it with a sentence.

Some by day, for the commands that only read; many by night.
"""

from __future__ import annotations

import random
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
import yaml

from campaigns import library
from clearance.cli import INTERNAL, WRONG_INPUT, invoke
from tests.adversary.mutations import mutated

FILES = ("result.json", "evidence.json", "campaign.json", "evaluations.npz")
READING = ("audit", "replay")
COMMANDS: dict[str, Callable[[Path, Path], list[str]]] = {
    "audit": lambda folder, _: ["audit", str(folder)],
    "replay": lambda folder, _: ["replay", str(folder), "F1"],
    "baseline": lambda folder, campaign: ["run", str(campaign), "--out", str(folder / "o"), "--baseline", str(folder)],
    "continue": lambda folder, _: ["run", "--continue", str(folder), "--budget", "+20", "--out", str(folder / "o")],
}


@pytest.fixture(scope="module")
def ended(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a campaign and the results of its run."""
    folder = tmp_path_factory.mktemp("ended")
    campaign = yaml.safe_load(library()["unicycle_static"].read_text(encoding="utf-8"))
    campaign["stages"] = {"search": [{"method": "direct", "evaluations": 40}], "findings": {"at_most": 1}}
    (folder / "campaign.yaml").write_text(yaml.safe_dump(campaign), encoding="utf-8")
    assert invoke(["run", str(folder / "campaign.yaml"), "--out", str(folder / "run")]) not in (WRONG_INPUT, INTERNAL)
    return folder


def damaged(content: bytes, seed: int) -> bytes:
    """JSON as somebody else would write it; of a zip file some bytes, in every fifth also its end."""
    if not content.startswith(b"PK"):
        return mutated(content.decode(), seed)
    chance, changed = random.Random(seed), bytearray(content)
    for _ in range(chance.choice((1, 5, 50))):
        changed[chance.randrange(len(changed))] = chance.randrange(256)
    return bytes(changed[: chance.randrange(len(changed))] if seed % 5 == 0 else changed)


@pytest.mark.by_day(2)
@pytest.mark.parametrize("count", [4, pytest.param(100, marks=pytest.mark.nightly)])
@pytest.mark.parametrize("file", FILES)
@pytest.mark.parametrize(
    "command", [c if c in READING else pytest.param(c, marks=pytest.mark.nightly) for c in COMMANDS]
)
def test_a_damaged_folder_crashes_no_command(
    ended: Path, tmp_path: Path, command: str, file: str, count: int, capsys: pytest.CaptureFixture[str]
) -> None:
    refused = 0
    for seed in range(count):
        folder = tmp_path / str(seed)
        shutil.copytree(ended / "run", folder)
        (folder / file).write_bytes(damaged((ended / "run" / file).read_bytes(), seed))
        code = invoke(COMMANDS[command](folder, ended / "campaign.yaml"))
        statement = capsys.readouterr().err
        assert code != INTERNAL, f"seed {seed}: {statement[-2000:]}"
        assert "Traceback" not in statement
        assert statement or code != WRONG_INPUT
        refused += code == WRONG_INPUT
    assert refused
