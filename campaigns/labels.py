"""Labels of a run, such as branch: main, commit: 4f2a91c: what a CI job states of it."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Annotated

from pydantic import AfterValidator, Field

MOST = 20
"""Labels of one run."""
LONGEST_KEY, LONGEST_VALUE = 40, 200
"""Characters."""
_KEY = re.compile(rf"[A-Za-z][A-Za-z0-9_.-]{{0,{LONGEST_KEY - 1}}}")
HOW = "give KEY=VALUE, such as branch=main"


def checked(labels: dict[str, str]) -> dict[str, str]:
    """The labels by key; raises `ValueError` with a sentence for the first one that is not allowed."""
    if len(labels) > MOST:
        raise ValueError(f"{len(labels)} labels are too many: a run has at most {MOST}")
    for key, value in labels.items():
        if not _KEY.fullmatch(key):
            raise ValueError(
                f"invalid label key {key[:60]!r}: a letter, then letters, digits, '_', '.' and '-', at most "
                f"{LONGEST_KEY} characters"
            )
        if not value.strip() or not value.isprintable() or len(value) > LONGEST_VALUE:
            raise ValueError(
                f"invalid value {value[:60]!r} of the label {key}: one line of readable text of at most "
                f"{LONGEST_VALUE} characters"
            )
    return dict(sorted(labels.items()))


Labels = Annotated[dict[str, str], Field(max_length=MOST), AfterValidator(checked)]
"""By key, in alphabetical order."""


def _group(name: str) -> str:
    if not name.strip() or not name.isprintable():
        raise ValueError(f"invalid group {name[:60]!r}: one line of readable text, such as project/branch")
    return name


Group = Annotated[str, Field(min_length=1, max_length=LONGEST_VALUE), AfterValidator(_group)]
"""The name of a concurrency group."""


def pair(text: str) -> tuple[str, str]:
    """Key and value of one label, KEY=VALUE; raises `ValueError`."""
    key, sign, value = text.partition("=")
    if not sign:
        raise ValueError(f"invalid label {text[:60]!r}: {HOW}")
    ((key, value),) = checked({key.strip(): value.strip()}).items()
    return key, value


def parsed(texts: Iterable[str]) -> dict[str, str]:
    """The labels given as KEY=VALUE; raises `ValueError`, also for a key with two values."""
    found: dict[str, str] = {}
    for key, value in map(pair, texts):
        if found.setdefault(key, value) != value:
            raise ValueError(f"the label {key} is given twice, as {found[key]!r} and {value!r}: a label has one value")
    return checked(found)
