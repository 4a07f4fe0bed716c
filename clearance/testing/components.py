"""The contract of a component: documented, limited, and robust within its limits.

`class TestMine(ComponentContract): component = mine.component` in a test file of the installed package runs all of it
with pytest; all but the last test use the plain form, which needs no compiler.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import ClassVar

import numpy as np

from campaigns import check
from campaigns.asked.load import load_document
from campaigns.results.base import OK
from clearance.testing.flights import as_in_plain_python, in_any_order, no_number_shows, repeated, unbreakable
from clearance.testing.rates import turns_as_declared
from clearance.testing.scenes import around, entry, own, problem
from worker.engine.kernels.component import Component, Obstacle
from worker.running.catalogue.installed import catalogue, source_of
from worker.running.examination import purity, reading

PURE = {"", "-", "N m^(3-n)"}
"""Units of numbers without a dimension, and one whose power is a parameter itself."""

UNIT = re.compile(r"(1/)?(\(?[A-Za-zµ%°]+[0-9]*( [A-Za-z]+[0-9]*)*\)?)(/(\(.+\)|[A-Za-z]+[0-9]*))?")


class ComponentContract:
    """Every check of one component."""

    component: ClassVar[Component]

    def test_it_is_documented(self) -> None:
        described = entry(self.component)
        assert described.title[0].isupper()
        assert len(described.text.splitlines()) >= 2, "the file's docstring tells what it is and where it comes from"
        assert described.text.splitlines()[0].endswith((".", ":"))
        assert (source_of(self.component).__doc__ or "").strip() == described.text
        if self.component.role in ("vehicle", "controller", "avoider", "criterion"):
            assert "Source: " in described.text

    def test_its_names_can_be_written_in_a_campaign(self) -> None:
        described = entry(self.component)
        assert re.fullmatch(r"[a-z][a-z0-9_]*", described.name)
        assert source_of(self.component).__name__.rpartition(".")[2] == described.name
        for entries in (described.parameters, described.starts, described.goals):
            names = [p.name for p in entries]
            assert len(set(names)) == len(names)
            assert all(re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*(\.[A-Za-z0-9_]+)*", name) for name in names)

    def test_its_parameters_have_unit_text_and_limits(self) -> None:
        for path, p in own(self.component).items():
            assert p.unit in PURE or UNIT.fullmatch(p.unit), f"{path}: what is the unit {p.unit!r}?"
            assert p.text[0].isupper(), path
            assert not p.text.endswith("."), path
            assert p.symbol, path
            assert -1e12 <= p.low < p.high <= 1e12, path
            assert p.default is None or p.low <= p.default <= p.high, path

    def test_it_turns_no_faster_than_it_declares(self) -> None:
        """Check an obstacle that moves by itself: if its motion is prescribed, it turns within pi over its rate by half
        a turn at most."""
        if isinstance(self.component, Obstacle) and self.component.moving:
            declared = entry(self.component).rate
            assert declared is not None, "it moves by itself and declares no rate"
            if not self.component.states:
                turns_as_declared(problem(self.component, compiled=False), own(self.component), declared)

    def test_it_can_be_simulated_with_the_first_other_components_that_fit(self) -> None:
        made = load_document(around(self.component))
        assert check(made, catalogue()) == []
        batch, reasons = problem(self.component, compiled=False).evaluate(np.array([[0.0], [0.5], [1.0]]))
        assert batch.status.tolist() == [OK] * 3, reasons

    def test_within_its_limits_nothing_crashes_and_nothing_is_hidden(self) -> None:
        unbreakable(problem(self.component, compiled=False), own(self.component), 6)

    def test_the_same_case_gives_the_same_bits(self) -> None:
        """Nothing in its file is random or keeps state."""
        home = source_of(self.component)
        purity.check(reading.read(Path(str(home.__file__))), home.__name__)
        repeated(problem(self.component, compiled=False), own(self.component), 4)

    def test_a_nan_fails_the_simulation_or_changes_nothing(self) -> None:
        no_number_shows(problem(self.component, compiled=False), own(self.component))

    def test_compiled_it_is_as_in_plain_python(self) -> None:
        """This compiles a loop, which takes seconds."""
        compiled = problem(self.component)
        in_any_order(compiled, own(self.component), 40)
        as_in_plain_python(compiled, problem(self.component, compiled=False), own(self.component), 4)
