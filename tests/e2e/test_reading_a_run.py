"""Reading the page of a run: the first screen, the tabs, the next step, a nominal case that diverged; and comparing.

The runs are written as a worker writes them, so that nothing is simulated here.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
import sqlalchemy as sa
from playwright.sync_api import Browser, Locator, Page, expect

from backend.db.rows import plain
from backend.db.tables import Run
from campaigns.claims.say import say
from campaigns.results.regression import FindingChange, Regression, Standing
from campaigns.results.verdict import Check
from campaigns.stored.records import Trace
from tests import results
from tests.e2e.browser import Visit, space_of, visiting
from tests.e2e.stored import served
from tests.given.at_night import nightly_but
from tests.given.finished_runs import COLUMNS, flight
from tests.given.reported_runs import PARAMETERS, finish_fully
from tests.given.service import Service
from tests.given.small_catalogue import campaign

pytestmark = [pytest.mark.e2e, pytest.mark.timeout(300)]
DRAWS = False

FAILING = [
    Check(code="validation", ok=False, statement=results.statement("the integrations disagree for F1")),
    Check(code="probability", ok=False, statement=results.statement("the bound of 9 % is above the required 5 %")),
    *(
        Check(code=f"check {i}", ok=True, statement=results.statement(f"condition {i} holds as it should"))
        for i in range(12)
    ),
]

LONG = (
    "Nothing may be claimed: the integrations disagree by more than the tolerance for F1; the bound of 9.21 % on "
    "P(violation) is above the required 5 %; draw more than 3000 samples, or set target_probability. The worst case "
    "found has d_min = 1.31234 m, a margin of +0.812341 m. It was found in 1\u202f000 evaluations, searched by DIRECT "
    "(1\u202f000) and SQP multistart (300). Of these, 100 failed."
)
"""A sentence as long as those of real runs."""


def diverged() -> Trace:
    """A nominal case that left the model's envelope: finite up to 1e12, then not a number."""
    trace = flight("nominal", 3001)
    growing = 10.0 ** np.linspace(0, 12, len(trace.data))
    data = trace.data.copy()
    for k, (name, _, _) in enumerate(COLUMNS):
        if name != "t":
            data[:, k] = growing * (-1.0) ** np.arange(len(data))
    data[-40:, 1:] = np.nan
    told = {"status": "failed", "reason": "the state diverged (non-finite or above 1e12)", "cost": None, "values": {}}
    meta = trace.meta.model_dump() | told | {"closest": None}
    return Trace(trace.name, trace.columns, data, results.head(**meta))


OUTSIDE = "vehicle.m = 6.5 is outside the bounds 4 to 6 of this campaign"


def changed() -> Regression:
    """One finding of the baseline has become worse, one cannot be compared, and one is new."""
    known: dict[str, Any] = {"parameters": PARAMETERS, "margin_before": 0.9}
    cases = [
        FindingChange(
            standing=Standing.WORSE, before="F1", now="F1", evaluation=0, margin_again=0.8, margin=0.75, change=-0.15,
            tolerance=0.001, fails=True, statement=say("F1 of R-0001 is worse"), **known,
        ),
        FindingChange(
            standing=Standing.NOT_COMPARED, before="F2", now=None,
            statement=say(f"F2 of R-0001 is not compared: {OUTSIDE}"),
            **known,
        ),
        FindingChange(
            standing=Standing.NEW, before=None, now="F2", margin=0.7, parameters=PARAMETERS, statement=say("F2 is new"),
        ),
    ]  # fmt: skip
    told = "Changes of the findings since R-0001: 1 worse, 1 not compared, 1 new. The policy fails: <b>."
    return Regression(
        run="R-0001", position=1, cases=cases, fail_on=["worse"], ok=False, quantity="d_min", unit="m",
        statement=say(told),
    )  # fmt: skip


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """Finished runs: cleared, inconclusive, one whose nominal case failed, the first one again, and a compared one."""
    with served(tmp_path_factory.mktemp("reading")) as service:
        with service.signed_in() as client:
            for name, verdict, more in (
                ("Cleared", "cleared", {}),
                ("Inconclusive", "inconclusive", {"further": FAILING, "text": LONG}),
                ("Diverged", "inconclusive", {"nominal": diverged(), "further": FAILING}),
                ("Again", "violated", {}),
            ):
                answer = client.post("/api/v1/runs", json={"campaign": campaign(), "name": name})
                assert answer.status_code == 201, answer.text
                finish_fully(service, verdict, **more)  # type: ignore[arg-type]
            baseline = {"campaign": campaign(), "name": "Compared", "labels": {"branch": "slow"}, "baseline": "R-0001"}
            assert client.post("/api/v1/runs", json=baseline).status_code == 201
            finish_fully(service)
        with service.engine.begin() as writer:
            summary: Any = writer.scalar(sa.select(Run.summary).where(Run.id == 5))
            writer.execute(sa.update(Run).where(Run.id == 5).values(summary=summary | {"regression": plain(changed())}))
            flown: Any = writer.scalar(sa.select(Run.flown).where(Run.id == 4))
            writer.execute(sa.update(Run).where(Run.id == 4).values(flown={**flown, "code": "feed" * 16}))
        yield service


@pytest.fixture(scope="module")
def visit(finished: Service, browser: Browser) -> Iterator[Visit]:
    with visiting(browser, finished.url) as visit:
        visit.sign_in(finished.login_code())
        yield visit


def bottom(of: Locator) -> float:
    box = of.bounding_box()
    assert box is not None
    return box["y"] + box["height"]


def right(of: Locator) -> float:
    box = of.bounding_box()
    assert box is not None
    return box["x"] + box["width"]


@pytest.mark.parametrize("run", nightly_but(("R-0001",), ("R-0001", "R-0002", "R-0004")))
def test_verdict_figures_and_view_share_the_first_screen(visit: Visit, run: str) -> None:
    visit.go(f"/runs/{run}")
    page = visit.page
    view = page.get_by_role("group", name="3D view and its keys")
    expect(view).to_be_visible()
    assert bottom(page.get_by_test_id("verdict")) < bottom(page.get_by_test_id("worst")) < 450
    box = view.bounding_box()
    assert box is not None
    assert box["y"] + 0.6 * box["height"] <= 900, "most of the view is on the first screen"
    visit.shot(f"reading-{run}", full=False)


def test_checks_are_folded_and_the_fold_names_those_that_do_not_hold(visit: Visit) -> None:
    page = visit.stay("/runs/R-0002")
    fold = page.get_by_test_id("checks")
    summary = fold.locator("summary")
    expect(summary).to_contain_text("3 of 16 checks fail:")
    expect(summary).to_contain_text("X, Integration, Bound on P(violation)")
    expect(fold.get_by_role("list", name="Checks")).to_be_hidden()
    summary.focus()
    page.keyboard.press("Enter")
    expect(fold.locator("[data-check=validation]")).to_contain_text("the integrations disagree for F1")
    visit.shot("reading-checks", full=False)


def current(page: Page) -> str:
    return page.get_by_role("navigation", name="Sections").locator("[aria-current]").inner_text().split("\n")[0]


def test_tabs_are_in_page_order_and_follow_the_scroll(visit: Visit) -> None:
    visit.go("/runs/R-0002")
    page = visit.page
    space_of(page)
    page.evaluate("scrollTo({top: 0, behavior: 'instant'})")
    links = page.get_by_role("navigation", name="Sections").get_by_role("link")
    targets = [str(link.get_attribute("href")) for link in links.all()]
    places = [page.locator(target).bounding_box() for target in targets]
    tops = [box["y"] for box in places if box is not None]
    assert len(tops) == len(targets) > 8
    for before, after in itertools.pairwise(tops):
        assert after > before - 8, dict(zip(targets, tops, strict=True))
    names = [link.inner_text().split("\n")[0] for link in links.all()]
    whole = int(page.evaluate("document.documentElement.scrollHeight"))
    seen: list[str] = []
    for y in range(0, whole, 200):
        page.evaluate(f"scrollTo({{top: {y}, behavior: 'instant'}})")
        page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
        if not seen or seen[-1] != current(page):
            seen.append(current(page))
    order = [names.index(name) for name in seen]
    assert order == sorted(order), seen
    assert seen[0] == names[0]
    assert len(seen) >= 6
    links.last.click()
    expect(links.last).to_have_attribute("aria-current", "true")


def test_an_inconclusive_verdict_opens_the_launch_page_with_the_change(visit: Visit) -> None:
    visit.go("/runs/R-0002")
    page = visit.page
    steps = page.get_by_role("group", name="Next steps")
    expect(steps.get_by_role("link")).to_have_count(3)
    steps.get_by_role("link", name="With both").click()
    expect(page).to_have_url(re.compile("/launch"))
    told = "Starts from R-0002, with step 2.5 ms, with 3\u202f000 samples"
    expect(page.get_by_text(re.compile(re.escape(told).replace("\\ ", r"\s")))).to_be_visible()
    page.get_by_role("button", name="YAML").click()
    expect(page.locator(".cm-line", has_text="step: 0.0025")).to_be_visible()
    expect(page.get_by_text(re.compile(r"if none of the 3\s000 random samples violates"))).to_be_visible()
    visit.shot("reading-next-step", full=False)


def test_a_nominal_case_that_diverged_does_not_hold_the_page(visit: Visit) -> None:
    visit.go("/runs/R-0003")
    page = visit.page
    expect(page.get_by_role("heading", name="Separation over time")).to_be_visible()
    slowest = float(page.evaluate(LONGEST))
    assert slowest < 10_000, f"the page was held for {slowest:.0f} ms at once"
    visit.shot("reading-diverged")


LONGEST = """new Promise(done => {
  let most = 0
  new PerformanceObserver(list => { for (const e of list.getEntries()) most = Math.max(most, e.duration) })
    .observe({type: 'longtask', buffered: true})
  scrollTo(0, document.documentElement.scrollHeight)
  let frames = 20
  const next = () => (frames-- > 0 ? requestAnimationFrame(next) : done(most))
  next()
})"""
"""The longest time for which a script held the page [ms]."""


def test_a_comparison_begins_with_the_older_run_and_can_be_swapped(visit: Visit) -> None:
    visit.move("/runs")
    page = visit.page
    for run in ("R-0004", "R-0001"):
        page.get_by_role("checkbox", name=re.compile(run)).check()
    page.get_by_role("link", name="Compare 2 runs").click()
    runs = page.locator("[data-run]")
    expect(runs).to_have_count(2)
    expect(runs.first).to_have_attribute("data-run", "R-0001")
    expect(runs.last).to_have_attribute("data-run", "R-0004")
    expect(page.get_by_test_id("other-code").first).to_have_text(
        "Same campaign, different code: source files whose names are not stored."
    )
    expect(page.locator("tr[data-code=step]")).to_contain_text("5 ms")
    page.get_by_role("button", name="Swap").click()
    expect(runs.first).to_have_attribute("data-run", "R-0004")
    visit.shot("reading-compare", full=False)


def test_the_changes_since_the_baseline_are_on_the_page(visit: Visit) -> None:
    visit.move("/runs/R-0005")
    page = visit.page
    card = page.locator("#since")
    expect(card.get_by_role("heading", name="Since the baseline")).to_be_visible()
    expect(card.get_by_test_id("policy")).to_have_text("Policy fails")
    rows = card.locator("tbody tr")
    expect(rows).to_have_count(3)
    worse, lost, new = (rows.nth(i) for i in range(3))
    expect(worse.get_by_role("cell")).to_have_text(
        ["Worse fails", "F1", "F1", "+0.90000", "+0.80000", "+0.75000", "\u22120.150", "0.001"]
    )
    expect(lost).to_contain_text("Not compared")
    expect(lost).to_contain_text("no finding")
    expect(new.get_by_role("cell").nth(1)).to_have_text("none")
    expect(card).to_contain_text(OUTSIDE)
    expect(card.get_by_role("link", name="R-0001")).to_have_attribute("href", "/runs/R-0001")
    new.get_by_role("button", name="F2").click()
    expect(page).to_have_url(re.compile("finding=F2"))
    visit.shot("since-baseline", of=card)


def test_a_run_that_is_launched_again_has_its_labels_and_its_baseline(visit: Visit) -> None:
    visit.move("/runs/R-0005")
    page = visit.page
    page.get_by_role("link", name="Run again").first.click()
    expect(page.get_by_text("with its baseline R-0001")).to_be_visible()
    fold = page.locator("details", has_text="Labels and baseline")
    expect(fold.locator("summary")).to_contain_text("branch=slow, baseline R-0001")
    fold.locator("summary").click()
    field = fold.get_by_label("Baseline")
    expect(field).to_have_value("R-0001")
    field.fill("main")
    expect(fold).to_contain_text("“main” is not a baseline")
    expect(page.get_by_role("button", name="Start run")).to_be_disabled()
    field.fill("label:branch=slow")
    with page.expect_request(lambda request: request.method == "POST" and request.url.endswith("/runs")) as sent:
        page.get_by_role("button", name="Start run").click()
    asked = sent.value.post_data_json
    assert isinstance(asked, dict)
    assert (asked["labels"], asked["baseline"]) == ({"branch": "slow"}, "label:branch=slow")


def test_the_verdicts_of_the_list_are_whole_in_a_narrow_window(visit: Visit) -> None:
    page = visit.page
    page.set_viewport_size({"width": 390, "height": 900})
    try:
        visit.go("/runs")
        row = page.get_by_role("row", name=re.compile("R-0002"))
        badge = row.locator("[data-tone]")
        expect(badge).to_have_text("Inconclusive")
        for around in (badge.locator("xpath=ancestor::td"), page.get_by_role("table").locator("xpath=..")):
            assert right(badge) < right(around)
    finally:
        page.set_viewport_size({"width": 1440, "height": 900})
