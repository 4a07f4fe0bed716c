"""Files and messages of others, mutated: each is read, or refused with its own error; nothing of them is executed.

Descriptors of simulators, files of components, answers of programs, labels, entity tags, addresses of views, files of
requirements. A few by day, many by night.
"""

from __future__ import annotations

import contextlib
import json
import random
import struct
from collections.abc import Callable
from pathlib import Path

import pytest

from backend.http.errors import RefusedError
from backend.http.matches import require_match
from backend.requirements import reading as requirements
from backend.requirements.reqif import CannotRead, write
from backend.scenes.base.address import parse
from campaigns import labels
from tests.adversary.mutations import GROWING, mutated
from worker.engine.systems.simulators.declared import descriptor
from worker.engine.systems.simulators.declared.described import BadDescriptor
from worker.engine.systems.simulators.slots.program import unframed, unlined
from worker.running.examination import reading
from worker.running.examination.mistake import Mistake

EXAMPLES = Path(__file__).parents[2] / "docs" / "examples"
DESCRIPTORS = sorted(EXAMPLES.glob("*/simulator.yaml"))
COMPONENTS = sorted(EXAMPLES.glob("components/**/*.py"))
BY_DAY, BY_NIGHT = 150, 20_000
COUNTS = [BY_DAY, pytest.param(BY_NIGHT, marks=pytest.mark.nightly)]


def described(folder: Path, content: bytes) -> None:
    (folder / "simulator.yaml").write_bytes(content)
    with contextlib.suppress(BadDescriptor):
        descriptor.read(folder)


def examined(folder: Path, content: bytes) -> None:
    file = folder / "component.py"
    file.write_bytes(content)
    with contextlib.suppress(Mistake):
        source = reading.read(file)
        reading.check(source)
        reading.check_names(source)


def answered(folder: Path, content: bytes) -> None:
    with contextlib.suppress(ValueError):
        unlined(bytearray(content), 10_000_000)
    with contextlib.suppress(ValueError):
        unframed(bytearray(struct.pack("<I", len(content)) + content), 10_000_000)
    with contextlib.suppress(ValueError):
        unframed(bytearray(content), 10_000_000)


def labelled(folder: Path, content: bytes) -> None:
    with contextlib.suppress(ValueError):
        labels.parsed(content.decode("utf-8", "replace").split("\n"))


def matched(folder: Path, content: bytes) -> None:
    with contextlib.suppress(RefusedError):
        require_match(content.decode("latin-1")[:1000], '"abc"', "it")


def addressed(folder: Path, content: bytes) -> None:
    with contextlib.suppress(ValueError):
        parse(content.decode("utf-8", "replace"))


def required(folder: Path, content: bytes) -> None:
    for kind in ("csv", "reqif"):
        with contextlib.suppress(CannotRead):
            requirements.read(kind, content, "", "")


LINES = "\n".join(json.dumps({"id": i, "results": {"margin": 0.5 * i, "x": [1, 2]}}) for i in range(20)) + "\n"
CSV = 'id,text\nREQ-1,"Keep 0.5 m"\nREQ-2,"Two\nlines"\n'
REQIF = write([("REQ-1", "Keep 0.5 m", "", ""), ("REQ-2", "é < & >", "", "")], 1.7e9, "Clearance").decode()
READERS: dict[str, tuple[Callable[[Path, bytes], None], list[str]]] = {
    "descriptors": (described, [path.read_text(encoding="utf-8") for path in DESCRIPTORS]),
    "components": (examined, [path.read_text(encoding="utf-8") for path in COMPONENTS]),
    "answers": (answered, [LINES, '{"trace": [[0.0, 1.5], [null, 2]]}\n']),
    "labels": (labelled, ["branch=main\ncommit=4f2a91c", "a=b=c\n=\nx="]),
    "entity tags": (matched, ['"abc", W/"abc", "x"', "*"]),
    "requirements": (required, [CSV, REQIF]),
    "views": (addressed, ["F2/t/12.5/cam/chase/dark/key/00000000-0000-4000-8000-000000000000", "nominal/t/nan"]),
}


@pytest.mark.parametrize("count", COUNTS)
@pytest.mark.parametrize("name", READERS)
def test_it_is_read_or_refused(tmp_path: Path, name: str, count: int) -> None:
    reader, texts = READERS[name]
    assert texts
    for seed in range(count):
        content = mutated(texts[seed % len(texts)], seed)
        try:
            reader(tmp_path, content)
        except Exception as error:
            raise AssertionError(f"seed {seed}: {error!r:.300}") from error


@pytest.mark.by_day(2)
@pytest.mark.parametrize("name", READERS)
def test_a_form_that_grows_ends_within_the_limits(tmp_path: Path, name: str) -> None:
    for seed, form in enumerate(GROWING * 2):
        READERS[name][0](tmp_path, form(random.Random(seed)).content)


def test_what_is_refused_is_not_executed(tmp_path: Path) -> None:
    mark = tmp_path / "mark"
    examined(tmp_path, f"open({str(mark)!r}, 'w').write('x')\ncomponent = 1\n".encode())
    described(tmp_path, f"!!python/object/apply:os.system ['touch {mark}']\n".encode())
    assert not mark.exists()
