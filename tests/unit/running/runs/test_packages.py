"""The identity of a run has the version of every package that can change a number of it."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import Any

import pytest

from campaigns import Campaign
from campaigns.asked.load import load_document
from campaigns.stored.records import Begun
from campaigns.versions import OtherCode
from tests.given.case_campaigns import campaign
from worker.engine.systems.simulators.declared.fmu import DescribedFmu
from worker.running.catalogue import installed
from worker.running.runs import begun, identity, sources

OURS = {"campaigns", "worker"}
WITHOUT_NUMBERS = {
    "pydantic": "checks documents, of which the campaign is stored as it was read",
    "pydantic_core": "as pydantic",
    "typing_extensions": "types",
    "yaml": "reads campaigns, which are stored as they were read, and descriptors, whose files have a digest",
    "greenlet": "switches between a search and its caller",
    "dask": "carries requests and answers as they are",
    "distributed": "as dask",
    "mcap": "reads logs before a campaign is written",
    "mcap_ros2": "as mcap",
    "pyulog": "as mcap",
}
"""Packages that the engine imports and that change no number, with the reason."""


def test_every_package_that_the_engine_imports_is_identified_or_changes_no_number() -> None:
    modules = [name for name in identity.loaded() if name.startswith(("worker.engine.", "campaigns."))]
    modules = [name for name in modules if not name.startswith(sources.OWN)]
    imported = {package for name in modules for package in identity._reached(name).packages}
    others = imported - sys.stdlib_module_names - OURS
    assert "scipy" in others
    assert others == {*sources.PACKAGES, *WITHOUT_NUMBERS}


def test_the_versions_are_those_of_packages_that_are_installed() -> None:
    assert {name for name in sources.PACKAGES if sources.LOADED.packages[name] == "not installed"} <= {sources.FMPY}


def attraction() -> Campaign:
    return campaign(stages__attraction={"degree": 2})


def test_a_region_of_attraction_has_the_version_of_its_solver() -> None:
    assert "clarabel" in identity.packages(attraction())
    assert "clarabel" not in identity.packages(campaign())


@pytest.mark.parametrize("fmu", [True, False])
def test_an_fmu_has_the_version_of_what_binds_it(fmu: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    described: Any = DescribedFmu.__new__(DescribedFmu) if fmu else SimpleNamespace()
    monkeypatch.setattr(installed, "simulators", lambda: {"bowl": described})
    asked = load_document(
        {
            "name": "Bowl",
            "simulator": {"name": "bowl"},
            "uncertain": {"simulator.x": {"low": 0.0, "high": 1.0}},
            "criterion": {"result": "d", "threshold": 0.5},
        }
    )
    assert (sources.FMPY in identity.packages(asked)) == fmu


def test_a_run_begun_without_the_version_of_a_package_is_not_taken_for_one_of_other_code() -> None:
    """Earlier versions did not store those of all packages."""
    asked, here = attraction(), identity.versions(attraction())
    fewer = {name: version for name, version in here.packages.items() if name != "clarabel"}
    assert fewer != here.packages
    older = here.model_copy(update={"packages": fewer})
    other = here.model_copy(update={"packages": here.packages | {"clarabel": "0.1"}})
    modules = identity.code(asked).modules
    assert begun.readable(asked.document(), "a run", Begun(older, modules)) == asked
    with pytest.raises(OtherCode, match=r"clarabel was 0\.1"):
        begun.readable(asked.document(), "a run", Begun(other, modules))
