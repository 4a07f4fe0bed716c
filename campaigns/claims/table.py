"""A table of quantities with their printed form, against which the formatting in the pages is tested.

Written by `python -m campaigns.claims.table frontend/src/format/quantities.json`.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from campaigns.claims.numbers import Format, printed

VALUES = [
    *(0.0, -0.0, 1.0, -1.0, 0.5, 0.94174123456, -0.94174123456, 57.185, 1e-3, 0.1 + 0.2, 123456.0, 999999.5, 1234567.0),
    *(2.5, 3.5, 0.125, 1.0000005, 123456.5, 123457.5, 40314.0, 1e6, 1e9, 1e15, 1e16, 1e21, 1e100, -1e-300, 5e-324),
    *(1e-4, 9.99999e-5, 9.9999949e-5, 0.00012345678, 3e-7, -3e-7, 1.7976931348623157e308, 0.05, 0.0009980790119965865),
]
"""Rounding to even, the ends of the powers of ten, the largest and the smallest number."""
FORMS = [
    *((Format.PLAIN, "m", 6), (Format.PLAIN, "", 3), (Format.PLAIN, "kg m2", 9), (Format.SIGNED, "1/rad", 6)),
    *((Format.PERCENT, "", 3), (Format.PERCENT, "", 6)),
]


def table() -> list[dict[str, object]]:
    """Every value in every format, with its text."""
    rows = [(value, form, unit, digits) for value in VALUES for form, unit, digits in FORMS]
    counts = [0.0, 1.0, 999.0, 1000.0, 40314.0, 1234567.0, 1e15]
    rows = [row for row in rows if row[1] is not Format.PERCENT or abs(row[0]) < 1e300]
    rows += [(value, Format.COUNT, "", 6) for value in counts]
    return [
        {"value": v, "format": form.value, "unit": unit, "digits": digits, "text": printed(v, unit, form, digits)}
        for v, form, unit, digits in rows
    ]


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(json.dumps(table(), indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
