"""A service that ends closes all it has opened, also if one part cannot be closed."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest

from backend.app import create
from backend.settings import Settings
from tests.given.databases import Fresh

PARTS = ("webhooks", "failures", "hub", "live", "previews", "cases", "door")
CLOSES = {"failures": "flush", "previews": "stop"}
WAITED_FOR = ("webhooks", "failures", "hub", "door")


@pytest.mark.by_day(2)
@pytest.mark.parametrize("broken", PARTS)
def test_each_part_is_closed_also_if_another_fails(broken: str, fresh: Fresh, tmp_path: Path) -> None:
    data = tmp_path / "data"
    app = create(Settings(database=fresh(data), data=data))
    parts = {name: getattr(app.state, name) for name in PARTS}
    closed: list[str] = []

    def noting(name: str, close: object) -> object:
        def note() -> None:
            closed.append(name)
            if name == broken:
                raise OSError(f"{name} cannot be closed")

        async def awaited() -> None:
            await close()  # type: ignore[operator]
            note()

        def called() -> None:
            close()  # type: ignore[operator]
            note()

        return awaited if name in WAITED_FOR else called

    for name, part in parts.items():
        method = CLOSES.get(name, "close")
        object.__setattr__(part, method, noting(name, getattr(part, method)))

    async def live() -> None:
        async with app.router.lifespan_context(app):
            assert closed == []

    with pytest.raises(OSError, match=f"{broken} cannot be closed"):
        asyncio.run(live())
    assert closed == list(PARTS)
    assert app.state.engine.pool.checkedout() == 0
