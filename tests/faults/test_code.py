"""A component's file is edited while a worker runs: the next run uses the new code, one started before waits."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa

from backend.catalog.service import required
from backend.db import refusals
from backend.db.engine import connect, migrate, read
from backend.db.queue import request_cancel, submit
from backend.db.tables import CampaignRow, CatalogueDocument, Stage
from campaigns import Campaign
from campaigns.identity.code import code_of
from campaigns.runs import RunState
from tests.faults.cases import campaign
from tests.faults.processes import CLEARANCE, REPOSITORY, Started, kill, started, until
from tests.faults.stored import Stored
from tests.given.own_files import POST

pytestmark = pytest.mark.nightly  # by day tests/unit/running/runs/test_sources.py

WRONG = POST.replace("d = norm2(dx, dy)", "d = norm2(dx, dy) if dx > 0.0 else (dx, dy)")
"""Which no compiler takes."""


class Home(Stored):
    """A database, a worker on it, and a component that another package adds."""

    def __init__(self, folder: Path) -> None:
        self.file, self.url = folder / "post_here.py", f"sqlite:///{folder}/clearance.sqlite3"
        self.edit(POST)
        info = folder / "post_here-1.0.dist-info"
        info.mkdir()
        (info / "METADATA").write_text("Metadata-Version: 2.1\nName: post-here\nVersion: 1.0\n", encoding="utf-8")
        (info / "entry_points.txt").write_text("[clearance.components]\npost = post_here\n", encoding="utf-8")
        migrate(self.url)
        self.engine = connect(self.url)
        self.worker: Started

    def edit(self, text: str) -> None:
        self.file.write_text(text, encoding="utf-8")

    def submit(self, name: str = "none") -> int:
        document = campaign().document()["scenario"]
        post = {"component": "post_here", "parameters": {"x": 1.0, "y": 2.0}}
        asked = campaign(name=name, scenario={**document, "obstacles": [post], "horizon": 0.5, "step": 0.005})
        with self.engine.begin() as connection:
            return submit(connection, asked, name=name, tags=[], owner="", planned=0)

    def stage(self, run_id: int, position: int) -> str | None:
        with read(self.engine) as connection:
            of = sa.select(Stage.state).where(Stage.run_id == run_id, Stage.position == position)
            return connection.scalar(of)

    def refused(self, run_id: int) -> str:
        """What differs, once a worker has refused the run."""
        with read(self.engine) as connection:
            return next(iter(refusals.of(connection, [run_id]).get(run_id, {}).values()), "")

    def installed(self, run: Any) -> str | None:
        """The code that a run of the same campaign would have now."""
        with read(self.engine) as connection:
            of = sa.select(CampaignRow.document).where(CampaignRow.digest == run.campaign_digest)
            document = connection.execute(of).scalar_one()
            return code_of(Campaign.model_validate(document), required(connection).code)

    def catalogue(self) -> Any:
        with read(self.engine) as connection:
            return connection.execute(sa.select(CatalogueDocument.code, CatalogueDocument.document)).one()


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Home]:
    folder = tmp_path_factory.mktemp("edited")
    home = Home(folder)
    command = [*CLEARANCE, "worker", "--name", "w", "--runner", "tests.faults.jobs:flying", "--lease", "5"]
    paths = f"{folder}:{REPOSITORY}"
    with started(command, folder, "w", CLEARANCE_DATABASE=home.url, PYTHONPATH=paths) as home.worker:
        yield home
        print(home.worker.text())
    home.engine.dispose()


def test_an_edit_applies_to_the_next_run_and_to_no_run_already_started(home: Home) -> None:
    first = home.ended(home.submit())
    assert first.state == "done"
    assert first.flown["packages"]["post-here"] == "1.0"
    assert home.installed(first) == first.flown["code"]

    home.edit(POST.replace("SHIFT = 0.0", "SHIFT = 1.0").replace("a point in", "one point in"))
    until(lambda: "one point in" in str(home.catalogue().document), "an idle worker publishes what was edited")
    run_id = home.submit("hang")
    until(lambda: home.stage(run_id, 1) == "running", "the second stage has begun")
    begun = home.run(run_id)
    assert abs(begun.nominal_cost - first.nominal_cost) > 0.1
    assert first.flown["code"] != begun.flown["code"] == home.installed(begun)
    assert first.flown["loop"] != begun.flown["loop"]

    home.edit(WRONG)  # what the next test runs, in the process that is started here
    kill(home.worker.child())
    until(lambda: home.refused(run_id), "the worker refuses it")
    until(lambda: home.run(run_id).state == RunState.QUEUED, "it waits")
    waits = home.run(run_id)
    assert (waits.error, waits.fence, waits.flown, waits.attempts) == (None, 2, begun.flown, 0)
    code = begun.flown["code"][:12]
    assert f" {code}, " in home.refused(run_id)
    assert "post_here" in home.refused(run_id)
    with home.engine.begin() as connection:
        assert request_cancel(connection, run_id) == RunState.CANCELLED


@pytest.mark.nightly  # by day tests/unit/engine/kernels/test_jit.py
def test_what_the_compiler_refuses_fails_the_run_with_file_and_line_and_not_the_worker(home: Home) -> None:
    home.edit(WRONG)
    line = next(n for n, text in enumerate(WRONG.splitlines(), 1) if "else (dx, dy)" in text)
    ended = home.ended(home.submit("none compiled"))
    assert (ended.state, ended.verdict, ended.attempts) == ("failed", None, 1)
    assert f"{home.file}, line {line}: the branches have different types (number and tuple of 2)" in ended.error
    assert ended.fence == 1, "its process answered"
    assert home.worker.process.poll() is None


@pytest.mark.nightly  # every edit costs the start of a process; by day the refusal above, which takes the same path
def test_what_fails_in_plain_python_or_cannot_be_loaded_fails_the_run_with_its_sentence(home: Home) -> None:
    home.edit(WRONG)
    line = next(n for n, text in enumerate(WRONG.splitlines(), 1) if "else (dx, dy)" in text)
    ended = home.ended(home.submit())  # in plain Python, where the tuple is used
    assert (ended.state, ended.verdict, ended.attempts) == ("failed", None, 1)
    assert f"a component failed: {home.file}, line {line + 1}: TypeError: " in ended.error

    home.edit("raise ValueError('not today')\n")
    ended = home.ended(home.submit())
    assert (ended.state, ended.verdict) == ("failed", None)
    skipped = "skipped: the package post_here: it cannot be loaded (ValueError: not today)"
    assert "no such obstacle" in ended.error
    assert skipped in ended.error

    home.edit(POST)
    assert home.ended(home.submit()).state == "done"
