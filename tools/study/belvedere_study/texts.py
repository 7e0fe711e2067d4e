"""All words of the page, in one table. A translation is a JSON file with the same keys, given with `--texts`."""

from __future__ import annotations

import json
from pathlib import Path

from .things import COLOURS, KINDS

#: Letters in braces are replaced by the page.
TEXTS: dict[str, str] = {
    "language": "en",
    "title": "Straight and bent pictures",
    "lead": "A short study of how people find their way in pictures of towns, mountains and molecules.",
    "code.ask": "Your code, as your teacher gave it to you",
    "code.bad": "This is not a code of this study. Codes look like {example}.",
    "code.start": "Begin",
    "code.none": "No code? Ask your teacher. To look around, use {example}.",
    "consent.title": "Before you begin",
    "consent.what": (
        "You will see pictures, find and count things in them, remember routes, or say which of two pictures you"
        " prefer. This takes about {minutes} minutes. It is the pictures that are tested, not you."
    ),
    "consent.bent": (
        "Some pictures are drawn as a camera sees the world. Others are drawn along bent rays: what stands in front is"
        " seen from the side, and what lies behind it is seen from above or from beside it. Nothing is added or taken"
        " away."
    ),
    "consent.data": (
        "Your answers and how long they took are kept in this browser only, under your number. The page sends nothing."
        " At the end you get a file, and whether you hand it in is up to you. You can stop at any time."
    ),
    "consent.agree": "I have read this, and I take part of my own free will.",
    "consent.go": "Start",
    "resume": "Welcome back. {done} of {all} answers are here; you go on where you were.",
    "ready": "I am ready",
    "ready.hint": "Press the space bar, or the button.",
    "next": "Next",
    "break.title": "A short break",
    "break.text": "{done} of {all} are done. Rest your eyes for a moment, and go on when you like.",
    "practice": "Practice: this one does not count.",
    "practice.right": "Right.",
    "practice.wrong": "Not quite. {hint}",
    "practice.done": "Now it counts. Answer as fast as you can without mistakes.",
    "progress": "{done} of {all}",
    "task.find.title": "Find something",
    "task.find.text": (
        "Find what is asked for and click it. Behind houses, ridges or molecules much is hidden: with the arrow keys,"
        " or the buttons below the picture, you step to the left and right and see the place from there. A click beside"
        " it costs a second."
    ),
    "task.find.keys": (
        "Without a mouse: move the cross with the keys W, A, S and D (with Shift in small steps), and press Enter."
    ),
    "task.find.ask": "Find the {thing} and click it.",
    "task.find.miss": "That is something else.",
    "task.find.giveup": "I cannot find it",
    "task.find.hint": "There it is.",
    "task.count.title": "Count",
    "task.count.text": (
        "Count what is asked for, in all views together: what one view hides, another may show. Step with the arrow"
        " keys or the buttons, then type the number. After {seconds} seconds the picture goes away, and you answer from"
        " memory."
    ),
    "task.count.ask": "How many {things} are there?",
    "task.count.answer": "Number",
    "task.count.done": "Answer",
    "task.count.hint": "There are {answer}.",
    "task.path.title": "Remember a route",
    "task.path.text": (
        "A red route leads through a town, from the front to the back. Houses hide parts of it. You see it from several"
        " places, one after the other; then choose the map that shows it. The maps have the front of the town at the"
        " bottom, and the route begins at the dot."
    ),
    "task.path.ask": "Remember the red route.",
    "task.path.choose": "Which map shows the route? Press 1 to 4, or click.",
    "task.path.hint": "It was map {answer}.",
    "task.prefer.title": "Which picture is better?",
    "task.prefer.text": (
        "You see two pictures of the same town and route. Say in which of them you would rather follow the red route."
        " There is no right or wrong."
    ),
    "task.prefer.ask": "In which picture would you rather follow the red route? Press 1 to 5, or click.",
    "task.prefer.-2": "left, clearly",
    "task.prefer.-1": "left, a little",
    "task.prefer.0": "no difference",
    "task.prefer.1": "right, a little",
    "task.prefer.2": "right, clearly",
    "view.left": "Step left",
    "view.right": "Step right",
    "view.at": "View {view} of {all}",
    "picture.alt": "Picture of the task",
    "map.alt": "Map {number}",
    "end.title": "Done. Thank you!",
    "end.text": "Your answers are in the file below. Give it to your teacher, or copy the text.",
    "end.download": "Save the file",
    "end.copy": "Copy the text",
    "end.copied": "Copied.",
    "end.delete": "Delete my answers from this browser",
    "end.deleted": "Deleted.",
    "broken.storage": (
        "This browser keeps nothing between visits, so do not close the page before you have saved your file."
    ),
    "teacher.title": "For the teacher",
    "teacher.start": "Start a class",
    "teacher.word": "Word of the class (letters only, may be empty)",
    "teacher.people": "Number of participants",
    "teacher.from": "First number",
    "teacher.run": "What to run",
    "teacher.run.A": "A: finding, counting, path memory",
    "teacher.run.B": "B: preferred perspectives",
    "teacher.run.AB": "both",
    "teacher.minutes": "Minutes that there are",
    "teacher.length": "With so many minutes: {length}, about {minutes} minutes.",
    "teacher.length.full": "the full session",
    "teacher.length.short": "the short session",
    "teacher.tight": "Even the short session takes about {minutes} minutes.",
    "teacher.codes": "Codes",
    "teacher.codes.text": (
        "Give everybody this page and one code. Who opens a link need not type it. Copy the list into your own, or"
        " print this page."
    ),
    "teacher.code": "Code",
    "teacher.link": "Link",
    "teacher.merge": "Collect the answers",
    "teacher.merge.text": (
        "Drop the files here, or choose them. They are read on this machine and go nowhere. The first summary below"
        " says what was answered; the intervals come from the program: python -m belvedere_study analyse FILE.csv"
    ),
    "teacher.choose": "Choose files",
    "teacher.paste": "Or paste copied texts here, one after the other",
    "teacher.pasted": "what was pasted",
    "teacher.save": "Save all answers as one file",
    "teacher.foreign": "{file}: answers of another kit or study; left out.",
    "teacher.twice": "{rows} rows came twice and count once.",
    "teacher.have": "{people} participants, {rows} answers.",
    "teacher.unfinished": "Not finished: {who}.",
    "sum.task": "Task",
    "sum.straight": "Straight",
    "sum.bent": "Bent",
    "sum.find.time": "Finding: mean time (geometric), seconds",
    "sum.find.found": "Finding: found",
    "sum.count": "Counting: right",
    "sum.path": "Path memory: right",
    "sum.prefer": "Perspective",
    "sum.score": "Mean preference, -2 to 2",
    "sum.none": "no answers",
    "perspective.straight": "straight",
    "perspective.progressive": "progressive",
    "perspective.degressive": "degressive",
    "perspective.hybrid": "hybrid",
}

_PLURALS = {"car": "cars", "bus": "buses", "hut": "huts", "tower": "towers", "ball": "balls"}


def english() -> dict[str, str]:
    """The table, with every thing in every colour as a phrase of its own, for languages that bend words."""
    things = [what for kinds in KINDS.values() for what in kinds]
    phrases = {f"thing.{colour}.{what}": f"{colour} {what}" for colour in COLOURS for what in things}
    plurals = {f"things.{colour}.{what}": f"{colour} {_PLURALS[what]}" for colour in COLOURS for what in things}
    return {**TEXTS, **phrases, **plurals}


def table(translation: Path | None) -> dict[str, str]:
    """English, or a translation over it; unknown keys are refused, so that slips do not go unseen."""
    texts = english()
    if translation is not None:
        words = json.loads(translation.read_text(encoding="utf-8"))
        unknown = sorted(set(words) - set(texts))
        if unknown:
            raise ValueError(f"{translation}: unknown texts: {', '.join(unknown[:5])}")
        texts.update(words)
    return texts
