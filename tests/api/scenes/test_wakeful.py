"""A wake-up of a viewer from another thread at the worst moment."""

from __future__ import annotations

import asyncio
import threading

from backend.scenes.control.relay import open_server
from backend.scenes.control.wakeful import Wakeful


def in_a_thread(event: Wakeful) -> None:
    thread = threading.Thread(target=event.set, daemon=True)
    thread.start()
    thread.join()


async def waiting(event: Wakeful) -> asyncio.Task[bool]:
    """A task that has looked at the flag and waits."""
    task = asyncio.create_task(event.wait())
    await asyncio.sleep(0)
    return task


def test_a_flag_set_between_check_and_wait_wakes_the_waiter() -> None:
    async def story() -> None:
        event = Wakeful()
        task = await waiting(event)
        in_a_thread(event)
        assert event.is_set()
        event.set()
        assert await asyncio.wait_for(task, 10)

    asyncio.run(story())


def test_it_wakes_everybody_once_and_can_be_cleared() -> None:
    async def story() -> None:
        event = Wakeful()
        tasks = [await waiting(event) for _ in range(3)]
        event.set()
        event.set()
        assert await asyncio.wait_for(asyncio.gather(*tasks), 10) == [True] * 3
        assert await event.wait()
        event.clear()
        task = await waiting(event)
        await asyncio.sleep(0)
        assert not task.done()
        task.cancel()

    asyncio.run(story())


def test_every_viewer_is_woken_so() -> None:
    server = open_server("nobody knows")
    try:
        assert isinstance(server._websock_server._broadcast_buffer.message_event, Wakeful)
    finally:
        server.stop()
