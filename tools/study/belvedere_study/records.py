"""Answers as rows of CSV: the columns, and reading and writing them."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass, field
from pathlib import Path
from typing import Iterable, Sequence

#: Columns in their order, each with its meaning; the page writes the same.
COLUMNS = {
    "kit": "name of the kit: answers of different kits are not put together",
    "class": "word of the class, may be empty",
    "participant": "number of the participant within the class",
    "session": "what was run: A, B or AB, and F (full) or S (short)",
    "position": "number of the trial within the session, from 1",
    "task": "find, count, path or prefer",
    "scene": "name of the picture or pictures",
    "condition": "straight or bent; empty in task prefer",
    "left": "perspective on the left; task prefer",
    "right": "perspective on the right; task prefer",
    "answer": "find: found, or not; count: the number; path: the map, 1 is right; prefer: -2 (left clearly) to 2",
    "right_answer": "count: how many there are",
    "correct": "1 or 0: found; the number; the map; empty in task prefer",
    "time_ms": "from the picture to the answer; path: from the maps to the choice",
    "timed_out": "1 if the time was up, or the participant gave up",
    "wrong_clicks": "find: clicks beside",
    "steps": "steps from view to view",
    "x": "find: where in the picture the click was, pixels of the picture",
    "y": "the same, downwards",
    "view": "view that was shown at the answer, from 0",
    "input": "mouse or key: what the answer was given with",
    "restarted": "1 if the page was loaded anew while the picture was shown; not analysed",
    "picture_px": "width of the picture on the screen",
}

Row = dict[str, str]


class RecordError(ValueError):
    """A file that holds no answers of this study."""


@dataclass
class Records:
    """Rows, and what was left out."""

    rows: list[Row] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def read(files: Sequence[Path]) -> Records:
    """The rows of all files, each answer once."""
    found = Records()
    for file in files:
        rows = parse(file.read_text(encoding="utf-8-sig"), file.name)
        found.rows += rows
    return unique(found)


def parse(text: str, name: str) -> list[Row]:
    """The rows of one text."""
    reader = csv.DictReader(io.StringIO(text, newline=""))
    missing = [column for column in COLUMNS if column not in (reader.fieldnames or [])]
    if missing:
        raise RecordError(f"{name}: no answers of this study: the column {missing[0]} is missing")
    return [{column: row[column] or "" for column in COLUMNS} for row in reader]


def unique(records: Records) -> Records:
    """One row for every position of every participant, the first that came; and one kit."""
    kits = sorted({row["kit"] for row in records.rows})
    if len(kits) > 1:
        raise RecordError(f"answers of several kits cannot be put together: {', '.join(kits)}")
    kept: dict[tuple[str, ...], Row] = {}
    for row in records.rows:
        kept.setdefault((row["class"], row["participant"], row["position"]), row)
    repeated = len(records.rows) - len(kept)
    if repeated:
        records.notes.append(f"{repeated} rows came twice and count once")
    return Records(list(kept.values()), records.notes)


def write(rows: Iterable[Row]) -> str:
    """Rows as a text of CSV, as the page writes it."""
    text = io.StringIO(newline="")
    writer = csv.DictWriter(text, list(COLUMNS), lineterminator="\r\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()
