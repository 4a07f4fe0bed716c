"""Own components: written by `component new`, examined once for each content, skipped with a sentence, never fatal."""

from __future__ import annotations

import importlib
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any, get_args

import pytest

from campaigns import check
from campaigns.asked.load import load_document
from campaigns.catalogue import Catalogue, Role, UnusableEntry
from campaigns.refusals import RefusalCode
from clearance.cli import WRONG_INPUT, invoke
from tests.faults.processes import REPOSITORY
from tests.given.at_night import nightly_but
from tests.given.case_campaigns import document
from tests.given.guest_packages import package
from tests.given.refused_commands import refused
from worker.running.catalogue import installed, own
from worker.running.catalogue.installed import catalogue
from worker.running.examination import naming

SKELETONS = Path(__file__).parents[4] / "worker" / "running" / "skeletons"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The operator's folder, and an empty store of examinations."""
    given = tmp_path / "components"
    given.mkdir()
    monkeypatch.setenv("CLEARANCE_COMPONENTS", str(given))
    monkeypatch.setenv("CLEARANCE_KERNEL_CACHE", str(tmp_path / "cache"))
    monkeypatch.chdir(tmp_path)
    return given


@pytest.fixture
def read(monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """Examinations only read the text; the files that were examined."""
    asked: list[Path] = []

    def examined(file: Path, vehicles: dict[str, str]) -> dict[str, Any]:
        asked.append(file)
        kind, name = own.declared_as(file) or ("", "")
        return {"role": kind.lower(), "name": name} if kind else {"text": "it is broken: mend it", "line": 3}

    monkeypatch.setattr(own, "_examined", examined)
    return asked


def skeleton(folder: Path, kind: str, name: str, stem: str = "") -> Path:
    file = folder / f"{stem or name}.py"
    text = (SKELETONS / f"{kind}.py").read_text(encoding="utf-8")
    file.write_text(text.replace(f"my_{kind}", name), encoding="utf-8")
    return file


def test_new_writes_a_file_and_overwrites_nothing(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["component", "new", "obstacle", "swinging_post"]) == 0
    text = (folder / "swinging_post.py").read_text(encoding="utf-8")
    assert 'name="swinging_post"' in text
    assert "class SwingingPost(NamedTuple)" in text
    assert text.startswith('"""Swinging post: ')
    assert "my_obstacle" not in text.lower()
    assert "clearance component check components/swinging_post.py" in capsys.readouterr().out
    assert refused(capsys, "component", "new", "obstacle", "swinging_post") == RefusalCode.EXISTS
    assert (folder / "swinging_post.py").read_text(encoding="utf-8") == text


def test_new_writes_all_files_or_none(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "rover_controller.py").write_text("mine", encoding="utf-8")
    assert refused(capsys, "component", "new", "vehicle", "rover") == RefusalCode.EXISTS
    assert [file.name for file in folder.iterdir()] == ["rover_controller.py"]


def test_new_has_every_kind_of_the_catalogue() -> None:
    assert set(get_args(Role)) == set(naming.FOLDERS)


# Each compiles for seconds.
@pytest.mark.nightly
@pytest.mark.parametrize("kind", nightly_but(("vehicle",), get_args(Role)))
def test_the_campaign_of_a_new_component_ends_with_a_verdict(kind: Role, folder: Path) -> None:
    """By day one kind; `test_what_is_written_to_start_from_can_be_used` in test_examination.py has each."""
    assert invoke(["component", "new", kind, "my_own"]) == 0
    command = [sys.executable, "-m", "clearance", "run", str(folder / "my_own.yaml")]
    environment = {
        name: value for name, value in os.environ.items() if name != "CLEARANCE_KERNEL_CACHE"
    }  # compiled once
    done = subprocess.run(command, cwd=REPOSITORY, env=environment, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr.count("search: ")) == (0, 1), done.stderr
    assert "\n✓ Cleared\n" in done.stdout
    assert "certify: 300 evaluations" in done.stderr


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("Post", "expected small letters, digits and _"),
        ("my post", "expected small letters, digits and _"),
        ("../post", "expected small letters, digits and _"),
        ("lambda", "is a word of Python: choose another, such as my_lambda"),
        ("circle", "is taken by the obstacle of worker/engine/components/obstacles/circle.py"),
        ("x" * 61, "expected small letters, digits and _"),
    ],
)
def test_new_refuses_a_name(name: str, text: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["component", "new", "obstacle", name]) == WRONG_INPUT
    assert text in capsys.readouterr().err
    assert list(folder.iterdir()) == []


def test_new_refuses_a_name_that_another_file_has(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    skeleton(folder, "obstacle", "post", "other")
    assert refused(capsys, "component", "new", "obstacle", "post") == RefusalCode.NAME_TAKEN


def test_new_writes_where_the_user_is_and_says_what_to_set(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv("CLEARANCE_COMPONENTS")
    assert invoke(["component", "new", "fault", "my_range"]) == 0
    assert (folder.parent / "my_range.py").is_file()
    assert f"export CLEARANCE_COMPONENTS={folder.parent}" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["avoider", "a", "--for", "unicycle"], "only a controller is written for a vehicle"),
        (["controller", "a", "--for", "unicyle"], "no such vehicle; did you mean 'unicycle'?"),
        (["controller", "a", "--for", "fixed_wing"], "is for the states x, y, theta, v, omega"),
    ],
)
def test_a_controller_is_written_for_a_vehicle(
    words: list[str], text: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke(["component", "new", *words]) == WRONG_INPUT
    assert text in capsys.readouterr().err
    assert invoke(["component", "new", "controller", "b"]) == 0
    assert 'fits=("unicycle",)' in (folder / "b.py").read_text(encoding="utf-8")


def test_check_of_a_file_that_does_not_exist(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert refused(capsys, "component", "check", "no.py") == RefusalCode.NO_FILE


def test_a_file_is_examined_once_for_each_content(folder: Path, read: list[Path]) -> None:
    file = skeleton(folder, "obstacle", "post")
    assert [(one.role, one.name, one.text) for one in own.examined()] == [("obstacle", "post", "")]
    own.examined()
    assert read == [file]
    file.write_text(file.read_text(encoding="utf-8") + "\n# edited\n", encoding="utf-8")
    own.examined()
    (folder / "_shared.py").write_text("X = 1.0\n", encoding="utf-8")
    own.examined()
    assert read == [file] * 3


def test_a_controller_is_examined_again_when_its_vehicle_changes(folder: Path, read: list[Path]) -> None:
    vehicle, pilot = skeleton(folder, "vehicle", "my_robot"), skeleton(folder, "controller", "pilot")
    pilot.write_text(pilot.read_text(encoding="utf-8").replace('"unicycle"', '"my_robot"'), encoding="utf-8")
    own.examined()
    vehicle.write_text(vehicle.read_text(encoding="utf-8") + "\n# edited\n", encoding="utf-8")
    read.clear()
    own.examined()
    assert sorted(read) == [vehicle, pilot]


def test_other_files_are_left_alone_and_broken_and_duplicate_ones_are_reported(folder: Path, read: list[Path]) -> None:
    (folder / "simulator.py").write_text("import clearance\n", encoding="utf-8")
    (folder / "_shared.py").write_text("from worker.engine.kernels.maths import kernel\n", encoding="utf-8")
    (folder / "broken.py").write_text("from worker.engine.kernels.maths import kernel\n", encoding="utf-8")
    skeleton(folder, "obstacle", "post", "a")
    second = skeleton(folder, "obstacle", "post", "b")
    skeleton(folder, "fault", "post", "c")
    found = {one.file.name: one for one in own.examined()}
    assert list(found) == ["a.py", "b.py", "broken.py", "c.py"]
    assert {name for name, one in found.items() if one.text} == {"b.py", "broken.py"}
    line = second.read_text(encoding="utf-8").splitlines()[found["b.py"].line - 1]
    assert 'name="post"' in line
    assert found["b.py"].text == "a.py already declares the obstacle 'post': rename one of them"
    broken = found["broken.py"]
    assert broken.line == 3
    assert str(broken.entry) == f"components/broken.py, line 3: {broken.text}"


def test_a_folder_that_does_not_exist_and_two_files_of_one_name(
    folder: Path, read: list[Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    other = folder.parent / "others"
    other.mkdir()
    skeleton(folder, "obstacle", "post")
    skeleton(other, "fault", "post")
    monkeypatch.setenv("CLEARANCE_COMPONENTS", f"{folder}:{other}:{folder.parent / 'none'}")
    (sentence,) = own.missing()
    assert str(folder.parent / "none") in sentence
    assert [(one.file, bool(one.text)) for one in own.examined()] == [
        (folder / "post.py", False),
        (other / "post.py", True),
    ]


@pytest.mark.nightly
@pytest.mark.by_day(1)
@pytest.mark.parametrize(
    ("line", "text"),
    [
        ("while True: pass", "the check stopped after 3 s in a loop at the top of the file, while importing it"),
        ("import os; os._exit(3)", "ended the process with exit code 3"),
        ("import sys; sys.stdout.write('examined 0 {}\\n'); raise ValueError('no')", "ValueError: no"),
    ],
)
def test_what_a_file_does_ends_no_other_process(
    line: str, text: str, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if "while" in line:
        monkeypatch.setenv(own.TIMEOUT, "9")
    file = skeleton(folder, "obstacle", "post")
    file.write_text(file.read_text(encoding="utf-8").replace("\n\nclass", f"\n{line}\n\n\nclass", 1), encoding="utf-8")
    found = own.examine(file).text
    assert text in found
    assert (own.BUSY in found) == ("while" in line)


def test_a_file_whose_process_takes_too_long_may_be_on_a_busy_machine(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(own.TIMEOUT, "0.01")
    found = own.examine(skeleton(folder, "obstacle", "post")).text
    assert found.endswith(own.BUSY)


def test_a_campaign_that_names_a_broken_component_is_refused_with_its_sentence() -> None:
    broken = UnusableEntry(file="components/my_robot.py", line=7, name="my_robot", text="broken")
    known: Catalogue = catalogue().model_copy(update={"unusable": [broken]})
    asked = load_document(document(scenario__vehicle__component="my_robot"), "test")
    found = [p for p in check(asked, known) if p.field == "scenario.vehicle.component"]
    assert [p.message.endswith(": components/my_robot.py, line 7: broken") for p in found] == [True]
    assert "unusable" not in catalogue().model_dump(mode="json")


def test_packages_add_components_and_what_cannot_be_used_is_skipped(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = (SKELETONS / "obstacle.py").read_text(encoding="utf-8")
    package(tmp_path, "clearance.components", "acme_post", text.replace("my_obstacle", "acme_post"))
    package(tmp_path, "clearance.components", "acme_again", text.replace("my_obstacle", "circle"))
    package(tmp_path, "clearance.components", "acme_broken", "raise ValueError('not today')\n")
    package(tmp_path, "clearance.components", "acme_empty", "X = 1.0\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    importlib.invalidate_caches()
    found, wrong = installed._found.__wrapped__()
    assert ("obstacle", "acme_post") in found
    assert installed.source_of(found["obstacle", "acme_post"]).__name__ == "acme_post"
    texts = {entry.name: str(entry) for entry in wrong}
    assert texts == {
        "acme_again": "the package acme_again: worker.engine.components.obstacles.circle already declares the obstacle "
        "'circle': rename one of them",
        "acme_broken": "the package acme_broken: it cannot be loaded (ValueError: not today)",
        "acme_empty": "the package acme_empty: it has no `component`: declare one at the end of the module",
    }
    for name in ("acme_post", "acme_again", "acme_broken", "acme_empty"):
        sys.modules.pop(name, None)


def test_a_stored_examination_that_cannot_be_read_is_made_again(folder: Path, read: list[Path]) -> None:
    skeleton(folder, "obstacle", "post")
    own.examined()
    for stored in own._file("").parent.glob("*.json"):
        stored.write_text("{", encoding="utf-8")
    own.examined()
    [stored] = own._file("").parent.glob("*.json")
    assert json.loads(stored.read_text(encoding="utf-8"))["name"] == "post"
    assert len(read) == 2


def test_the_code_of_a_criterion_is_known_with_what_it_imports(folder: Path) -> None:
    helper = folder / "helping.py"
    helper.write_text("SHIFT = 0.0\n", encoding="utf-8")
    file = skeleton(folder, "criterion", "own_gap")
    text = file.read_text(encoding="utf-8").replace("import kernel\n", "import kernel\nfrom .helping import SHIFT\n")
    paths = {f"{own.PACKAGE}.{each.stem}": each for each in (file, helper)}

    def code() -> str:
        return own.code_of(f"{own.PACKAGE}.own_gap", paths)

    file.write_text(text, encoding="utf-8")
    before = code()
    assert before
    file.write_text(text.replace("My criterion:", "Another text:") + "\n# a comment\n", encoding="utf-8")
    assert code() == before
    file.write_text(text.replace("return (body.gap,)", "return (body.gap + 0.5,)"), encoding="utf-8")
    assert code() != before
    file.write_text(text, encoding="utf-8")
    helper.write_text("SHIFT = 0.5\n", encoding="utf-8")
    assert code() != before
    assert own.code_of("worker.engine.components.criteria.separation", paths) == ""


def test_the_code_of_a_criterion_of_a_package_is_known_with_what_it_imports_of_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    home = tmp_path / "acme_gaps"
    home.mkdir()
    (home / "__init__.py").write_text("from acme_gaps import near, other\n", encoding="utf-8")
    texts = {
        "near": "from . import shift\nfrom acme_gaps.shift import SHIFT\nX = 1.0  # a comment\n",
        "shift": "SHIFT = 0.0\n",
        "other": "Y = 1.0\n",
    }
    monkeypatch.syspath_prepend(str(tmp_path))

    def code(**changed: str) -> str:
        for name, text in (texts | changed).items():
            (home / f"{name}.py").write_text(text, encoding="utf-8")
        importlib.invalidate_caches()
        importlib.import_module("acme_gaps.near")
        return own.code_of_package("acme_gaps.near")

    before = code()
    assert before
    assert code(other="Y = 2.0\n") == before
    assert code(near=texts["near"].replace("a comment", "another one")) == before
    assert code(near=texts["near"].replace("1.0", "2.0")) != before
    assert code(shift="SHIFT = 0.5\n") != before
    for name in [name for name in sys.modules if name.partition(".")[0] == "acme_gaps"]:
        monkeypatch.delitem(sys.modules, name)
