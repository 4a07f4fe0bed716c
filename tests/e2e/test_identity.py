"""Two versions of an own file, run one after the other without a restart, are told apart wherever code is named.

`PLACES` are the places: each says of a run what its code is. `CASES` are the kinds of files; a further kind is a row.
"""

from __future__ import annotations

import csv
import io
import json
import subprocess
import zipfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx
import pytest
import sqlalchemy as sa
from playwright.sync_api import Browser, expect

import clearance.client
from backend.db.engine import connect, default_url, read
from backend.db.tables import Run
from backend.runs.outcomes import outcomes
from backend.scenes.base import setting
from backend.sweeps import sheet
from backend.sweeps.schemas import SweepDetail, SweepPoint
from backend.webhooks import body
from campaigns.identity.identity import Identity
from campaigns.runs import run_number
from clearance.cli import invoke
from tests.e2e.browser import visiting
from tests.e2e.looking import looks
from tests.faults.cases import campaign
from tests.faults.processes import CLEARANCE, until
from tests.faults.serving import Service, serving
from tests.given.at_night import nightly_but
from tests.given.own_files import POST
from tests.given.printed_words import printed_words

pytestmark = [
    pytest.mark.e2e,
    pytest.mark.timeout(420),
    pytest.mark.nightly,
]  # by day what identifies code: tests/api/runs/test_code.py, tests/api/runs/test_onward.py
DRAWS = False
REQUIREMENT = "SYS-1"

PENDULUM = '''"""A length above a wave of the wind."""

import clearance

SHIFT = 0.0


@clearance.simulator(
    parameters={"wind": clearance.Parameter(-1.0, 1.0, nominal=0.0, unit="m/s", text="Wind")},
    results={"height": clearance.Output(unit="m", worse="low")},
)
def pendulum(wind: float) -> float:
    return 2.0 - wind * wind - SHIFT
'''

HELPED = PENDULUM.replace("SHIFT = 0.0", "from lowered import SHIFT")
"""By a module next to it."""
FAR = HELPED.replace(
    "import clearance\n",
    "import sys\nfrom pathlib import Path\n\nimport clearance\n\n"
    'sys.path.insert(0, str(Path(__file__).parents[1] / "elsewhere"))\n',
)
"""By a module of another folder."""


@dataclass(frozen=True)
class Case:
    """A kind of own files. name: in identities; file: from the operator's folder; text: its first version, of which
    `SHIFT` is edited; more: files in that folder; campaign: what runs it;
    published: whether workers publish its digest as soon as it changes."""

    name: str
    file: str
    text: str
    campaign: Callable[[], dict[str, Any]]
    published: bool = True
    what_if: str = "flights"
    more: Mapping[str, str] = field(default_factory=dict)


def past_the_post() -> dict[str, Any]:
    scenario = campaign().document()["scenario"]
    post = {"component": "post_here", "parameters": {"x": 4.0, "y": 4.0}}
    changes: dict[str, Any] = {
        "scenario": {**scenario, "obstacles": [post], "horizon": 10.0},
        "stages": {"sensitivity": None, "search": [{"method": "direct", "evaluations": 20}], "certify": None},
    }
    return stated(campaign(name="Past a post", **changes).document())


def in_the_wind() -> dict[str, Any]:
    search = [{"method": "direct", "evaluations": 20}]
    return stated({
        "name": "In the wind",
        "simulator": {"name": "pendulum"},
        "uncertain": {"simulator.wind": {"low": -0.5, "high": 0.5, "unit": "m/s"}},
        "criterion": {"result": "height", "threshold": 1.0},
        "stages": {"sensitivity": None, "search": search, "certify": None},
    })  # fmt: skip


def stated(document: dict[str, Any]) -> dict[str, Any]:
    return document | {"criterion": document["criterion"] | {"requirements": [REQUIREMENT]}}


CASES = {
    "component": Case("components/post_here.py", "post_here.py", POST, past_the_post),
    "simulator": Case("simulators/pendulum", "pendulum.py", PENDULUM, in_the_wind, published=True, what_if="cases"),
    "helper": Case(
        "simulators/pendulum", "lowered.py", "SHIFT = 0.0\n", in_the_wind, what_if="cases", more={"pendulum.py": HELPED}
    ),
    "helper elsewhere": Case(
        "simulators/pendulum", "../elsewhere/lowered.py", "SHIFT = 0.0\n", in_the_wind, what_if="cases",
        more={"pendulum.py": FAR},
    ),
}  # fmt: skip


@dataclass
class Home:
    """A service, two runs of one campaign by two versions of a file, and a client of it."""

    case: Case
    service: Service
    client: httpx.Client
    folder: Path
    runs: tuple[str, str] = ("", "")
    files: dict[str, Path] = field(default_factory=dict)

    def get(self, path: str, **parameters: Any) -> httpx.Response:
        answer = self.client.get(f"/api/v1{path}", params=parameters)
        assert answer.is_success, answer.text
        return answer

    def edit(self, old: str, new: str) -> None:
        file = self.folder / self.case.file
        text = file.read_text(encoding="utf-8")
        assert old in text
        file.write_text(text.replace(old, new), encoding="utf-8")

    def submit(self, **request: Any) -> dict[str, Any]:
        answer = self.client.post("/api/v1/runs", json={"campaign": self.case.campaign(), **request})
        assert answer.is_success, answer.text
        return dict(answer.json())

    def ended(self, **request: Any) -> str:
        """A run of the campaign by the file as it is now."""
        found = self.submit(**request)
        assert found.get("reused") is None
        run = str(found["id"])
        until(lambda: self.get(f"/runs/{run}").json()["state"] in ("done", "failed"), "it has ended", 120)
        found = self.get(f"/runs/{run}").json()
        assert found["state"] == "done", found["error"]
        return run

    def said(self, *words: str) -> str:
        """What a command prints, whatever its exit code."""
        out = self.files.setdefault("capture", self.folder.parent / "said.txt")
        return _printed(out, words)

    def engine(self) -> sa.Engine:
        return connect(default_url(self.service.data))


def _printed(out: Path, words: tuple[str, ...]) -> str:
    from contextlib import redirect_stderr, redirect_stdout

    with out.open("w", encoding="utf-8") as file, redirect_stdout(file), redirect_stderr(file):
        invoke(list(words))
    return out.read_text(encoding="utf-8")


def in_database(home: Home, said: Callable[[sa.Connection, int], str], run: str) -> str:
    engine = home.engine()
    try:
        with read(engine) as reader:
            return said(reader, run_number(run) or 0)
    finally:
        engine.dispose()


def of_file(kind: str) -> Callable[[Home, str], str]:
    """A file that the command line writes of a run."""

    def said(home: Home, run: str) -> str:
        file = home.folder.parent / f"{run}.{kind}"
        file.unlink(missing_ok=True)
        home.said("follow", run, f"--{kind}", str(file))
        return file.read_text(encoding="utf-8")

    return said


def listed(home: Home, run: str) -> str:
    return next(str(one["code"]) for one in home.get("/runs").json()["items"] if one["id"] == run)


def trend(home: Home, run: str) -> str:
    digest = home.get(f"/runs/{run}").json()["campaign_digest"]
    one = next(one for one in home.get("/trends", campaign=digest).json()["runs"] if one["id"] == run)
    return f"{one['code']} {one['code_changes']}"


def related(home: Home, run: str) -> str:
    other = home.get(f"/runs/{run}/related").json()["runs"][0]
    assert other["differs"] == ["code"]
    return f"{other['code']} {other['code_changes']}"


def compared(home: Home, run: str) -> str:
    other = next(one for one in home.runs if one != run)
    found = home.get(f"/runs/{run}/code", against=other).json()
    assert found["files"] == [{"file": home.case.name, "change": "changed", "component": None}]
    return f"{found['code']} {found['changes']}"


def capsule(home: Home, run: str) -> str:
    packed = zipfile.ZipFile(io.BytesIO(home.get(f"/runs/{run}/exports/capsule-F1.zip").content))
    return json.dumps(json.loads(packed.read("capsule.json"))["versions"])


def signed(home: Home, run: str) -> str:
    """What is said of a sign-off."""
    address = f"/api/v1/runs/{run}/signoffs"
    found = home.get(f"/runs/{run}/signoffs").json()
    if not found["items"]:
        made = home.said("login-link", "--data", str(home.service.data))
        with httpx.Client(base_url=home.client.base_url, timeout=60, trust_env=False) as reviewer:
            reviewer.get("/login", params={"code": made.strip().rpartition("code=")[2]})
            review = {"name": "Ada", "role": "Independent review", "comment": "", "digest": found["digest"]}
            assert (answer := reviewer.post(address, json=review)).status_code == 201, answer.text
    return str(home.get(f"/runs/{run}/signoffs").json()["items"][0]["sentence"])


def recorded(home: Home, run: str) -> str:
    return home.get(f"/runs/{run}/exports/flight-nominal.html").text.partition("<p>Digests")[2][:2000]


def fetched(home: Home, run: str) -> str:
    """By the Python client, which has address and token from the environment."""
    with clearance.client.Client() as client:
        found = client.run(run)
    return f"{found.code} {found.document['identity']}"


def swept(reader: sa.Connection, run_id: int) -> str:
    (found,) = outcomes(reader, [Run.id == run_id])
    points = [SweepPoint(value=1.0, run=found.id, outcome=found)]
    table = sheet.csv_of(SweepDetail.model_construct(path="x", unit="", points=points)).decode()
    return next(csv.DictReader(io.StringIO(table)))["code"]


def matrix(home: Home, run: str) -> str:
    rows = home.get("/requirements").json()["items"]
    one = next(one for row in rows for one in row["runs"] if one["id"] == run)
    return f"{one['code']} {one['changes']}"


def what_if(home: Home, run: str) -> str:
    answer = home.client.post(f"/api/v1/runs/{run}/{home.case.what_if}", json={}, timeout=120)
    assert answer.is_success, answer.text
    return f"{answer.json()['code_changes']} {answer.json()['code_known']}"


def drawn(home: Home, run: str) -> str:
    """What a 3D view says of a simulation by the code of the second run."""
    now = Identity.model_validate(home.get(f"/runs/{home.runs[1]}").json()["identity"])

    def said(reader: sa.Connection, run_id: int) -> str:
        return setting.load(reader, run_id).other_code(now)

    return in_database(home, said, run)


def replayed(home: Home, run: str) -> str:
    """In a process that loads the file as it is now."""
    command = [*CLEARANCE, "replay", run, "--data", str(home.service.data)]
    return subprocess.run(command, capture_output=True, text=True, check=False).stdout


PLACES: dict[str, Callable[[Home, str], str]] = {
    "run": lambda home, run: json.dumps(home.get(f"/runs/{run}").json()["identity"]),
    "runs": listed,
    "components": lambda home, run: json.dumps(home.get(f"/runs/{run}/components").json()["code_changes"]),
    "trends": trend,
    "related": related,
    "compare": compared,
    "sweep.csv": lambda home, run: in_database(home, swept, run),
    "webhook": lambda home, run: in_database(home, lambda reader, n: body.ended(reader, n, ""), run),
    "matrix": matrix,
    "gsn": lambda home, run: home.get("/requirements/export/argument.gsn.yaml").text.partition(f"{run} is")[2][:900],
    "report.html": lambda home, run: home.get(f"/runs/{run}/report.html").text,
    "report.pdf": lambda home, run: printed_words(home.get(f"/runs/{run}/report.pdf").content),
    "recording": recorded,
    "sign-off": signed,
    "client": fetched,
    "run.json": lambda home, run: home.get(f"/runs/{run}/exports/run.json").text.partition('"identity"')[2][:900],
    "capsule": capsule,
    "what-if": what_if,
    "3D view": drawn,
    "junit": of_file("junit"),
    "sarif": of_file("sarif"),
    "summary": of_file("summary"),
    "show": lambda home, run: home.said("show", run),
    "list of runs": lambda home, run: next(x for x in home.said("runs").splitlines() if x.startswith(run)),
    "replay": replayed,
}
NAMED = {
    "run", "related", "compare", "report.html", "report.pdf", "recording", "client", "run.json", "junit", "sarif",
    "summary", "show",
}  # fmt: skip
"""Where the file is named for either version."""
SINCE = {"components", "matrix", "sign-off", "what-if", "3D view", "replay"}
"""Where the first run is compared with what is installed, which names the file; and the second one is not."""
PUBLISHED = {"components", "matrix", "sign-off"}
"""Where what is installed is what workers have published."""


AT_NIGHT = {"simulator", "helper", "helper elsewhere"}


@pytest.fixture(
    scope="module", params=[pytest.param(one, marks=[pytest.mark.nightly] * (one in AT_NIGHT)) for one in CASES]
)
def home(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Home]:
    case, place = CASES[request.param], tmp_path_factory.mktemp("identity")
    folder = place / "own"
    folder.mkdir()
    for file, text in {case.file: case.text, **case.more}.items():
        (folder / file).parent.mkdir(exist_ok=True)
        (folder / file).write_text(text, encoding="utf-8")
    patch = pytest.MonkeyPatch()
    environment = {f"CLEARANCE_{case.name.partition('/')[0].upper()}": str(folder)}
    for variable, value in environment.items():
        patch.setenv(variable, value)
    try:
        with serving(place, **environment) as service:
            address = service.address()
            token = _printed(place / "token", ("token", "create", "ci", "--data", str(service.data))).split()[-1]
            patch.setenv("CLEARANCE_SERVICE", address)
            patch.setenv("CLEARANCE_TOKEN", token)
            headers = {"Authorization": f"Bearer {token}"}
            with httpx.Client(base_url=address, headers=headers, timeout=60, trust_env=False) as client:
                made = Home(case, service, client, folder)
                first = made.ended()
                made.edit("SHIFT = 0.0", "SHIFT = 0.5")
                if case.published:
                    before = made.get(f"/runs/{first}/components").json()["code_installed"]
                    changed = lambda: made.get(f"/runs/{first}/components").json()["code_installed"] != before  # noqa: E731
                    until(changed, "the worker has published the edit", 60)
                made.runs = (first, made.ended(reuse=True) if case.published else made.ended())
                yield made
    finally:
        patch.undo()


@pytest.mark.parametrize("place", nightly_but(PLACES.keys() - {"replay"}, PLACES))
def test_two_versions_are_told_apart(home: Home, place: str) -> None:
    if place in PUBLISHED and not home.case.published:
        pytest.skip("workers publish its digest when they start")
    if place == "report.pdf" and home.case is not CASES["component"]:
        pytest.skip("it is printed from report.html, which takes seconds")
    if place in ("3D view", "recording") and home.case.what_if == "cases":
        pytest.skip("it has no positions to draw")
    first, second = (PLACES[place](home, run) for run in home.runs)
    assert first != second
    if place in NAMED | SINCE:
        assert home.case.name in first
    if place in NAMED:
        assert home.case.name in second
    if place in SINCE:
        assert home.case.name not in second


def test_the_trend_names_the_file_where_it_changed(home: Home) -> None:
    assert home.case.name not in trend(home, home.runs[0])
    assert home.case.name in trend(home, home.runs[1])


def test_the_pages_name_the_file(home: Home, browser: Browser) -> None:
    kind, (first, second), name = "-".join(Path(home.case.file).with_suffix("").parts[-2:]), home.runs, home.case.name
    digest = home.get(f"/runs/{first}").json()["campaign_digest"]
    with visiting(browser, home.service.address()) as visit:
        page = visit.page
        made = home.said("login-link", "--data", str(home.service.data))
        visit.sign_in(made.strip().rpartition("code=")[2])
        visit.go(f"/trends?campaign={digest}")
        expect(page.get_by_text(f"The code changed before {second} ({name})")).to_be_visible()
        expect(page.get_by_text(f"changed: {name}")).to_be_visible()
        looks(visit, f"identity-trends-{kind}")
        visit.move(f"/runs/{first}")
        visit.near("#provenance")
        expect(page.locator("#provenance")).to_contain_text(name)
        visit.near("#related")
        expect(page.locator("#related")).to_contain_text(f"code: {name}")
        if home.case.published:
            visit.near("#components")
            expect(page.locator("#components")).to_contain_text(f"What differs: {name}.")
        page.get_by_role("button", name="What-if").first.click()
        if home.case.what_if == "cases":
            page.get_by_role("button", name="Evaluate").click()
        expect(page.get_by_test_id("what-if-code")).to_contain_text(f"Simulated by other code than this run: {name}.")
        looks(visit, f"identity-run-{kind}")
        visit.shot(f"identity-what-if-{kind}", of=page.locator("#what-if"))
        visit.go(f"/api/v1/runs/{first}/report.html")
        expect(page.get_by_text(name, exact=True)).to_be_visible()
        visit.shot(f"identity-report-{kind}")
        visit.go(f"/compare?runs={first},{second}")
        expect(page.locator("#code")).to_contain_text(name)
        visit.shot(f"identity-compare-{kind}")
