"""Invalid values in a campaign are refused with field, given value and what is allowed."""

from __future__ import annotations

import datetime
from typing import Any

import pytest

from campaigns import CampaignError, Problem
from campaigns.asked.load import load_document
from tests.given.case_campaigns import campaign, document

NESTED: Any = {}
for _ in range(3000):
    NESTED = {"a": NESTED}


def refused(**changes: Any) -> list[Problem]:
    """The problems of case 1 with these changes."""
    with pytest.raises(CampaignError) as caught:
        load_document(document(**changes))
    return caught.value.problems


def only(**changes: Any) -> tuple[str, str, str]:
    """The one problem of case 1 with these changes: field, given, message."""
    (problem,) = refused(**changes)
    return problem.field, problem.given, problem.message


def one_search(**changes: Any) -> list[dict[str, Any]]:
    return [{"method": "direct", "evaluations": 10, **changes}]


UNKNOWN = "unknown key; remove it or correct its spelling"

KEYS = {
    "top": ({"sede": 1}, "sede", "1", UNKNOWN),
    "scenario": ({"scenario__speed": 1}, "scenario.speed", "1", UNKNOWN),
    "part": ({"scenario__vehicle__mass": 5}, "scenario.vehicle.mass", "5", UNKNOWN),
    "uncertain": (
        {"uncertain__vehicle.m": {"plus_minus": 1, "lo": 1}}, "uncertain.vehicle.m.lo", "1", UNKNOWN,
    ),
    "search": ({"stages__search": one_search(budget=3)}, "stages.search.0.budget", "3", UNKNOWN),
    "stages": ({"stages__validate_": {}}, "stages.validate_", "{}", UNKNOWN),
    "missing": ({"scenario": {}}, "scenario.vehicle", "", "this key is required"),
    "path": (
        {"uncertain": {"m": {"low": 1, "high": 2}}}, "uncertain.m", '"m"',
        "not the path of a parameter, such as vehicle.m or obstacles.0.position.x",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", KEYS)
def test_keys_that_are_not_known_or_missing(name: str) -> None:
    changes, field, given, message = KEYS[name]
    assert Problem(field, given, message) in refused(**changes)


NUMBERS: dict[str, tuple[Any, str, str]] = {
    "nan": (float("nan"), "NaN", "expected a finite number of at most 1e+12 in magnitude"),
    "infinite": (float("inf"), "Infinity", "expected a finite number of at most 1e+12 in magnitude"),
    "absurd": (1.1e12, "1100000000000.0", "expected a finite number of at most 1e+12 in magnitude"),
    "true": (True, "true", "expected a number, given true or false"),
    "text": ("five", '"five"', "expected a number, given text"),
    "nothing": (" ", '" "', "expected a number, given nothing"),
    "text of nan": ("nan", '"nan"', "expected a number, given text"),
    "text with underscores": ("1_000", '"1_000"', "expected a number, given text"),
    "hexadecimal": ("0x10", '"0x10"', "expected a number, given text"),
    "null": (None, "null", "expected a number"),
    "list": ([5], "[5]", "expected a number"),
}


@pytest.mark.parametrize("name", NUMBERS)
@pytest.mark.parametrize(
    "place", ["scenario__horizon", "scenario__vehicle__parameters__m", "criterion__threshold", "agreement"]
)
def test_values_that_are_not_numbers(name: str, place: str) -> None:
    value, given, message = NUMBERS[name]
    assert only(**{place: value}) == (place.replace("__", "."), given, message)


def test_a_number_of_ten_thousand_digits() -> None:
    field, _, message = only(agreement=10**10_000)
    assert (field, message) == ("agreement", "a whole number of more than 64 bits")


WHOLE: dict[str, tuple[Any, str]] = {
    "fraction": (5.5, "expected a whole number"),
    "true": (True, "expected a whole number"),
    "text": ("many", "expected a number, given text"),
    "infinite": (float("inf"), "expected a whole number"),
}


@pytest.mark.parametrize("name", WHOLE)
def test_counts_that_are_not_whole(name: str) -> None:
    value, message = WHOLE[name]
    field, _, statement = only(stages__search=one_search(evaluations=value))
    assert (field, statement) == ("stages.search.0.evaluations", message)
    assert only(seed=value)[0] == "seed"


def test_numbers_typed_as_text_are_numbers() -> None:
    typed = campaign(scenario__horizon="15", agreement=" 5e-2 ", stages__search=one_search(evaluations="100"))
    written = campaign(scenario__horizon=15, agreement=0.05, stages__search=one_search(evaluations=100.0))
    assert typed.digest == written.digest
    assert typed.stages.search[0].evaluations == 100


SIZES: dict[str, tuple[dict[str, Any], str, str]] = {
    "steps": ({"scenario__step": 1e-9}, "scenario", "at most 2,000,000 are allowed"),
    "a step of nothing": ({"scenario__step": 1e-300}, "scenario", "at most 2,000,000 are allowed"),
    "step longer than horizon": ({"scenario__step": 20}, "scenario", "longer than the horizon of 15 s"),
    "broken horizon": ({"scenario__step": 0.007}, "scenario", "not a whole number of steps of 0.007 s"),
    "broken guidance": ({"scenario__guidance": {"period": 0.012}}, "scenario", "period of 0.012 s is not a whole"),
    "guidance within a step": ({"scenario__guidance": {"period": 1e-9}}, "scenario", "is not a whole number of steps"),
    "negative step": ({"scenario__step": -0.005}, "scenario.step", "above 0"),
    "evaluations": ({"stages__search": one_search(evaluations=10**9)}, "stages.search.0.evaluations", "10,000,000"),
    "no evaluations": ({"stages__search": one_search(evaluations=0)}, "stages.search.0.evaluations", "at least 1 and"),
    "no search": ({"stages__search": []}, "stages.search", "at least 1 entry"),
    "searches": ({"stages__search": one_search() * 33}, "stages.search", "at most 32 entries"),
    "points": ({"stages__sensitivity": {"points": 1}}, "stages.sensitivity.points", "of at least 2 and at most 2,001"),
    "neighbours": ({"stages__validate": {"neighbours": 10**6}}, "stages.validate.neighbours", "at most 100,000"),
    "nothing uncertain": ({"uncertain": {}}, "uncertain", "at least 1 entry"),
    "uncertain": (
        {"uncertain": {f"vehicle.m{i}": {"low": 0, "high": 1} for i in range(65)}}, "uncertain", "at most 64 entries",
    ),
    "obstacles": ({"scenario__obstacles": [{"component": "circle"}] * 65}, "scenario.obstacles", "at most 64 entries"),
    "name": ({"name": "n" * 121}, "name", "at most 120 characters"),
    "notes": ({"notes": "n" * 20_001}, "notes", "at most 20,000 characters"),
    "target": ({"target_probability": 1.0}, "target_probability", "above 0 and below 1"),
    "confidence": ({"confidence": 0.5}, "confidence", "at least 0.9 and below 1"),
    "seed": ({"seed": 2**53 + 1}, "seed", "at most 9,007,199,254,740,992"),
    "options": (
        {"stages__search": one_search(options={f"o{i}": i for i in range(101)})}, "stages.search.0.options", "100",
    ),
    "depth": ({"scenario__start": NESTED}, "scenario.start" + ".a" * 15, "nested deeper than 16 levels"),
    "depth of an option": (
        {"stages__search": one_search(options={"o": NESTED})},
        "stages.search.0.options.o" + ".a" * 12, "nested deeper than 16 levels",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", SIZES)
def test_an_absurd_size_is_refused_at_its_field(name: str) -> None:
    changes, field, message = SIZES[name]
    found, _, statement = only(**changes)
    assert found == field
    assert message in statement


def test_a_thousand_problems_are_reported_in_fifty_lines() -> None:
    problems = refused(**{f"key{i}": i for i in range(1000)})
    assert len(problems) == 51
    assert str(problems[-1]) == "campaign: and 950 more problems"


INTERVALS: dict[str, tuple[Any, str, str]] = {
    "reversed": (
        {"low": 6, "high": 4}, "", "the interval from low = 6 to high = 4 is reversed: low must be below high",
    ),
    "empty": ({"low": 4, "high": 4}, "", "the interval from low = 4 to high = 4 is empty: low must be below high"),
    "half": ({"low": 4}, "", "give both low and high, or plus_minus"),
    "none": ({}, "", "give both low and high, or plus_minus"),
    "both forms": ({"low": 4, "high": 6, "plus_minus": 1}, "", "give either low and high, or plus_minus, not both"),
    "nan": ({"low": float("nan"), "high": 6}, ".low", "expected a finite number of at most 1e+12 in magnitude"),
    "infinite": ({"low": 4, "high": float("inf")}, ".high", "expected a finite number of at most 1e+12 in magnitude"),
    "unit": ({"plus_minus": 1, "unit": 5}, ".unit", "expected text"),
}  # fmt: skip


@pytest.mark.parametrize("name", INTERVALS)
def test_a_wrong_interval_is_refused_at_its_field(name: str) -> None:
    value, below, message = INTERVALS[name]
    field, given, statement = only(**{"uncertain__vehicle.m": value})
    assert (field, statement) == (f"uncertain.vehicle.m{below}", message)
    assert given


SHARE = "expected a number or a percentage such as 20%, above 0"


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ("-5%", SHARE), ("0%", SHARE), ("%", SHARE), ("twenty%", SHARE), ("nan%", SHARE), ("1e400%", SHARE),
        ("20%%", SHARE), ("1_0%", SHARE), (0, SHARE), (-1.0, SHARE), ("-1", SHARE),
        ("20", None), ("20 per cent", "expected a number, given text; give a number or a percentage such as 20%"),
        (True, "expected a number, given true or false; give a number or a percentage such as 20%"),
        (1e13, "expected a finite number of at most 1e+12 in magnitude; give a number or a percentage such as 20%"),
    ],
)  # fmt: skip
def test_a_fraction_is_a_number_or_a_percentage(value: Any, message: str | None) -> None:
    changes = {"uncertain__vehicle.m": {"plus_minus": value}}
    if message is None:
        assert campaign(**changes).uncertain["vehicle.m"].plus_minus == 20.0
    else:
        field, _, statement = only(**changes)
        assert (field, statement) == ("uncertain.vehicle.m.plus_minus", message)


@pytest.mark.parametrize("spelling", ["20%", "20 %", " 20.0%", "2e1%", "+20%"])
def test_a_percentage_is_the_same_however_it_is_spelled(spelling: str) -> None:
    found = campaign(**{"uncertain__vehicle.m": {"plus_minus": spelling}})
    assert found.uncertain["vehicle.m"].plus_minus == "20%"
    assert found.uncertain["vehicle.m"].interval(-5.0) == (-6.0, -4.0)


OTHERS: dict[str, tuple[dict[str, Any], str, str]] = {
    "distribution": (
        {"uncertain__vehicle.m": {"plus_minus": 1, "distribution": "gauss"}},
        "uncertain.vehicle.m.distribution", "triangular",
    ),
    "mode": (
        {"uncertain__vehicle.m": {"plus_minus": 1, "distribution": {"kind": "triangular", "mode": "x"}}},
        "uncertain.vehicle.m.distribution.mode", "expected a number, given text",
    ),
    "deviation": (
        {"uncertain__vehicle.m": {"plus_minus": 1, "distribution": {"kind": "truncated_normal", "mean": 5}}},
        "uncertain.vehicle.m.distribution.deviation", "required",
    ),
    "twice": ({"scenario__start": {"p": {"x": 1}, "p.x": 2}}, "scenario.start", "'p.x' is given twice"),
    "option nan": ({"stages__search": one_search(options={"o": float("nan")})}, "stages.search.0.options.o", "finite"),
    "option mapping": ({"stages__search": one_search(options={"o": {}})}, "stages.search.0.options.o", "true, false"),
    "blank name": ({"name": " "}, "name", "one line of readable text"),
    "name of two lines": ({"name": "a\nb"}, "name", "one line of readable text"),
    "name with NUL": ({"name": "a\0"}, "name", "one line of readable text"),
    "notes with NUL": ({"notes": "a\0"}, "notes", "without control characters"),
    "half a surrogate pair": ({"name": "\ud800"}, "name", "unpaired surrogate"),
    "key with half a pair": ({"scenario__start": {"\udfff": 1}}, "scenario.start", "a key is Unicode text"),
    "key of another kind": ({"scenario__start": {1: 1}}, "scenario.start", "a key is Unicode text"),
    "component": ({"scenario__vehicle__component": "Uni cycle"}, "scenario.vehicle.component", "of the form"),
    "tag": ({"tags": ["a b"]}, "tags.0", "of the form"),
    "version": ({"version": 2}, "version", "expected 1"),
    "date": ({"name": datetime.date(2026, 1, 31)}, "name", "expected text, a number"),
}  # fmt: skip


@pytest.mark.parametrize("name", OTHERS)
def test_a_wrong_value_is_refused_at_its_field(name: str) -> None:
    changes, field, message = OTHERS[name]
    found, _, statement = only(**changes)
    assert found == field
    assert message in statement


def test_a_campaign_that_states_no_search_has_the_usual_one() -> None:
    asked = {key: value for key, value in document().items() if key != "stages"}
    one = load_document(asked)
    assert [(each.method, each.evaluations) for each in one.stages.search] == [("auto", 5000)]
    assert one.stages.certify is not None
    wide = {f"vehicle.{name}": {"low": 1.0, "high": 2.0} for name in "abcdefgh"}
    assert load_document({**asked, "uncertain": wide}).stages.search[0].evaluations == 8000
    stated = load_document({**asked, "stages": {"certify": None}})
    assert (stated.stages.search, stated.stages.certify) == (one.stages.search, None)
