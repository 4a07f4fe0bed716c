"""The compose file and the image: network access, users, and health checks."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest
import yaml

REPOSITORY = Path(__file__).parents[3]


@pytest.fixture
def services() -> dict[str, Any]:
    document: dict[str, Any] = yaml.safe_load((REPOSITORY / "docker-compose.yml").read_text())
    assert document["volumes"] == {"data": None}
    services: dict[str, Any] = document["services"]
    return services


def test_only_the_backend_is_published_and_only_on_the_loopback_address(services: dict[str, Any]) -> None:
    published = {name: service.get("ports", []) for name, service in services.items()}
    assert published == {"backend": ["127.0.0.1:${CLEARANCE_PORT:-8000}:8000"], "worker": []}
    assert services["backend"]["environment"]["CLEARANCE_ALLOW_ANY_HOST"] == "true"
    assert "CLEARANCE_ALLOW_ANY_HOST" not in services["worker"]["environment"]
    assert not any("network_mode" in service for service in services.values())


def test_every_service_has_a_health_check_the_volume_and_no_rights(services: dict[str, Any]) -> None:
    for service in services.values():
        assert service["healthcheck"]["test"][0] == "CMD"
        assert service["volumes"] == ["data:/data"]
        assert (service["read_only"], service["cap_drop"], service["init"]) == (True, ["ALL"], True)
    assert "container_name" not in services["worker"], "a fixed name cannot be scaled"


def test_the_image_runs_as_an_unprivileged_user() -> None:
    lines = (REPOSITORY / "Dockerfile").read_text().splitlines()
    assert re.fullmatch(r"USER [1-9]\d+:[1-9]\d+", next(line for line in lines if line.startswith("USER")))
    steps = [line.removeprefix("RUN tools/image.sh ") for line in lines if line.startswith("RUN tools/")]
    script = (REPOSITORY / "tools" / "image.sh").read_text()
    assert steps == ["packages", "app", "pages"]
    assert all(f"\n{step}() {{" in script for step in steps)


def test_compose_itself_accepts_the_file() -> None:
    commands = [["docker", "compose"], ["docker-compose"]]
    for command in commands:
        if shutil.which(command[0]) and subprocess.run([*command, "version"], capture_output=True).returncode == 0:
            done = subprocess.run([*command, "config"], cwd=REPOSITORY, capture_output=True, text=True, check=False)
            assert done.returncode == 0, done.stderr
            return
    pytest.skip("neither `docker compose` nor `docker-compose` is installed")
