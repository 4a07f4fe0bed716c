"""The examples of `deploy/`: read by the programs they are for where these are installed, and of metrics that exist."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from configparser import RawConfigParser
from pathlib import Path

import pytest

from backend.db.engine import connect
from backend.db.space import Room
from backend.db.tables import Base
from backend.metrics.requests import Requests
from backend.metrics.service import Metrics
from backend.settings import Settings

DEPLOY = Path(__file__).parents[3] / "deploy"
UNITS = sorted(DEPLOY.glob("*.service"))
TIMERS = sorted(DEPLOY.glob("*.timer"))


@pytest.mark.parametrize("unit", UNITS, ids=lambda unit: unit.name)
def test_units_are_read_and_have_settings_that_exist(unit: Path, tmp_path: Path) -> None:
    text = unit.read_text()
    parser = RawConfigParser(strict=False)
    parser.read_string(text)
    timed = unit.with_suffix(".timer") in TIMERS
    assert {"Unit", "Service"} | (set() if timed else {"Install"}) == set(parser.sections())
    environment = dict(re.findall(r"^Environment=(\w+)=(\S+)$", text, re.MULTILINE))
    assert environment
    assert list(Settings.unknown(environment)) == []
    if "backend" in text:
        Settings.load(environment)
    verify = shutil.which("systemd-analyze")
    if verify is None:
        return
    copy = tmp_path / unit.name.replace("@", "@1" if "@." in unit.name else "@")
    copy.write_text(re.sub(r"/opt/clearance/bin/\w+", "/bin/true", text).replace("User=clearance\n", ""))
    done = subprocess.run([verify, "verify", str(copy)], capture_output=True, text=True, timeout=60, check=False)
    wrong = [line for line in done.stderr.splitlines() if unit.name.partition("@")[0] in line and "Unknown" in line]
    assert wrong == []


@pytest.mark.parametrize("timer", TIMERS, ids=lambda timer: timer.name)
def test_timers_start_a_unit_that_is_there_at_times_that_are_read(timer: Path) -> None:
    parser = RawConfigParser()
    parser.read_string(timer.read_text())
    assert {"Unit", "Timer", "Install"} == set(parser.sections())
    assert timer.with_suffix(".service") in UNITS
    verify = shutil.which("systemd-analyze")
    if verify is not None:
        subprocess.run([verify, "calendar", parser["Timer"]["OnCalendar"]], capture_output=True, timeout=60, check=True)


def test_the_dashboard_shows_metrics_that_exist(tmp_path: Path) -> None:
    engine = connect(f"sqlite:///{tmp_path}/clearance.sqlite3")
    Base.metadata.create_all(engine)
    requests = Requests()
    requests.note(("GET", "/", "2xx"), 0.1)
    metrics = Metrics(Room((DEPLOY,), 0), requests)
    text = metrics.text(engine, {"pdf": 0})
    engine.dispose()
    known = set(re.findall(r"^(\w+)[{ ]", text, re.MULTILINE))
    asked = [target["expr"] for panel in json.loads((DEPLOY / "grafana.json").read_text())["panels"]
             for target in panel["targets"]]  # fmt: skip
    names = {name for expression in asked for name in re.findall(r"clearance_\w+", expression)}
    assert names
    assert names <= known


@pytest.mark.parametrize("name", ["nginx.conf", "Caddyfile"])
def test_proxies_keep_the_metrics_inside_and_close_their_brackets(name: str) -> None:
    text = "\n".join(line.partition("#")[0] for line in (DEPLOY / name).read_text().splitlines())
    assert text.count("{") == text.count("}") > 0
    assert "/metrics" in text
    assert "127.0.0.1:8000" in text
    if name == "nginx.conf":
        lines = [line.strip() for line in text.splitlines() if line.strip()]
        assert all(line[-1] in "{};" for line in lines)
