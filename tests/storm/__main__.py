"""`make faults`: all single faults and three storms on SQLite and PostgreSQL; prints a table, writes build/faults.json.

`python -m tests.storm [--only TEXT] [--database sqlite|postgresql] [--seeds 1,2,3] [--no-storms]` does less.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path

import sqlalchemy as sa

from backend.db.engine import default_url
from tests.faults import machines, postgres
from tests.storm.faults import FAULTS, databases, disks, networks
from tests.storm.faults.base import Row, hurt, kernels
from tests.storm.kills import storm
from tests.storm.site import Site, site

BUILD = Path("build")


def main() -> int:
    """Exit code 1 if anything was lost, repeated, left behind or given up."""
    given = argparse.ArgumentParser(prog="python -m tests.storm", description=__doc__)
    given.add_argument("--only", default="", help="faults whose name matches this")
    given.add_argument("--database", choices=("sqlite", "postgresql"))
    given.add_argument("--seeds", default="1,2,3", help="of the storms")
    given.add_argument("--no-storms", action="store_true")
    asked = given.parse_args()
    seeds = [] if asked.no_storms else [int(seed) for seed in asked.seeds.split(",")]
    rows = []
    for row in measured(asked.only, asked.database, seeds):
        rows.append(row)
        print(line(row), flush=True)
    BUILD.mkdir(exist_ok=True)
    (BUILD / "faults.json").write_text(json.dumps([asdict(row) for row in rows], indent=2) + "\n", encoding="utf-8")
    wrong = [row for row in rows if row.lost or row.repeated or row.left_behind or row.given_up]
    print(f"{len(rows)} faults, {len(wrong)} with something lost, repeated, left behind or given up")
    return 1 if wrong else 0


def line(row: Row) -> str:
    """One row of the table."""
    counts = f"{row.lost:>5} {row.repeated:>8} {row.left_behind:>5} {row.given_up:>8} {row.recovery_s:>8.1f}"
    return f"{row.database:<11} {row.name:<42} {counts}  {row.seen}"


def measured(only: str, database: str | None, seeds: list[int]) -> Iterator[Row]:
    print(f"{'database':<11} {'fault':<42}  lost repeated  left given up time [s]  seen")
    with tempfile.TemporaryDirectory(prefix="storm") as home, kernels(Path(home) / "kernels"):
        if database != "postgresql":
            yield from _on("sqlite", Path(home), default_url, None, only, seeds)
        if database != "sqlite":
            with postgres.server() as server:
                yield from _on("postgresql", Path(home), lambda folder: _emptied(server), server, only, seeds)
            yield from _networked(Path(home), only)


def _on(
    database: str, home: Path, fresh: Callable[[Path], str], server: postgres.Server | None, only: str, seeds: list[int]
) -> Iterator[Row]:
    each = Each(database, home, fresh)
    for name, fault in (FAULTS | (databases.of_server(server) if server else {})).items():
        if re.search(only, name):
            yield each(name, partial(hurt, database=database, name=name, fault=fault), fault.disk)
    for seed in seeds:
        yield each(f"storm {seed}", partial(storm, database=database, seed=seed))


def _networked(home: Path, only: str) -> Iterator[Row]:
    """Those on machines of their own, whose server is one of them."""
    with machines.network() as network:
        at = network.machine("db")
        with postgres.server(at.within, at.address, machines.NETWORK) as server:
            each = Each("postgresql", home, lambda folder: _emptied(server))
            for name, part in networks.parts(server).items():
                if re.search(only, name):
                    yield each(name, partial(part, network, name))


@dataclass(frozen=True)
class Each:
    """Does something on a site of its own; what does not recover is a row that says so."""

    database: str
    home: Path
    fresh: Callable[[Path], str]

    def __call__(self, name: str, work: Callable[[Site], Row], disk: bool = False) -> Row:
        folder = self.home / f"{self.database}-{re.sub('[^a-z0-9]+', '-', name)}"
        folder.mkdir()
        try:
            with disks.small(folder) if disk else nullcontext():
                (folder / "kernels").symlink_to(self.home / "kernels")
                with site(self.fresh(folder), folder) as made:
                    return work(made)
        except AssertionError as error:
            print(error, file=sys.stderr)
            return Row(self.database, name, f"did not recover: {error}", 0, 0, 0, 1, 0.0)


def _emptied(server: postgres.Server) -> str:
    engine = sa.create_engine(sa.make_url(server.url).set(drivername="postgresql+psycopg"))
    with engine.begin() as connection:
        connection.execute(sa.text("drop schema public cascade; create schema public"))
    engine.dispose()
    return server.url


if __name__ == "__main__":
    sys.exit(main())
