"""`make soak`: a service under the daily load of a team for a quarter of an hour; a table, build/soak.json.

`python -m tests.storm.soak [--seconds 900]`. Clients read the list (also by search), runs and reports, while runs are
submitted that one worker executes. Then each route is called alone for its processor time. The exit code is 1 if a bar
is missed; the bar of waiting times is for a machine that does nothing else.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
import threading
import time
from collections import defaultdict
from pathlib import Path
from typing import Any

import httpx
import numpy as np

from campaigns import library, load_file
from tests.faults.serving import Service, serving

BUILD = Path("build")
CLIENTS = 6
PAUSE = 0.2
"""Of a client between two requests [s]."""
SUBMITTED = 20.0
"""Time between two submissions [s]."""
ALONE = 30
"""Calls of each route alone."""
WARM = 60.0
"""What is loaded in the first minute, or third of a shorter soak, is no growth [s]."""
MOST_WAIT, MOST_GROWTH, LEAST_FAIR = 300.0, 40.0, 0.8
"""Bars: the 99th percentile of a route [ms], growth of memory in a quarter of an hour [MB], fewest requests of a client
over most."""


def routes(run: str) -> dict[str, tuple[str, dict[str, Any]]]:
    """What clients read: the address of each and its query."""
    return {
        "run list": ("/runs", {"limit": 50}),
        "run list, searched": ("/runs", {"q": "unicycle", "limit": 50}),
        "facets": ("/runs/facets", {}),
        "run": (f"/runs/{run}", {}),
        "stages": (f"/runs/{run}/stages", {}),
        "findings": (f"/runs/{run}/findings", {}),
        "evaluations": (f"/runs/{run}/evaluations", {}),
        "report": (f"/runs/{run}/report.html", {}),
        "workers": ("/workers", {}),
        "requirements": ("/requirements", {}),
        "health": ("/health", {}),
    }


class Load:
    """The clients, and what they have seen."""

    def __init__(self, address: str, cookies: httpx.Cookies, run: str) -> None:
        self.address, self.cookies, self.routes = address, cookies, routes(run)
        self.times: dict[str, list[float]] = defaultdict(list)
        self.errors: dict[str, int] = defaultdict(int)
        self.served = [0] * CLIENTS
        self.over = threading.Event()

    def client(self, number: int) -> None:
        """Requests in an order of its own until the load is over."""
        random = np.random.default_rng(number)
        with httpx.Client(base_url=self.address, cookies=self.cookies, trust_env=False, timeout=60) as client:
            while not self.over.is_set():
                name = list(self.routes)[int(random.integers(len(self.routes)))]
                self._call(client, name)
                self.served[number] += 1
                self.over.wait(PAUSE * 2 * random.random())

    def _call(self, client: httpx.Client, name: str) -> None:
        path, query = self.routes[name]
        began = time.perf_counter()
        try:
            status = client.get(f"/api/v1{path}", params=query).status_code
        except httpx.TransportError:
            status = 0
        self.times[name].append(1e3 * (time.perf_counter() - began))
        if status != 200:
            self.errors[f"{name}: {status}"] += 1


def main() -> int:
    """Exit code 1 if a bar is missed."""
    given = argparse.ArgumentParser(prog="python -m tests.storm.soak", description=__doc__)
    given.add_argument("--seconds", type=float, default=900.0)
    asked = given.parse_args()
    with tempfile.TemporaryDirectory(prefix="soak") as folder, serving(Path(folder)) as service:
        found = measured(service, asked.seconds)
    BUILD.mkdir(exist_ok=True)
    (BUILD / "soak.json").write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")
    show(found)
    for sentence in found["missed"]:
        print(f"MISSED: {sentence}")
    return 1 if found["missed"] else 0


def show(found: dict[str, Any]) -> None:
    """The table."""
    print(f"{'route':<22} {'p50 [ms]':>9} {'p99 [ms]':>9} {'cpu [ms]':>9}  p99 below {MOST_WAIT:g} ms")
    for name, wait in found["p99_ms"].items():
        met = "met" if wait < MOST_WAIT else "MISSED"
        print(f"{name:<22} {found['p50_ms'][name]:>9.1f} {wait:>9.1f} {found['cpu_ms'][name]:>9.1f}  {met}")
    memory = ("rss_growth_mb", "rss_slope_mb", "rss_mb")
    for name in ("seconds", "runs", "requests", "errors", "lock_errors", *memory, "fairness"):
        print(f"{name:<22} {found[name]}")


def missed(found: dict[str, Any]) -> list[str]:
    """The bars that are missed, as sentences."""
    late = [name for name, wait in found["p99_ms"].items() if wait >= MOST_WAIT]
    bars = {
        f"the 99th percentile is {MOST_WAIT:g} ms or more of {', '.join(late)}": bool(late),
        f"requests failed: {found['errors']}": bool(found["errors"]),
        f"the database was locked {found['lock_errors']} times": bool(found["lock_errors"]),
        f"memory grows by {found['rss_slope_mb']} MB in 15 minutes, at most {MOST_GROWTH:g} are expected": (
            found["rss_slope_mb"] > MOST_GROWTH
        ),
        f"the fewest requests of a client are {found['fairness']} of the most, at least {LEAST_FAIR} are expected": (
            found["fairness"] < LEAST_FAIR
        ),
    }
    return [sentence for sentence, is_missed in bars.items() if is_missed]


def measured(service: Service, seconds: float) -> dict[str, Any]:
    """The load for this long [s], then each route alone."""
    link = service.link()
    address = link.partition("/login")[0]
    campaign = load_file(library()["unicycle_static"]).document()
    with httpx.Client(base_url=address, trust_env=False, timeout=60) as client:
        assert client.get(link).status_code == 303
        first = _submitted(client, campaign, 1)
        while client.get(f"/api/v1/runs/{first}").json()["state"] not in ("done", "failed"):
            time.sleep(0.2)
        load = Load(address, client.cookies, first)
        threads = [threading.Thread(target=load.client, args=(n,), daemon=True) for n in range(CLIENTS)]
        for thread in threads:
            thread.start()
        backend, runs, began = service.part("-m backend"), 1, time.monotonic()
        memory: list[tuple[float, float]] = []
        while time.monotonic() < began + seconds:
            runs += 1
            _submitted(client, campaign, runs)
            ended = min(time.monotonic() + SUBMITTED, began + seconds)
            while time.monotonic() < ended:
                memory.append((time.monotonic() - began, _resident(backend) / 1e6))
                time.sleep(min(1.0, max(0.0, ended - time.monotonic())))
        load.over.set()
        for thread in threads:
            thread.join()
        cpu = {name: _alone(client, backend, *load.routes[name]) for name in load.routes}
    found = {
        "p50_ms": {name: float(np.percentile(values, 50)) for name, values in load.times.items()},
        "p99_ms": {name: float(np.percentile(values, 99)) for name, values in load.times.items()},
        "cpu_ms": cpu,
        "requests": sum(load.served),
        "errors": dict(load.errors),
        "lock_errors": _locked(service),
        **_growth(memory, min(WARM, seconds / 3)),
        "rss_mb": [round(size) for _, size in memory[::60]],
        "fairness": round(min(load.served) / max(load.served), 2),
        "runs": runs,
        "seconds": seconds,
    }
    return found | {"missed": missed(found)}


def _growth(memory: list[tuple[float, float]], warm: float) -> dict[str, float]:
    """How memory [MB] grows over time [s] once warm: in all, and by the line through it, in a quarter of an hour."""
    times, sizes = np.array([at for at in memory if at[0] >= warm]).T
    slope = np.polyfit(times, sizes, 1)[0]
    return {"rss_growth_mb": round(float(sizes[-1] - sizes[0]), 1), "rss_slope_mb": round(900.0 * float(slope), 1)}


def _submitted(client: httpx.Client, campaign: dict[str, Any], number: int) -> str:
    answer = client.post("/api/v1/runs", json={"campaign": {**campaign, "seed": number}, "name": f"unicycle {number}"})
    assert answer.status_code == 201, answer.text
    return str(answer.json()["id"])


def _alone(client: httpx.Client, backend: int, path: str, query: dict[str, Any]) -> float:
    """Processor time of the service for one call [ms]."""
    before = _cpu(backend)
    for _ in range(ALONE):
        assert client.get(f"/api/v1{path}", params=query).status_code == 200
    return 1e3 * (_cpu(backend) - before) / ALONE


def _cpu(pid: int) -> float:
    user, system = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[11:13]
    return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")


def _resident(pid: int) -> int:
    return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def _locked(service: Service) -> int:
    logs = [path.read_text(errors="replace") for path in (service.data / "logs").glob("*.log")]
    return sum(text.count("database is locked") for text in logs)


if __name__ == "__main__":
    sys.exit(main())
