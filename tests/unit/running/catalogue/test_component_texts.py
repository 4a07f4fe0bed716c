"""Help in place: every component's equations, symbols, units and source, as in the catalogue and thus the API.

The text is the docstring of the component's one file; one that is derived from a planar component derives it.
"""

from __future__ import annotations

import inspect
import re

import pytest

from campaigns.catalogue import Catalogue, ComponentEntry
from worker.running.catalogue.installed import catalogue, components, source_of

CATALOGUE: Catalogue = catalogue()
MODELS = ("vehicle", "controller", "avoider", "environment", "fault", "criterion")


def named(entry: ComponentEntry) -> str:
    return f"{entry.role}-{entry.name}"


@pytest.mark.parametrize("entry", CATALOGUE.components, ids=named)
def test_the_text_of_a_component_is_its_docstring(entry: ComponentEntry) -> None:
    stated = source_of(components()[entry.role, entry.name]).__doc__ or ""
    assert entry.text == inspect.cleandoc(stated), "the text is that of the component's one file"
    title, _, more = entry.text.partition("\n\n")
    assert title.endswith("."), title
    assert more
    if entry.role in MODELS:
        assert "Source" in entry.text


@pytest.mark.parametrize("entry", [e for e in CATALOGUE.components if e.role in MODELS[:4]], ids=named)
def test_a_model_states_an_equation(entry: ComponentEntry) -> None:
    assert re.search(r"\S (=|<=|>=|<|>) \S", entry.text)


@pytest.mark.parametrize("entry", CATALOGUE.components, ids=named)
def test_every_parameter_is_described(entry: ComponentEntry) -> None:
    parameters = [*entry.parameters, *entry.starts, *entry.goals]
    for p in parameters:
        assert p.symbol, p.name
        assert len(p.text) > 3, p.name
        assert p.text[0].isupper(), p.name
        assert p.low < p.high, p.name
        assert p.default is None or p.low <= p.default <= p.high, p.name
        assert p.unit == p.unit.strip(), p.name
    for kind in (entry.parameters, entry.starts, entry.goals):
        assert len({p.name for p in kind}) == len(kind)
