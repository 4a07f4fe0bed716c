"""The digests of simulators' files in a published catalogue are those that a run stores."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
import yaml

from campaigns.asked.load import load_document
from campaigns.identity.identity import UNREAD, Identity, differences, identity_of, same
from campaigns.versions import Versions
from tests.simulators import package
from worker.engine.systems.base import CampaignUnusable
from worker.engine.systems.simulators.declared.descriptor import read
from worker.engine.systems.simulators.declared.folder import watched
from worker.evidence.scopes.simulators import terms
from worker.running.catalogue import installed
from worker.running.catalogue.digests import with_digests
from worker.running.catalogue.files import read_file
from worker.running.opening import opened

FUNCTION = """
import clearance

@clearance.simulator(parameters={"x": (0.0, 1.0), "y": (0.0, 1.0)}, results={"separation": clearance.Output(unit="m")})
def a_function(x, y):
    return x + y
"""


@pytest.fixture(autouse=True)
def undone() -> Iterator[None]:
    yield
    for name in ("a_program", "a_function"):
        installed.simulators().pop(name, None)
    sys.modules.pop("same_helper", None)
    installed.catalogue.cache_clear()


def add_program(folder: Path) -> None:
    folder.mkdir()
    document = {
        "name": "a_program",
        "command": ["true"],
        "parameters": {name: {"nominal": 0.5, "low": 0, "high": 1} for name in "xy"},
        "results": {"separation": {"unit": "m"}},
    }
    (folder / "simulator.yaml").write_text(yaml.safe_dump(document), encoding="utf-8")
    installed.simulators()["a_program"] = read(folder)


def add_function(folder: Path) -> None:
    folder.mkdir()
    (folder / "function.py").write_text(FUNCTION, encoding="utf-8")
    (installed.simulators()["a_function"],) = read_file(folder / "function.py")


def digest(name: str) -> str:
    """That of the simulator as a run opens it."""
    system = opened.system(load_document(package.campaign(simulator={"name": name})))
    found = system.digest
    system.close()
    return found


def test_they_are_those_of_the_opened_simulators_and_follow_their_files(tmp_path: Path) -> None:
    add_program(tmp_path / "program")
    add_function(tmp_path / "functions")
    installed.catalogue.cache_clear()
    names = ("a_program", "a_function")
    before = with_digests(installed.catalogue()).digests
    assert {name: before[name] for name in names} == {name: digest(name) for name in names}
    (tmp_path / "program" / "data").write_text("1", encoding="utf-8")
    (tmp_path / "functions" / "helper.py").write_text("", encoding="utf-8")
    after = with_digests(installed.catalogue()).digests
    assert all(before[name] != after[name] for name in names)
    assert "digests" not in installed.catalogue().model_dump(mode="json")


@pytest.mark.parametrize("isolated", [True, False])
def test_code_that_cannot_be_read_has_none_and_its_scope_states_why(tmp_path: Path, isolated: bool) -> None:
    """So that no verdict of it is reused, and no requirement rests on it."""
    add_function(tmp_path / "functions")
    file = tmp_path / "functions" / "function.py"
    settings = "" if isolated else ", isolated=False"
    dynamic = f"import importlib\njson = importlib.import_module('js' + 'on')\n{FUNCTION}"
    file.write_text(dynamic.replace('unit="m")}', f'unit="m")}}{settings}'), encoding="utf-8")
    (installed.simulators()["a_function"],) = read_file(file)
    installed.catalogue.cache_clear()
    assert "a_function" not in with_digests(installed.catalogue()).digests
    system = opened.system(load_document(package.campaign(simulator={"name": "a_function"})))
    assert system.digest.startswith(UNREAD)
    scope = terms(system).scope.version
    system.close()
    assert "computed name, line 2 of function.py" in scope


def test_an_edited_table_is_another_simulator(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A verdict is reused only if it is declared and unchanged; one that is not declared identifies nothing."""
    add_function(tmp_path / "functions")
    file, table = tmp_path / "functions" / "function.py", tmp_path / "functions" / "table.csv"
    reading = FUNCTION.replace("x + y", "x + float(open(FILE).read())").replace(
        "import", f"FILE = {str(table)!r}\nimport"
    )
    monkeypatch.setenv("CLEARANCE_SIMULATORS", str(file.parent))

    def published(text: str, content: str) -> Identity:
        file.write_text(text, encoding="utf-8")
        table.write_text(content, encoding="utf-8")
        (installed.simulators()["a_function"],) = read_file(file)
        installed.catalogue.cache_clear()
        found = with_digests(installed.catalogue()).digests.get("a_function")
        system = opened.system(load_document(package.campaign(simulator={"name": "a_function"})))
        assert system.digest == found or (found is None and system.digest.startswith(UNREAD))
        system.close()
        return identity_of(Versions(code="0" * 16, simulator=found), "a_function")

    undeclared = published(reading, "1")
    assert not same(undeclared, published(reading, "1"))
    assert differences(undeclared, undeclared) == ["simulators/a_function is not identified"]
    declared = reading.replace('"y": (0.0, 1.0)}', '"y": (0.0, 1.0)}, reads=["table.csv"]')
    before = published(declared, "1")
    assert table in watched()
    assert same(before, published(declared, "1"))
    assert not same(before, published(declared, "2"))


def test_a_function_is_never_called_with_the_helper_of_another(tmp_path: Path) -> None:
    """Of two folders with a module of the same name; the digest would be that of the one, the numbers of the other."""
    text = FUNCTION.replace('unit="m")}', 'unit="m")}, isolated=False').replace("x + y", "x + y + OFFSET")
    for name, offset in (("one", 1.0), ("two", 2.0)):
        (tmp_path / name).mkdir()
        (tmp_path / name / "same_helper.py").write_text(f"OFFSET = {offset}", encoding="utf-8")
        (tmp_path / name / "function.py").write_text(f"from same_helper import OFFSET\n{text}", encoding="utf-8")
    (installed.simulators()["a_function"],) = read_file(tmp_path / "one" / "function.py")
    installed.catalogue.cache_clear()
    campaign = load_document(package.campaign(simulator={"name": "a_function"}))
    system = opened.system(campaign)
    assert system.evaluate(system.nominal[None, :])[0].costs[0, 0] == 2.0
    (installed.simulators()["a_function"],) = read_file(tmp_path / "two" / "function.py")
    with pytest.raises(CampaignUnusable, match=r"two/same_helper\.py, .*one/same_helper\.py"):
        opened.system(campaign)


def test_files_that_cannot_be_read_have_none_and_prevent_nothing(tmp_path: Path) -> None:
    add_program(tmp_path / "program")
    add_function(tmp_path / "functions")
    for path in sorted(tmp_path.rglob("*"), reverse=True):
        path.rmdir() if path.is_dir() else path.unlink()
    (tmp_path / "program").touch()
    assert not {"a_function"} & with_digests(installed.catalogue()).digests.keys()
