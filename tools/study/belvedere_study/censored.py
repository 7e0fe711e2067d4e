"""Times of which some were cut off: whoever had not found it by then needed longer, nobody knows how much."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .fit import Array, Sums, sums
from .student import normal_hazard

#: Rounds of expectation and maximisation; times that were cut off are some in a hundred, so it settles soon.
ROUNDS = 40


def log_times(x: Array, y: Array, cut: NDArray[np.bool_], person: NDArray[np.int64]) -> tuple[Array, Array]:
    """Coefficients of log times, and those without each participant. A time that was cut off is replaced by what is
    expected of it, given that it is longer, until nothing changes."""
    guessed, changed = _expected(x, y, cut, person)
    found = sums(x, guessed, person, own_level=True)
    if not changed:
        return found.solved(), found.without()
    # What is expected of cut times hangs a little on everybody, so without a participant it is found anew.
    people = found.xx.shape[0]
    left_out = np.array([_without(x, y, guessed, cut, person, one) for one in range(people)])
    return found.solved(), left_out


def _without(
    x: Array, y: Array, guessed: Array, cut: NDArray[np.bool_], person: NDArray[np.int64], one: int
) -> Array:
    rest = person != one
    others = np.unique(person[rest], return_inverse=True)[1]
    again, _ = _expected(x[rest], y[rest], cut[rest], others, guessed[rest], 8)
    return sums(x[rest], again, others, own_level=True).solved()


def _expected(
    x: Array,
    y: Array,
    cut: NDArray[np.bool_],
    person: NDArray[np.int64],
    start: Array | None = None,
    rounds: int = ROUNDS,
) -> tuple[Array, bool]:
    """Log times with cut ones replaced, and whether there were any."""
    guessed = y.copy() if start is None else start.copy()
    if not cut.any():
        return guessed, False
    people = int(person.max()) + 1
    spread, freedom = 0.0, max(1, len(y) - people - x.shape[1])
    for _ in range(rounds):
        fitted = _fitted(sums(x, guessed, person, own_level=True), x, guessed, person, people)
        # The variance of what is only expected counts, too.
        variance = (np.sum((guessed - fitted) ** 2) + spread) / freedom
        sigma = float(np.sqrt(max(variance, 1e-12)))
        z = (y[cut] - fitted[cut]) / sigma
        hazard = normal_hazard(z)
        guessed[cut] = fitted[cut] + sigma * hazard
        spread = float(np.sum(sigma**2 * np.clip(1 + z * hazard - hazard**2, 0, 1)))
    return guessed, True


def _fitted(found: Sums, x: Array, y: Array, person: NDArray[np.int64], people: int) -> Array:
    from_columns = x @ found.solved()
    level = np.bincount(person, y - from_columns, people) / np.bincount(person, minlength=people).clip(1)
    fitted: Array = from_columns + level[person]
    return fitted
