"""Prints the table of rules in Markdown, for `docs/access.md`: `python -m backend.access.rule_table`."""

from __future__ import annotations

from collections.abc import Mapping

from backend.access.routes import Key
from backend.access.rules import RULES, Rule

_METHODS = ("GET", "POST", "PUT", "PATCH", "DELETE", "SOCKET")


def table(rules: Mapping[Key, Rule] = RULES) -> str:
    """One line for each address and method, by address."""
    lines = ["| address | method | least role | least token scope |", "|---|---|---|---|"]
    for method, path in sorted(rules, key=lambda key: (key[1], _METHODS.index(key[0]))):
        rule = rules[method, path]
        role = "no sign-in" if rule.role is None else f"{rule.role}, own only" if rule.own else rule.role
        role += ", or the key of a view" if rule.framed else ""
        scope = "" if rule.role is None else "no token" if rule.scope is None else rule.scope
        lines.append(f"| `{path}` | {method} | {role} | {scope} |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    print(table(), end="")
