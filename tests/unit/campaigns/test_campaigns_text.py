"""Text and documents of any kind: a campaign or a `CampaignError`, nothing else."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from campaigns import CampaignError, library, load_file, load_text
from campaigns.asked.load import LARGEST_FILE, load_document
from campaigns.asked.reading import TOO_LONG, parse
from campaigns.asked.text import to_yaml
from campaigns.documents import canonical
from tests.given.case_campaigns import campaign, document
from tests.simulators import package

TEXTS = {
    "name: x\nname: y": "line 2, column 1: not readable as YAML: the key 'name' is given twice",
    "a: &x 1\nb: *x": "line 2, column 4: not readable as YAML: aliases (*name) are not allowed, write the value out",
    "1: x": "line 1, column 1: not readable as YAML: keys must be text, given 1 ",
    "? [a]\n: x": "line 1, column 3: not readable as YAML: keys must be text, given ['a']",
    "a: !!float x": "line 1, column 4: not readable as YAML: tags (tag:yaml.org,2002:float) are not allowed",
    "!!int ''": "tags (tag:yaml.org,2002:int) are not allowed",
    "!!timestamp x": "tags (tag:yaml.org,2002:timestamp) are not allowed",
    "!!python/object/apply:os.system [id]": "are not allowed",
    "a: [": "line 1, column 5: not readable as YAML",
    'a: "\\UFFFFFFFF"': "not readable as YAML",
    "a: " + "9" * 5000: f"line 1, column 4: not readable as YAML: {TOO_LONG}",
    "a:\n  b: [1, -" + "9" * 5000 + "]": f"line 2, column 10: not readable as YAML: {TOO_LONG}",
    "? " + "9" * 5000 + "\n: a": f"line 1, column 3: not readable as YAML: {TOO_LONG}",
    '{"a": ' + "9" * 5000 + "}": f"not readable as JSON: {TOO_LONG}",
    "{" * 3000: "nested too deeply",
    '{"a":' * 100_000: "nested too deeply",
    "- " * 2000: "nested too deeply",
    "\0": "special characters are not allowed",
    "": "a campaign is a mapping with name, scenario, ...",
    "just text": 'a campaign is a mapping with name, scenario, ... (given: "just text")',
    "[1, 2]": "a campaign is a mapping with name, scenario, ... (given: [1, 2])",
    '{"name": 1, "name": 2}': "not readable as JSON: the key 'name' is given twice",
    "---\n---\n": "another document",
    "x" * (LARGEST_FILE + 1): "a campaign is at most 1000000 bytes",
}


@pytest.mark.parametrize("text", TEXTS, ids=lambda text: repr(text[:20]))
def test_text_that_is_no_campaign(text: str) -> None:
    with pytest.raises(CampaignError) as caught:
        load_text(text, "here.yaml")
    (problem,) = caught.value.problems
    assert TEXTS[text].strip() in str(problem)
    assert caught.value.source == "here.yaml"


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    latin, large, good = tmp_path / "latin.yaml", tmp_path / "large.yaml", tmp_path / "good.json"
    latin.write_bytes(b"name: caf\xe9")
    large.write_bytes(b" " * (LARGEST_FILE + 1))
    good.write_text("\ufeff" + json.dumps(document(), indent="\t"), encoding="utf-8")
    for path, message in (
        (tmp_path / "none.yaml", "No such file"),
        (tmp_path, "Is a directory"),
        (latin, "not UTF-8"),
        (large, "at most 1000000 bytes"),
        (Path("/dev/zero"), "at most 1000000 bytes"),
        (Path("a\0b"), "cannot be read"),
    ):
        with pytest.raises(CampaignError, match=message):
            load_file(path)
    assert load_file(good).digest == campaign().digest


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e-3", 1e-3), ("1E5", 1e5), (".5", 0.5), ("-2.", -2.0), ("012", 12), ("+7", 7), ("0.0", 0.0),
        ("true", True), ("no", "no"), ("on", "on"), ("1:30", "1:30"), ("2026-01-31", "2026-01-31"),
        ("0x10", "0x10"), ("1_000", "1_000"), ("~", None), ("", None), ("null", None), ("<<", "<<"), ("=", "="),
    ],
)  # fmt: skip
def test_yaml_is_read_by_its_core_schema(text: str, value: Any) -> None:
    read = parse(f"key: {text}")
    assert read == {"key": value}
    assert type(read["key"]) is type(value)


def test_json_text_is_read_as_json() -> None:
    assert parse('{"name":\t"\\ud83d\\ude80\\/", "x": [1e5, -0.5]}') == {"name": "\U0001f680/", "x": [1e5, -0.5]}
    assert parse("{name: unquoted}") == {"name": "unquoted"}


TELLING = "aZ09 _-.:,#'\"\\/{}[]&*!|>%@~\n\r\t\0\x7f\x85\u00e9\u2028\ufeff\ufffe\U0001f680"
"""By day, characters that readers treat in their own way; by night, all that there are, whose table takes seconds."""


def values(text: st.SearchStrategy[str]) -> st.SearchStrategy[Any]:
    return st.recursive(
        st.none() | st.booleans() | st.integers() | st.floats() | text,
        lambda inner: st.lists(inner, max_size=3) | st.dictionaries(text, inner, max_size=3),
        max_leaves=8,
    )


PLAIN = values(st.text(TELLING, max_size=8))
PLACES = [
    "name", "tags", "scenario", "scenario__vehicle", "scenario__vehicle__parameters", "scenario__start",
    "scenario__obstacles", "scenario__obstacles__0", "scenario__guidance", "scenario__horizon", "scenario__step",
    "uncertain", "uncertain__vehicle.m", "criterion", "criterion__threshold", "stages", "stages__search",
    "stages__search__0", "stages__search__0__options", "stages__search__0__starts", "stages__validate",
    "stages__sensitivity", "agreement", "target_probability", "seed", "published", "version", "extra",
]  # fmt: skip


def read_or_refused(place: str, value: Any) -> None:
    """The campaign with this value somewhere is read, the same in every form, or refused."""
    try:
        found = load_document(document(**{place: value}))
    except CampaignError as error:
        str(error).encode()  # it can be printed
    else:
        assert load_text(to_yaml(found)).digest == load_text(canonical(found.document())).digest == found.digest


@settings(max_examples=60)
@given(st.sampled_from(PLACES), PLAIN)
def test_any_value_anywhere_gives_a_campaign_or_a_campaign_error(place: str, value: Any) -> None:
    read_or_refused(place, value)


@pytest.mark.nightly
@settings(max_examples=1000)
@given(st.sampled_from(PLACES), values(st.text(max_size=8)))
def test_any_value_anywhere_is_read_or_refused(place: str, value: Any) -> None:
    read_or_refused(place, value)


@settings(max_examples=150)
@given(st.text("{}[]:,-&*!|>?%@#'\"\\ \n\t\r~0123456789.eExXan\u00e9\ufeff\0", max_size=40))
def test_any_other_text_gives_a_campaign_error(text: str) -> None:
    with pytest.raises(CampaignError):
        load_text(text)


@pytest.mark.nightly
@settings(max_examples=1000)
@given(st.text(max_size=40))
def test_any_characters_give_a_campaign_error(text: str) -> None:
    with pytest.raises(CampaignError):
        load_text(text)


@settings(max_examples=80)
@given(PLAIN)
def test_any_other_document_gives_a_campaign_error(value: Any) -> None:
    with pytest.raises(CampaignError):
        load_document(value)


@pytest.mark.parametrize("name", library())
def test_the_library_reads_the_same_as_yaml_and_json(name: str) -> None:
    path = library()[name]
    found = load_file(path)
    again = load_text(json.dumps(yaml.safe_load(path.read_text(encoding="utf-8"))))
    assert again == found
    assert again.digest == found.digest


@pytest.mark.parametrize("asked", [document(), package.campaign()], ids=["scenario", "simulator"])
def test_the_text_has_only_fields_of_the_canonical_form(asked: dict[str, Any]) -> None:
    found = load_document(asked)
    assert _strays(yaml.safe_load(to_yaml(found)), found.document()) == []


def _strays(written: Any, canonical: Any, place: str = "") -> list[str]:
    """Where the text has a field that the canonical form omits."""
    if isinstance(written, dict):
        return [
            stray
            for key, value in written.items()
            for stray in (_strays(value, canonical[key], f"{place}.{key}") if key in canonical else [f"{place}.{key}"])
        ]
    if isinstance(written, list):
        pairs = zip(written, canonical, strict=True)
        return [stray for i, (value, told) in enumerate(pairs) for stray in _strays(value, told, f"{place}.{i}")]
    return []
