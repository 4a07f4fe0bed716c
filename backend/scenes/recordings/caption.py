"""The caption of a recording: a card with text and numbers over the scene."""

from __future__ import annotations

import html
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import viser

from backend.scenes.base.dress import CHARSET, dressed
from backend.scenes.base.palette import DARK, LIGHT
from backend.scenes.base.setting import NOMINAL, Setting
from backend.scenes.panel.tables import number
from backend.scenes.recordings.recording import Cast, Recording
from campaigns.version import VERSION

POLICY = (
    "default-src 'none'; script-src 'unsafe-inline' 'wasm-unsafe-eval' blob: data:; worker-src blob: data:; "
    "style-src 'unsafe-inline'; img-src data: blob:; font-src data:; connect-src data: blob:; base-uri 'none'; "
    "form-action 'none'"
)
"""The page is self-contained: its policy blocks all requests."""

_STYLE = """
#caption{position:fixed;top:12px;right:12px;z-index:4;max-width:min(340px,calc(100vw - 24px));
max-height:calc(100vh - 76px);overflow:auto;box-sizing:border-box;padding:10px 14px;border:1px solid;border-radius:6px;
font:12px/18px var(--mantine-font-family,system-ui,sans-serif);font-variant-numeric:tabular-nums}
#caption summary{cursor:pointer;font-weight:600;font-size:13px}
#caption summary:focus-visible{outline:2px solid currentColor;outline-offset:2px}
#caption p{margin:6px 0 0}
#caption dl{display:grid;grid-template-columns:max-content 1fr;gap:1px 12px;margin:8px 0 0}
#caption dt{opacity:.75}
#caption dd{margin:0;text-align:right;overflow-wrap:anywhere}
#caption .digest{font-family:ui-monospace,Menlo,monospace;font-size:11px}
#caption i{display:inline-block;width:14px;height:3px;margin-right:6px;vertical-align:middle}
"""


@dataclass(frozen=True)
class Caption:
    run: str
    name: str
    state: str
    """The verdict, or the state of the run."""
    campaign: str
    results: str
    """The digests."""
    costs: Mapping[str, float | None]
    """What the run stored of the nominal case and each finding, by label."""


def with_caption(
    made: Recording, setting: Setting, cast: Cast, caption: Caption, dark: bool, font: str | None = None
) -> str:
    """viser's page with a title, a policy that blocks all requests, our style, and the card; font: a data address."""
    title = html.escape(f"{caption.run} {cast.label}: {caption.name}")
    policy = f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">'
    page = dressed(made.html, font).replace(CHARSET, f"{CHARSET}{policy}", 1)
    page = page.replace("<title>Viser</title>", f"<title>{title}</title><style>{_STYLE}{_colours(dark)}</style>", 1)
    return page.replace(
        '<div id="root"></div>', f'<div id="root"></div>{_card(made.statement, setting, cast, caption, dark)}', 1
    )


def _colours(dark: bool) -> str:
    ground, ink, edge = ("#151b21", "#e7ecf2", "#2f3b47") if dark else ("#ffffff", "#15202b", "#c8d0d9")
    return f"#caption{{background:{ground};color:{ink};border-color:{edge}}}"


def _card(statement: str, setting: Setting, cast: Cast, caption: Caption, dark: bool) -> str:
    palette = DARK if dark else LIGHT
    quantity = setting.quantity or "value"
    flights = [("Nominal", palette.nominal, cast.nominal)] if cast.nominal else []
    colour = palette.nominal if cast.label == "nominal" else palette.worst
    flights.append(("Nominal" if cast.label == "nominal" else cast.label, colour, cast.shown))
    rows = [_row(f"{title}, {quantity}", _cost(flight.cost, setting), colour) for title, colour, flight in flights]
    rows.append(_row("Criterion", setting.criterion))
    rows.append(_row("Verdict of the run", caption.state))
    units = {one.path: one.unit for one in setting.uncertain}
    values = {
        path: cast.shown.parameters[path]
        for path in setting.document.get("uncertain") or {}
        if path in cast.shown.parameters
    }
    parameter_rows = [_row(path, f"{value!r} {units.get(path, '')}") for path, value in values.items()]
    code = setting.identity.digest or f"not identified: {', '.join(setting.identity.unidentified)}"
    digests = {"Campaign": caption.campaign, "Results": caption.results, "Code": code, **setting.identity.files}
    marks = [_row(name, digest, kind="digest") for name, digest in digests.items()]
    notes = " ".join([statement, *_of_simulator(setting, cast, caption), "Vehicles are not to scale."])
    last = f"{html.escape(notes)} Clearance {VERSION}, viser {viser.__version__}."
    return (
        f'<details id="caption" open><summary>{html.escape(f"{caption.run} · {cast.label}")}</summary>'
        f"<p>{html.escape(caption.name)}</p>{_list(rows)}"
        + (
            f"<p>Parameters of {html.escape(cast.label)}, all digits</p>{_list(parameter_rows)}"
            if parameter_rows
            else ""
        )
        + f"<p>Digests (SHA-256)</p>{_list(marks)}<p>{last}</p></details>"
    )


def _of_simulator(setting: Setting, cast: Cast, caption: Caption) -> Iterator[str]:
    """Yield sentences on the source of the positions, and on traces of another call than the stored evaluation."""
    if setting.clears:
        return
    yield "Positions come from the trace of the simulator, obstacles from its declaration."
    for label, flight in cast.flights.items():
        stored = caption.costs.get(label)
        if stored is not None and stored != flight.cost:
            of = "the nominal case" if label == NOMINAL else label
            yield f"The trace of {of} is one more call with its own value; the run stored {_cost(stored, setting)}."


def _cost(cost: float | None, setting: Setting) -> str:
    return f"{number(cost, setting.decimals)} {setting.unit}" if cost is not None else f"none: the {setting.one} failed"


def _list(rows: Sequence[str]) -> str:
    return f"<dl>{''.join(rows)}</dl>"


def _row(head: str, value: str, colour: str = "", kind: str = "") -> str:
    mark = f'<i style="background:{colour}"></i>' if colour else ""
    of = f' class="{kind}"' if kind else ""
    return f"<dt>{mark}{html.escape(head)}</dt><dd{of}>{html.escape(value.strip())}</dd>"
