"""Descriptors of programs: what they state, and one sentence for every mistake."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import pytest
import yaml

from worker.engine.systems.simulators.declared.descriptor import BadDescriptor, listed, read, unusable
from worker.engine.systems.simulators.declared.folder import FOLDERS
from worker.engine.systems.simulators.declared.reached import data_files

GOOD: dict[str, Any] = {
    "name": "drop",
    "command": ["{folder}/drop"],
    "parameters": {"mass": {"unit": "kg", "nominal": 2, "low": 1, "high": 3}},
    "results": {"separation": {"unit": "m"}},
}


def write(folder: Path, **changed: Any) -> Path:
    folder.mkdir(parents=True)
    document = {k: v for k, v in (GOOD | changed).items() if v is not None}
    (folder / "simulator.yaml").write_text(yaml.safe_dump(document), encoding="utf-8")
    return folder


@pytest.mark.parametrize("stated", [None, False])
def test_a_description_without_ids_is_what_it_was(tmp_path: Path, stated: bool | None) -> None:
    """The digest of a command in a campaign file covers it."""
    described = read(write(tmp_path / "a", ids=stated)).descriptor.model_dump(mode="json")
    assert "ids" not in described
    assert read(write(tmp_path / "b", ids=True)).descriptor.model_dump(mode="json")["ids"] is True


def test_its_entry_in_the_catalogue(tmp_path: Path) -> None:
    entry = read(write(tmp_path / "a")).entry
    assert (entry.name, entry.title) == ("drop", "drop")
    assert [(p.name, p.unit, p.low, p.default, p.high) for p in entry.parameters] == [("mass", "kg", 1.0, 2.0, 3.0)]
    assert [(r.name, r.title, r.quantity, r.worse) for r in entry.results] == [
        ("separation", "separation", "separation", "low")
    ]


@pytest.mark.parametrize(
    ("changed", "expected"),
    [
        ({"command": None}, "command: this key is required"),
        ({"command": []}, "command: expected at least 1 entr"),
        ({"comand": ["x"]}, "comand: unknown key; remove it or correct its spelling"),
        ({"protocol": "http"}, "protocol: expected 'lines' or 'files'"),
        (
            {"protocol": "files", "ids": True},
            "the file: ids is only for the protocol lines; with files each evaluation",
        ),
        ({"ids": "yes"}, "ids: expected true or false"),
        ({"ids": 1}, "ids: expected true or false"),
        ({"name": "a b"}, "name: "),
        ({"timeout": 0}, "timeout: expected a number above 0 and at most 86,400"),
        ({"timeout": float("nan")}, "timeout: expected a finite number"),
        ({"parameters": {}}, "parameters: expected at least 1 entr"),
        ({"parameters": {"mass": {"nominal": 5, "low": 1, "high": 3}}}, "parameters.mass: nominal 5 must be within"),
        ({"parameters": {"mass": {"nominal": 2, "low": 1}}}, "parameters.mass.high: this key is required"),
        ({"results": {"d": {"worse": "both"}}}, "results.d.worse: expected 'low' or 'high'"),
    ],
)
def test_a_mistake_is_named_with_its_file_and_key(tmp_path: Path, changed: dict[str, Any], expected: str) -> None:
    folder = write(tmp_path / "a", **changed)
    with pytest.raises(BadDescriptor) as caught:
        read(folder)
    assert str(caught.value).startswith(f"{folder / 'simulator.yaml'}: {expected}")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("text", ["{", "a: [1", "\tname: x", "- 1", "", "name: \x00"])
def test_what_is_not_a_descriptor_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / "simulator.yaml").write_text(text, encoding="utf-8")
    with pytest.raises(BadDescriptor, match=r"simulator\.yaml: "):
        read(tmp_path)


PROGRAM = """name: drop
command: ["x"]
parameters:
  mass: {{nominal: {nominal}, low: -5, high: {high}}}
results: {{d: {{worse: low{result}}}}}
environment: {{{variables}}}
{more}"""
FMU = "name: drop\nfmu: model.fmu\nparameters: {{mass: {{low: -5, high: {high}}}}}\nresults: {{d: {{}}}}\n{more}"
TWICE = "the key '{key}' is given twice"


def text_of(text: str, **changed: str) -> str:
    usual = {"nominal": "1", "high": "100", "result": "", "variables": "", "more": ""}
    return text.format(**(usual | changed))


AMBIGUOUS = [
    ({"more": "timeout: 5\ntimeout: 6\n"}, TWICE.format(key="timeout")),
    ({"more": "parameters: {wind: {nominal: 0, low: 0, high: 1}}\n"}, TWICE.format(key="parameters")),
    ({"nominal": "1, nominal: 2"}, TWICE.format(key="nominal")),
    ({"result": ", worse: high"}, TWICE.format(key="worse")),
    ({"high": "100, high: 200"}, TWICE.format(key="high")),
    ({"high": "1:30"}, "parameters.mass.high: "),
    ({"nominal": "yes"}, "parameters.mass.nominal: "),
    ({"nominal": "2001-01-01"}, "parameters.mass.nominal: "),
    ({"more": "text: &a x\ntitle: *a\n"}, "aliases (*name) are not allowed"),
    ({"more": "text: !!str 5\n"}, "are not allowed, write the plain value"),
]


@pytest.mark.parametrize(
    ("text", "changed", "expected"),
    [
        (text, changed, expected)
        for text in (PROGRAM, FMU)
        for changed, expected in AMBIGUOUS
        if all("{" + name + "}" in text for name in changed)
    ],
)
def test_what_can_be_read_in_two_ways_is_refused(
    tmp_path: Path, text: str, changed: dict[str, str], expected: str
) -> None:
    (tmp_path / "simulator.yaml").write_text(text_of(text, **changed), encoding="utf-8")
    with pytest.raises(BadDescriptor) as caught:
        read(tmp_path)
    assert expected in str(caught.value)


def test_numbers_are_those_that_are_written(tmp_path: Path) -> None:
    (tmp_path / "simulator.yaml").write_text(text_of(PROGRAM, nominal="010", high="1e2"), encoding="utf-8")
    (mass,) = read(tmp_path).entry.parameters
    assert (mass.default, mass.high) == (10.0, 100.0)


@pytest.mark.parametrize("value", ["010", "8", "1.10", "true", "null", "no", "12:30:00", "1e5"])
def test_a_variable_of_the_environment_is_passed_on_as_it_is_written(tmp_path: Path, value: str) -> None:
    file = tmp_path / "simulator.yaml"
    for quoted in (value, f"'{value}'", f'"{value}"'):
        file.write_text(text_of(PROGRAM, variables=f"DOMAIN: {quoted}"), encoding="utf-8")
        assert read(tmp_path).descriptor.environment == {"DOMAIN": value}


def test_what_only_libyaml_reads_is_read(tmp_path: Path) -> None:
    text = text_of(PROGRAM, variables="DOMAIN: 010", more="title: a\tb\n")
    (tmp_path / "simulator.yaml").write_text(text, encoding="utf-8")
    assert read(tmp_path).descriptor.environment == {"DOMAIN": "010"}


@pytest.mark.parametrize("value", ["[a]", "{a: b}"])
def test_a_variable_of_the_environment_is_text(tmp_path: Path, value: str) -> None:
    (tmp_path / "simulator.yaml").write_text(text_of(PROGRAM, variables=f"DOMAIN: {value}"), encoding="utf-8")
    with pytest.raises(BadDescriptor, match=r"environment\.DOMAIN: "):
        read(tmp_path)


def test_a_bad_one_keeps_no_other_from_being_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write(tmp_path / "one" / "a")
    write(tmp_path / "one" / "b", name="other", timeout=-1)
    write(tmp_path / "two" / "c")
    monkeypatch.setenv(FOLDERS, os.pathsep.join(map(str, (tmp_path / "one", tmp_path / "two", tmp_path / "none"))))
    assert sum(not isinstance(d, BadDescriptor) for d in listed()) == 2
    assert unusable() == [
        f"{FOLDERS} names {tmp_path / 'none'}, which is not a folder",
        f"{tmp_path / 'one' / 'b' / 'simulator.yaml'}: timeout: expected a number above 0 and at most 86,400",
        f"{tmp_path / 'two' / 'c' / 'simulator.yaml'}: name: {tmp_path / 'one' / 'a'} already describes a simulator "
        "drop; rename one of them",
    ]


def test_the_digest_covers_every_file_by_name_and_content(tmp_path: Path) -> None:
    folder = write(tmp_path / "a")
    digests = [read(folder).digest]
    for name, content in (("drop", "1"), ("drop", "2"), ("inner/data.csv", "2"), ("other", "")):
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(content)
        digests.append(read(folder).digest)
    assert len(set(digests)) == len(digests)
    assert read(folder).digest == digests[-1]


def test_the_digest_covers_folders_that_are_linked_into_it(tmp_path: Path) -> None:
    """Also links of links, and data that a function declares; a link back to the folder itself ends."""
    for version in ("v3", "v4"):
        (tmp_path / version / "inner").mkdir(parents=True)
        (tmp_path / version / "inner" / "model.py").write_text(f"A = '{version}'\n")
    folder = write(tmp_path / "a")
    alone = read(folder).digest
    (folder / "back").symlink_to(folder)
    (folder / "itself").symlink_to("itself")
    assert read(folder).digest == alone
    (tmp_path / "current").symlink_to("v3")
    (folder / "model").symlink_to(tmp_path / "current")
    first = read(folder).digest
    assert first != alone
    assert folder / "model" / "inner" / "model.py" in read(folder).covered
    assert [path.name for path in data_files(["model"], folder)[0].values()] == ["model.py"]
    (tmp_path / "current").unlink()
    (tmp_path / "current").symlink_to("v4")
    assert read(folder).digest not in (alone, first)
