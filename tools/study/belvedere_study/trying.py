"""Generated places are tried until one offers the task."""

from __future__ import annotations

from typing import Any, Callable

import numpy as np

from .program import ProgramError

#: Places that are tried.
TRIES = 60

Item = dict[str, Any]


class Unsuitable(Exception):
    """This place offers no task; another one may."""


def first(seed: list[int], name: str, make: Callable[[np.random.Generator], Item]) -> Item:
    """What is made at the first place that offers it. A town without a park, or a massif without a trail, is refused by
    the program, and the next one is taken."""
    why = ""
    for attempt in range(TRIES):
        try:
            return make(np.random.default_rng([*seed, attempt]))
        except (Unsuitable, ProgramError) as error:
            why = str(error)
    raise ProgramError(f"{name}: none of {TRIES} places will do; the last: {why}")
