"""What the answers say: how much faster, how much more often right, which perspective is preferred."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any, Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from . import censored, fit
from .fit import Array, Interval
from .order import PERSPECTIVES
from .records import Records, Row

#: Statements that are made about A at a time (three tasks), and about B (four perspectives).
FAMILY_A, FAMILY_B = 3, len(PERSPECTIVES)
#: Faster answers were no search: a key or button was still held down.
SHORTEST_MS = 150.0

Report = dict[str, Any]


def analyse(records: Records) -> Report:
    """The report of all tasks that have answers."""
    rows = [row for row in records.rows if row["restarted"] != "1"]
    notes = list(records.notes)
    if len(rows) < len(records.rows):
        notes.append(f"{len(records.rows) - len(rows)} trials during which the page was loaded anew are left out")
    searched = _of(rows, "find")
    slow_enough = [row for row in searched if float(row["time_ms"]) >= SHORTEST_MS]
    if len(slow_enough) < len(searched):
        notes.append(f"{len(searched) - len(slow_enough)} finds within {SHORTEST_MS:.0f} ms are left out: no search")
    report: Report = {
        "kit": rows[0]["kit"] if rows else "",
        "participants": len({_who(row) for row in rows}),
        "finding": finding(slow_enough),
        "counting": accuracy(_of(rows, "count")),
        "path_memory": accuracy(_of(rows, "path")),
        "preferences": preferences(_of(rows, "prefer")),
        "notes": notes,
    }
    return report


def finding(rows: Sequence[Row]) -> Report | None:
    """Times to find it: bent over straight, below 1 is faster. Times that were cut off count as longer ones."""
    if not _both(rows):
        return None
    y = np.log([float(row["time_ms"]) for row in rows])
    cut = np.array([row["correct"] != "1" for row in rows])
    x, person = _columns(rows), _numbers(rows, _who)
    found, without = censored.log_times(x, y, cut, person)
    ratio = fit.interval(float(found[-1]), without[:, -1], FAMILY_A)
    return {
        "ratio": _as_dict(ratio, math.exp),
        "straight": _times(rows, "straight"),
        "bent": _times(rows, "bent"),
    }


def accuracy(rows: Sequence[Row]) -> Report | None:
    """Share of right answers: bent less straight."""
    if not _both(rows):
        return None
    right = np.array([float(row["correct"] == "1") for row in rows])
    sums = fit.sums(_columns(rows), right, _numbers(rows, _who), own_level=True)
    difference = fit.interval(float(sums.solved()[-1]), sums.without()[:, -1], FAMILY_A)
    return {
        "difference": _as_dict(difference, lambda value: min(1.0, max(-1.0, value))),
        "straight": _shares(rows, "straight"),
        "bent": _shares(rows, "bent"),
    }


def preferences(rows: Sequence[Row]) -> Report | None:
    """Scores of the perspectives, which add up to 0: the difference of two is the answer that is expected between them,
    from -2 to 2. What the left or right side itself attracts is taken out."""
    if not rows:
        return None
    y = np.array([float(row["answer"]) for row in rows])
    signs = np.array(
        [[float(row["right"] == one) - float(row["left"] == one) for one in PERSPECTIVES] for row in rows]
    )
    # Scores that add up to 0: those of the first three are free, the last is what is left.
    columns = np.column_stack([signs[:, :-1] - signs[:, -1:], np.ones(len(rows))])
    sums = fit.sums(columns, y, _numbers(rows, _who), own_level=False)
    value, without = _scores(sums.solved()[None])[0], _scores(sums.without())
    # Answers are at most 2, so a score is at most 1.5: 2 away from each of the three others.
    scores = {
        one: _as_dict(fit.interval(float(value[k]), without[:, k], FAMILY_B), lambda score: min(1.5, max(-1.5, score)))
        for k, one in enumerate(PERSPECTIVES)
    }
    return {"scores": scores, "won": _won(rows), "answers": len(rows)}


def _scores(found: Array) -> Array:
    free = found[:, : len(PERSPECTIVES) - 1]
    return np.column_stack([free, -free.sum(axis=1)])


def _won(rows: Sequence[Row]) -> dict[str, float]:
    """Share of its comparisons that a perspective wins; no difference is half."""
    won: dict[str, float] = {}
    for one in PERSPECTIVES:
        mine = [float(r["answer"]) * (1 if r["right"] == one else -1) for r in rows if one in (r["left"], r["right"])]
        won[one] = float(np.mean([0.5 + 0.5 * np.sign(answer) for answer in mine])) if mine else math.nan
    return won


def _columns(rows: Sequence[Row]) -> Array:
    bent = np.array([float(row["condition"] == "bent") for row in rows])
    return fit.two_way(_numbers(rows, lambda row: row["scene"]), bent)


def _numbers(rows: Sequence[Row], of: Callable[[Row], str]) -> NDArray[np.int64]:
    known: dict[str, int] = {}
    return np.array([known.setdefault(of(row), len(known)) for row in rows], dtype=np.int64)


def _times(rows: Sequence[Row], condition: str) -> Report:
    mine = [row for row in rows if row["condition"] == condition]
    middle = math.exp(np.mean([math.log(float(row["time_ms"])) for row in mine])) / 1000
    return {"trials": len(mine), "found": _right(mine), "geometric_mean_s": middle}


def _shares(rows: Sequence[Row], condition: str) -> Report:
    mine = [row for row in rows if row["condition"] == condition]
    return {"trials": len(mine), "correct": _right(mine)}


def _right(rows: Sequence[Row]) -> float:
    return float(np.mean([row["correct"] == "1" for row in rows]))


def _of(rows: Sequence[Row], task: str) -> list[Row]:
    return [row for row in rows if row["task"] == task]


def _both(rows: Sequence[Row]) -> bool:
    return {"straight", "bent"} <= {row["condition"] for row in rows}


def _who(row: Row) -> str:
    return f"{row['class']} {row['participant']}"


def _as_dict(one: Interval, scale: Callable[[float], float] = lambda value: value) -> Report:
    def finite(value: float) -> float | None:
        return scale(value) if math.isfinite(value) else None

    return {k: v if k == "participants" else finite(v) for k, v in asdict(one).items()}
