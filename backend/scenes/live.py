"""What-if flights from a child process (stub)."""

from __future__ import annotations


class Live:
    async def close(self) -> None:
        pass
