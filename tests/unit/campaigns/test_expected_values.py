"""No problem of a campaign, or of a simulator's description, has the words of pydantic: every value is replaced."""

from __future__ import annotations

import copy
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

from campaigns import CampaignError, library, load_file
from campaigns.asked.load import load_document
from tests.faults.processes import REPOSITORY
from tests.given.at_night import nightly_but
from tests.simulators import noisy
from worker.engine.systems.simulators.declared import descriptor
from worker.engine.systems.simulators.declared.described import BadDescriptor

WRONG: list[Any] = [
    *(None, "", "x", "y" * 20_001, [], [1], ["x"] * 200, {}, {"a": 1}),
    *(True, 0, 1, -1, 1.5, -1e11, 1e11, float("inf"), 2**70),
]
RAW = re.compile(
    r"[Ii]nput should|should (have|be|match)|valid (dictionary|list|string|tuple|number)|Value error"
    r"|[Ff]ield required|not permitted|validation|unable to"
)
Dumper: Any = getattr(yaml, "CSafeDumper", yaml.SafeDumper)
DESCRIBED = REPOSITORY / "docs" / "examples" / "mass_spring" / "simulator.yaml"
Place = tuple[str | int, ...]


def places(document: Any, at: Place = ()) -> Iterator[Place]:
    """Every location, of a list the first entry."""
    if at:
        yield at
    inside: Iterable[tuple[str | int, Any]] = document.items() if isinstance(document, dict) else ()
    if isinstance(document, list):
        inside = enumerate(document[:1])
    for key, value in inside:
        yield from places(value, (*at, key))


def changed(document: Any) -> Iterator[Any]:
    """The document with another value, without a key, and with an unknown one, everywhere."""
    for *above, last in places(document):
        for value in WRONG:
            made = copy.deepcopy(document)
            held = made
            for key in above:
                held = held[key]
            held[last] = value
            yield made
        if isinstance(last, str):
            del held[last]
            yield made
            held["unknown"] = 1
            yield made


SHIPPED = ("unicycle_static", "uav_moving_gusts", "unicycle_latency")
CAMPAIGNS = {name: load_file(library()[name]).document() for name in SHIPPED}
CAMPAIGNS["simulator"] = noisy.campaign(repeats={"count": 5}).document()


@pytest.mark.parametrize("name", nightly_but(("unicycle_static", "simulator"), CAMPAIGNS))
def test_no_problem_of_a_campaign_is_in_the_words_of_pydantic(name: str) -> None:
    found = set()
    for document in changed(CAMPAIGNS[name]):
        try:
            load_document(document)
        except CampaignError as error:
            found |= {problem.message for problem in error.problems}
    assert len(found) > 20
    assert [message for message in found if RAW.search(message)] == []


def test_no_problem_of_a_description_is_in_the_words_of_pydantic(tmp_path: Path) -> None:
    found = set()
    for document in changed(yaml.safe_load(DESCRIBED.read_text(encoding="utf-8"))):
        (tmp_path / "simulator.yaml").write_text(yaml.dump(document, Dumper=Dumper), encoding="utf-8")
        try:
            descriptor.read(tmp_path)
        except BadDescriptor as error:
            found.add(str(error).removeprefix(str(tmp_path)))
    assert len(found) > 20
    assert [message for message in found if RAW.search(message)] == []
