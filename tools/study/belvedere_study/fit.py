"""One way to estimate everything: least squares with the participants' own levels taken out, and an interval from
leaving out one participant at a time.

Participants are what is drawn at random, so they are what is left out: answers of one participant may hang together in
any way. Scenes are fixed: what is said holds for the scenes of the kit.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .student import t_quantile

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Sums:
    """Normal equations of every participant: `[participant, k, k]` and `[participant, k]`."""

    xx: Array
    xy: Array

    def solved(self) -> Array:
        """The coefficients of all participants together."""
        return _solve(self.xx.sum(axis=0), self.xy.sum(axis=0))

    def without(self) -> Array:
        """The coefficients without each participant, `[participant, k]`."""
        return _solve(self.xx.sum(axis=0) - self.xx, self.xy.sum(axis=0) - self.xy)


@dataclass(frozen=True)
class Interval:
    """An estimate with two intervals: the first holds together with the others of its family, so that in 95 of 100
    studies none of them misses; the second would do for this statement alone."""

    value: float
    low: float
    high: float
    alone_low: float
    alone_high: float
    participants: int


def sums(x: Array, y: Array, person: NDArray[np.int64], own_level: bool) -> Sums:
    """Adds up the normal equations of each participant; with `own_level` each has a level of its own, which is taken
    out by subtracting means."""
    people = int(person.max()) + 1 if len(person) else 0
    if own_level and people:
        x, y = x - _means(x, person, people), y - _means(y[:, None], person, people)[:, 0]
    k = x.shape[1]
    xx, xy = np.zeros((people, k, k)), np.zeros((people, k))
    np.add.at(xx, person, x[:, :, None] * x[:, None, :])
    np.add.at(xy, person, x * y[:, None])
    return Sums(xx, xy)


def interval(value: float, without: Array, family: int) -> Interval:
    """The jackknife's interval with Student's t. `family` is how many such statements are made at a time, which share
    the error between them (Bonferroni)."""
    people = len(without)
    if people < 2:
        return Interval(value, float("-inf"), float("inf"), float("-inf"), float("inf"), people)
    error = float(np.sqrt((people - 1) / people * np.sum((without - without.mean()) ** 2)))
    together, alone = (t_quantile(1 - 0.025 / n, people - 1) * error for n in (family, 1))
    return Interval(value, value - together, value + together, value - alone, value + alone, people)


def two_way(scene: NDArray[np.int64], bent: Array) -> Array:
    """Columns of a scene's own level (but for one scene) and of the bent condition, which is the last."""
    scenes = int(scene.max()) + 1 if len(scene) else 0
    levels = (scene[:, None] == np.arange(1, scenes)[None, :]).astype(float)
    return np.column_stack([levels, bent])


def _means(values: Array, person: NDArray[np.int64], people: int) -> Array:
    total = np.zeros((people, values.shape[1]))
    np.add.at(total, person, values)
    means: Array = total / np.bincount(person, minlength=people)[:, None].clip(1)
    return means[person]


def _solve(xx: Array, xy: Array) -> Array:
    # The pseudo-inverse answers also where a scene was seen by nobody.
    found: Array = (np.linalg.pinv(xx, hermitian=True) @ xy[..., None])[..., 0]
    return found
