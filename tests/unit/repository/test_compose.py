"""The compose file and the image: network access, users, secrets, health checks, and the settings that it names."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest
import yaml

from backend.settings import _OTHERS, Settings
from tools.healthy import CHECKS

REPOSITORY = Path(__file__).parents[3]
ENVIRONMENT = REPOSITORY / "deploy" / "postgres.env"
OWN = {"backend", "worker", "scheduler", "node"}
"""Services of this project's image."""


@pytest.fixture
def document() -> dict[str, Any]:
    document: dict[str, Any] = yaml.safe_load((REPOSITORY / "docker-compose.yml").read_text())
    return document


@pytest.fixture
def services(document: dict[str, Any]) -> dict[str, Any]:
    services: dict[str, Any] = document["services"]
    return services


def test_only_the_backend_is_published_and_only_on_the_loopback_address(services: dict[str, Any]) -> None:
    published = {name: service["ports"] for name, service in services.items() if "ports" in service}
    assert published == {"backend": ["127.0.0.1:${CLEARANCE_PORT:-8000}:8000"]}
    assert services["backend"]["environment"]["CLEARANCE_ALLOW_ANY_HOST"] == "true"
    assert not [
        name
        for name, service in services.items()
        if name != "backend" and "CLEARANCE_ALLOW_ANY_HOST" in service.get("environment", {})
    ]
    assert not any("network_mode" in service for service in services.values())


def test_every_service_has_a_health_check_is_started_again_and_has_no_rights(services: dict[str, Any]) -> None:
    for service in services.values():
        assert service["healthcheck"]["test"][0] == "CMD"
        assert (service["read_only"], service["cap_drop"], service["init"]) == (True, ["ALL"], True)
        assert service["security_opt"] == ["no-new-privileges:true"]
        assert service["restart"] == "unless-stopped"
        assert not {"privileged", "cap_add", "devices", "pid", "container_name"} & set(service)
    assert re.fullmatch(r"[1-9]\d*:[1-9]\d*", services["postgres"]["user"]), "the image's own user is root"
    checks = {each["healthcheck"]["test"][-1] for name, each in services.items() if name in OWN - {"worker"}}
    assert checks <= set(CHECKS)


def test_without_a_profile_there_are_the_service_and_its_workers_on_the_volume_of_earlier_versions(
    document: dict[str, Any], services: dict[str, Any]
) -> None:
    assert {name for name, service in services.items() if "profiles" not in service} == {"backend", "worker"}
    for name in ("backend", "worker"):
        assert "data:/data" in services[name]["volumes"]
        assert services[name]["environment"]["CLEARANCE_DATABASE"] == "${CLEARANCE_DATABASE:-}"
    assert document["volumes"]["data"] is None


def test_no_service_waits_for_one_that_waits_for_it(services: dict[str, Any]) -> None:
    """The backend is healthy once a worker is alive, so that a worker that waits for its health would wait for ever."""
    assert services["backend"]["healthcheck"]["test"][-1] == "ready"
    assert services["worker"]["depends_on"] == {"backend": {"condition": "service_started"}}
    assert "depends_on" not in services["backend"]


def test_simulators_components_and_secrets_are_read_only_where_the_settings_name_them(services: dict[str, Any]) -> None:
    for name, service in services.items():
        mounted = [volume.rsplit(":", 2) for volume in service["volumes"] if "FOLDER" in volume]
        assert all(mode == "ro" for _, _, mode in mounted), name
        targets = {target for _, target, _ in mounted}
        given = service.get("environment", {})
        for setting in ("CLEARANCE_SIMULATORS", "CLEARANCE_COMPONENTS"):
            assert (setting in given) == (given.get(setting) in targets), (name, setting)
    for name in ("backend", "worker"):
        given = services[name]["environment"]
        assert (given["CLEARANCE_SIMULATORS"], given["CLEARANCE_COMPONENTS"]) == ("/simulators", "/components")
        assert [each for each in services[name]["tmpfs"] if each.startswith("/tmp:exec")], "libraries of FMUs"


def test_every_variable_is_a_setting_and_no_secret_is_written_down(services: dict[str, Any]) -> None:
    for name in OWN:
        given: dict[str, str] = services[name].get("environment", {})
        assert Settings.unknown(given) == [], name
        for variable in Settings.secret():
            assert given.get(variable, "") in ("", f"${{{variable}:-}}"), "it comes from outside"
        files = {variable for variable in given if variable.endswith("_FILE")}
        assert files <= {f"{variable}_FILE" for variable in Settings.secret()}
    assert "POSTGRES_PASSWORD" not in services["postgres"]["environment"]


def test_variables_for_the_file_are_those_that_it_reads() -> None:
    text = (REPOSITORY / "docker-compose.yml").read_text()
    read = set(re.findall(r"\$\{(\w+)", text))
    given = dict(line.split("=", 1) for line in ENVIRONMENT.read_text().splitlines() if line[:1] not in ("#", ""))
    assert set(given) - {"COMPOSE_PROFILES"} <= read
    settings = Settings.load({**given, "CLEARANCE_DATABASE_PASSWORD_FILE": str(REPOSITORY / "README.md")})
    assert settings.database.startswith("postgresql://clearance@postgres/clearance")
    own = {"CLEARANCE_SIMULATORS_FOLDER", "CLEARANCE_COMPONENTS_FOLDER", "CLEARANCE_SECRETS_FOLDER"}
    known = set(_OTHERS) | {f"CLEARANCE_{name.upper()}" for name in Settings.model_fields}
    known |= {f"{name}_FILE" for name in Settings.secret()} | own | {"CLEARANCE_NODE_THREADS"}
    assert read <= known
    documented = (REPOSITORY / "docs" / "operation.md").read_text() + (REPOSITORY / "docs" / "access.md").read_text()
    assert not [name for name in read if name.removesuffix("_FILE") not in documented]


def test_images_of_others_are_named_by_digest(services: dict[str, Any]) -> None:
    images = [service["image"] for name, service in services.items() if name not in OWN]
    images += re.findall(r"^ARG \w+_IMAGE=(\S+)$", (REPOSITORY / "Dockerfile").read_text(), re.MULTILINE)
    assert len(images) == 3
    assert all(re.fullmatch(r"[\w.-]+:[\w.-]+@sha256:[0-9a-f]{64}", image) for image in images)


def test_the_image_runs_as_an_unprivileged_user() -> None:
    lines = (REPOSITORY / "Dockerfile").read_text().splitlines()
    assert re.fullmatch(r"USER [1-9]\d+:[1-9]\d+", next(line for line in lines if line.startswith("USER")))
    steps = [line.removeprefix("RUN tools/image.sh ") for line in lines if line.startswith("RUN tools/")]
    script = (REPOSITORY / "tools" / "image.sh").read_text()
    assert steps == ["system", "packages", "app", "pages"]
    assert all(f"\n{step}() {{" in script for step in steps)


@pytest.mark.parametrize("options", [[], ["--env-file", str(ENVIRONMENT)]])
def test_compose_itself_accepts_the_file(options: list[str]) -> None:
    commands = [["docker", "compose"], ["docker-compose"]]
    environment = {name: value for name, value in os.environ.items() if not name.startswith("CLEARANCE_")}
    for command in commands:
        if shutil.which(command[0]) and subprocess.run([*command, "version"], capture_output=True).returncode == 0:
            done = subprocess.run(
                [*command, *options, "config"], cwd=REPOSITORY, capture_output=True, text=True, check=False,
                env=environment,
            )  # fmt: skip
            assert done.returncode == 0, done.stderr
            return
    pytest.skip("neither `docker compose` nor `docker-compose` is installed")
