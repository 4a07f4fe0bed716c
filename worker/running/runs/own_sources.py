"""The source of the components and methods of a campaign that are not shipped, as this process loaded it.

A run stores it when it begins, so that its capsules can be replayed where they are not installed. Simulators are
programs of their own and are not part of it.
"""

from __future__ import annotations

import hashlib
import importlib.util
from collections.abc import Iterable, Iterator

from campaigns.asked.spec import Campaign
from campaigns.capsules.sources import LARGEST, LARGEST_OF_ALL, MOST_FILES, EntryPoint, SourceFile, Sources
from campaigns.checked.check import parts
from worker.running.catalogue import installed
from worker.running.runs import sources
from worker.running.runs.sources import within


def added(campaign: Campaign) -> tuple[Sources, dict[str, bytes]] | None:
    """The files, and their texts by module; None if all is shipped, or if there are too many or too large files."""
    components = [installed.components().get((role, part.component)) for _, _, role, part in parts(campaign)]
    used = [component for component in components if component is not None]
    methods = [installed.methods().get(search.method) for search in campaign.stages.search]
    homes = {installed.source_of(thing).__name__ for thing in [*used, *(m for m in methods if m is not None)]}
    foreign = [home for home in homes if not home.startswith("worker.")]
    modules, entries = list(installed.own_modules(used)), []
    if foreign:
        modules += _of_packages(foreign)
        entries = list(_entries(foreign))
    texts = {name: sources.LOADED.files[name] for name in modules if name in sources.LOADED.files}
    sizes = [len(text) for text in texts.values()]
    if not sizes or len(sizes) > MOST_FILES or max(sizes) > LARGEST or sum(sizes) > LARGEST_OF_ALL:
        return None
    files = [
        SourceFile(module=name, package=_is_package(name), digest=hashlib.sha256(text).hexdigest())
        for name, text in sorted(texts.items())
    ]
    return Sources(files=tuple(files), entries=tuple(entries[:MOST_FILES])), texts


def _of_packages(homes: Iterable[str]) -> list[str]:
    """The Python files of the packages that contain these modules."""
    found = []
    for name in sorted({name for name, _, _ in sources.added_places() if any(within(home, name) for home in homes)}):
        for module in sources.LOADED.files:
            spec = importlib.util.find_spec(module) if within(module, name) else None
            if spec is not None and str(spec.origin).endswith(".py"):
                found.append(module)
    return found


def _entries(homes: Iterable[str]) -> Iterator[EntryPoint]:
    for name, _, entry in sources.added_places():
        if entry.dist is not None and any(within(home, name) for home in homes):
            yield from (
                EntryPoint(
                    distribution=entry.dist.name,
                    version=entry.dist.version,
                    group=each.group,
                    name=each.name,
                    value=each.value,
                )
                for each in entry.dist.entry_points
                if each.group in ("clearance.components", "clearance.methods")
            )


def _is_package(module: str) -> bool:
    spec = importlib.util.find_spec(module)
    return spec is not None and spec.submodule_search_locations is not None
