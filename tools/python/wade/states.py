"""States of agents: the list of configs/scene/states.def, which the C++ programs include.

STATES: {word: State}, in the order of the codes in files of numbers. Tables count a state as its kind.
"""

import re
from typing import NamedTuple

from wade import UsageError
from wade.paths import CONFIGS


class State(NamedTuple):
    """A line of the list. end: "safe", "lost" or "none" (no end yet); person: of an active person in water."""

    word: str
    kind: str
    end: str
    person: bool
    is_outcome: bool


def read_states(file):
    """The states of a list in its order."""
    lines = re.findall(r"^WADE_(\w+)\((\w+), (\w+), (safe|lost|none)\)$", file.read_text(encoding="utf-8"), re.MULTILINE)
    return {word: State(word, kind.replace("_", " "), end, macro == "PERSON_STATE", macro == "OUTCOME") for macro, word, kind, end in lines}


STATES = read_states(CONFIGS / "scene" / "states.def")
CODES = {word: code for code, word in enumerate(STATES)}
UNKNOWN = -1  # code of a state that a file does not hold
ENDS = {state.kind: state.end for state in STATES.values()}  # by kind
SAFE = tuple(word for word, state in STATES.items() if state.end == "safe")
LOST = tuple(word for word, state in STATES.items() if state.end == "lost")
OPEN = tuple(word for word, state in STATES.items() if state.end == "none")
OFF_FEET = tuple(word for word, state in STATES.items() if state.person and state.kind != "walking")
OUTCOMES = ("active", *(word for word, state in STATES.items() if state.is_outcome))  # of agents.csv
IN_HOUSES = ("indoors", "upper_floor")
MISSING = ("carried", "holding", "recovering", "pinned")  # kinds of people to be looked for, though not dead


def kind_of(state):
    """The kind of a state; an unknown state is its own."""
    return STATES[state].kind if state in STATES else state


def end_of(outcome):
    """safe, lost or none of the column `outcome` of agents.csv."""
    return STATES[outcome].end if outcome in STATES else "none"


def check_states(file, outcomes, states):
    """Refuses columns of agents.csv with an outcome or a state that is not in the list. Errors: UsageError."""
    for column, values, allowed in (("outcome", outcomes, OUTCOMES), ("state", states, tuple(STATES))):
        if not set(values) <= set(allowed):
            row, value = next((row, value) for row, value in enumerate(values, 1) if value not in allowed)
            raise UsageError(f'{file}, row {row}: {column} "{value}" is not allowed; allowed: {", ".join(allowed)}')


def code_lists(words):
    """The codes of states, for arrays of codes."""
    return [CODES[word] for word in words]
