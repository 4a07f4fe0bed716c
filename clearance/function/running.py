"""Runs the campaign of a search in this process, through the stages of `clearance run`."""

from __future__ import annotations

import contextlib
import signal
import threading
from collections.abc import Callable, Iterator

from worker.running.runs import sources as sources  # first: it records the files before they are loaded

# isort: split
from campaigns import Campaign, CampaignError, Catalogue, check
from campaigns.asked.load import load_document
from campaigns.sample_seed import SampleSeed
from clearance.function import resuming
from clearance.function.origin import Origin
from clearance.function.request import Request
from clearance.function.result import Interrupted, Result, evaluations, of
from clearance.local.interrupt import deferred
from worker.engine.problem.problem import Problem
from worker.engine.stages.parts.context import ReplayMismatch, Tally
from worker.engine.systems.base import CampaignUnusable
from worker.running.catalogue.files import PythonFunction
from worker.running.catalogue.installed import catalogue
from worker.running.opening import opened
from worker.running.runs.runner import execute
from worker.running.runs.store import MemoryStore

Show = Callable[[int, Tally], None]


def run(
    request: Request, document: dict[str, object], progress: bool, seed: SampleSeed | None, resume: object
) -> Result:
    """The result of the campaign; raises ValueError for one that cannot be run, `Interrupted` after Ctrl-C."""
    function = PythonFunction(request.declaration, dict(request.place), request.call)
    known = catalogue().model_copy(update={"simulators": [function.entry]})
    campaign, before = _campaign(document, known), None if resume is None else resuming.earlier(resume)
    if before is not None:
        campaign = _campaign(resuming.extended(document, before.campaign, campaign), known)
    problem = Problem(campaign, opened.simulated(campaign, function, known))
    if before is None:
        store = MemoryStore(sample_seed=seed or SampleSeed.drawn())
    else:
        store = resuming.store(campaign, problem, before, seed)
    cites = None if before is None else before.cited
    origin = Origin(campaign, problem, store, known, tuple(request.ranges), cites)
    # Ctrl-C is not lost where this is the main thread and has no other handler.
    usual = threading.current_thread() is threading.main_thread() and (
        signal.getsignal(signal.SIGINT) is signal.default_int_handler
    )
    interruptible = deferred(_never) if usual else contextlib.nullcontext(_never)
    try:
        with interruptible as stopped, _shown(campaign, progress) as show:
            verdict = execute(campaign, store, stopped, progress=show, problem=problem)
    except ReplayMismatch as error:
        raise ValueError(f"resume: {error}") from None
    except CampaignUnusable as error:
        raise ValueError("; ".join(problem.message for problem in error.problems)) from None
    except KeyboardInterrupt:
        partial = evaluations(origin)
        raise Interrupted(partial) from None
    return of(origin, verdict)


def _campaign(document: dict[str, object], known: Catalogue) -> Campaign:
    try:
        campaign = load_document(document, "the search")
        problems = check(campaign, known)
    except CampaignError as error:
        problems = list(error.problems)
    if problems:
        raise ValueError("the search cannot be run: " + "; ".join(map(str, problems)))
    return campaign


def _never() -> bool:
    return False


@contextlib.contextmanager
def _shown(campaign: Campaign, progress: bool) -> Iterator[Show]:
    if not progress:
        yield lambda position, tally: None
        return
    from clearance.local.progress import Progress

    with Progress(campaign) as bars:
        yield bars.show
