"""Reading takes time in proportion to the text, and no text takes long: repeated keys, long lists, many problems."""

from __future__ import annotations

import json
import time
import tracemalloc
from functools import cache

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from campaigns import CampaignError, Problem
from campaigns.asked import reading
from campaigns.asked.load import LARGEST_FILE, load_document, load_text
from campaigns.asked.problem import shown
from campaigns.asked.reading import _Fast, _Loader, parse
from campaigns.asked.text import readable_yaml
from tests.given.case_campaigns import document

LIMIT = 10.0
"""Time that any text may take [s]; each of these takes a second, and took half a minute."""

KEYS = [f"k{i}" for i in range(29_000)]


@cache
def told(text: str) -> str:
    """The first problem of the text, which is found in time."""
    began = time.process_time()
    with pytest.raises(CampaignError) as caught:
        load_text(text)
    assert time.process_time() - began < LIMIT
    assert len(caught.value.problems) <= 51
    return str(caught.value.problems[0])


LATE = {
    "json, the key before": ("{" + ",".join(f'"{k}":1' for k in KEYS) + ',"k28999":2}', "the key 'k28999' is"),
    "json, the first key": ("{" + ",".join(f'"{k}":1' for k in KEYS) + ',"k0":2}', "the key 'k0' is given twice"),
    "yaml": (
        "\n".join(f"{k}: 1" for k in KEYS) + "\nk0: 2",
        "line 29001, column 1: not readable as YAML: the key 'k0'",
    ),
    "yaml in braces": ("{" + ",".join(f"{k}: 1" for k in KEYS) + ", k0: 2}", "the key 'k0' is given twice"),
}


@pytest.mark.parametrize("name", LATE)
def test_a_repeated_key_is_found_in_one_pass(name: str) -> None:
    text, message = LATE[name]
    assert len(text) <= LARGEST_FILE
    assert message in told(text)


LARGE = {
    "yaml list": "tags: [" + "1," * 490_000 + "]",
    "json list": '{"tags": [' + "1," * 490_000 + "1]}",
}


@pytest.mark.parametrize("name", LARGE)
def test_a_long_text_is_read_or_refused_soon(name: str) -> None:
    assert told(LARGE[name])


def test_too_many_values_are_refused_as_such(monkeypatch: pytest.MonkeyPatch) -> None:
    assert "more than 60,000 values" in told(LARGE["yaml list"])
    monkeypatch.setattr(reading, "MOST_VALUES", 1000)
    assert "line 1, column 1999: " in told("a: [" + "1," * 998 + "]")
    assert len(parse("a: [" + "1," * 997 + "]")["a"]) == 997


@pytest.mark.by_day(1)
@pytest.mark.parametrize("piece", ["[[]]", '{"":0}'])
def test_too_many_lists_are_refused_before_their_places_are_noted(piece: str) -> None:
    text = f'{{"name": [{",".join([piece] * 160_000)}]}}'
    tracemalloc.start()
    try:
        with pytest.raises(CampaignError, match="more than 150,000 lists and mappings: shorten the campaign"):
            load_document(json.loads(text))
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < 100_000_000


def test_of_very_many_unreadable_texts_only_the_first_are_described() -> None:
    with pytest.raises(CampaignError) as caught:
        load_document({"name": ["\ud800"] * 100_000})
    assert len(caught.value.problems) == 50
    assert [bool(p.field) for p in caught.value.problems] == [True] * 49 + [False], "the last one counts the others"


def test_as_many_starts_as_a_campaign_can_have_are_read() -> None:
    starts = [{f"vehicle.m{i}": 5.0 for i in range(30)}] * 10_000
    found = load_document(document(stages__search=[{"method": "sqp", "evaluations": 10, "starts": starts}]))
    assert len(found.stages.search[0].starts) == 10_000


def test_yaml_is_written_where_it_can_be_read_back() -> None:
    def started(count: int) -> str | None:
        starts = [{"vehicle.m": 5.0, "vehicle.J": 0.05}] * count
        search = [{"method": "sqp", "evaluations": 10, "starts": starts}]
        return readable_yaml(load_document(document(stages__search=search)))

    text = started(10_000)
    assert text is not None
    assert len(load_text(text).stages.search[0].starts) == 10_000
    search = {"method": "sqp", "evaluations": 10, "starts": [{f"vehicle.m{i}": 5.0 for i in range(8)}] * 10_000}
    assert readable_yaml(load_document(document(stages__search=[search]))) is None


def test_of_many_problems_fifty_are_worked_out_and_all_are_counted() -> None:
    large = {f"key{i}": ["x" * 200] * 40 for i in range(50)} | {f"key{i}": i for i in range(50, 20_000)}
    problem = told(json.dumps(document(**large)))
    assert problem.startswith("key0: unknown key")
    with pytest.raises(CampaignError) as caught:
        load_document(document(**large))
    assert caught.value.problems[-1] == Problem("", "", "and 19950 more problems")


def test_of_a_large_value_only_the_beginning_is_written_out() -> None:
    value = [["x"] * 100] * 100_000
    began = time.process_time()
    assert shown(value) == json.dumps(value[:5])[:117] + "..."
    assert time.process_time() - began < 0.1


def test_locations_are_built_only_where_there_is_a_problem() -> None:
    """Half a million values below fifteen long keys: their places alone would take 1.5 GB."""
    inner: object = [1] * 50_000 + ["\ud800"]
    for _ in range(15):
        inner = {"k" * 200: inner}
    tracemalloc.start()
    try:
        with pytest.raises(CampaignError, match=r"\.50000: invalid Unicode text: it contains an unpaired surrogate"):
            load_document(inner)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < 30_000_000


def test_a_sentence_stays_short_whatever_the_key() -> None:
    for text in (
        '{"%s": 1, "%s": 2}' % (("k" * 400_000,) * 2),
        "? [" + "1," * 90_000 + "]\n: x",
        "a: !" + "t" * 90_000 + " x",
    ):
        assert len(told(text)) < 1000


def test_nesting_is_bounded_by_the_reader_itself() -> None:
    for text in ("a: " + "[" * 5000, "a:\n" + "".join(" " * i + "- \n" for i in range(1, 1000)), '{"a":' * 900):
        with pytest.raises(CampaignError, match=r"nested too deeply|nested deeper"):
            load_text(text)


WORDS = ["a", "b", "1", ": ", ":", "- ", "\n", "\n  ", "  ", "{", "}", "[", "]", ", ", "?", "&x ", "'", '"', "#", "1e3"]
WORDS += ["|\n", ">\n", "%", "@", "---\n", "\\", "\u00e9", "~", "\u2028", "\u0085", "\r"]


SENTENCES = st.lists(st.sampled_from(WORDS), max_size=12).map("".join)


@settings(max_examples=150)
@given(SENTENCES)
def test_both_readers_read_the_same(text: str) -> None:
    """libyaml and PyYAML read the same values; errors have PyYAML's text."""
    read_by_both(text)


@pytest.mark.nightly
@settings(max_examples=4000)
@given(SENTENCES)
def test_both_readers_read_many_texts_the_same(text: str) -> None:
    read_by_both(text)


def read_by_both(text: str) -> None:
    try:
        found = yaml.load(text, Loader=_Fast)
    except yaml.YAMLError:
        return
    assert yaml.load(text, Loader=_Loader) == found
