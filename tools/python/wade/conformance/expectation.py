"""How a check says that the contract was broken, and how it waits without measuring time."""

import time

PATIENCE_S = 60


class Violation(Exception):
    """What the contract says, and what was seen instead."""

    def __init__(self, contract, seen):
        super().__init__(f"the contract says: {contract}; seen: {seen}")


class NotApplicable(Exception):
    """Why a check cannot be made with this producer."""


def expect(condition, contract, seen):
    if not condition:
        raise Violation(contract, seen() if callable(seen) else seen)


def wait_until(condition, contract, seen, patience_s, over=None):
    """Polls until the condition holds. Its value is returned.

    seen: a function that tells what is the case instead; over: a function that gives a text once waiting is in vain.
    The patience only keeps a broken producer from blocking the suite.
    """
    deadline = time.monotonic() + patience_s
    while True:
        value = condition()
        if value:
            return value
        end = over() if over else None
        if end:
            value = condition()  # what was done before the end counts
            if value:
                return value
            raise Violation(contract, end)
        if time.monotonic() > deadline:
            raise Violation(contract, f"nothing of that within {patience_s:g} s; {seen()}")
        time.sleep(0.0002)
