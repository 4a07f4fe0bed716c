"""Simulates the nominal case of an edited campaign, one at a time, in a separate process from the viewers'.

Requests whose client has disconnected while waiting are dropped, so that of many edits only the newest is simulated.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any

from backend.catalog.service import required
from backend.db.engine import ask
from backend.http.capacity import Capacity, Gone
from backend.http.deps import Engine
from backend.http.errors import RefusedError
from backend.previews.schemas import Preview, PreviewClosest, PreviewIntruder, PreviewRealisation
from backend.scenes.live.live import FlightRefusedError, Live, LiveError
from campaigns import Campaign, CampaignError, check
from campaigns.catalogue import ComponentEntry
from campaigns.checked import effort
from campaigns.stored.replies import FlightReply

ROWS = 240
"""Approximate number of points of a preview."""

WAITING = 8
"""Maximum number of running and waiting previews."""

LIMIT = 90.0
"""Time limit of a preview [s]: every edit is a new campaign, which may have to be compiled."""

_BUSY = "other previews are being simulated and the queue is full: try again in a few seconds"


class Previews:
    """The simulation process of the previews and its queue; used on one event loop."""

    def __init__(self, live: Live | None = None) -> None:
        self.live = live or Live(limit=LIMIT, first_limit=LIMIT)
        self._queue = Capacity("", 1, WAITING - 1, None, 3, _BUSY, "preview-busy")

    @property
    def waiting(self) -> int:
        """The number of running and waiting previews."""
        return self._queue.inside

    async def simulate(self, account: str, campaign: Campaign, gone: Gone) -> tuple[FlightReply, float]:
        """The answer of the simulation process, and how long it took [s]. Raises `RefusedError`.

        account: as in `Capacity.turn`. gone: whether the client has disconnected; checked again when its turn comes.
        """
        async with self._queue.turn(account):
            if await gone():
                raise RefusedError("preview-overtaken", "the client no longer waits for this preview")
            began = time.monotonic()
            answer = await self._queue.thread(lambda: self._flown(campaign))
            return answer, time.monotonic() - began

    def stop(self) -> None:
        self.live.close()

    def _flown(self, campaign: Campaign) -> FlightReply:
        try:
            return self.live.simulate(campaign.document(), campaign.digest, {}, ROWS)
        except FlightRefusedError as error:
            raise RefusedError("not-flyable", f"this campaign cannot be simulated: {error}") from None
        except LiveError as error:
            raise RefusedError("preview-failed", f"the nominal case could not be simulated: {error}") from None


def checked(engine: Engine, campaign: Campaign) -> ComponentEntry:
    """The criterion of a campaign that can be previewed; raises `CampaignError`, or 503 if no worker has started."""
    catalogue = ask(engine, required)
    problems = check(campaign, catalogue) or list(effort.unpreviewable(campaign))
    if problems:
        raise CampaignError("request", problems)
    criterion = catalogue.component("criterion", campaign.criterion.component)
    assert criterion is not None
    return criterion


def response(campaign: Campaign, criterion: ComponentEntry, answer: FlightReply, seconds: float) -> Preview:
    data, meta = answer["data"], answer["meta"]
    moving = [i for i, obstacle in enumerate(meta["obstacles"]) if obstacle["moving"]]
    intruders = [PreviewIntruder(obstacle=i, **{a: data[f"obstacle.{i}.{a}"] for a in "xyz"}) for i in moving]
    return Preview(
        digest=campaign.digest,
        status=answer["status"],
        reason=answer["reason"],
        value=answer["cost"],
        margin=answer["margin"],
        threshold=meta["threshold"],
        quantity=criterion.quantity,
        unit=criterion.unit,
        frame=meta["frame"],
        t=data["t"],
        x=data["x"],
        y=data["y"],
        z=data["z"],
        heading=data["yaw"],
        intruders=intruders,
        closest=_closest(meta.get("closest")),
        realisation=_realisation(meta.get("realisation")),
        seconds=seconds,
    )


def _closest(point: Mapping[str, Any] | None) -> PreviewClosest | None:
    return None if point is None else PreviewClosest(**{name: point[name] for name in PreviewClosest.model_fields})


def _realisation(realisation: Mapping[str, Any] | None) -> PreviewRealisation | None:
    if realisation is None:
        return None
    return PreviewRealisation(
        seed=realisation["seed"], seeds=realisation["seeds"], combine=realisation["combine"], value=realisation["cost"]
    )
