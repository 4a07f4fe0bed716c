"""Why a sign-in through the provider did not take place, as sentences for the page."""

from __future__ import annotations


class SignInError(Exception):
    """sentence: for the user. status: of the response. reason: for the audit trail; empty: not recorded there."""

    def __init__(self, sentence: str, status: int = 403, reason: str = "") -> None:
        super().__init__(sentence)
        self.sentence, self.status, self.reason = sentence, status, reason


def unreachable(name: str, what: str) -> SignInError:
    """The provider did not answer, or not with what the standard requires; `what` is for the log and the trail."""
    sentence = f"{name} could not be reached or gave no valid answer. Try again in a minute, or sign in another way."
    return SignInError(sentence, 502, what)


def invalid(name: str, reason: str) -> SignInError:
    sentence = f"The answer of {name} is not valid ({reason}), so you are not signed in. Try again."
    return SignInError(sentence, 403, reason)


def stale() -> SignInError:
    """This browser did not begin this sign-in, or it has used it, or it began too long ago."""
    sentence = (
        "This sign-in was not begun in this browser, was used already, or took longer than 10 minutes. Sign in again."
    )
    return SignInError(sentence, 403)
