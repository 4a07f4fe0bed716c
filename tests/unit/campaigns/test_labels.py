"""Labels of runs: what is allowed, and the sentence for what is not."""

from __future__ import annotations

import pytest

from campaigns.labels import LONGEST_KEY, LONGEST_VALUE, MOST, checked, parsed


def test_labels_are_read_in_alphabetical_order() -> None:
    found = parsed(["commit=4f2a91c", "branch=feature/wider turn", "build=42", "note=a=b"])
    assert list(found.items()) == [
        ("branch", "feature/wider turn"),
        ("build", "42"),
        ("commit", "4f2a91c"),
        ("note", "a=b"),
    ]
    assert parsed([]) == {}
    assert parsed(["branch=main", "branch=main"]) == {"branch": "main"}


@pytest.mark.parametrize(
    ("given", "statement"),
    [
        (["branch"], "invalid label 'branch': give KEY=VALUE, such as branch=main"),
        (["=main"], "invalid label key '': a letter, then letters, digits"),
        (["1st=main"], "invalid label key '1st'"),
        (["bränch=main"], "invalid label key 'bränch'"),
        ([f"{'k' * (LONGEST_KEY + 1)}=v"], "at most 40 characters"),
        (["branch="], "invalid value '' of the label branch: one line of readable text"),
        (["branch=a\nb"], "of the label branch"),
        (["branch=\u202emain"], "of the label branch"),
        ([f"branch={'v' * (LONGEST_VALUE + 1)}"], "at most 200 characters"),
        (["branch=main", "branch=dev"], "the label branch is given twice, as 'main' and 'dev': a label has one value"),
        ([f"k{i}=v" for i in range(MOST + 1)], "21 labels are too many: a run has at most 20"),
    ],
)
def test_a_bad_label_is_named(given: list[str], statement: str) -> None:
    with pytest.raises(ValueError, match="label") as refused:
        parsed(given)
    assert statement in str(refused.value)


def test_the_largest_ones_are_allowed() -> None:
    labels = {f"k{i:0{LONGEST_KEY - 1}}": "v" * LONGEST_VALUE for i in range(MOST)}
    assert checked(labels) == labels
