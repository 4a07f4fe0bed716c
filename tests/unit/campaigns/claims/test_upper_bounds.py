"""An upper bound of a stored sentence is rounded up, whichever version stored the spans; its value stays as it is."""

from __future__ import annotations

import pytest

from campaigns.claims import earlier
from campaigns.claims.numbers import Format
from campaigns.claims.spans import Quantity
from campaigns.results.verdict import Statistics

BOUND = 0.0009980790119965865  # 1 - 0.05 ** (1 / 3000)


def nothing() -> earlier.Terms:
    return earlier.Terms({}, ())


@pytest.mark.parametrize("field", ["said", "statement"])
@pytest.mark.parametrize("form", [Format.PERCENT, Format.PROBABILITY, Format.AT_MOST])
def test_a_stored_bound_is_rounded_up(field: str, form: Format) -> None:
    span = Quantity(value=BOUND, format=form, digits=3, name="upper_bound").model_dump()
    stored = {
        "samples": 3000,
        "violations": 0,
        "confidence": 0.95,
        "upper_bound": BOUND,
        field: [span],
        "text": "0.0998 %",
    }
    found = Statistics.model_validate(earlier.spoken(stored, nothing))
    assert (found.text, found.upper_bound) == ("0.0999 %", BOUND)
    assert isinstance(found.statement[0], Quantity)
    assert found.statement[0].value == BOUND


def test_other_fractions_are_written_as_they_were() -> None:
    span = Quantity(value=0.95, format=Format.PERCENT, digits=6, name="confidence").model_dump()
    assert earlier.spoken([span], nothing) == [span]
