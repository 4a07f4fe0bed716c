"""The figures of benches that the guides state, as JSON beside this file, with a digest of the code that measured them.

`python -m tests.bench.small_budgets --keep` and `python -m tests.bench.rare --half judging --keep` (also with `--whole`
or `--subset`) write them; the tables of `docs/methods.md` follow by `python -m tools.generated`. At night a test fails
if the code has changed since, so that they are measured again.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from campaigns.documents import digest_of
from tests.bench.scoreboard.cells import code
from worker.running.catalogue.installed import methods
from worker.running.runs.identity import closure, code_parts, loaded

FOLDER = Path(__file__).parent
_SEARCHES = ("tests/bench/scoreboard/searches.py", "clearance/testing/searching.py")
_SMALL = ("tests/bench/small_budgets.py", "tests/given/small_budget_functions.py", *_SEARCHES)
_RARE = ("generated", "judge", "problem", "public", "starts")
_OF_PART = {"judging": (), "whole": ("whole",), "subset": ("subset",)}


def read(name: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((FOLDER / f"{name}.json").read_text(encoding="utf-8"))
    return found


def keep_small_budgets(found: Mapping[str, Any], folder: Path = FOLDER) -> None:
    """Those of these methods, with those that are kept of the others; found: what the bench measured."""
    file = folder / "small_budgets.json"
    before = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
    conditions = {name: found[name] for name in ("functions", "problems", "seeds", "first_seed")}
    if {name: before.get(name, found[name]) for name in conditions} != conditions:
        raise ValueError(f"the figures that are kept are of {before['seeds']} seeds of {before['functions']}")
    codes = small_budgets_code(found["methods"])
    rows = {
        name: {
            "many valleys": row["many valleys"],
            "few valleys": row["few valleys"],
            "failed": row["failed of half fails"],
            "code": codes[name],
        }
        for name, row in found["methods"].items()
    }
    every = before.get("methods", {}) | rows
    ordered = sorted(every, key=lambda name: methods()[name].title.casefold())
    _write(file, conditions | {"methods": {name: every[name] for name in ordered}})


def keep_rare(part: str, seeds: int, figures: Mapping[str, Any], folder: Path = FOLDER) -> None:
    """part: `judging`, `whole` or `subset`; figures: what it measured on the judging half."""
    file = folder / "rare.json"
    before = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
    _write(file, before | {part: {"seeds": seeds, "code": rare_code(part), **figures}})


def small_budgets_code(names: Iterable[str]) -> dict[str, str]:
    """By method: of its modules, of the bench and of its functions."""
    of = code_parts().methods
    return {name: f"{code(_SMALL)} {of[name][:16]}" for name in names}


def rare_code(part: str) -> str:
    """Of the estimate, the bench and its problems; with a search before it, of `auto` as well."""
    bench = code([f"tests/bench/rare/{name}.py" for name in (*_RARE, *_OF_PART[part])])
    modules = closure(frozenset(["worker.engine.rare.estimate", "worker.engine.rare.starts"])).modules
    known = {name: loaded()[name].digest[:16] for name in sorted(modules)}
    searched = [*small_budgets_code(["auto"]).values()] if part == "whole" else []
    return " ".join([bench, _digest(known), *(one.split()[-1] for one in searched)])


def _digest(known: Mapping[str, str]) -> str:
    return digest_of(known)[:16]


def _write(file: Path, document: Mapping[str, Any]) -> None:
    file.write_text(json.dumps(_rounded(document), indent=1) + "\n", encoding="utf-8")


def _rounded(value: Any) -> Any:
    if isinstance(value, float):
        return round(value, 4)
    if isinstance(value, Mapping):
        return {key: _rounded(one) for key, one in value.items()}
    return [_rounded(one) for one in value] if isinstance(value, list | tuple) else value
