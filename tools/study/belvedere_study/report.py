"""Reports as lines to read."""

from __future__ import annotations

from typing import Any

Report = dict[str, Any]


def text(found: Report) -> str:
    """What the answers say, in words."""
    lines = [f"kit {found['kit']}, {found['participants']} participants"]
    if found["finding"]:
        lines += _finding(found["finding"])
    for task, name in (("counting", "counting"), ("path_memory", "path memory")):
        if found[task]:
            lines += _accuracy(found[task], name)
    if found["preferences"]:
        lines += _preferences(found["preferences"])
    lines += [f"note: {note}" for note in found["notes"]]
    lines.append("Intervals in front hold together with 95 %; those in brackets are 95 % for one statement alone.")
    return "\n".join(lines)


def coverage(found: dict[str, dict[str, float]], populations: int) -> str:
    """The table of a simulation."""
    lines = [f"{'effect':<20} {'known':>7} {'mean':>7}  held by 95 % intervals, of {populations}: together, alone"]
    for name, one in found.items():
        lines.append(f"{name:<20} {one['known']:7.3f} {one['mean']:7.3f}  {one['together']:.0f}, {one['alone']:.0f}")
    return "\n".join(lines)


def _finding(found: Report) -> list[str]:
    shown = [
        f"  {condition}: {one['geometric_mean_s']:.1f} s, {one['found']:.0%} found, {one['trials']} trials"
        for condition, one in ((c, found[c]) for c in ("straight", "bent"))
    ]
    return ["finding, time bent / straight: " + _interval(found["ratio"], "{:.2f}"), *shown]


def _accuracy(found: Report, name: str) -> list[str]:
    shown = [
        f"  {condition}: {one['correct']:.1%} right, {one['trials']} trials"
        for condition, one in ((c, found[c]) for c in ("straight", "bent"))
    ]
    return [f"{name}, share right bent - straight: " + _interval(found["difference"], "{:+.3f}"), *shown]


def _preferences(found: Report) -> list[str]:
    lines = [f"preferences, {found['answers']} comparisons: score, and share of comparisons won"]
    for one, score in found["scores"].items():
        lines.append(f"  {one:<12} {_interval(score, '{:+.2f}')}, won {found['won'][one]:.0%}")
    return lines


def _interval(one: Report, style: str) -> str:
    if one["low"] is None:
        return f"{style.format(one['value'])} (one participant: no interval)"
    value, low, high, alone_low, alone_high = (
        style.format(one[key]) for key in ("value", "low", "high", "alone_low", "alone_high")
    )
    return f"{value}, {low} to {high} [{alone_low} to {alone_high}]"
