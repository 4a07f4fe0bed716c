"""`python -m tests.bench.large`: costs of a run of a million evaluations, of 10,000 runs and of a live page.

The service is a process of its own with its own data, on a machine that should be idle. Times are of its processor,
unless called wall. Prints every figure, one a line.
"""

from __future__ import annotations

import statistics
import tempfile
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import httpx
import numpy as np
import sqlalchemy as sa

from backend.db.engine import connect, default_url
from backend.db.store import RunStore
from campaigns import library, load_file
from campaigns.stored.records import Columns, StagePlan
from tests import results
from tests.bench import page_data
from tests.bench.page_loads import seconds
from tests.bench.pages import LISTS, RUNS, service
from tests.faults.processes import Started

EVALUATIONS, CHUNK = 1_000_000, 4096
"""Of the large run, and those that a worker stores at once."""
AT_ONCE, REPEATS = 6, 20
WATCHED = 10.0
"""How long the service is watched while it serves a live page [s]."""
BUDGETS = {"direct": 400, "sqp": 200, "monte_carlo": 200, "portfolio": 200}


def main() -> None:
    """Make the data, measure, print."""
    with tempfile.TemporaryDirectory() as folder, service(Path(folder)) as (running, address, data):
        engine = connect(default_url(data))
        page_data.publish(engine)
        page_data.copies(engine, page_data.flown(engine, BUDGETS), RUNS - 1)
        run = f"R-{million(engine):04d}"
        with httpx.Client(trust_env=False, timeout=600, follow_redirects=False) as client:
            client.get(running.link())
            client.base_url = httpx.URL(f"{address}/api/v1")
            for measure in (lists, evaluations, export):
                measure(client, running, run)
            with page_data.growing(engine, 1) as active:
                live(client, running, f"R-{active[0]:04d}")
        engine.dispose()


def million(engine: sa.Engine) -> int:
    """A finished run of case 5 with a million evaluations of one search; returns its number."""
    claim = page_data.claimed(engine, load_file(library()[page_data.LARGE]), "A million evaluations")
    store, random = RunStore(engine, claim), np.random.default_rng(3)
    store.plan([StagePlan("nominal", None, 1), StagePlan("search", "direct", EVALUATIONS)])
    store.begin(0)
    store.finish(0, results.nominal(64.0), 0.01)
    store.begin(1)
    for first in range(0, EVALUATIONS, CHUNK):
        count = min(CHUNK, EVALUATIONS - first)
        costs = 60.0 - np.log1p(first) + random.random((count, 1))
        columns = Columns(random.random((count, 6)), costs, np.zeros(count, np.uint8), np.full(count, 1e-4 * first), {})
        store.append(1, first, columns)
    store.finish(1, results.searched(), 60.0)
    store.conclude(results.verdict("inconclusive", "Not searched.", 64.0, 46.0))
    return claim.run_id


def lists(client: httpx.Client, running: Started, _: str) -> None:
    """Pages of the run list, their facets."""
    for name, query in LISTS.items():
        show(f"list_{name}_ms", cost(running, lambda query=query: client.get("/runs", params=query)))
    later = client.get("/runs").json()["next_cursor"]
    show("list_second_page_ms", cost(running, lambda: client.get("/runs", params={"cursor": later})))
    show("facets_ms", cost(running, lambda: client.get("/runs/facets")))


def evaluations(client: httpx.Client, running: Started, run: str) -> None:
    """The evaluations of the large run, alone and six at once."""
    ask = lambda: client.get(f"/runs/{run}/evaluations")  # noqa: E731
    show("evaluations_ms", cost(running, ask, 3))
    before = peak(running)
    with ThreadPoolExecutor(AT_ONCE) as pool:
        answers = [found.result() for found in [pool.submit(ask) for _ in range(AT_ONCE)]]
    assert all(answer.status_code == 200 for answer in answers)
    show("evaluations_six_at_once_mb", peak(running, reset=False) - before)


def export(client: httpx.Client, running: Started, run: str) -> None:
    """The CSV file of the large run, and what others wait for in the meantime."""
    show("others_alone_wall_ms", waited(client, 2.0))
    done, others = threading.Event(), [0.0]
    watching = threading.Thread(target=lambda: others.append(waited(client, 600.0, done)), daemon=True)
    before, began, size = seconds(running.family()), time.perf_counter(), 0
    watching.start()
    with client.stream("GET", f"/runs/{run}/exports/evaluations.csv") as answer:
        for part in answer.iter_raw():
            size += len(part)
    wall, used = time.perf_counter() - began, seconds(running.family()) - before
    done.set()
    watching.join()
    show("csv_mb", size / 1e6)
    show("csv_wall_s", wall)
    show("csv_processor_s", used)
    show("others_during_csv_wall_ms", others[-1])


def live(client: httpx.Client, running: Started, run: str) -> None:
    """The event streams of a page of a growing run, and of the run list."""
    for name, query in (("run", {"run": run}), ("list", {})):
        with client.stream("GET", "/events", params=query) as answer:
            events, ended = 0, time.monotonic() + WATCHED
            before = seconds(running.family())
            for line in answer.iter_lines():
                events += line.startswith("event:")
                if time.monotonic() > ended:
                    break
            show(f"live_{name}_ms_a_second", 1e3 * (seconds(running.family()) - before) / WATCHED)
            show(f"live_{name}_events_a_second", events / WATCHED)


def waited(client: httpx.Client, most: float, done: threading.Event | None = None) -> float:
    """The median of what a client waits for one run of the list [ms], for so long [s] or until `done`."""
    times, ended = [], time.monotonic() + most
    while time.monotonic() < ended and not (done and done.is_set()):
        began = time.perf_counter()
        client.get("/runs", params={"limit": 1})
        times.append(1e3 * (time.perf_counter() - began))
        threading.Event().wait(0.05)
    return statistics.median(times)


def cost(running: Started, ask: Callable[[], httpx.Response], repeats: int = REPEATS) -> float:
    """Processor time of a request [ms], the mean of several."""
    assert ask().status_code == 200
    before = seconds(running.family())
    for _ in range(repeats):
        ask()
    return 1e3 * (seconds(running.family()) - before) / repeats


def peak(running: Started, reset: bool = True) -> float:
    """The most memory that the service has had [MB]; from now on, with a reset."""
    if reset:
        Path(f"/proc/{running.pid}/clear_refs").write_text("5")
    status = Path(f"/proc/{running.pid}/status").read_text()
    return int(status.partition("VmHWM:")[2].split()[0]) / 1e3


def show(name: str, value: float) -> None:
    print(f"{name:32} {value:10.2f}", flush=True)


if __name__ == "__main__":
    main()
