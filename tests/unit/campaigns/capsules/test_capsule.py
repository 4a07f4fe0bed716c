"""Capsules: the same bits again from one file, and everything that a file from anyone may not do."""

from __future__ import annotations

import io
import json
import random
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from campaigns.capsules import packing
from campaigns.capsules.capsule import digest_of
from campaigns.capsules.packing import CapsuleError, read, unpacked
from campaigns.refusals import RefusalCode
from clearance.cli import VIOLATED, WRONG_INPUT, invoke
from clearance.cli._capsule import of_capsule, sentence, write_capsules
from tests.given.capsule_files import few_checks, files_of, written, zipped
from tests.given.corrupted_records import ran
from tests.given.refused_commands import refusal

Document = dict[str, Any]


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    few_checks(monkeypatch)


@pytest.fixture
def capsule(tmp_path: Path) -> Path:
    """That of the worst finding of a violated run."""
    return written(tmp_path)


def replayed(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, Any]:
    capsys.readouterr()
    code = invoke(["replay", *arguments, "--json"])
    return code, json.loads(capsys.readouterr().out)


def altered(path: Path, change: Callable[[Document], object], sealed: bool = True) -> bytes:
    """The capsule with a change of its document; sealed: with a digest that fits, as a forger would write it."""
    files = files_of(path)
    document = json.loads(files["capsule.json"])
    change(document)
    if sealed:
        document["digest"] = digest_of(document)
    return zipped(files | {"capsule.json": json.dumps(document).encode()})


def test_a_capsule_replays_to_the_same_bits_without_a_service(
    capsule: Path, capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)  # no data folder, no folder of results
    code, statement = replayed(capsys, str(capsule))
    assert (code, statement["agrees"], statement["differences"], statement["component_changes"]) == (0, True, [], [])
    (case,) = statement["cases"]
    assert (case["case"], case["agreement"], case["now"]["values"]) == ("F1", "same bits", case["stored"]["values"])
    assert (statement["executed"], statement["origin"]["verdict"]) == (False, "violated")
    assert invoke(["replay", str(capsule), "F1"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[1] == sentence(of_capsule(capsule, allow_code=False), [])
    assert lines[2].endswith("It agrees.")


def test_a_capsule_contains_the_finding_exactly(capsule: Path) -> None:
    campaign, store = ran("violated")
    found, arrays, _ = read(capsule)
    worst = min(store.findings, key=lambda finding: finding.cost)
    assert found.finding == worst
    assert found.specification == campaign
    assert found.origin.sentence == store.verdict.sentence if store.verdict else None
    for name in ("nominal", "F1"):
        assert arrays[name].tobytes() == np.ascontiguousarray(store.traces[name].data).tobytes()
        with np.load(io.BytesIO(zipped({}, (f"{name}.npy", files_of(capsule)[f"{name}.npy"])))) as loaded:
            assert np.array_equal(loaded[name], store.traces[name].data, equal_nan=True)
    assert found.described is not None
    assert any("equation" in c.text or len(c.text) > 40 for c in found.described.components)


def test_the_same_finding_gives_the_same_file(capsule: Path) -> None:
    before = capsule.read_bytes()
    write_capsules(capsule.parent, *ran("violated"), None)
    assert capsule.read_bytes() == before


def test_a_cost_that_was_changed_does_not_agree(capsule: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def better(document: Document) -> None:
        document["finding"]["cost"] *= 1 - 2e-16

    capsule.write_bytes(altered(capsule, better))
    assert replayed(capsys, str(capsule))[0] == VIOLATED


def test_other_components_are_reported(capsule: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def another(document: Document) -> None:
        document["versions"]["loop"] = "0" * 64
        document["components"]["components"][0]["text"] += "!"
        document["components_digest"] = packing.described_digest(document["components"])

    capsule.write_bytes(altered(capsule, another))
    code, statement = replayed(capsys, str(capsule))
    assert (code, len(statement["component_changes"]), len(statement["differences"])) == (0, 1, 1)
    assert " 000000000000, " in statement["differences"][0]
    assert invoke(["replay", str(capsule)]) == 0
    assert f"{statement['component_changes'][0]}." in capsys.readouterr().out


def _text(key: str, value: Any) -> Callable[[Document], object]:
    return lambda document: document.update({key: value})


@pytest.mark.parametrize(
    ("change", "why"),
    [
        (_text("format", "clearance-capsule/2"), "another version"),
        (_text("more", 1), "more: Extra inputs"),
        (_text("finding", {}), "finding.label"),
        (_text("campaign_digest", "0" * 64), "digest of its campaign"),
        (_text("components_digest", "0" * 64), "digest of its components"),
        (_text("files", {}), "not those that it states"),
        (_text("trajectories", []), "trajectories"),
        (lambda d: d["finding"].update(label="F1\x1b[2J"), "control characters"),
        (lambda d: d["finding"].update(label="../F1"), "label"),
        (lambda d: d["finding"]["validation"].update(realisation=2**70), "seed"),
        (lambda d: d["finding"]["parameters"].update(x=1.0), "parameters of its finding"),
        (lambda d: d["campaign"]["scenario"].pop("vehicle"), "campaign"),
        (lambda d: d["trajectories"][0]["columns"].pop(), "stated columns"),
        (lambda d: d["trajectories"].append(d["trajectories"][0]), "trajectories"),
    ],
)
def test_a_document_that_contradicts_itself_is_refused(
    capsule: Path, change: Callable[[Document], object], why: str
) -> None:
    with pytest.raises(CapsuleError, match=why):
        unpacked(altered(capsule, change))


def test_a_change_without_the_digest_is_noticed(capsule: Path) -> None:
    with pytest.raises(CapsuleError, match="was changed"):
        unpacked(altered(capsule, lambda d: d["finding"].update(cost=9.0), sealed=False))
    files = files_of(capsule)
    with pytest.raises(CapsuleError, match="was changed"):
        unpacked(zipped(files | {"F1.npy": files["F1.npy"][:-8] + bytes(8)}))


@pytest.mark.parametrize("key", ["digest", "cost", "criterion", "columns"])
def test_a_key_that_is_given_twice_is_refused(capsule: Path, key: str) -> None:
    """At any depth, also with the same value: another reader takes the other one."""
    text, name = files_of(capsule)["capsule.json"], f'"{key}":'.encode()
    assert name in text
    twice = text.replace(name, f'"{key}": 0, "{key}":'.encode(), 1)
    with pytest.raises(CapsuleError, match=f"the key '{key}' twice"):
        unpacked(zipped(files_of(capsule) | {"capsule.json": twice}))


@pytest.mark.parametrize(
    "name", ["../evil.py", "/etc/passwd", "evil.py", "F1.npy/../x", "capsule.json", "C:\\x", "F0.npy"]
)
@pytest.mark.filterwarnings("ignore:Duplicate name")
def test_other_names_are_refused_and_nothing_is_written(capsule: Path, name: str, tmp_path: Path) -> None:
    before = sorted(tmp_path.rglob("*"))
    with pytest.raises(CapsuleError, match="no capsule does"):
        unpacked(zipped(files_of(capsule), (name, b"x")))
    assert sorted(tmp_path.rglob("*")) == before


def test_a_file_that_expands_is_refused_before_it_does(capsule: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    bomb = zipped({"flight.html": bytes(3_000_000), **files_of(capsule)})
    lied = bytearray(bomb)  # with sizes in the directory that claim less
    for at in (i for i in range(len(lied)) if lied[i : i + 4] == b"PK\x01\x02"):
        lied[at + 24 : at + 28] = (10).to_bytes(4, "little")
    monkeypatch.setitem(packing.LARGEST, "flight.html", 1_000_000)
    for data in (bomb, bytes(lied)):
        with pytest.raises(CapsuleError):
            unpacked(data)
    monkeypatch.setattr(packing, "LARGEST_FILE", 100)
    with pytest.raises(CapsuleError, match="larger"):
        unpacked(bomb)


@pytest.mark.parametrize(
    "header",
    [
        "{'descr': '|O', 'fortran_order': False, 'shape': (1, 1), }",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (999999999, 999999999), }",
        "{'descr': '<f8', 'fortran_order': True, 'shape': (1, 1), }",
        "__import__('os').system('true')",
        "(" * 5000,
    ],
)
def test_the_header_of_an_array_neither_runs_nor_allocates(capsule: Path, header: str) -> None:
    text = (header + "\n").encode()
    forged = packing._MAGIC + len(text).to_bytes(2, "little") + text + bytes(8)
    files = files_of(capsule) | {"F1.npy": forged}
    document = json.loads(files["capsule.json"])
    document["files"]["F1.npy"] = packing.hashlib.sha256(forged).hexdigest()
    document["digest"] = digest_of(document)
    with pytest.raises(CapsuleError, match="stated columns as doubles"):
        unpacked(zipped(files | {"capsule.json": json.dumps(document).encode()}))


@pytest.mark.parametrize(
    "data",
    [
        b"", b"PK", b"PK\x05\x06" + bytes(18), b"PK\x01\x02" * 200, zipped({"capsule.json": b"[" * 100_000}),
        zipped({"capsule.json": b"\xff\xfe"}), zipped({"capsule.json": b'{"format": "clearance-capsule/1", "x": NaN}'}),
    ],
    ids=range(7),
)  # fmt: skip
def test_what_is_no_capsule_is_a_sentence(data: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "x.zip"
    file.write_bytes(data)
    assert invoke(["replay", str(file)]) == WRONG_INPUT
    statement = capsys.readouterr().err
    assert refusal(statement) == RefusalCode.NO_CAPSULE
    assert "Traceback" not in statement


@pytest.mark.parametrize("method", [zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_a_damaged_file_is_a_sentence(method: int) -> None:
    """Bytes anywhere in it are changed; only a compression that takes a bounded amount of memory is read."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", method) as archive:
        archive.writestr("capsule.json", b"{}" * 200)
    data = buffer.getvalue()
    statement = "not JSON" if method == zipfile.ZIP_DEFLATED else "is not compressed as a capsule is"
    with pytest.raises(CapsuleError, match=statement):
        unpacked(data)
    for seed in range(300):
        changes = random.Random(seed)
        damaged = bytearray(data)
        for _ in range(3):
            damaged[changes.randrange(len(damaged))] = changes.randrange(256)
        with pytest.raises(CapsuleError):
            unpacked(bytes(damaged))


def test_a_command_in_a_capsule_is_executed_only_if_that_is_permitted(
    capsule: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    trace = tmp_path / "ran"
    program = {
        "descriptor": {"name": "inline", "command": ["touch", str(trace)]}, "file": "x.yaml", "folder": str(tmp_path),
    }  # fmt: skip
    capsule.write_bytes(altered(capsule, _text("program", program)))
    assert invoke(["replay", str(capsule)]) == WRONG_INPUT
    assert "--allow-code permits it" in capsys.readouterr().err
    assert not trace.exists()
