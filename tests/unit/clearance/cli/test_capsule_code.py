"""The source of components in capsules: run only if that is permitted, with the same bits; no other text is run."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
from collections.abc import Callable
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any

import pytest

from campaigns.asked.load import load_document
from campaigns.capsules.capsule import digest_of
from campaigns.capsules.packing import CapsuleError, read, unpacked
from campaigns.refusals import RefusalCode
from clearance.cli import VIOLATED, WRONG_INPUT, invoke
from clearance.cli._capsule_code import _written
from tests.given.capsule_files import few_checks, files_of, written, zipped
from tests.given.corrupted_records import ran
from tests.given.guest_packages import package
from tests.given.refused_commands import refusal, refused
from worker.engine.components.avoiders import potential_field
from worker.running.runs import own_sources as recorded
from worker.running.runs.meaning import meaning

SHIPPED = Path(potential_field.__file__).read_text(encoding="utf-8")
OWN, FOREIGN = "worker.engine.components.own.my_field", "acme_fields"
Document = dict[str, Any]


@pytest.fixture(autouse=True)
def trace(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """The file that importing the component leaves."""
    few_checks(monkeypatch)
    monkeypatch.setenv("TRACE", str(tmp_path / "ran"))
    return tmp_path / "ran"


TEXT = SHIPPED.replace('name="potential_field"', 'name="my_field"').encode()
TEXT += b"\nfrom tests.given.left_trace import leave\nleave()\n"
"""The shipped component under another name; the same for all tests, so that it is examined and compiled once."""


def with_source(folder: Path, module: str, text: bytes, change: Callable[[Document], object] = lambda d: None) -> Path:
    """The capsule of a run whose avoider is not shipped: the same numbers as those of the shipped one."""
    made = written(folder)
    files = files_of(made)
    document = json.loads(files["capsule.json"])
    document["campaign"]["scenario"]["avoider"]["component"] = "my_field"
    document["campaign_digest"] = load_document(document["campaign"], "x").digest
    document |= {"components": None, "components_digest": ""}
    digest = hashlib.sha256(text).hexdigest()
    document["sources"] = {"files": [{"module": module, "package": False, "digest": digest}], "entries": []}
    if module == OWN:
        document["versions"]["components"] = {"my_field.py": meaning(text).digest}
    else:
        entry = {"distribution": "acme-fields", "version": "1.2", "group": "clearance.components", "name": "my_field"}
        document["sources"]["entries"] = [entry | {"value": FOREIGN}]
        document["modules"][module] = meaning(text).digest
        document["versions"]["packages"]["acme-fields"] = "1.2"
    files[f"source/{module}.py"] = text
    document["files"][f"source/{module}.py"] = digest
    change(document)
    document["digest"] = digest_of(document)
    files["capsule.json"] = json.dumps(document).encode()
    made.write_bytes(zipped(files))
    return made


@pytest.mark.parametrize("module", [OWN, FOREIGN])
def test_source_in_a_capsule_does_not_run_unless_permitted(
    module: str, trace: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke(["replay", str(with_source(tmp_path, module, TEXT))]) == WRONG_INPUT
    errors = capsys.readouterr().err
    assert refusal(errors) == RefusalCode.CODE_NOT_PERMITTED
    assert f"({module.rpartition('.')[2]}.py)" in errors
    assert not trace.exists()


# By day, that of a package is found by the entry points that are written, below, and recorded by the run, at the end.
@pytest.mark.nightly
@pytest.mark.parametrize("module", [OWN, pytest.param(FOREIGN, marks=pytest.mark.nightly)])
def test_permitted_source_runs_and_gives_the_same_bits(
    module: str, trace: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    capsule = with_source(tmp_path, module, TEXT)
    assert invoke(["replay", str(capsule), "--allow-code", "--json"]) == 0, capsys.readouterr().err
    statement = json.loads(capsys.readouterr().out)
    (case,) = statement["cases"]
    assert (case["agreement"], case["now"]["values"]) == ("same bits", case["stored"]["values"])
    assert statement["executed"] is True
    assert not [one for one in statement["differences"] if "my_field" in one or "acme" in one]
    assert trace.exists()
    assert invoke(["replay", str(capsule), "--allow-code", "--blocks", "3"]) == WRONG_INPUT, (
        "it has no sample in blocks"
    )


def test_source_of_a_package_is_written_where_its_entry_points_find_it(
    trace: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = with_source(tmp_path, FOREIGN, TEXT)
    capsule, _, texts = read(path)
    assert capsule.sources is not None
    place = tmp_path / "written"
    place.mkdir()
    packages = _written(place, capsule.sources, texts)["PYTHONPATH"].split(os.pathsep)[0]
    monkeypatch.syspath_prepend(packages)
    monkeypatch.delitem(sys.modules, FOREIGN, raising=False)
    (entry,) = entry_points(group="clearance.components", name="my_field")
    assert entry.load().component.name == "my_field"
    assert Path(sys.modules.pop(FOREIGN).__file__ or "").is_relative_to(packages)
    assert trace.exists()


@pytest.mark.parametrize("module", [OWN, FOREIGN])
def test_text_that_was_changed_is_refused_and_not_run(
    module: str, trace: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    capsule = with_source(tmp_path, module, TEXT)
    files = files_of(capsule)
    changed = files[f"source/{module}.py"] + b"x = 1\n"
    capsule.write_bytes(zipped(files | {f"source/{module}.py": changed}))
    assert invoke(["replay", str(capsule), "--allow-code"]) == WRONG_INPUT
    assert "was changed" in capsys.readouterr().err

    def sealed(document: Document) -> None:
        """A capsule with digests of the file that fit, but not that of the run."""
        document["versions"]["components"] = {"my_field.py": "0" * 16}
        document["modules"][module] = "0" * 16

    capsule = with_source(tmp_path, module, TEXT, sealed)
    assert refused(capsys, "replay", capsule, "--allow-code") == RefusalCode.OTHER_SOURCE
    assert not trace.exists()


@pytest.mark.nightly
def test_a_run_of_an_own_component_is_replayed_where_it_is_not_installed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, out = tmp_path / "components", tmp_path / "out"
    folder.mkdir()
    text = SHIPPED.replace('name="potential_field"', 'name="my_field"')
    text = text.replace(
        "from worker.engine.physics.fields", "from ._shared import HALF\nfrom worker.engine.physics.fields"
    )
    (folder / "my_field.py").write_text(text.replace("k_att * (goal.x", "k_att * 2.0 * HALF * (goal.x"))
    (folder / "_shared.py").write_text("HALF = 0.5\n")
    document = ran("violated")[0].document()
    document["scenario"]["avoider"]["component"] = "my_field"
    campaign = tmp_path / "campaign.json"
    campaign.write_text(json.dumps(document))
    command = [sys.executable, "-m", "clearance", "run", str(campaign), "--out", str(out)]
    ended = subprocess.run(
        command, env={**os.environ, "CLEARANCE_COMPONENTS": str(folder)}, capture_output=True, text=True, check=False
    )
    assert ended.returncode == VIOLATED, ended.stderr
    capsule = out / "capsule-F1.zip"
    assert set(read(capsule).sources) == {OWN, "worker.engine.components.own._shared"}
    assert invoke(["replay", str(capsule)]) == WRONG_INPUT
    capsys.readouterr()
    assert invoke(["replay", str(capsule), "--allow-code", "--json"]) == 0
    statement = json.loads(capsys.readouterr().out)
    assert (statement["cases"][0]["agreement"], statement["differences"]) == ("same bits", [])


@pytest.mark.nightly
def test_source_that_does_not_evaluate_the_finding_is_not_claimed_to(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The campaign is one of shipped components, with other source next to it."""

    def shipped(document: Document) -> None:
        document["campaign"]["scenario"]["avoider"]["component"] = "potential_field"
        document["campaign_digest"] = load_document(document["campaign"], "x").digest

    capsule = with_source(tmp_path, OWN, TEXT, shipped)
    assert invoke(["replay", str(capsule), "--allow-code"]) == WRONG_INPUT
    assert refusal(capsys.readouterr().err) == RefusalCode.UNUSED_SOURCE
    assert invoke(["replay", str(capsule), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["executed"] is False


def _module(name: str) -> Callable[[Document], object]:
    return lambda d: d["sources"]["files"][0].update(module=name)


@pytest.mark.parametrize(
    ("change", "why"),
    [
        (_module("worker.engine.kernels.maths"), "not those that it states"),
        (_module("../evil"), "module"),
        (lambda d: d["sources"]["files"][0].update(digest="0" * 64), "was changed"),
        (lambda d: d["sources"]["files"].clear(), "not those that it states"),
        (lambda d: d["sources"]["files"].extend(d["sources"]["files"] * 60), "at most 60"),
        (lambda d: d.pop("sources"), "not those that it states"),
        (lambda d: d["sources"].update(entries=[{"distribution": "../x", "version": "1"}]), "distribution"),
    ],
)
def test_sources_that_contradict_the_document_are_refused(
    tmp_path: Path, change: Callable[[Document], object], why: str
) -> None:
    capsule = with_source(tmp_path, OWN, TEXT, change)
    with pytest.raises(CapsuleError, match=why):
        unpacked(capsule.read_bytes())


def test_source_of_shipped_code_is_not_replaced(tmp_path: Path) -> None:
    capsule = with_source(tmp_path, "worker.engine.kernels.maths", b"x = 1\n")
    with pytest.raises(CapsuleError, match=r"worker\.engine\.kernels\.maths in it is no component"):
        read(capsule)


def test_a_run_records_the_source_of_a_packages_component(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    package(tmp_path, "clearance.components", FOREIGN, TEXT.decode())
    monkeypatch.syspath_prepend(tmp_path)
    campaign = ran("violated")[0]
    assert recorded.added(campaign) is None
    import acme_fields  # type: ignore[import-not-found]

    with pytest.MonkeyPatch.context() as patched:
        patched.setitem(recorded.installed.components(), ("avoider", "my_field"), acme_fields.component)
        patched.setitem(recorded.installed._HOMES, id(acme_fields.component), (acme_fields.component, FOREIGN))
        patched.setitem(recorded.sources.LOADED.files, FOREIGN, (tmp_path / f"{FOREIGN}.py").read_bytes())
        document = campaign.document()
        document["scenario"]["avoider"]["component"] = "my_field"
        found = recorded.added(load_document(document, "x"))
    assert found is not None
    sources, texts = found
    assert sources.faults(texts) == ""
    assert [(file.module, file.package, file.own) for file in sources.files] == [(FOREIGN, False, False)]
    (entry,) = sources.entries
    assert (entry.distribution, entry.group, entry.value) == (FOREIGN, "clearance.components", FOREIGN)
