"""A storm: many runs on three workers, of which one is killed at random again and again, whatever it does."""

from __future__ import annotations

import time
from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from tests.faults.processes import alive, kill, until
from tests.storm.faults.base import Row
from tests.storm.site import Site

RUNS, KILLS, WORKERS = 30, 14, 3
MOST_EARLY = KILLS
"""Kills before the first evaluation of a run, at most."""
PATIENCE = 900.0


def storm(site: Site, database: str, seed: int) -> Row:
    """Every kill hits the whole family of a worker that has a run, or its child, at a moment drawn from the seed.

    Kills before the first evaluation of a run are counted apart, and are done besides the others.
    """
    random = np.random.default_rng(seed)
    ids = [site.begin(1 + k % 3) for k in range(RUNS)]
    site.staffed(WORKERS)
    hits = early = 0
    waited = time.monotonic()
    while hits < KILLS and not site.ended():
        until(partial(_due, site, ids, _done(site, ids), random), "the next kill", 120)
        site.staffed(WORKERS)
        struck = _struck(site, random)
        if struck is None or (struck.evaluations == 0 and early == MOST_EARLY):
            continue
        victim = next(one for one in site.workers if one.output.stem == struck.worker)
        kill(*(victim.family() if random.random() < 0.5 else [p for p in victim.family()[1:] if alive(p)]))
        hits, early = hits + (struck.evaluations > 0), early + (struck.evaluations == 0)
        site.staffed(WORKERS)
    until(partial(_over, site), "all runs end", PATIENCE)
    given_up = sum(site.run(i).state != "done" for i in ids)
    lost, repeated = (sum(n) for n in zip(*(site.compared(i, 1 + k % 3) for k, i in enumerate(ids)), strict=True))
    took = time.monotonic() - waited
    site.stop()
    seen = f"{RUNS} runs, {hits} kills, and {early} before the first evaluation of a run"
    return Row(database, f"storm {seed}", seen, lost, repeated, len(site.left_behind()), given_up, round(took, 1))


def _struck(site: Site, random: np.random.Generator) -> Any:
    """One of the runs that a worker has which still lives; None if there is none. A run that has stored nothing since
    it was struck twice is left alone: a third time it would be given up, as it should."""
    alive_ones = [one.output.stem for one in site.workers if one.process.poll() is None]
    running = [run for run in map(site.run, site.runs) if run.state == "running" and run.attempts < run.max_attempts]
    held = [run for run in running if run.worker in alive_ones]
    return held[int(random.integers(len(held)))] if held else None


def _done(site: Site, ids: Sequence[int]) -> int:
    return sum(site.run(run_id).state == "done" for run_id in ids)


def _over(site: Site) -> bool:
    """Whether all runs have ended; a worker that was found alive just after its kill is replaced."""
    site.staffed(WORKERS)
    return site.ended()


def _due(site: Site, ids: Sequence[int], before: int, random: np.random.Generator) -> bool:
    """Whether a run has ended since, or else by chance."""
    return _done(site, ids) > before or random.random() < 0.05
