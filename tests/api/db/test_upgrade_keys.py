"""A database that revision 0019 wrote: a request of before the migration, repeated after it, is not done again.

`stored/revision-0019.sqlite3.gz` was written by the code of that revision: the token `ci` queued R-0001 from YAML and
launched S-0001 under the key `first`, and S-0002 without a key. The draft D-0001 holds the body of the sweeps.
"""

from __future__ import annotations

import gzip
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
import sqlalchemy as sa

from backend.db.engine import default_url, migrate
from backend.settings import Settings
from tests.given.problem_documents import problem
from tests.given.service import Service

STORED = Path(__file__).parents[1] / "stored" / "revision-0019.sqlite3.gz"
KEY = {"idempotency-key": "first"}
JSON = {"content-type": "application/json"}
YAML = {"content-type": "application/yaml"}


@pytest.fixture
def service(tmp_path: Path) -> Iterator[Service]:
    (tmp_path / "clearance.sqlite3").write_bytes(gzip.decompress(STORED.read_bytes()))
    migrate(default_url(tmp_path))
    service = Service(Settings(data=tmp_path, pages=tmp_path / "dist"))
    service.start()
    yield service
    service.stop()


def test_requests_of_before_are_not_done_again(service: Service) -> None:
    with service.engine.connect() as reader:
        campaign = str(reader.scalar(sa.text("select text from run_texts")))
    before = service.rows()
    assert before["request_keys"] == 2
    with service.visitor(authorization="Bearer clr_of-revision-0019") as program:
        sweep = str(program.get("/api/v1/drafts/D-0001").json()["text"])
        assert post(program, "runs", campaign, YAML).json()["id"] == "R-0001"
        assert post(program, "sweeps", sweep, JSON).json()["id"] == "S-0001"
        assert "R-0001" in str(problem(post(program, "runs", campaign + "\n", YAML), 422)["detail"])
        assert "S-0001" in str(problem(post(program, "sweeps", sweep + "\n", JSON), 422)["detail"])
        assert program.get("/api/v1/sweeps/S-0002").json()["runs"] == 2
    assert service.rows() == before


def post(program: httpx.Client, noun: str, body: str, kind: dict[str, str]) -> httpx.Response:
    return program.post(f"/api/v1/{noun}", content=body, headers=KEY | kind)
