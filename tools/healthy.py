"""Ends with 0 when what runs in this container is well, else with 1: `healthy.py [live | ready | scheduler | node]`.

ready: the service can have runs done; live: its process answers; scheduler, node: those of a Dask cluster.
"""

from __future__ import annotations

import os
import socket
import sys
import urllib.request

PORT = os.environ.get("CLEARANCE_PORT") or 8000
SCHEDULER = 8786


def service(which: str) -> str:
    """What is wrong with the service (CLEARANCE_PORT, or 8000); empty: nothing."""
    url = f"http://127.0.0.1:{PORT}/api/v1/health/{which}"
    try:
        # Asks this machine itself, whatever proxy the environment names.
        with urllib.request.build_opener(urllib.request.ProxyHandler({})).open(url, timeout=5) as answer:
            return "" if answer.status == 200 else f"{url}: {answer.status}"
    except OSError as error:
        return f"{url}: {error}"


def scheduler() -> str:
    """Whether it takes connections."""
    try:
        socket.create_connection(("127.0.0.1", SCHEDULER), timeout=5).close()
    except OSError as error:
        return f"scheduler: {error}"
    return ""


def node() -> str:
    """Whether the scheduler knows the node of this container."""
    from distributed import Client

    here = {entry[4][0] for entry in socket.getaddrinfo(socket.gethostname(), None)}
    try:
        with Client(f"tcp://scheduler:{SCHEDULER}", timeout=8, set_as_default=False) as client:
            nodes = client.scheduler_info(n_workers=-1)["workers"].values()
    except OSError as error:
        return f"scheduler: {error}"
    return "" if here & {each["host"] for each in nodes} else "the scheduler does not know the node of this container"


CHECKS = {"live": lambda: service("live"), "ready": lambda: service("ready"), "scheduler": scheduler, "node": node}

if __name__ == "__main__":
    sys.exit(CHECKS[sys.argv[1] if len(sys.argv) > 1 else "ready"]() or 0)
