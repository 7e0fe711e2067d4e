"""``python -m belvedere_study``: make a kit, analyse answers, try the analysis on made-up populations."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Sequence

from . import analysis, page, records, report, simulate, stimuli, texts
from .program import ProgramError


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs one command; returns the exit code."""
    asked = _parser().parse_args(arguments)
    try:
        code: int = asked.run(asked)
    except (ProgramError, records.RecordError, ValueError, OSError) as error:
        print(f"belvedere_study: {error}", file=sys.stderr)
        return 2
    return code


def _make(asked: argparse.Namespace) -> int:
    folder: Path = asked.out
    words = texts.table(asked.texts)
    extent = stimuli.QUICK if asked.quick else stimuli.FULL
    kit = stimuli.make(folder, asked.belvedere, asked.seed, asked.size, extent, asked.jobs)
    written = page.write(folder, kit, words)
    (folder / "texts.json").write_text(json.dumps(words, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    print(f"{written}: {written.stat().st_size / 1e6:.1f} MB, kit {kit['kit']}; teachers open {written.name}#teacher")
    return 0


def _analyse(asked: argparse.Namespace) -> int:
    found = analysis.analyse(records.read(asked.files))
    if asked.out:
        asked.out.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    print(report.text(found))
    return 0


def _simulate(asked: argparse.Namespace) -> int:
    found = simulate.coverage(asked.seed, asked.populations, asked.people, asked.length)
    print(report.coverage(found, asked.populations))
    return 0 if all(one["together"] >= 0.95 * asked.populations for one in found.values()) else 1


def _size(text: str) -> tuple[int, int]:
    width, _, height = text.partition("x")
    try:
        return int(width), int(height)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text} is no size such as 640x400") from None


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m belvedere_study", description=__doc__)
    commands = parser.add_subparsers(required=True)
    make = commands.add_parser("make", help="draw all pictures and pack the page")
    make.add_argument("-o", "--out", type=Path, required=True, metavar="FOLDER", help="folder of the kit")
    make.add_argument("--seed", type=int, default=1, help="seed of all places and tasks; 1 by default")
    make.add_argument("--belvedere", metavar="PATH", help="the program; by default $BELVEDERE, or the one on the path")
    make.add_argument("--size", type=_size, default=(640, 400), metavar="WxH", help="640x400 by default")
    make.add_argument("--quick", action="store_true", help="two scenes of each task, for tries")
    make.add_argument("--jobs", type=int, default=2, help="pictures that are drawn at a time; 2 by default")
    make.add_argument("--texts", type=Path, metavar="FILE.json", help="a translation: texts by the keys of texts.json")
    make.set_defaults(run=_make)
    analyse = commands.add_parser("analyse", help="what the answers say, with intervals")
    analyse.add_argument("files", type=Path, nargs="+", metavar="CSV", help="files of answers")
    analyse.add_argument("-o", "--out", type=Path, metavar="REPORT.json", help="the report as JSON, too")
    analyse.set_defaults(run=_analyse)
    tried = commands.add_parser("simulate", help="how often the intervals hold what is true of made-up populations")
    tried.add_argument("--populations", type=int, default=100, help="how many; 100 by default")
    tried.add_argument("--people", type=int, default=44, help="participants of each; 44 by default")
    tried.add_argument("--length", choices=("full", "short"), default="full", help="length of sessions")
    tried.add_argument("--seed", type=int, default=1, help="seed of the populations; 1 by default")
    tried.set_defaults(run=_simulate)
    return parser


if __name__ == "__main__":
    sys.exit(main())
