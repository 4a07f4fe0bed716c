"""The colours of the theme tokens that methods declare, as in `frontend/src/theme/tokens.css`.

`tests/unit/test_looks.py` compares them.
"""

from __future__ import annotations

from collections.abc import Mapping

from campaigns.looks import Colour

METHODS: Mapping[Colour, str] = {
    "direct": "#0072b2",
    "hybrid": "#2b8fcb",
    "sqp": "#b8578c",
    "ga": "#b97c00",
    "global": "#857c00",
    "mc": "#4a5563",
    "racing": "#5a2fe0",
    "portfolio": "#1b2733",
    "cma": "#007a6c",
    "de": "#8379ea",
    "mlsl": "#9a5a44",
    "nlopt": "#5d7d1f",
    "direct-l": "#003e6b",
    "nsga2": "#9c1257",
    "lq": "#11523f",
    "turbo": "#a4262c",
    "extra-1": "#6b4f00",
    "extra-2": "#2e8b3d",
    "extra-3": "#7d5a8c",
}
"""Colours of the light theme, also used in reports."""
METHODS_DARK: Mapping[Colour, str] = {
    "direct": "#3f9bdb",
    "hybrid": "#8ccbf2",
    "sqp": "#d98db8",
    "ga": "#e69f00",
    "global": "#d8cd3c",
    "mc": "#c3ccd6",
    "racing": "#a07cff",
    "portfolio": "#f2f5f8",
    "cma": "#46c9b8",
    "de": "#7470e6",
    "mlsl": "#c98d78",
    "nlopt": "#9fd15f",
    "direct-l": "#6f8fb4",
    "nsga2": "#e8589b",
    "lq": "#b4efdc",
    "turbo": "#f07a7a",
    "extra-1": "#b59a4d",
    "extra-2": "#6fcf7f",
    "extra-3": "#b79ac4",
}
