"""Requirements of a criterion and their digests; when a requirement is met, for every mixture of its runs."""

from __future__ import annotations

import itertools
from typing import Any

import pytest

from backend.requirements.standing import ORDER, Edge, standing
from campaigns import CampaignError
from campaigns.asked.load import load_document, load_text
from campaigns.asked.requirements import definition
from campaigns.asked.text import to_yaml
from campaigns.identity.identity import UNSTORED, Identity
from campaigns.results.verdict import VerdictWord
from tests.given.case_campaigns import campaign, document

OLD, NEW = Identity(engine="a" * 64), Identity(engine="b" * 64)
WORDS = {"c": VerdictWord.CLEARED, "v": VerdictWord.VIOLATED, "i": VerdictWord.INCONCLUSIVE, "-": None}


def asked(*requirements: Any) -> Any:
    return load_document(document(criterion__requirements=list(requirements)))


def edge(run_id: int, word: str = "c", **changes: Any) -> Edge:
    """A run that is signed off, and unchanged."""
    known: dict[str, Any] = {"campaign": "A", "question": "q", "identity": OLD, "signed": True}
    return Edge(run_id, verdict=WORDS[word], **(known | changes))


def test_a_campaign_without_requirements_keeps_its_digest_and_document() -> None:
    assert "requirements" not in campaign().document()["criterion"]
    assert asked().digest == campaign().digest
    assert campaign().digest == "f013acf5df20fd4e2918da4952ff6c52e5abd762d9fe9a8cf1144304e8dfadb5"


def test_requirements_are_ids_or_ids_with_text_and_part_of_the_digest() -> None:
    both = asked("REQ-1", {"id": "SYS 2", "text": "Keep 0.5 m."})
    assert [(one.id, one.text) for one in both.criterion.requirements] == [("REQ-1", ""), ("SYS 2", "Keep 0.5 m.")]
    assert both.document()["criterion"]["requirements"] == [{"id": "REQ-1"}, {"id": "SYS 2", "text": "Keep 0.5 m."}]
    assert len({both.digest, campaign().digest, asked("REQ-1").digest, asked("REQ-2").digest}) == 4
    assert load_text(to_yaml(both)).digest == both.digest


@pytest.mark.parametrize(
    ("wrong", "statement"),
    [
        (["A", {"id": "A", "text": "x"}], "A is given twice; name a requirement once"),
        (["A "], "expected the id of a requirement: one line"),
        ([""], "at least 1 character"),
        ([{"text": "x"}], "criterion.requirements.0.id: this key is required"),
        ([{"id": "A", "title": "x"}], "criterion.requirements.0.title: unknown key"),
        (["A\nB"], "one line"),
        ("A", "list"),
        ([7], "criterion.requirements.0"),
    ],
)
def test_a_wrong_requirement_is_refused_with_a_sentence(wrong: Any, statement: str) -> None:
    with pytest.raises(CampaignError, match=r".*") as refused:
        load_document(document(criterion__requirements=wrong))
    assert statement in str(refused.value)


def test_the_definition_is_without_the_baseline() -> None:
    one, again = campaign().document(), campaign(seed=2).document()
    assert definition(one) == definition({**one, "baseline": {"run": "R-0001"}})
    assert definition(one) != definition(again)


def test_only_signed_unchanged_cleared_evidence_is_met() -> None:
    assert standing([edge(1)]).status == "met"
    assert standing([]).status == "no evidence"
    assert standing([edge(1, signed=False)]).status == "unsigned"
    assert standing([edge(1, changes=("other code",))]).status == "suspect"
    assert standing([edge(1, "i")]).status == "inconclusive"
    assert standing([edge(1, "-")]).status == "no verdict"
    assert standing([edge(1, "v")]).status == "violated"


@pytest.mark.parametrize("words", ["".join(w) for n in (1, 2, 3) for w in itertools.product("cvi-", repeat=n)])
def test_no_mixture_of_runs_is_met_if_the_newest_verdict_or_a_violation_speaks_against_it(words: str) -> None:
    """The runs of one question on one model, in their order, all signed off; and the same of a campaign each."""
    edges = [edge(i, word) for i, word in enumerate(words, 1)]
    judged = [word for word in words if word != "-"]
    expected = (
        "no verdict" if not judged else "violated" if "v" in judged else "met" if judged[-1] == "c" else "inconclusive"
    )
    assert standing(edges).status == expected
    apart = [edge(i, word, campaign=str(i)) for i, word in enumerate(words, 1)]
    alone = {"c": "met", "v": "violated", "i": "inconclusive", "-": "no verdict"}
    assert standing(apart).status == min((alone[word] for word in words), key=ORDER.index)


def test_a_violation_is_not_outrun_by_another_search_of_the_same_question() -> None:
    found = standing([edge(1, "v"), edge(2, "c")])
    assert found.violations == {1}
    assert "The newer R-0002 is cleared, but asks the same of the same model" in found.sentence
    unknown = standing([edge(1, "v", identity=UNSTORED), edge(2, "c", identity=NEW)])
    assert unknown.status == "violated", "an unknown model may be the same"


@pytest.mark.parametrize(
    "changes",
    [{"identity": NEW}, {"question": "r"}, {"identity": Identity(engine="a" * 64, files={"components/x.py": "1"})}],
)
def test_a_violation_is_resolved_by_another_model_or_question_and_still_named(changes: dict[str, Any]) -> None:
    found = standing([edge(1, "v"), edge(2, "c", **changes)])
    assert found.status == "met"
    assert (found.evidence, found.violations) == (frozenset({2}), frozenset())
    assert "violated it: R-0001" in found.sentence
    assert standing([edge(1, "v", **changes), edge(2, "v")]).violations == {2}


def test_a_threshold_that_was_lowered_below_a_violation_is_named_as_the_reason() -> None:
    found = standing([edge(1, "v", threshold=0.6, worst=0.55), edge(2, "v", question="r"), edge(3, "c", threshold=0.5)])
    assert found.status == "met"
    assert "lowered since, R-0001 " in found.sentence
    assert found.sentence.endswith(": R-0002.")


CONTRADICTING: list[tuple[str, dict[str, Any], str]] = [
    ("-", {"worst": 0.5}, "inconclusive"),  # cancelled after it had found a violation
    ("-", {"worst": 0.51}, "met"),
    ("-", {"worst": 0.4, "question": "r"}, "met"),
    ("-", {"worst": 0.4, "identity": NEW}, "met"),
    ("i", {"worst": 0.4}, "inconclusive"),
    ("c", {"worst": 0.4, "threshold": 0.3}, "inconclusive"),  # cleared with a threshold that is easier to meet
    ("v", {"worst": 0.2, "threshold": 0.3}, "violated"),  # even that one was violated
    ("v", {"worst": 0.55, "threshold": 0.6}, "met"),
    ("v", {"worst": 0.45, "threshold": 0.6}, "violated"),
]


@pytest.mark.parametrize("evidence", [True, False])
@pytest.mark.parametrize(("word", "changes", "expected"), CONTRADICTING)
def test_a_value_that_violates_counts_whoever_found_it(
    word: str, changes: dict[str, Any], expected: str, evidence: bool
) -> None:
    """evidence: the run states the requirement and is of no sweep."""
    given = edge(1, word, **({"threshold": 0.5} | changes))
    newest = edge(2, threshold=0.5, worst=0.7)
    found = standing([given, newest]) if evidence else standing([newest], [given])
    assert found.status == expected, found.sentence
    assert found.evidence == {2}
    assert found.violations == (set() if expected == "met" else {1})
    assert ("R-0001" in found.sentence) == (expected != "met" or (word == "v" and evidence))
    renamed = {"threshold": 0.5} | changes | {"campaign": "B"}
    assert standing([newest], [edge(1, word, **renamed)]).status == expected, "a name is no part of the question"
    unknown = standing(
        [edge(2, threshold=0.5, worst=0.7, question="")], [edge(1, word, **(renamed | {"question": ""}))]
    )
    assert unknown.status == "met", "questions that are not stored are compared within a campaign"


def test_a_sign_off_by_who_launched_the_run_is_named() -> None:
    own, other = standing([edge(1, own=True)]), standing([edge(1)])
    assert (own.status, own.sentence != other.sentence) == (other.status, True)
