"""A storm: many runs on three workers, of which one is killed at random again and again, whatever it does."""

from __future__ import annotations

import time
from collections.abc import Sequence
from functools import partial

import numpy as np

from tests.faults.processes import alive, kill, until
from tests.storm.faults import Row
from tests.storm.site import Site

RUNS, KILLS, WORKERS = 30, 14, 3
PATIENCE = 900.0


def storm(site: Site, database: str, seed: int) -> Row:
    """Every kill hits the whole family of a worker or its child, at a moment drawn from the seed."""
    random = np.random.default_rng(seed)
    ids = [site.begin(1 + k % 3) for k in range(RUNS)]
    site.staffed(WORKERS)
    before_first, waited = 0, time.monotonic()
    for _ in range(KILLS):
        until(partial(_due, site, ids, _done(site, ids), random), "the next kill", 120)
        held = [run for run in map(site.run, ids) if run.state == "running"]
        before_first += sum(run.evaluations == 0 for run in held) > 0
        working = [one for one in site.workers if one.process.poll() is None]
        victim = working[int(random.integers(len(working)))]
        kill(*(victim.family() if random.random() < 0.5 else [p for p in victim.family()[1:] if alive(p)]))
        site.staffed(WORKERS)
    until(lambda: all(site.run(i).state in ("done", "failed") for i in ids), "all runs end", PATIENCE)
    given_up = sum(site.run(i).state != "done" for i in ids)
    lost, repeated = (sum(n) for n in zip(*(site.compared(i, 1 + k % 3) for k, i in enumerate(ids)), strict=True))
    took = time.monotonic() - waited
    site.stop()
    seen = f"{RUNS} runs, {KILLS} kills, {before_first} of them while a run had no evaluation yet"
    return Row(database, f"storm {seed}", seen, lost, repeated, site.left_behind(), given_up, round(took, 1))


def _done(site: Site, ids: Sequence[int]) -> int:
    return sum(site.run(run_id).state == "done" for run_id in ids)


def _due(site: Site, ids: Sequence[int], before: int, random: np.random.Generator) -> bool:
    """Whether a run has ended since, or else by chance."""
    return _done(site, ids) > before or random.random() < 0.05
