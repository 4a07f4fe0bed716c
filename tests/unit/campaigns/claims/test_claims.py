"""Claims as data: spans reproduce the text, codes are listed, unknown codes are accepted."""

from __future__ import annotations

import ast
import json
import math
from itertools import pairwise
from pathlib import Path

import pytest

from campaigns.claims import earlier
from campaigns.claims.numbers import Format, printed, written
from campaigns.claims.say import (
    at_most,
    capital,
    count,
    finding,
    joined,
    listed,
    method,
    number,
    percent,
    say,
    sentence,
    signed,
)
from campaigns.claims.say import symbol as named
from campaigns.claims.spans import Quantity, Text, values, words
from campaigns.claims.stages import attraction
from campaigns.codes import CheckCode, StopCode
from campaigns.results.base import Stop
from campaigns.results.search import Gap
from campaigns.results.verdict import Check, Verdict
from campaigns.results.verdicts import described
from worker.engine.search.base import Ended
from worker.engine.stages.parts.ended import spoken, stop

ROOT = Path(__file__).parents[4]
TERMS = earlier.Terms({"d_min": "d_min", "vehicle.m": "m", "goal": "goal"}, {"m", "s", "kg m2"})


def test_a_sentence_is_its_spans() -> None:
    statement = say(
        *(
            named("d_min"),
            " keeps a margin of ",
            signed(-0.25, "m", "margin"),
            " in ",
            count(40314),
            " evaluations of ",
        ),
        *(listed([method("direct", "DIRECT"), method("sqp", "SQP"), finding("F1"), finding("F1")]), ", "),
        *(percent(0.05, name="bound"), " and ", number(0.94174123456, "m"), "", named("goal")),
    )
    assert words(statement) == (
        "d_min keeps a margin of \u22120.25 m in 40\u202f314 evaluations of DIRECT, SQP and F1, 5 % and 0.941741 mgoal"
    )
    assert values(statement) == {"margin": -0.25, "bound": 0.05}
    assert say(*statement) == statement
    assert not any(isinstance(a, Text) and isinstance(b, Text) for a, b in pairwise(statement))


def test_a_clause_becomes_a_sentence() -> None:
    assert words(sentence(say("it agrees"))) == "It agrees."
    assert words(sentence(say(named("d_min"), " varies."))) == "d_min varies."
    assert words(capital(say(count(3), " of them"))) == "3 of them"
    assert words(listed([])) == "nothing"
    assert words(joined("; ", ["a", say("b"), finding("F1")])) == "a; b; F1"


def test_a_number_that_is_none_stays_readable() -> None:
    statement = say(number(math.nan, "m", "worst"), " and ", number(-0.0, "m"))
    assert words(statement) == "nan m and 0 m"
    assert values(statement) == {}


@pytest.mark.parametrize(
    ("value", "form", "digits", "plain", "print_"),
    [
        (-1.5, Format.PLAIN, 6, "-1.5 kg m2", "\u22121.5\u202fkg·m²"),
        (3e-7, Format.PLAIN, 6, "3e-07 kg m2", "3e\u221207\u202fkg·m²"),
        (-0.25, Format.SIGNED, 6, "\u22120.25 kg m2", "\u22120.25\u202fkg·m²"),
        (0.12345, Format.PERCENT, 3, "12.3 %", "12.3\u202f%"),
        (1234567.0, Format.COUNT, 6, "1\u202f234\u202f567 kg m2", "1\u202f234\u202f567\u202fkg·m²"),
    ],
)
def test_words_and_print_have_the_same_digits(value: float, form: Format, digits: int, plain: str, print_: str) -> None:
    assert written(value, "kg m2", form, digits) == plain
    assert printed(value, "kg m2", form, digits) == print_


EARLIER = [
    "d_min falls to or below 0.94175 m. The worst case found has d_min = 0.9417 m, a margin of \u22128.25e\u221206 m.",
    "40\u202f314 evaluations, searched by DIRECT (100) and SQP (1\u202f000); 0.0499 % with 99.9 % confidence",
    "vehicle.m 4.5 to 5.5 kg; start.x 2024-11-02, step 0.005 s, 0.0 m, half-step 2-3, 5 men, -0.2 m and +1.50 m",
    "d_minimum, vehicle.mass and my.d_min are others; goal is a word",
    "",
]


@pytest.mark.parametrize("text", EARLIER)
def test_earlier_words_stay_as_they_are(text: str) -> None:
    spans = earlier.spans(text, TERMS)
    assert words(spans) == text
    for span in spans:
        assert not isinstance(span, Text) or "vehicle.m " not in span.text


def test_earlier_results_are_read_with_symbols_and_units() -> None:
    stored = {"rectangles": 9, "lower_bound": 0.1, "gap": 0.2, "text": "d_min lies nowhere below 0.1 m"}
    calls: list[int] = []

    def terms() -> earlier.Terms:
        calls.append(1)
        return TERMS

    read = Gap.model_validate(earlier.spoken(stored, terms))
    assert read.text == stored["text"]
    assert [span.kind for span in read.statement] == ["symbol", "text", "quantity"]
    assert Gap.model_validate(stored).text == stored["text"], "without a look at the campaign the words alone"
    assert earlier.spoken(read.model_dump(), terms) == read.model_dump(), "what has spans stays"
    assert calls == [1]
    nested = {"stop": {"kind": "rule", "text": "ended"}, "curves": [{"values": [1.0, 2.0]}]}
    assert earlier.spoken(nested, terms)["stop"]["statement"] == [{"kind": "text", "text": "ended"}]


@pytest.mark.parametrize("bound", [9.99e-7, 1e-6, 3.2e-9, 0.00214, 0.05])
def test_the_bound_of_a_verdict_is_read_from_its_words(bound: float) -> None:
    (found,) = (
        span
        for span in earlier.verdict(words(say("P(violation) is at most ", at_most(bound), " with 95 % confidence")))
        if isinstance(span, Quantity) and span.name == "upper_bound"
    )
    assert found.value == pytest.approx(bound, rel=1e-12)


def test_an_earlier_verdict_states_the_same() -> None:
    stored = {
        "verdict": "cleared",
        "sentence": "d_min stayed above 0.5 m.",
        "scope": "Scope: one obstacle.",
        "checks": [],
    }
    for read in (Verdict.model_validate(stored), Verdict.model_validate(earlier.spoken(stored, lambda: TERMS))):
        assert (read.sentence, read.scope) == (stored["sentence"], stored["scope"])
        assert words(read.holds_for) == "one obstacle."
        assert read.reason == f"{stored['sentence']} {stored['scope']}"
        assert Verdict.model_validate(json.loads(read.model_dump_json())) == read


def test_spans_that_were_stored_as_said_keep_their_named_numbers() -> None:
    verdict = Verdict(
        verdict="cleared", checks=[], statement=say("d_min stayed above ", number(0.5, "m", "threshold"), ".")
    )
    gap = Gap(rectangles=9, lower_bound=0.1, gap=0.2, statement=say("a bound of ", number(0.1, "m", "bound")))
    for now in (verdict, gap):
        stored = json.loads(now.model_dump_json().replace('"statement"', '"said"'))
        assert "said" in stored
        for read in (stored, earlier.spoken(stored, lambda: TERMS), earlier.throughout(stored)):
            assert type(now).model_validate(read) == now
    nested = json.loads(json.dumps({"checks": [gap.model_dump(mode="json")]}).replace('"statement"', '"said"'))
    assert earlier.throughout(nested) == {"checks": [gap.model_dump(mode="json")]}


def test_a_check_of_another_package_needs_no_table() -> None:
    foreign = Check(code="fuel reserve", ok=False, statement=say("it keeps ", number(0.25, "kg", "fuel")))
    read = Check.model_validate(json.loads(foreign.model_dump_json()))
    assert (read.code, read.name, read.values) == ("fuel reserve", "fuel reserve", {"fuel": 0.25})
    assert described([read], 0)[0].title == "Fuel reserve"
    ours = Check.model_validate({"name": "no violation", "ok": True, "text": "none"})
    assert ours.code is CheckCode.NO_VIOLATION


def test_a_stop_rule_of_another_package_needs_no_table() -> None:
    ended = stop(
        "rule", Ended("annealed", "cooled to {temperature:.3g} in {cycles} cycles", temperature=1.23456, cycles=4000)
    )
    assert ended.text == "cooled to 1.23 in 4\u202f000 cycles"
    assert (ended.code, ended.values) == ("annealed", {"temperature": 1.23456, "cycles": 4000})
    assert Stop.model_validate(json.loads(ended.model_dump_json())) == ended
    plain = stop("rule", "it felt right {sic}")
    assert (plain.code, plain.text) == (StopCode.OTHER, "it felt right {sic}")


def test_a_sentence_within_a_sentence_keeps_its_numbers() -> None:
    inner = Ended("iterations", "completed the {iterations} iterations", iterations=15)
    statement = spoken(Ended("members", "DIRECT: {direct}; SQP from {centres} centres", direct=inner, centres=5))
    assert words(statement) == "DIRECT: completed the 15 iterations; SQP from 5 centres"
    assert [span.value for span in statement if isinstance(span, Quantity)] == [15, 5]


def test_every_rule_of_ours_has_a_listed_code() -> None:
    used = set()
    texts = {path: path.read_text(encoding="utf-8") for path in (ROOT / "worker").rglob("*.py")}
    for path, text in texts.items():
        for node in ast.walk(ast.parse(text)) if "Ended" in text else ():  # to parse all files takes seconds
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "Ended":
                assert isinstance(node.args[0], ast.Constant), path
                used.add(node.args[0].value)
    assert used <= {code.value for code in StopCode}
    assert {code.value for code in StopCode} - used <= {StopCode.OTHER}


@pytest.mark.parametrize(("limit", "text"), [(0.12341, "0.1235"), (0.5, "0.5"), (math.pi, "3.142"), (1234.2, "1235")])
def test_a_region_keeps_no_state_within_less_than_its_limit(limit: float, text: str) -> None:
    facts = attraction.Facts([("heading", 0.0, "rad")], 1, 2, [("u", limit, "m/s")], 100, 0, 0.1, 0.0)
    assert f"keeps u within {text} m/s of it" in words(attraction.proved(facts))
