"""Asks the advisory sources of PyPI and npm about everything that is locked: `make advisories`.

A source that does not answer, or does not know the packages, is named as such: that is no result. The exit status is
1 if there are advisories, 2 if a source could not be asked.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).parents[1]


class Asked(NamedTuple):
    """What a source answered."""

    advisories: list[str]
    audited: int
    not_reached: str
    """Why it is no result; empty if it is one."""


def of_pip(output: str, problem: str) -> Asked:
    """The answer of pip-audit; a package that it skipped was not audited."""
    try:
        found = json.loads(output)["dependencies"]
    except (ValueError, KeyError, TypeError):
        return Asked([], 0, problem.strip().rpartition("\n")[2] or "no answer")
    audited = [one for one in found if "skip_reason" not in one]
    statement = [f"{one['name']} {one['version']}: {fault['id']}" for one in audited for fault in one["vulns"]]
    skipped = [one for one in found if "skip_reason" in one]
    if skipped:
        return Asked(statement, len(audited), f"{len(skipped)} of {len(found)} skipped; {skipped[0]['skip_reason']}")
    return Asked(statement, len(audited), "" if audited else "nothing was audited")


def of_npm(output: str, problem: str) -> Asked:
    """The answer of npm audit."""
    try:
        found: dict[str, Any] = json.loads(output)
        total = int(found["metadata"]["dependencies"]["total"])
    except (ValueError, KeyError, TypeError):
        statement = next((line for line in problem.splitlines() if "audit" in line), "no answer")
        return Asked([], 0, statement)
    statement = [f"{name}: {one['severity']}" for name, one in found["vulnerabilities"].items()]
    return Asked(statement, total, "")


def main() -> int:
    """Ask both and print what they answered."""
    pip = [sys.executable, "-m", "pip_audit", "-r", "requirements.lock", "--disable-pip", "--no-deps"]
    npm = ["npm", "audit", "--json", "--package-lock-only"]
    answers = {
        "PyPI": of_pip(*_run([*pip, "--progress-spinner", "off", "--format", "json"], ROOT)),
        "npm": of_npm(*_run(npm, ROOT / "frontend")),
    }
    for name, answer in answers.items():
        if answer.not_reached:
            print(f"{name}: NOT AUDITED, the advisory source could not be asked completely: {answer.not_reached}")
        else:
            print(f"{name}: {answer.audited} packages audited, {len(answer.advisories)} with advisories")
        for statement in answer.advisories:
            print(f"  {statement}")
    if any(answer.advisories for answer in answers.values()):
        return 1
    return 2 if any(answer.not_reached for answer in answers.values()) else 0


def _run(command: list[str], folder: Path) -> tuple[str, str]:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    return done.stdout, done.stderr


if __name__ == "__main__":
    sys.exit(main())
