"""The files that follow from the code are as `python -m tools.generated` writes them."""

from __future__ import annotations

import pytest

from tools.generated import FILES, PAGES, ROOT

WRITTEN = {**FILES, **PAGES}


@pytest.mark.parametrize("name", WRITTEN)
def test_it_is_up_to_date(name: str) -> None:
    assert (ROOT / name).read_text(encoding="utf-8") == WRITTEN[name](), "run `python -m tools.generated`"
