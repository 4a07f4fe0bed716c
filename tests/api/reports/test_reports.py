"""The report for a safety case: sections, figures, unfinished runs, hostile names, the PDF."""

from __future__ import annotations

import html
import os
import re
import shutil
from collections import Counter
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
import sqlalchemy as sa

from backend.db.tables import CatalogueDocument, Run, Stage, Trace
from backend.reports import charts, figures, pdf, plot, words
from backend.reports.service import _STATES
from campaigns.claims import earlier, numbers
from campaigns.results.slices import Curve
from campaigns.runs import RunState
from tests.given import declared_traces
from tests.given.databases import AT_NIGHT
from tests.given.finished_runs import Work, finish
from tests.given.problem_documents import problem
from tests.given.reported_runs import finish_fully, missing
from tests.given.service import Service
from tests.given.small_catalogue import CATALOGUE, campaign
from tests.given.submissions import submit

SECTIONS = (
    "Scope of the claim", "Uncertain parameters and worst case", "Checks behind the verdict", "Worst cases",
    "Sensitivity", "Methods and settings", "Evaluations", "Statistical statement", "Validation",
    "Limits of this evidence", "Provenance", "Approval", "Appendix. Model",
)  # fmt: skip
HOSTILE = "<script>alert(1)</script><img src=x onerror=alert(1)>\"'>{{ 7*7 }}"


@pytest.fixture
def run(service: Service, client: httpx.Client) -> str:
    """A finished run with a result of every kind."""
    run = submit(client)
    finish_fully(service)
    return run


def report(client: httpx.Client, run: str) -> str:
    answer = client.get(f"/api/v1/runs/{run}/report.html")
    assert answer.status_code == 200
    assert answer.headers["content-type"] == "text/html; charset=utf-8"
    return answer.text


def test_its_parts_share_what_they_read_of_the_run(service: Service, client: httpx.Client, run: str) -> None:
    asked: Counter[tuple[str, str]] = Counter()
    sa.event.listen(
        service.engine, "before_cursor_execute", lambda _c, _k, text, of, *_: asked.update([(text, f"{of}")])
    )
    report(client, run)
    again = [text for (text, _), times in asked.items() if times > 1]
    assert len(asked) > 40
    assert max(asked.values()) <= 2, asked.most_common(1)
    assert [text for text in again if "FROM runs" in text or "FROM catalogue_snapshots" in text] == []


@AT_NIGHT
def test_it_has_every_section_and_figure(client: httpx.Client, run: str) -> None:
    text = report(client, run)
    found = [re.sub(r"^\d+\. ", "", heading) for heading in re.findall(r"<h2>(.*?)</h2>", text)]
    assert found == list(SECTIONS)
    labels = re.findall(r'<svg class="ch"[^>]*aria-label="([^"]*)"', text)
    assert [label.partition(" ")[0] for label in labels] == [
        "Flights", "Separation", "d_min", "d_min", "Best", "Change", "Histogram",
    ]  # fmt: skip
    assert len(set(re.findall(r"<b>(?:Figure|Table) \d\.</b>", text))) == 11


@AT_NIGHT
def test_its_numbers_are_those_that_are_stored(client: httpx.Client, run: str) -> None:
    text = html.unescape(re.sub(r"<[^>]+>", "", report(client, run)))
    for statement in (
        "dmin stayed above 0.5\u202fm in all 1\u202f000 evaluations. A search can miss a worse case.",
        "At most 5\u202f% of the flights have dmin below 1.33\u202fm.",
        "0 of 3\u202f000 samples drawn violate the criterion",
        "The step-halving check and DOP853 agree for nominal and F1.",
        "completed the 100 iterations",
        "numpy 2.4.6",
        "A CPU",
    ):
        assert statement in text, statement
    told = client.get(f"/api/v1/runs/{run}/exports/run.json").json()
    assert told["results_digest"] in text
    assert told["run"]["campaign_digest"] in text


def test_it_needs_nothing_else_and_runs_nothing(client: httpx.Client, run: str) -> None:
    answer = client.get(f"/api/v1/runs/{run}/report.html")
    policy = answer.headers["content-security-policy"]
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy
    assert "script" not in policy
    (own,) = re.findall(r'http-equiv="Content-Security-Policy" content="([^"]*)"', answer.text)
    assert policy.startswith(html.unescape(own))
    assert not re.search(r"<script|\son\w+=|javascript:|<link|<img|<iframe|\sstyle=", answer.text)
    assert set(re.findall(r'(?:src|href|url)\s*[=(]\s*["\']?(\w+:)', answer.text)) <= {"data:"}
    assert "http" not in answer.text.replace('http-equiv="Content-Security-Policy"', "")
    assert answer.headers["content-disposition"] == (
        'inline; filename="R-0001-unicycle-past-a-pillar-safety-case-report.html"'
    )


def test_hostile_words_stay_words(service: Service, client: httpx.Client) -> None:
    document = campaign(name=HOSTILE[:100], summary=HOSTILE, notes=HOSTILE)
    answer = client.post("/api/v1/runs", json={"campaign": document, "name": HOSTILE[:100]})
    assert answer.status_code == 201, answer.text
    finish_fully(service, text=HOSTILE, checked=HOSTILE)
    text = report(client, "R-0001")
    assert "<script" not in text
    assert "<img" not in text
    assert text.count("&lt;script&gt;alert(1)&lt;/script&gt;") >= 5
    assert "{{ 7*7 }}" in text
    assert "49}}" not in text
    (style,) = re.findall(r"<style>(.*?)</style>", text, re.DOTALL)
    assert "alert" not in style


@pytest.mark.by_day(1)
@pytest.mark.parametrize("verdict", ["violated", "inconclusive"])
def test_other_verdicts_are_reported(service: Service, client: httpx.Client, verdict: str) -> None:
    run = submit(client)
    finish_fully(service, verdict, "Nothing may be claimed.")
    text = report(client, run)
    assert f'<section class="vbox {"bad" if verdict == "violated" else "unk"}"' in text
    assert f"</svg>{verdict.capitalize()}</div>" in text


def test_an_unfinished_run_claims_nothing(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    queued = report(client, run)
    assert "Queued: no verdict" in queued
    assert "not ended" in queued
    assert 'content:"No verdict' in queued
    work = Work(service)
    work.nominal()
    work.search(0, 700)
    text = report(client, run)
    keys = text.partition('<p class="keys">')[2].partition("</p>")[0]
    title = CATALOGUE.method("direct")
    assert title is not None
    assert re.sub("<.*?>", "", keys) == title.title
    assert "Running: no verdict" in text
    assert _STATES[RunState.RUNNING] in text
    assert {"verdict", "sample"} <= missing(text)
    assert "Cleared</div>" not in text
    assert not [heading for heading in SECTIONS if heading not in text]


def test_the_report_of_a_run_with_bare_results_names_what_is_unknown(service: Service, client: httpx.Client) -> None:
    run = submit(client)
    finish(service)
    text = report(client, run)
    assert {"sensitivity", "validation"} <= missing(text)
    assert text.count("not recorded") >= 5


def test_without_a_catalogue_the_model_is_reported_as_unknown(service: Service, client: httpx.Client, run: str) -> None:
    with service.engine.begin() as connection:
        connection.execute(sa.delete(CatalogueDocument))
        connection.execute(sa.update(Run).values(snapshot=None))
    text = report(client, run)
    assert "component" in missing(text)
    assert "not described" in text


def test_components_that_may_have_changed_since_are_named(service: Service, client: httpx.Client, run: str) -> None:
    text = report(client, run)
    assert re.search(r"clearance 0\.1\.0, and .* by test\b", text)
    with service.engine.begin() as connection:
        trace = sa.select(Trace.meta).where(Trace.name == "nominal")
        meta = connection.scalar(trace) | {"parameters": {"vehicle.m": 5.5, "vehicle.J": 0.05}}  # type: ignore[operator]
        connection.execute(sa.update(Trace).where(Trace.name == "nominal").values(meta=meta))
    text = report(client, run)
    assert "vehicle.m was 5.5 " in text
    assert "vehicle.J was" not in text


def test_parameters_with_one_symbol_are_distinguished(client: httpx.Client) -> None:
    document = campaign()
    document["scenario"]["obstacles"] *= 2
    document["uncertain"] |= {f"obstacles.{i}.radius": {"low": 0.40000004, "high": 0.6} for i in range(2)}
    text = report(client, submit(client, **document))
    assert text.count('<td class="num">0.40000004</td><td class="num">0.6</td>') == 2  # bounds with all their digits
    for i in range(2):
        named = f'<i class="v" title="obstacles.{i}.radius">radius</i> of obstacle {i + 1}</td>'
        assert f'{named}<td>Radius <span class="m mono">obstacles.{i}.radius</span></td>' in text
    assert '<i class="v" title="vehicle.m">m</i></td><td>M <span class="m mono">vehicle.m</span></td>' in text


def test_it_is_printed_as_pdf(client: httpx.Client, run: str) -> None:
    answer = client.get(f"/api/v1/runs/{run}/report.pdf", timeout=90)
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"] == "application/pdf"
    assert answer.headers["content-disposition"].endswith('-safety-case-report.pdf"')
    assert answer.content.startswith(b"%PDF-")
    assert answer.content.count(b"/Type /Page\n") >= 4
    assert b"/MediaBox [0 0 594" in answer.content or b"/MediaBox [0 0 595" in answer.content


def test_without_a_browser_the_message_names_what_to_install(
    client: httpx.Client, run: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    told = problem(client.get(f"/api/v1/runs/{run}/report.pdf"), 503)
    assert "apt install chromium" in str(told["detail"])
    listed = {file["href"]: file["unavailable"] for file in client.get(f"/api/v1/runs/{run}/exports").json()}
    assert "Chromium" in (listed[f"/api/v1/runs/{run}/report.pdf"] or "")
    assert listed[f"/api/v1/runs/{run}/report.html"] is None


def _stand_in(folder: Path, program: str) -> None:
    file = folder / pdf.NAMES[0]
    file.write_text(f"#!{shutil.which('sh')}\n{program}\n")
    file.chmod(0o755)


def test_a_browser_that_fails_or_hangs_is_a_problem(
    client: httpx.Client, run: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    _stand_in(tmp_path, "echo no display >&2; exit 7")
    failed = problem(client.get(f"/api/v1/runs/{run}/report.pdf"), 503, "browser-failed")["detail"]
    monkeypatch.setattr(pdf, "PATIENCE", 0.3)
    _stand_in(tmp_path, "sleep 600 & sleep 600")
    late = problem(client.get(f"/api/v1/runs/{run}/report.pdf"), 503, "browser-failed")["detail"]
    assert "took too long" in str(late)
    assert failed != late


@pytest.mark.parametrize("file", ["report.html", "report.pdf"])
def test_no_report_of_a_run_that_is_not_there(guest: httpx.Client, file: str) -> None:
    problem(guest.get(f"/api/v1/runs/R-0999/{file}"), 404)


def test_no_line_bridges_an_evaluation_without_a_value() -> None:
    status: list[Any] = ["ok", "ok", "failed", "ok", "ok", "timeout", "ok"]
    costs = [2.0, 2.1, None, 2.2, 2.3, None, 2.4]
    curve = Curve(path="vehicle.m", values=[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0], costs=costs, status=status)
    about = figures.About("m", "Mass", "kg", 3.0, 0.0, 6.0, None)
    svg = figures.sensitivity(curve, None, about, (1.0, 3.0), figures.Quantity("d", "m", 0.5))
    lines = re.findall(rf'<path d="(M[^"]+)" stroke="{plot.NOMINAL}"', svg)
    assert [line.count("L") for line in lines] == [1, 1]
    assert svg.count("<circle") == 1, "a value between two gaps is a dot"


def test_of_many_curves_those_with_gaps_and_the_largest_effects_are_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    def curve(k: int, last: float | None) -> Curve:
        return Curve(path=f"p.{k}", values=[0.0, 1.0], costs=[2.0, last], status=["ok", "ok" if last else "failed"])

    made = [curve(0, 2.001), curve(1, None), *(curve(k, 2.0 + k) for k in range(2, 14))]
    monkeypatch.setattr(charts, "_curves", lambda record: made)
    shown = charts._shown(None)  # type: ignore[arg-type]
    assert [one.path for one in shown] == ["p.1", *(f"p.{k}" for k in range(3, 14))]


def test_numbers_as_in_print() -> None:
    assert numbers.fixed(-1234567.891, 1) == "\u22121\u202f234\u202f567.9"
    assert numbers.fixed(-0.001, 2) == "0.00"
    assert numbers.fixed(float("nan")) == numbers.NONE
    assert (numbers.difference(7.194), numbers.difference(0.0001)) == ("+7.19", "0.00")
    assert (numbers.plain(0.05), numbers.plain(1e-6), numbers.plain(12000.5)) == ("0.05", "1e\u22126", "12\u202f000.5")
    assert numbers.unit_in_print("N s2/m") == "N·s²/m"
    terms = earlier.Terms({"d_min": "d_min", "vehicle.m": "m", "avoider.dpsi": "dpsi"}, {"m", "m/s", "kg m2"})
    stored = "a < d_min and d_min2; vehicle.m at -0.2 m/s, 3e-06 kg m2, vehicle.mass, 2 metres."
    set_ = words.drawn(earlier.spans(stored, terms))
    assert set_ == (
        'a &lt; <i class="v">d</i><sub>min</sub> and d_min2; <i class="v" title="vehicle.m">m</i> '
        "at \u22120.2\u202fm/s, 3e\u221206\u202fkg·m², vehicle.mass, 2 metres."
    )
    assert plot.linear_ticks(-2, 2, 4) == [-2, -1, 0, 1, 2]
    assert words.flowed(f"{'long ' * 18}\nline\nshort\nnext") == f"{'long ' * 18} line\nshort\nnext"


@pytest.mark.by_day(1)
@pytest.mark.parametrize(
    ("frame", "position", "axes"),
    [
        ("z_up", ["lon", "lat"], ("lon, m", "lat, m")),
        # By day from above with z up, and from the side with z down.
        pytest.param("z_down", ["lat", "lon", "deep"], ("lon, m", "lat, m"), marks=pytest.mark.nightly),
        pytest.param("z_up", ["lon", 0, "high"], ("lon, m", "high, m"), marks=pytest.mark.nightly),
        ("z_down", ["lon", 0, "deep"], ("lon, m", "−deep, m")),
    ],
)
def test_a_simulator_is_drawn_from_the_columns_that_it_declares(
    bare: Service, frame: str, position: list[object], axes: tuple[str, str]
) -> None:
    """In the report and in the picture of summaries; by names that nothing but its scene states."""
    place = [40, 0, 50] if len(position) == 3 else [40, 0]
    scene = {
        "frame": frame,
        "vehicle": {"position": position},
        "bodies": [{"name": "kite", "position": position[::-1] if frame == "z_up" else position, "radius": 2}],
        "obstacles": [
            {"name": "tower", "shape": "box", "position": place, "size": [4, 6, 30], "angle": 0.5},
            {"name": "balloon", "shape": "sphere", "position": place, "radius": 3},
        ],
    }
    t = np.linspace(0.0, 20.0, 401)
    tracks = {"lon": 3.0 * t, "lat": 0.5 * t, "high": 100.0 - 5.0 * t, "deep": 5.0 * t - 100.0}
    with bare.signed_in() as client:
        run = declared_traces.declared(bare, client, lambda name: declared_traces.trace(name, scene, **tracks))
        (file,) = [f for f in client.get(f"/api/v1/runs/{run}/exports").json() if f["name"].endswith("worst-case.svg")]
        text, picture = report(client, run), client.get(file["href"]).text
    for drawn in (text, picture):
        assert axes[0] in drawn
        assert axes[1] in drawn
        assert "East" not in drawn
        for name in ("kite", "tower", "balloon"):
            assert name in drawn
    assert 'data-missing="drawing"' not in text


@pytest.mark.by_day(1)
@pytest.mark.parametrize(
    ("stated", "sentence"),
    [
        ({}, "declares no trace"),
        ({"cost": None}, "trace is stored"),
        ({"untraced": {"nominal": "it has 1 row", "F1": "it has 1 row"}}, "nominal case, F1: it has 1 row."),
    ],
)
def test_report_and_page_say_why_a_simulator_has_no_trace(bare: Service, stated: dict[str, Any], sentence: str) -> None:
    with bare.signed_in() as client:
        run = declared_traces.declared(bare, client, found=False)
        assert client.get(f"/api/v1/runs/{run}").json()["untraced"] == ""
        with bare.engine.begin() as writer:
            writer.execute(sa.delete(Trace))
            first = Stage.position == 0
            result = writer.execute(sa.select(Stage.result).where(first)).scalar_one()
            writer.execute(sa.update(Stage).where(first).values(result=result | stated))
        why = client.get(f"/api/v1/runs/{run}").json()["untraced"]
        assert sentence in why
        assert ("declares a trace" in why) == ("untraced" in stated)
        assert f'data-missing="trace">{why}</p>' in report(client, run)


@pytest.mark.by_day(1)
@pytest.mark.parametrize("drawn", [True, False])
def test_the_report_says_where_a_seed_was_stated(service: Service, client: httpx.Client, run: str, drawn: bool) -> None:
    with service.engine.begin() as connection:
        of = Stage.kind == "certify"
        result = connection.execute(sa.select(Stage.result).where(of)).scalar_one()
        connection.execute(sa.update(Stage).where(of).values(result=result | {"seed": 7, "drawn_at_launch": drawn}))
    text = report(client, run)
    assert ("a user stated" in text) != drawn
