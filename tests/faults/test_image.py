"""The image and the compose file, without an engine: the Dockerfile's own steps on Debian's packages, and its services
started read-only and without rights, as a team uses them.
"""

from __future__ import annotations

import re
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from tests.faults.image.build import built
from tests.faults.image.containers import Container
from tests.faults.image.dockerfile import Stage
from tests.faults.image.team import PASSWORD, Team, team
from tests.faults.processes import until

pytestmark = [pytest.mark.nightly, pytest.mark.timeout(3600)]  # the build fetches 500 MB of packages

CAMPAIGNS = {
    "of the library": "unicycle_static",
    "a program of one's own": "/app/docs/examples/campaigns/mass_spring.yaml",
    "an FMU of one's own": "/app/docs/examples/campaigns/fmu_drop.yaml",
    "a component of one's own": "/components/my_robot.yaml",
}


@pytest.fixture(scope="module")
def image() -> Iterator[Stage]:
    with tempfile.TemporaryDirectory(prefix="image", dir="/var/tmp") as folder:
        yield built(Path(folder))


class Started(Team):
    """A team whose service and worker run."""

    backend: Container
    worker: Container


@pytest.fixture(scope="module", params=["sqlite", "postgresql"])
def running(
    request: pytest.FixtureRequest, image: Stage, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Started]:
    with team(image, tmp_path_factory.mktemp("team"), request.param) as one, ExitStack() as stack:
        one.__class__ = Started
        assert isinstance(one, Started)
        one.backend = stack.enter_context(one.running("backend"))
        one.worker = stack.enter_context(one.running("worker"))
        until(lambda: one.backend.healthy() and one.worker.healthy(), "healthy", 200)
        made = one.backend.run("clearance", "token", "create", "team", "--scope", "run")
        assert made.returncode == 0, made.stderr
        one.token = made.stdout.split()[-1]
        yield one


def submitted(running: Started, campaign: str) -> str:
    """The name of a run that has ended with a verdict."""
    command = ["env", f"CLEARANCE_TOKEN={running.token}", "clearance", "submit", campaign]
    done = running.backend.run(*command)
    assert done.returncode in (0, 1, 2), (done.stdout, done.stderr, running.worker.text()[-2000:])
    found = re.search(r"R-\d{4}", done.stdout + done.stderr)
    assert found, done.stdout
    return found[0]


def test_the_service_is_ready_once_a_worker_is_alive(image: Stage, tmp_path: Path) -> None:
    with team(image, tmp_path, "sqlite") as one, one.running("backend") as backend:
        until(lambda: backend.run("python", "/app/tools/healthy.py", "live").returncode == 0, "alive", 100)
        refused = backend.run(*backend.service.check)
        assert refused.returncode == 1
        assert "503" in refused.stderr
        with one.running("worker") as worker:
            until(lambda: worker.healthy() and backend.healthy(), "healthy", 200)


def test_nothing_but_data_and_temporary_files_can_be_written_and_there_are_no_rights(running: Started) -> None:
    for container in (running.backend, running.worker):
        for folder in ("/", "/app", "/etc", "/run", "/simulators", "/components", "/run/secrets"):
            assert container.run("touch", f"{folder}/x").returncode != 0, folder
        for folder in ("/tmp", "/data"):
            assert container.run("touch", f"{folder}/x").returncode == 0, folder
        status = container.run("cat", "/proc/self/status").stdout
        assert re.search(r"^Uid:\s+10001\s+10001", status, re.MULTILINE)
        assert re.search(r"^Groups:\s*$", status, re.MULTILINE)
        assert set(re.findall(r"^Cap(?:Prm|Eff|Bnd):\s+(\w+)$", status, re.MULTILINE)) == {"0" * 16}
        assert re.search(r"^NoNewPrivs:\s+1$", status, re.MULTILINE)


@pytest.mark.parametrize("what", CAMPAIGNS)
def test_a_campaign_gets_its_verdict_and_its_report_as_pdf(running: Started, what: str) -> None:
    run = submitted(running, CAMPAIGNS[what])
    answer = running.get(f"/api/v1/runs/{run}/report.pdf")
    assert (answer.status_code, answer.content[:5]) == (200, b"%PDF-"), answer.text[:2000]
    assert len(answer.content) > 20_000


def test_the_pages_and_the_guides_are_there(running: Started) -> None:
    page = running.get("/help/guides/cluster")
    assert page.status_code == 200
    names = [path.name for path in (running.image.root / "app/frontend/dist/assets").iterdir()]
    texts = running.get("/assets/" + next(name for name in names if re.fullmatch(r"texts-.+\.js", name))).text
    titles = [file.read_text("utf-8").splitlines()[0] for file in (running.image.root / "app/docs").glob("*.md")]
    assert [title for title in titles if title not in texts] == []
    scripts = re.findall(r'(?:src|href)="/?(assets/[^"]+)"', page.text)
    assert scripts
    assert {running.get(f"/{name}").status_code for name in scripts} == {200}
    copied = running.backend.run("clearance", "examples", "/tmp/examples")
    assert copied.returncode == 0, copied.stderr


def test_no_password_is_in_the_environment_or_a_log(running: Started) -> None:
    if not running.services["backend"].environment["CLEARANCE_DATABASE"]:
        pytest.skip("SQLite has no password")
    for container in (running.backend, running.worker):
        assert container.run("cat", "/run/secrets/database_password").stdout.strip() == PASSWORD
        assert PASSWORD not in container.run("env").stdout + container.text()


def test_a_secret_that_the_user_of_the_container_cannot_read_is_named(running: Started) -> None:
    file = running.folder / "secrets" / "of_root"
    file.write_text("x", encoding="utf-8")
    file.chmod(0o400)
    given = ["CLEARANCE_WEBHOOK_SECRET_FILE=/run/secrets/of_root", "CLEARANCE_DATA=/tmp/other"]
    ended = running.backend.run("env", *given, "python", "-P", "-m", "backend")
    assert ended.returncode == 2
    assert "CLEARANCE_WEBHOOK_SECRET_FILE" in ended.stderr
    assert "/run/secrets/of_root" in ended.stderr


def test_what_is_wrong_with_an_installation_is_nothing(running: Started) -> None:
    found = running.backend.run("clearance", "doctor")
    assert "FAILED" not in found.stdout, found.stdout
    assert re.search(r"^ok +Chromium", found.stdout, re.MULTILINE), found.stdout


def test_a_simulator_evaluates_on_the_nodes_of_dask(image: Stage, tmp_path: Path) -> None:
    with team(image, tmp_path, "sqlite") as one, ExitStack() as stack:
        one.__class__ = Started
        assert isinstance(one, Started)
        scheduler = stack.enter_context(one.running("scheduler"))
        node = stack.enter_context(one.running("node"))
        until(lambda: scheduler.healthy() and node.healthy(), "a cluster", 100)
        one.services["worker"].environment["CLEARANCE_EVALUATOR"] = "dask://scheduler:8786"
        one.backend = stack.enter_context(one.running("backend"))
        one.worker = stack.enter_context(one.running("worker"))
        until(lambda: one.backend.healthy() and one.worker.healthy(), "healthy", 200)
        one.token = one.backend.run("clearance", "token", "create", "team").stdout.split()[-1]
        submitted(one, CAMPAIGNS["a program of one's own"])
        assert "tcp://" in node.text(), "it was registered"
