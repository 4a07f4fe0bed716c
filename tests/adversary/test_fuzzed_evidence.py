"""Files that come from elsewhere with a result, damaged or forged: capsules, audit trails, flight logs, models of FMUs.

Each is read, or refused with its own error. A few by day, many by night.
"""

from __future__ import annotations

import contextlib
import json
import random
import zipfile
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import pytest

from backend.db.chain import COVERED, FIRST, digest
from campaigns.capsules.capsule import digest_of
from campaigns.capsules.packing import CapsuleError, unpacked
from clearance.cli import WrongInputError
from clearance.cli.trail import _of_file
from tests.adversary.mutations import GROWING, mutated
from tests.fmu import made
from tests.given import capsule_files as capsules
from tests.given.capsule_files import few_checks, files_of, zipped
from tests.logs import written
from worker.engine.systems.simulators.declared import fmu_model
from worker.engine.systems.simulators.logs.approach import Sphere, Unreadable
from worker.engine.systems.simulators.logs.rosbag import separation_of_mcap
from worker.engine.systems.simulators.logs.ulog import separation_of_ulog

Read = Callable[[Path], object]
COUNTS = [60, pytest.param(3_000, marks=[pytest.mark.nightly, pytest.mark.timeout(1800)])]
BALL = Sphere(3.0, 1.0, -2.0, 0.5)
TRACK = [(0.1 * k, 0.2 * k, 1.0, -2.0) for k in range(40)]


def capsule(file: Path) -> object:
    with contextlib.suppress(CapsuleError):
        return unpacked(file.read_bytes())
    return None


def trail(file: Path) -> object:
    with contextlib.suppress(WrongInputError):
        return _of_file(file, None)
    return None


def log(file: Path) -> object:
    with contextlib.suppress(Unreadable):
        return separation_of_ulog(file, [BALL], gap=10.0)
    return None


def recording(file: Path) -> object:
    with contextlib.suppress(Unreadable):
        return separation_of_mcap(file, "/pose", obstacles=[BALL], gap=10.0)
    return None


def described(file: Path) -> object:
    with contextlib.suppress(fmu_model.Unusable):
        return fmu_model.model(file, f"{random.random()}")  # it remembers what it has read by this
    return None


def rows() -> str:
    """A trail of five rows."""
    found, before = [], FIRST
    for number in range(1, 6):
        row = dict.fromkeys(COVERED, "x") | {"id": number, "at": 1.7e9 + number, "previous": before}
        row["detail"] = {"a": [1.5, None, "é"]}
        before = digest(row)
        found.append(json.dumps(row | {"hash": before}))
    return "\n".join(found) + "\n"


def flipped(content: bytes, seed: int) -> bytes:
    """Some bytes, in every fifth file also its end."""
    chance, changed = random.Random(seed), bytearray(content)
    for _ in range(chance.choice((1, 3, 20))):
        changed[chance.randrange(len(changed))] = chance.randrange(256)
    return bytes(changed[: chance.randrange(len(changed))] if seed % 5 == 0 else changed)


@pytest.mark.nightly
@pytest.mark.parametrize("count", COUNTS)
def test_a_forged_capsule_is_read_or_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, count: int) -> None:
    """Its document is any other one, with the digest that fits it."""
    few_checks(monkeypatch)
    files = files_of(capsules.written(tmp_path))
    text, forged = files["capsule.json"].decode(), 0
    for seed in range(count):
        content = mutated(text, seed)
        with contextlib.suppress(ValueError, RecursionError):
            document = json.loads(content.decode("utf-8", "surrogatepass"))
            if isinstance(document, dict):
                document["digest"] = digest_of(document)
                content, forged = json.dumps(document).encode(), forged + 1
        (tmp_path / "forged.zip").write_bytes(zipped(files | {"capsule.json": content}))
        tried(capsule, tmp_path / "forged.zip", seed)
    assert forged > 0.1 * count, "documents that cannot be read reach no check"


@pytest.mark.parametrize("count", COUNTS)
def test_a_trail_is_verified_or_refused(tmp_path: Path, count: int) -> None:
    file, text = tmp_path / "trail.jsonl", rows()
    file.write_text(text)
    assert _of_file(file, None).faults == []
    for seed in range(count):
        file.write_bytes(mutated(text, seed))
        tried(trail, file, seed)
    for seed, form in enumerate(GROWING * 2):
        file.write_bytes(form(random.Random(seed)).content)
        tried(trail, file, seed)


@pytest.mark.parametrize("count", COUNTS)
@pytest.mark.parametrize(
    ("package", "read", "write"),
    [
        ("pyulog", log, lambda file: written.ulog(file, {"vehicle_local_position": TRACK})),
        ("mcap_ros2", recording, lambda file: written.mcap(file, {"/pose": (written.POSE, "map", TRACK)})),
    ],
)
def test_a_damaged_log_is_read_or_refused(
    tmp_path: Path, package: str, read: Read, write: Callable[[Path], Path], count: int
) -> None:
    if find_spec(package) is None:
        pytest.skip(f"{package} is not installed")
    file = write(tmp_path / "log.mcap")
    content = file.read_bytes()
    assert read(file) is not None, "undamaged it is read"
    for seed in range(count):
        file.write_bytes(flipped(content, seed))
        tried(read, file, seed)


@pytest.mark.parametrize("count", COUNTS)
@pytest.mark.parametrize("fmi", [2, 3])
def test_the_description_of_a_model_is_read_or_refused(tmp_path: Path, fmi: int, count: int) -> None:
    pytest.importorskip("fmpy")
    text = made.description(fmi)
    for seed in range(count):
        with zipfile.ZipFile(tmp_path / "model.fmu", "w") as archive:
            archive.writestr("modelDescription.xml", mutated(text, seed))
        tried(described, tmp_path / "model.fmu", seed)


def tried(read: Read, file: Path, seed: int) -> None:
    try:
        read(file)
    except Exception as error:
        raise AssertionError(f"seed {seed}: {error!r:.300}") from error
