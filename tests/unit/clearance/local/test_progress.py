"""Progress where there is no terminal: a line for each stage, an updated display in a notebook."""

from __future__ import annotations

import io
import sys
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest
from rich.console import Console

from campaigns.asked.load import library, load_file
from campaigns.claims.numbers import count
from campaigns.stages.plan import plan
from clearance.local import progress
from clearance.local.progress import Progress
from worker.engine.stages.parts.context import Tally

CAMPAIGN = load_file(library()["unicycle_static"])
BEST = Tally(evaluations=1200, best=0.25)


def test_a_pipe_gets_a_line_for_each_stage(capsys: pytest.CaptureFixture[str]) -> None:
    with Progress(CAMPAIGN) as shown:
        for position, tally in ((0, Tally(evaluations=1, best=1.5)), (2, Tally(evaluations=600)), (2, BEST)):
            shown.show(position, tally)
    out, err = capsys.readouterr()
    assert out == ""
    first, second = err.splitlines()
    assert first.startswith("nominal: 1 evaluation, best 1.5, ")
    assert all(line.endswith(" after the start") for line in (first, second)), "a stage's own time is in its result"
    assert second.startswith("search: ")
    assert f": {count(1200)} evaluations, best 0.25, " in second


def test_nothing_is_shown_of_a_run_that_has_no_evaluation(capsys: pytest.CaptureFixture[str]) -> None:
    with Progress(CAMPAIGN):
        pass
    assert capsys.readouterr() == ("", "")


def test_a_bar_is_not_full_while_excluded_samples_are_drawn_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """In a terminal and in a notebook."""
    position, planned = next((k, s.planned) for k, s in enumerate(plan(CAMPAIGN)) if s.kind == "certify")
    tally = Tally(evaluations=planned, excluded=planned // 2)
    terminal = Console(force_terminal=True, file=io.StringIO())
    monkeypatch.setattr(progress, "Console", lambda stderr: terminal)
    shown: Any = Progress(CAMPAIGN)._shown
    shown.show(position, tally)
    (task,) = shown._bars.tasks
    assert (task.completed, task.total) == (planned, 2 * planned)
    shown.end()
    in_notebook = progress._Display(shown._names, 0.5, lambda *_, **__: SimpleNamespace(update=lambda _: None))
    in_notebook.show(position, tally)
    assert f'<progress max="{2 * planned}" value="{planned}">' in in_notebook._repr_html_()


class Kernel(ModuleType):
    """IPython as a notebook has it, as far as a display needs it."""

    def __init__(self) -> None:
        super().__init__("IPython")
        self.shown: list[str] = []

    def get_ipython(self) -> object:
        return self

    def display(self, value: Any, *, display_id: bool) -> Any:
        assert display_id
        self.shown.append(value._repr_html_())
        return SimpleNamespace(update=lambda again: self.shown.append(again._repr_html_()))


def test_a_notebook_gets_one_display_that_is_updated(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    kernel, now = Kernel(), [100.0]
    monkeypatch.setitem(sys.modules, "IPython", kernel)
    monkeypatch.setitem(sys.modules, "IPython.display", SimpleNamespace(display=kernel.display))
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    with Progress(CAMPAIGN) as shown:
        for evaluations in range(1, 51):
            now[0] += 0.1
            shown.show(2, Tally(evaluations=evaluations, best=0.25))
    assert 10 < len(kernel.shown) < 20, "every few tenths of a second, and at the end"
    assert "50 evaluations" in kernel.shown[-1]
    assert "best 0.25" in kernel.shown[-1]
    assert capsys.readouterr() == ("", "")
