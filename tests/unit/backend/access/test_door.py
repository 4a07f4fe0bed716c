"""The door: however many ask for the health of a service at once, its database is asked once."""

from __future__ import annotations

import asyncio
import threading
from pathlib import Path

import pytest
import sqlalchemy as sa

from backend.access.door import Door
from tests.migrated import migrated

VISITORS = 2_000


@pytest.fixture
def database(tmp_path: Path) -> str:
    return migrated(tmp_path)


def test_all_that_wait_for_one_answer_get_it_and_whoever_comes_later_a_new_one(database: str) -> None:
    asked: list[int] = []
    released = threading.Event()

    def question(engine: sa.Engine) -> int:
        asked.append(1)
        released.wait(60)
        return len(asked)

    async def visits() -> None:
        door = Door(database, "session")
        waiting = [asyncio.ensure_future(door.inspected("health", question)) for _ in range(VISITORS)]
        while not asked:
            await asyncio.sleep(0)
        waiting[0].cancel()  # a visitor who leaves takes nothing from the others
        released.set()
        assert await asyncio.gather(*waiting[1:]) == [1] * (VISITORS - 1)
        assert await door.inspected("health", question) == 2
        await door.close()

    asyncio.run(visits())


def test_all_that_wait_learn_why_there_is_no_answer(database: str) -> None:
    def question(engine: sa.Engine) -> int:
        raise OSError("gone")

    async def visits() -> None:
        door = Door(database, "session")
        found = await asyncio.gather(*(door.inspected("health", question) for _ in range(9)), return_exceptions=True)
        assert [type(one) for one in found] == [OSError] * 9
        await door.close()

    asyncio.run(visits())
