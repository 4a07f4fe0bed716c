"""Finds again which obstacles, disturbances and faults of a baseline are which here: an index may be another part's."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from worker.evidence.audit import limits
from worker.evidence.audit.recompute import Run

NOISY = ("environment", "faults")
NAMES = ("obstacles", *NOISY)
Its = tuple[str, dict[str, float], set[str]]
"""Of a part: its component, the values that are fixed, and the names of what is varied."""


def parts(run: Run) -> dict[str, str]:
    """The part here of each of the baseline, both by list and index; before `PARTS` those with the same index."""
    baseline, scenario = run.campaign.baseline, run.campaign.scenario
    assert baseline is not None
    if scenario is None:
        return {}
    if run.wording < limits.PARTS:
        paths = {*(baseline.fixed or {})}.union(*(case.parameters for case in baseline.cases))
        return {part: part for part in map(_part, paths) if part}
    before = {part: (component, *_before(run, part)) for part, component in (baseline.parts or {}).items()}
    found: dict[str, str] = {}
    for name in NAMES:
        now = {
            f"{name}.{i}": (_component(part), *_now(run, f"{name}.{i}"))
            for i, part in enumerate(getattr(scenario, name))
        }
        found |= _same({part: its for part, its in before.items() if part.split(".")[0] == name}, now)
    return found


def here(values: Mapping[str, float], known: Mapping[str, str]) -> dict[str, float]:
    """Values of the baseline at the paths of this campaign; without those of parts that it does not have."""
    found = {}
    for path, value in values.items():
        part = _part(path)
        if not part:
            found[path] = value
        elif part in known:
            found[".".join((known[part], *path.split(".")[2:]))] = value
    return found


def complete(values: Mapping[str, float], known: Mapping[str, str]) -> bool:
    """Whether this campaign has every part whose values these are."""
    return all(part in known for part in map(_part, values) if part)


def moved(values: Mapping[str, float], known: Mapping[str, str]) -> dict[str, str]:
    """Of the parts whose values these are, those with another index here."""
    return {part: known[part] for part in map(_part, values) if part and known[part] != part}


def numbered(run: Run, known: Mapping[str, str]) -> bool:
    """Whether the noise of each part is drawn by the number that it had, its rank among the parts with a seed, and by
    the seed that it had if neither campaign varies it."""
    baseline = run.campaign.baseline
    assert baseline is not None
    if run.wording < limits.PARTS or not run.random:
        return True
    there = {*(baseline.fixed or {})}.union(*(case.parameters for case in baseline.cases))
    first, second = (
        [f"{name}.{i}" for name in NOISY for i in range(100) if f"{name}.{i}.seed" in paths]
        for paths in ({path for path in there if _part(path) in (baseline.parts or {})}, run.known)
    )
    ranks = [(first.index(part), second.index(known[part])) for part in first if known.get(part) in second]
    before, varied = baseline.fixed or {}, run.bounds
    seeds = [(before.get(f"{part}.seed"), f"{known[part]}.seed") for part in first if known.get(part) in second]
    kept = all(seed is None or path in varied or seed == run.known[path][1] for seed, path in seeds)
    return kept and all(one == other for one, other in ranks)


def _part(path: str) -> str:
    names = path.split(".")
    return ".".join(names[:2]) if names[0] in NAMES else ""


def _component(part: Any) -> str:
    on = getattr(part, "on", "")
    return f"{part.component} on {on}" if on else str(part.component)


def _before(run: Run, part: str) -> tuple[dict[str, float], set[str]]:
    """What the baseline fixed of a part, and what it varied."""
    baseline = run.campaign.baseline
    assert baseline is not None
    varied = {path for case in baseline.cases for path in case.parameters if _part(path) == part}
    fixed = {_name(path): value for path, value in (baseline.fixed or {}).items() if _part(path) == part}
    return fixed, {_name(path) for path in varied}


def _now(run: Run, part: str) -> tuple[dict[str, float], set[str]]:
    own = {path: nominal for path, (_, nominal) in run.known.items() if _part(path) == part}
    fixed = {_name(path): value for path, value in own.items() if path not in run.bounds}
    return fixed, {_name(path) for path in own if path in run.bounds}


def _name(path: str) -> str:
    return ".".join(path.split(".")[2:])


def _same(before: Mapping[str, Its], now: Mapping[str, Its]) -> dict[str, str]:
    """Of one list: a part is one of the same component and of equal values where neither is varied, preferably of which
    the same is varied, and preferably with the same index, otherwise the only one; if none has another index and the
    components are the same in order, one without such a part is the changed one with its index, unless one of them has
    fewer other values than the changed one at another index."""
    candidates = {}
    for part, (component, fixed, varied) in before.items():
        every = [q for q, its in now.items() if its[0] == component and _equal(fixed, its[1], varied | its[2])]
        alike = [q for q in every if now[q][2] == varied]
        candidates[part] = alike or every
    found = {part: part for part, them in candidates.items() if part in them}
    single: dict[str, list[str]] = {}
    for part, them in candidates.items():
        free = [q for q in them if q not in found]
        if part not in found and len(free) == 1:
            single.setdefault(free[0], []).append(part)
    others = {of[0]: q for q, of in single.items() if len(of) == 1}
    listed = {part: its[0] for part, its in before.items()} == {q: its[0] for q, its in now.items()}
    if not listed or others:
        return found | others
    left = [part for part in before if part not in found]
    count = {
        (part, q): _unequal(before[part][1], now[q][1], before[part][2] | now[q][2])
        for part in left
        for q in left
        if before[part][0] == now[q][0]
    }
    swapped = any(count[part, q] < count[part, part] for part, q in count)
    return found if swapped else {part: part for part in before}


def _equal(one: Mapping[str, float], other: Mapping[str, float], free: set[str]) -> bool:
    return _unequal(one, other, free) == 0


def _unequal(one: Mapping[str, float], other: Mapping[str, float], free: set[str]) -> int:
    names = [name for name in one if name in other and name not in free]
    return sum(not math.isclose(one[name], other[name], rel_tol=1e-9) for name in names)
