"""A run as JUnit XML, for a CI service: cases for the verdict, the criterion, each requirement, each check and each
finding compared.

The format has no standard; this is the form that Jenkins, GitLab and GitHub's reporters read.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree as Xml

from campaigns.claims.numbers import signed
from campaigns.results.regression import FindingChange
from clearance.cli._ended import UNKNOWN, Case, EndedRun, exit_sentence, read, sureness

if TYPE_CHECKING:
    from campaigns.results import Verdict
    from campaigns.results.verdicts import DescribedCheck

_FORBIDDEN = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that XML 1.0 cannot contain."""


def write(file: Path, ended: EndedRun) -> None:
    file.write_text(junit(ended), encoding="utf-8")


def junit(ended: EndedRun) -> str:
    suite = Xml.Element("testsuite", name=_clean(ended.campaign), time=f"{ended.seconds:.3f}")
    properties = Xml.SubElement(suite, "properties")
    values = {"run": ended.run, "link": ended.link, "state": ended.state, "outcome": ended.outcome}
    values |= {f"label.{key}": value for key, value in ended.labels.items()}
    if ended.identity is not None:
        values["code"] = ended.identity.digest or f"not identified: {', '.join(ended.identity.unidentified)}"
        values |= {f"code.{name}": digest for name, digest in ended.identity.digests.items()}
    values["sureness"] = "" if ended.verdict is None else " ".join(sureness(ended.verdict))
    for name, value in values.items():
        if value:
            Xml.SubElement(properties, "property", name=name, value=_clean(value))
    _verdict(suite, ended)
    if ended.verdict is not None:
        _criterion(suite, ended, ended.verdict)
    for requirement in ended.requirements:
        _requirement(suite, ended, requirement)
    for check in ended.checks:
        _check(suite, ended, check)
    regression = ended.regression
    if regression is not None:
        for case in regression.cases:
            _case(suite, ended, case)
    elif not ended.compared:
        _ended(_added(suite, ended, "baseline"), "skipped", " ".join(ended.notes))
    for kind, tag in (("tests", "testcase"), ("failures", "failure"), ("errors", "error"), ("skipped", "skipped")):
        suite.set(kind, str(len(suite.findall(f".//{tag}"))))
    suites = Xml.Element("testsuites")
    suites.append(suite)
    Xml.indent(suites)
    return Xml.tostring(suites, encoding="unicode", xml_declaration=True) + "\n"


def _verdict(suite: Xml.Element, ended: EndedRun) -> None:
    case, verdict = _added(suite, ended, "verdict"), ended.verdict
    if verdict is None:
        _ended(case, "error", ended.no_verdict, *ended.notes, ended.link, kind=ended.state)
        return
    if ended.passes:
        _passed(case, ended, verdict)
        return
    text = [verdict.reason, *ended.notes, *(_values(verdict.worst.parameters) if verdict.worst else ()), ended.link]
    if ended.replay and verdict.worst is not None:
        text.append(f"{ended.replay} {verdict.worst.finding}")
    _ended(case, "failure", ended.against or verdict.sentence, *text, kind=ended.headline)


def _criterion(suite: Xml.Element, ended: EndedRun, verdict: Verdict) -> None:
    """The test case of the criterion: every violating finding is a failure; else only a verdict passes that is
    cleared and that no other run speaks against."""
    case = _added(suite, ended, f"criterion: {ended.quantity or verdict.quantity or 'value'}")
    text = "\n\n".join(_violation(ended, found) for found in ended.violating), verdict.scope, ended.link
    violated = bool(ended.violating) or verdict.verdict == "violated"
    if violated and ended.accepted:
        _ended(case, "skipped", exit_sentence(verdict), *text)  # no failure of the job, and not met either
    elif violated:
        kind = "violation" if verdict.verdict == "violated" else "unconfirmed"
        _ended(case, "failure", _violating(ended, verdict), *text, kind=kind)
    elif ended.against:
        _ended(case, "failure", ended.against, *text, kind=ended.headline)
    elif verdict.verdict == "cleared":
        _passed(case, ended, verdict)
    else:
        _ended(case, "skipped", f"not cleared, although no finding violates it: {verdict.reason}")


def _violating(ended: EndedRun, verdict: Verdict) -> str:
    """Which findings violate the criterion, and which of them are not confirmed, as a clause."""
    labels = [found.label for found in ended.violating if found.confirmed and verdict.verdict == "violated"]
    others = [found.label for found in ended.violating if found.label not in labels]
    which = ", ".join(labels) or ("a stored evaluation" if verdict.verdict == "violated" else "")
    stated = f"{which} {'violate' if len(labels) > 1 else 'violates'} the criterion" if which else ""
    many = len(others) > 1
    beside = f"{', '.join(others)} {'are' if many else 'is'} not confirmed as {'violations' if many else 'a violation'}"
    return "; ".join(filter(None, [stated, beside if others else ""]))


def _requirement(suite: Xml.Element, ended: EndedRun, requirement: str) -> None:
    """Evidence of this run, and what speaks against it: other campaigns may state the requirement, and the run is not
    signed off yet."""
    case, verdict = _added(suite, ended, f"requirement: {requirement}"), ended.verdict
    if ended.unconfirmed:
        message = f"inconclusive: the run is {ended.state}. {ended.unconfirmed}"
        _ended(case, "failure", message, ended.error, ended.link, kind="inconclusive")
    elif verdict is None:
        _ended(case, "error", f"no evidence: {ended.state}", ended.link, kind=ended.state)
    elif verdict.verdict == "cleared" and ended.passes:
        _passed(case, ended, verdict, "Evidence of this run alone; the matrix of requirements has all runs.")
    elif ended.accepted:
        _ended(case, "skipped", f"{verdict.sentence} {exit_sentence(verdict)}", verdict.scope)
    else:
        _ended(case, "failure", ended.against or verdict.sentence, verdict.reason, ended.link, kind=ended.headline)


def _violation(ended: EndedRun, found: Case) -> str:
    unit = f" {ended.unit}" if ended.unit else ""
    value, rest = read(found.cost, ended.threshold), found.beside(ended.threshold)
    head = f"{found.label}: {value}{unit}, margin {signed(found.margin)}{unit}{rest}"
    replay = f"{ended.replay} {found.label}" if ended.replay else ""
    return "\n".join(filter(None, [head, found.likelihood, *_values(found.parameters), replay]))


def _check(suite: Xml.Element, ended: EndedRun, check: DescribedCheck) -> None:
    """A check that does not hold fails, unless the policy of the campaign accepts the violations of the run."""
    case = _added(suite, ended, f"check: {check.title}")
    if check.standing == "holds":
        Xml.SubElement(case, "system-out").text = _clean(check.text)
    elif check.standing == "open":
        _ended(case, "skipped", f"{check.text}; {check.but}")
    elif ended.accepted:
        _ended(case, "skipped", f"does not hold; the policy accepts the violations: {check.text}")
    else:
        _ended(case, "failure", check.text, check.text, ended.link, kind=str(check.code))


def _case(suite: Xml.Element, ended: EndedRun, change: FindingChange) -> None:
    """The names do not contain the baseline's number, so that a CI service can follow a case from build to build."""
    name = f"{change.before} of the baseline" if change.before else f"new finding {change.now}"
    case = _added(suite, ended, name)
    if change.standing in UNKNOWN and not change.fails:
        _ended(case, "skipped", change.text)
    elif change.fails:
        lines = change.text, *_values(change.parameters), ended.link, ended.command(change)
        _ended(case, "failure", change.text, *lines, kind=str(change.standing))
    else:
        Xml.SubElement(case, "system-out").text = _clean(change.text)


def _added(suite: Xml.Element, ended: EndedRun, name: str) -> Xml.Element:
    return Xml.SubElement(suite, "testcase", classname=_clean(ended.campaign), name=_clean(name))


def _passed(case: Xml.Element, ended: EndedRun, verdict: Verdict, *lines: str) -> None:
    Xml.SubElement(case, "system-out").text = _clean("\n".join([verdict.reason, *lines, *ended.notes]))


def _ended(case: Xml.Element, tag: str, message: str, *lines: str, kind: str = "") -> None:
    """Why the test case did not pass: kind: its type; lines: the text, without those that are empty."""
    stated = {"message": _clean(message)} | ({"type": _clean(kind)} if kind else {})
    Xml.SubElement(case, tag, stated).text = _clean("\n".join(filter(None, lines)))


def _values(parameters: Mapping[str, float]) -> list[str]:
    return [f"{path} = {value!r}" for path, value in parameters.items()]


def _clean(text: str) -> str:
    return _FORBIDDEN.sub("\ufffd", text)
