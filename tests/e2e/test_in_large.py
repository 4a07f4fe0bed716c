"""What is stated in large is the same everywhere: the worst value that every evaluation grants, a missing sample, how
sure the search is."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterator
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import Browser, expect

from campaigns.claims.sureness import sureness
from campaigns.results.finding import Finding
from campaigns.results.sureness import Sureness
from campaigns.results.verdict import Check
from clearance.cli import invoke
from tests import results
from tests.e2e.browser import visiting
from tests.e2e.looking import looks
from tests.e2e.stored import served
from tests.given.reported_runs import PARAMETERS, finish_fully
from tests.given.service import Service
from tests.given.submissions import altered, submit

pytestmark = [pytest.mark.e2e, pytest.mark.timeout(240), pytest.mark.nightly]  # by day tests/unit/campaigns/claims
DRAWS = False
EVALUATED, GRANTED, THRESHOLD = 0.261, 0.495, 0.5
DIFFERING, LACKING, CALLED = "R-0001", "R-0002", "R-0003"
"""A violation whose evaluations differ; a run that lacks a sample only; one that an earlier version called cleared."""
SURE = Sureness(chance=0.0437, lower=0.0104, landscapes=1234, statement=sureness(0.0437, 0.0104, "m", 1234))
"""Of the one that lacks a sample; the others have none."""


@dataclass(frozen=True)
class Home:
    service: Service
    client: httpx.Client
    folder: Path

    def text(self, path: str) -> str:
        answer = self.client.get(f"/api/v1{path}")
        assert answer.is_success, answer.text
        return answer.text

    def printed(self, *words: str) -> str:
        out = io.StringIO()
        with redirect_stdout(out), redirect_stderr(out):
            invoke(list(words))
        return out.getvalue()

    def written(self, kind: str, run: str) -> str:
        file = self.folder / f"{run}.{kind}"
        file.unlink(missing_ok=True)
        self.printed("follow", run, f"--{kind}", str(file))
        return file.read_text(encoding="utf-8")


def differing() -> Finding:
    """Confirmed by every integration, of which DOP853 grants the least."""
    one = results.validation("F1", EVALUATED, agrees=False, violates=True)
    assert one.integrator is not None
    other = one.integrator.model_copy(update={"cost": GRANTED, "difference": GRANTED - EVALUATED})
    case = one.model_copy(update={"integrator": other})
    return results.finding("F1", EVALUATED, EVALUATED - THRESHOLD, PARAMETERS, validation=case)


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Home]:
    folder = tmp_path_factory.mktemp("large")
    holds = Check(code="nominal", ok=True, statement=results.statement("margin +0.9 m"))
    sample = Check(code="sample", ok=False, statement=results.statement("no independent sample was drawn"))
    with served(folder / "data") as service, service.signed_in() as client, pytest.MonkeyPatch.context() as patch:
        patch.setenv("CLEARANCE_SERVICE", service.url)
        patch.setenv("CLEARANCE_TOKEN", service.token())
        submit(client, **altered("scenario", "horizon", value=16))  # another question: it speaks against no other run
        finish_fully(service, "violated", found=[differing()], worst=GRANTED)
        for lacks in (True, False):
            submit(client)
            if lacks:
                finish_fully(service, "inconclusive", checks=[holds, sample], statistics=None, sureness=SURE)
            else:
                finish_fully(service, "cleared", checks=[holds], statistics=None)
        yield Home(service, client, folder)


def sheet(home: Home, run: str) -> str:
    rows = csv.DictReader(io.StringIO(home.text(f"/runs/{run}/exports/findings.csv")))
    row = next(row for row in rows if row["flight"] == "F1")
    assert row["evaluated"] == repr(EVALUATED)
    return " ".join(row.values())


VALUES: dict[str, Callable[[Home, str], str]] = {
    "run": lambda home, run: str(home.client.get(f"/api/v1/runs/{run}").json()["worst_cost"]),
    "list of runs": lambda home, run: home.text("/runs"),
    "findings": lambda home, run: str(home.client.get(f"/api/v1/runs/{run}/findings").json()[0]["granted"]),
    "report.html": lambda home, run: home.text(f"/runs/{run}/report.html").partition("4. Worst cases")[2][:1500],
    "findings.csv": sheet,
    "junit": lambda home, run: home.written("junit", run),
    "sarif": lambda home, run: home.written("sarif", run),
    "show": lambda home, run: home.printed("show", run),
}


@pytest.mark.parametrize("place", VALUES)
def test_the_value_that_every_evaluation_grants(home: Home, place: str) -> None:
    assert str(GRANTED) in VALUES[place](home, DIFFERING)


@pytest.mark.parametrize("place", ["report.html", "junit", "sarif", "show"])
def test_the_evaluated_value_is_beside_it(home: Home, place: str) -> None:
    assert f"evaluated {EVALUATED}" in VALUES[place](home, DIFFERING).replace("evaluated as", "evaluated")


def report(home: Home, run: str) -> bool:
    (found,) = (one for one in home.client.get("/api/v1/reports").json()["items"] if one["run"] == run)
    return bool(found["not_sampled"])


WORDED = ("run", "report.html", "show")
"""Places of which each run is told by day: the service, a file, a command. All places tell it of `LACKING`."""


LARGE: dict[str, Callable[[Home, str], bool]] = {
    "run": lambda home, run: bool(home.client.get(f"/api/v1/runs/{run}").json()["not_sampled"]),
    "reports": report,
    "report.html": lambda home, run: ": not sampled" in home.text(f"/runs/{run}/report.html"),
    "junit": lambda home, run: ': not sampled"' in home.written("junit", run),
    "sarif": lambda home, run: ': not sampled"' in home.written("sarif", run),
    "summary": lambda home, run: ": not sampled" in home.written("summary", run).splitlines()[0],
    "show": lambda home, run: ": not sampled" in home.printed("show", run).splitlines()[0],
    "runs": lambda home, run: any(
        line.startswith(run) and ": not sampled" in line for line in home.printed("runs").splitlines()
    ),
}


@pytest.mark.parametrize(
    ("run", "lacks", "place"),
    [
        pytest.param(run, lacks, place, marks=[] if run == LACKING or place in WORDED else [pytest.mark.nightly])
        for run, lacks in ((DIFFERING, False), (LACKING, True), (CALLED, True))
        for place in LARGE
    ],
)
def test_a_missing_sample_is_stated(home: Home, run: str, lacks: bool, place: str) -> None:
    if (place, run) == ("junit", CALLED):
        pytest.skip("what is cleared is no failure, and has no type")
    assert LARGE[place](home, run) == lacks


SURENESS: dict[str, Callable[[Home, str], str]] = {
    "run": lambda home, run: str(
        (home.client.get(f"/api/v1/runs/{run}").json()["summary"].get("sureness") or {}).get("text")
    ),
    "report.html": lambda home, run: home.text(f"/runs/{run}/report.html"),
    "junit": lambda home, run: home.written("junit", run),
    "sarif": lambda home, run: home.written("sarif", run),
    "summary": lambda home, run: home.written("summary", run),
    "show": lambda home, run: home.printed("show", run),
    "follow": lambda home, run: home.printed("follow", run),
}


@pytest.mark.parametrize(
    ("run", "known", "place"),
    [
        pytest.param(run, known, place, marks=[] if run == LACKING or place in WORDED else [pytest.mark.nightly])
        for run, known in ((DIFFERING, False), (LACKING, True))
        for place in SURENESS
    ],
)
def test_how_sure_the_search_is(home: Home, run: str, known: bool, place: str) -> None:
    text = " ".join(SURENESS[place](home, run).split())
    assert ("about 4.4 %" in text and "1 234 random" in text) == known
    assert ("not a bound" in text) == known


@pytest.mark.nightly  # by day every other place, above
def test_the_pages_show_each_record(home: Home, browser: Browser) -> None:
    with visiting(browser, home.service.url) as visit:
        page = visit.page
        visit.sign_in(home.service.login_code())
        visit.go(f"/runs/{DIFFERING}")
        row = page.locator("tr[data-finding=F1]")
        expect(row).to_contain_text(str(GRANTED))
        expect(row).to_contain_text(f"evaluated {EVALUATED}")
        looks(visit, "granted-run")
        visit.move(f"/runs/{LACKING}")
        expect(page.get_by_test_id("verdict")).to_have_text("Inconclusive: not sampled")
        expect(page.get_by_test_id("sureness")).to_contain_text("4.4\u202f%")
        looks(visit, "not-sampled-run")
        visit.move(f"/runs/{CALLED}")
        expect(page.get_by_test_id("verdict")).to_have_text("Cleared: not sampled")
        for path in ("/reports", "/runs"):
            visit.move(path)
            expect(page.get_by_text("Inconclusive: not sampled")).to_be_visible()
            expect(page.get_by_text("Cleared: not sampled")).to_be_visible()
            looks(visit, f"not-sampled{path.replace('/', '-')}")
        visit.go(f"/api/v1/runs/{DIFFERING}/report.html")
        visit.shot("granted-report")
        visit.go(f"/api/v1/runs/{LACKING}/report.html")
        expect(page.get_by_text("Inconclusive: not sampled")).to_be_visible()
        visit.shot("not-sampled-report")
