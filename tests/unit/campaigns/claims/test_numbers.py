"""Numbers in print: the cases that the pages are tested with, too, and random numbers written by both."""

from __future__ import annotations

import json
import math
import shutil
import subprocess
from collections.abc import Callable, Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from campaigns.claims import numbers
from campaigns.claims.numbers import Format
from campaigns.claims.say import probability_on_side
from campaigns.claims.spans import words

ROOT = Path(__file__).parents[4]
CASES: dict[str, list[list[Any]]] = json.loads((ROOT / "frontend/tests/numbers.json").read_text(encoding="utf-8"))
WRITTEN: dict[str, Callable[..., str | int]] = {
    "printed": lambda value, unit, form, digits: numbers.printed(value, unit, Format(form), digits),
    "fixed": numbers.fixed,
    "signed": numbers.difference,
    "margin": numbers.margin,
    "count": numbers.count,
    "plain": numbers.plain,
    "duration": numbers.duration,
    "unit": numbers.unit_in_print,
    "decimals_for": numbers.decimals_for,
    "decimals_apart": numbers.decimals_apart,
    "decimals_beside": numbers.decimals_beside,
    "digits_between": numbers.digits_between,
}
ROLLDOWN = ROOT / "frontend/node_modules/.bin/rolldown"
ANSWERS = """
import { createInterface } from 'node:readline'
import { decimalsApart, decimalsBeside, decimalsFor, digitsBetween } from '@/numbers'
import { count, duration, fixed, margin, plain, signed } from '@/numbers'
import { quantityText } from '@/quantity'
const printed = (value, unit, format, digits) => quantityText({ value, unit, format, digits })
const decimals = { decimals_for: decimalsFor, decimals_apart: decimalsApart, decimals_beside: decimalsBeside }
const digits = { digits_between: digitsBetween }
const written = { printed, fixed, signed, margin, count, plain, duration, ...decimals, ...digits }
for await (const line of createInterface({ input: process.stdin })) {
  console.log(JSON.stringify(JSON.parse(line).map(([name, ...given]) => written[name](...given))))
}
"""


@pytest.mark.parametrize("name", WRITTEN)
def test_every_case_is_written_as_on_the_pages(name: str) -> None:
    assert set(CASES) == set(WRITTEN)
    assert [WRITTEN[name](*given) for *given, _ in CASES[name]] == [text for *_, text in CASES[name]]


Ask = Callable[[list[list[Any]]], list[Any]]


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Ask]:
    """What the pages write, by a process of Node."""
    node = shutil.which("node")
    if node is None or not ROLLDOWN.is_file():
        pytest.skip("the pages are not installed: make install")
    folder = tmp_path_factory.mktemp("pages")
    script, built = folder / "answers.js", folder / "built.mjs"
    script.write_text(ANSWERS.replace("@", str(ROOT / "frontend/src/format")), encoding="utf-8")
    bundled = [str(ROLLDOWN), str(script), "--format", "esm", "--platform", "node", "--file", str(built)]
    subprocess.run(bundled, cwd=ROOT / "frontend", check=True, capture_output=True)
    with subprocess.Popen([node, str(built)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        sent, received = process.stdin, process.stdout

        def ask(cases: list[list[Any]]) -> list[Any]:
            sent.write(json.dumps(cases) + "\n")
            sent.flush()
            answer: list[Any] = json.loads(received.readline())
            return answer

        yield ask
        sent.close()


ANY = st.floats(allow_nan=False, allow_infinity=False)
TIES = st.builds(lambda whole, power: (whole + 0.5) / 2**power, st.integers(-(10**6), 10**6), st.integers(0, 12))
"""Numbers whose decimals end, so that they can lie in the middle of two texts."""
NUMBERS = st.one_of(ANY, TIES, st.floats(-1e6, 1e6), st.floats(-1e-3, 1e-3))
COUNTED = NUMBERS.filter(lambda value: not abs(value or 0.0) >= 2**53)
"""Times of which whole seconds can be told apart: beyond them the remainder of a division is rounding."""
PROBABILITIES = st.one_of(st.floats(0, 1), st.floats(0, 1e-3), st.integers(1, 10**7).map(lambda n: n / 10**9))
SHARES = st.one_of(st.floats(0, 1), st.floats(0, 50), st.integers(1, 17).map(lambda n: 1 - 10.0**-n))
FORMS = st.sampled_from(["plain", "signed", "lowest"])
ONE = st.one_of(
    st.tuples(st.just("fixed"), NUMBERS, st.integers(0, 12)),
    st.tuples(st.sampled_from(["signed", "margin"]), NUMBERS, st.integers(0, 12)),
    st.tuples(st.just("count"), NUMBERS),
    st.tuples(st.just("plain"), NUMBERS, st.integers(1, 12)),
    st.tuples(st.just("duration"), st.one_of(COUNTED, st.floats(0, 1e5), st.integers(0, 10**6).map(lambda n: n / 20))),
    st.tuples(st.just("printed"), NUMBERS, st.sampled_from(["", "m"]), FORMS, st.integers(1, 12)),
    st.tuples(st.just("printed"), SHARES, st.just(""), st.just("percent"), st.integers(1, 12)),
    st.tuples(st.just("printed"), PROBABILITIES, st.just(""), st.sampled_from([*numbers.ROUNDED]), st.integers(1, 17)),
    st.tuples(st.just("decimals_for"), st.lists(NUMBERS, max_size=4), st.integers(1, 8)),
    st.tuples(st.just("decimals_apart"), st.lists(NUMBERS, max_size=4), st.integers(1, 5), st.integers(5, 8)),
    st.tuples(st.just("decimals_beside"), st.lists(NUMBERS, max_size=4), NUMBERS, st.integers(0, 8)),
    st.tuples(st.just("digits_between"), NUMBERS, NUMBERS, st.integers(1, 8)),
)  # fmt: skip


@settings(max_examples=100)
@given(cases=st.lists(ONE, min_size=1, max_size=40))
def test_random_numbers_are_written_as_on_the_pages(pages: Ask, cases: list[tuple[Any, ...]]) -> None:
    assert pages([list(case) for case in cases]) == [WRITTEN[name](*rest) for name, *rest in cases]


@given(value=PROBABILITIES, digits=st.integers(1, 6))
def test_a_bound_is_never_written_below_itself(value: float, digits: int) -> None:
    """Read back, an upper bound is no smaller, a lower one no larger, and they differ by a last digit at most."""

    def read(form: Format) -> Fraction:
        number, *percents = numbers.written(value, form=form, digits=digits).split()
        return Fraction(number) / (100 if percents else 1)

    exact = Fraction(repr(value))
    assert read(Format.AT_LEAST) <= exact <= read(Format.AT_MOST)
    assert read(Format.AT_LEAST) <= read(Format.PROBABILITY) <= read(Format.AT_MOST)
    assert read(Format.AT_MOST) - read(Format.AT_LEAST) <= 10 * exact / 10**digits


@given(value=NUMBERS, digits=st.integers(1, 12))
def test_a_lower_bound_is_never_written_above_itself(value: float, digits: int) -> None:
    read = Fraction(numbers.written(value, form=Format.LOWEST, digits=digits).replace(numbers.MINUS, "-"))
    exact = Fraction(repr(value))
    assert read <= exact
    assert exact - read <= abs(exact) * 10 / Fraction(10) ** digits


@given(value=SHARES, digits=st.integers(1, 12))
def test_less_than_all_is_never_written_as_all_and_more_than_none_never_as_none(value: float, digits: int) -> None:
    text = numbers.written(value, form=Format.PROBABILITY, digits=digits)
    assert (text == "100 %") <= (value >= 1 - 1e-12)
    assert (text == "0 %") == (value == 0)


@given(value=st.floats(0, 1), limit=st.sampled_from([0.05, 0.1, 0.25]), near=st.integers(2, 16))
def test_a_fraction_is_read_on_its_own_side_of_its_limit(value: float, limit: float, near: int) -> None:
    for fraction in (value, limit, limit * (1 + 10.0**-near), limit * (1 - 10.0**-near)):
        text = words((probability_on_side(fraction, limit),))
        number, *percents = text.split()
        read = Fraction(number) / (100 if percents else 1)
        assert (read > Fraction(repr(limit))) == (fraction > limit), text


@given(value=SHARES, digits=st.integers(1, 12))
def test_less_than_all_is_never_written_as_all_and_no_share_as_a_power_of_ten(value: float, digits: int) -> None:
    text = numbers.written(value, form=Format.PERCENT, digits=digits)
    assert (text == "100 %") <= (value >= 1 - 1e-12)
    assert "e+" not in text


@given(value=st.floats(0, 1e6))
def test_a_duration_is_the_nearest_that_can_be_shown(value: float) -> None:
    """Read back, it is at most half of its last unit away."""
    text = numbers.duration(value).replace("\u202f", " ")
    number, *rest = text.replace("< 0.1", "0.0").split()
    if rest[0] == "s":
        read, unit = float(number), 0.1
    elif rest[0] == "min":
        minutes, seconds = number.split(":")
        read, unit = 60.0 * int(minutes) + int(seconds), 1.0
        assert int(seconds) < 60
    else:
        read, unit = 3600.0 * int(number) + 60.0 * int(rest[1]), 60.0
        assert int(rest[1]) < 60
    assert math.fabs(read - value) <= unit / 2 + 1e-9


@pytest.mark.parametrize("threshold", [0.5, 0.1, 1.00000005, 123456.6, 0.9999996, -4.5, 1e-7, 1 / 3])
def test_a_threshold_is_read_as_it_is(threshold: float) -> None:
    assert float(f"{threshold:.{numbers.digits_of(threshold)}g}") == threshold
    for beside in (math.nextafter(threshold, 9e9), math.nextafter(threshold, -9e9), threshold):
        read = float(f"{beside:.{numbers.digits_beside(beside, threshold)}g}")
        assert (read < threshold, read > threshold) == (beside < threshold, beside > threshold)
