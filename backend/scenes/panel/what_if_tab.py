"""The tab that flies the case live with other parameters. Start reading at `WhatIfTab`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import viser

from backend.scenes.base.flight import ROWS, Flight, from_live
from backend.scenes.base.noise import Noise
from backend.scenes.base.part import Part
from backend.scenes.base.setting import NOMINAL, Progress, Setting, Uncertain, UnknownParameterError
from backend.scenes.drawing.drawn import Drawn
from backend.scenes.live.latest import Latest
from backend.scenes.live.live import Live, LiveError
from backend.scenes.panel import tables

STEPS = 400
"""How finely a slider divides its range; the buttons set values at full precision."""


class WhatIfTab(Part):
    """A slider for each uncertain parameter; the newest position is flown, whatever was overtaken is not."""

    def __init__(
        self,
        gui: viser.GuiApi,
        setting: Setting,
        live: Live,
        drawn: Drawn,
        show: Callable[[Flight], None],
        progress: Progress,
    ) -> None:
        self._gui, self._setting, self._live, self._drawn, self._show = gui, setting, live, drawn, show
        self._progress = progress
        self._values = {one.path: one.nominal for one in setting.uncertain}
        self._offered = {NOMINAL: dict(self._values)}
        self._seed: int | None = None
        """Of the noise realisation that the flight it was set to drew; None: those of the campaign."""
        self._latest: Latest[tuple[dict[str, float], Noise]] = Latest(self._fly)
        if not setting.uncertain:
            gui.add_html(tables.note("The components of this campaign are not known to this installation (any more)."))
        self._sliders = {one.path: self._slider(one) for one in setting.uncertain}
        self._result = gui.add_html(tables.outcome(drawn, setting))
        self._cases = gui.add_folder("Set to")
        with self._cases:
            self._sets(gui.add_button("Nominal"), NOMINAL)

    def changed(self) -> None:
        """A button for each finding."""
        for label, parameters in self._progress.findings.items():
            new = label not in self._offered
            self._offered[label] = parameters
            if new:
                with self._cases:
                    button = self._gui.add_button(label, hint="The parameters of this finding, at full precision.")
                self._sets(button, label)

    def take(self, parameters: dict[str, float], seed: int | None) -> None:
        """Stand at these parameters and this noise seed, whose flight is shown already."""
        self._seed = seed
        for path, slider in self._sliders.items():
            if path in parameters:
                self._values[path] = slider.value = parameters[path]

    @property
    def parameters(self) -> dict[str, float] | None:
        """Those of the flight that is drawn; None where there is none."""
        flight = self._drawn.flight
        if flight is None:
            return None
        return {one.path: flight.parameters.get(one.path, one.nominal) for one in self._setting.uncertain}

    @property
    def seed(self) -> int | None:
        """Of the noise realisation of the flight that is drawn; None where it has those of the campaign."""
        flight = self._drawn.flight
        return self._seed if flight is not None and flight.seed == self._seed else None

    def fly(self, parameters: dict[str, float], seed: int | None) -> None:
        """Fly the case with these, the others nominal, under this noise seed or those of the campaign.

        Raises `UnknownParameterError`.
        """
        known = {one.path: one for one in self._setting.uncertain}
        for path, value in parameters.items():
            one = known.get(path)
            if one is None:
                allowed = ", ".join(known) or "none is known"
                raise UnknownParameterError(f"{path!r} is no uncertain parameter of this campaign: {allowed}")
            if not one.low <= value <= one.high:
                bounds = f"{one.low!r} to {one.high!r} {one.unit}".strip()
                raise UnknownParameterError(f"{path} is given as {value!r}, and may be {bounds}")
        self._set(self._offered[NOMINAL] | parameters, seed)

    def flown(self) -> None:
        """Say what the flight that is shown gave."""
        self._result.content = tables.outcome(self._drawn, self._setting, own_noise=self.seed is not None)

    def stop(self) -> None:
        """Fly nothing more."""
        self._latest.stop()

    def _slider(self, one: Uncertain) -> Any:
        label = f"{one.path} [{one.unit}]" if one.unit else one.path
        step = (one.high - one.low) / STEPS
        slider: Any = self._gui.add_slider(label, one.low, one.high, step, one.nominal, hint=one.text)

        def changed(event: Any) -> None:
            if event.client is not None:  # not one that a button has set
                self._values[one.path] = float(slider.value)
                self._ask()

        slider.on_update(changed)
        return slider

    def _sets(self, button: Any, label: str) -> None:
        button.on_click(lambda _: self._set(self._offered[label], self._progress.seeds.get(label)))

    def _set(self, parameters: dict[str, float], seed: int | None) -> None:
        self.take(parameters, seed)
        self._ask()

    def _ask(self) -> None:
        self._latest.ask((dict(self._values), Noise(seed=self._seed)))

    def _fly(self, asked: tuple[dict[str, float], Noise]) -> None:
        parameters, noise = asked
        try:
            answer = self._live.fly(self._setting.document, self._setting.digest, parameters, ROWS, noise)
        except LiveError as error:
            self._result.content = tables.note(str(error), strong=True)
            return
        flight = from_live(answer)
        if flight is None:
            self._result.content = tables.note(f"{answer['status']}: {answer['reason']}", strong=True)
            return
        self._show(flight)
        self.flown()
