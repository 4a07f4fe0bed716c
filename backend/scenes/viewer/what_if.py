"""The what-if flight of a viewer: supplied by the API, or simulated from its parameters.

The API passes each what-if flight of a page to the viewer. A reopened view receives only the parameters and simulates
the flight itself. The most recent request is drawn.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from backend.http.errors import RefusedError
from backend.scenes.base.flight import ROWS, Flight, from_live
from backend.scenes.base.part import Driver, Part
from backend.scenes.base.setting import Setting
from backend.scenes.drawing.drawn import Drawn
from backend.scenes.live.latest import Latest
from backend.scenes.live.live import Live, LiveError
from campaigns.checked.texts import within

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class _WhatIfRequest:
    number: int
    parameters: dict[str, float]
    seed: int | None


class WhatIf(Part):
    def __init__(
        self, setting: Setting, live: Live, drawn: Drawn, show: Callable[[Flight | None], None], driver: Driver
    ) -> None:
        self._setting, self._live, self._drawn, self._show, self._driver = setting, live, drawn, show, driver
        self.seed: int | None = None
        """Requested noise seed; None for those of the campaign."""
        self._number = self._order = 0
        self._latest: Latest[_WhatIfRequest] = Latest(self._simulate)

    @property
    def parameters(self) -> dict[str, float] | None:
        flight = self._drawn.flight
        if flight is None:
            return None
        return {one.path: one.nominal for one in self._setting.uncertain} | flight.parameters

    @property
    def shown(self) -> dict[str, Any]:
        return {"what_if": self.parameters, "what_if_seed": self.seed}

    def draw(self, flight: Flight | None, seed: int | None, order: int = 0) -> None:
        """Show this flight (None if it has no motion), unless a later one of the page is already shown."""
        with self._driver.drawing():
            if order and order <= self._order:
                return
            self._order = max(order, self._order)
            self._number += 1
            self.seed = seed
            self._show(flight)

    def simulate(self, parameters: Mapping[str, float], seed: int | None) -> None:
        """Simulate and show the case with these parameters, the others nominal, with this noise seed or the campaign's.

        Raises `RefusedError`, also for a run that evaluates a simulator.
        """
        if not self._setting.clears:
            text = "a what-if of a simulator is evaluated by POST /runs/RUN/cases, which also draws it"
            raise RefusedError("unknown-parameter", text)
        known = {one.path: one for one in self._setting.uncertain}
        for path, value in parameters.items():
            one = known.get(path)
            if one is None:
                allowed = ", ".join(known) or "no parameter is known"
                text = f"{path!r} is not an uncertain parameter of this campaign: {allowed}"
                raise RefusedError("unknown-parameter", text)
            if not within(value, one.low, one.high):
                bounds = f"{one.low!r} to {one.high!r} {one.unit}".strip()
                raise RefusedError("unknown-parameter", f"{path} is given as {value!r}, and may be {bounds}")
        self._number += 1
        nominal = {path: one.nominal for path, one in known.items()}
        self._latest.ask(_WhatIfRequest(self._number, nominal | dict(parameters), seed))

    def stop(self) -> None:
        self._latest.stop()

    def _simulate(self, request: _WhatIfRequest) -> None:
        setting = self._setting
        try:
            answer = self._live.simulate(setting.document, setting.digest, request.parameters, ROWS, request.seed)
        except LiveError as error:
            _log.info("the what-if flight of a view of %s could not be simulated: %s", setting.run, error)
            return
        flight = from_live(answer)
        with self._driver.drawing():
            if request.number == self._number:
                self.draw(flight, request.seed)
