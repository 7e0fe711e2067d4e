"""Runs the program ``belvedere`` on scenes that are made here."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Sequence

import numpy as np
from numpy.typing import NDArray

from . import pictures

Scene = dict[str, Any]
Buffer = NDArray[Any]


class ProgramError(RuntimeError):
    """The program could not do what it was asked."""


@dataclass(frozen=True)
class Visible:
    """What `measure` says of the layers that must be seen: shares of their length, 0 to 1."""

    straight: float
    bent: float
    in_frame_straight: float
    in_frame_bent: float


@dataclass(frozen=True)
class Program:
    """The program, and the folder in which scenes and their files are laid."""

    path: str
    folder: Path

    @staticmethod
    def find(path: str | None, folder: Path) -> Program:
        """The program that is named, else the one of ``$BELVEDERE``, else the one on the path."""
        named = path or os.environ.get("BELVEDERE") or "belvedere"
        found = shutil.which(named)
        if found is None:
            raise ProgramError(f"{named} is not there; say where the program is with --belvedere PATH")
        return Program(str(Path(found).resolve()), folder)

    def version(self) -> str:
        """Name and version, such as ``belvedere 0.1.0``."""
        return self._run("--version").strip()

    def ids(self, scene: Scene, name: str) -> Buffer:
        """The buffer of layers: 1 + index of the layer that a pixel shows, 0 where sky."""
        return self._buffers(scene, name, ("id",))[0]

    def ids_and_places(self, scene: Scene, name: str) -> tuple[Buffer, Buffer]:
        """The buffer of layers and that of true positions, NaN where sky."""
        ids, world = self._buffers(scene, name, ("id", "world"))
        return ids, world

    def picture(self, scene: Scene, name: str) -> tuple[pictures.Picture, Buffer]:
        """The finished picture as it goes into the page, and its buffer of layers."""
        drawn = self.folder / f"{name}.{pictures.drawn_as()}"
        self._draw(scene, name, drawn, "--aux", "id")
        ids = self._take(drawn, "id")
        picture = pictures.encode(drawn)
        drawn.unlink()
        return picture, ids

    def visible(self, scene: Scene, name: str) -> Visible:
        """Shares of the layers that must be seen, straight and bent."""
        answer = json.loads(self._run("measure", str(self._lay(scene, name)), "--json"))
        keys = ("visible_straight", "visible_bent", "in_frame_straight", "in_frame_bent")
        return Visible(*(float(answer[key]) for key in keys))

    def _buffers(self, scene: Scene, name: str, wanted: Sequence[str]) -> list[Buffer]:
        drawn = self.folder / f"{name}.png"
        self._draw(scene, name, drawn, "--samples", "1", "--aux", ",".join(wanted))
        taken = [self._take(drawn, one) for one in wanted]
        drawn.unlink()
        return taken

    def _draw(self, scene: Scene, name: str, drawn: Path, *options: str) -> None:
        # The mark in the corner would tell the participants which pictures are bent.
        self._run("render", str(self._lay(scene, name)), "-o", str(drawn), "--overwrite", "--no-mark", *options)
        drawn.with_name(drawn.name + ".json").unlink(missing_ok=True)

    def _take(self, drawn: Path, buffer: str) -> Buffer:
        file = drawn.with_suffix(f".{buffer}.npy")
        array: Buffer = np.load(file)
        file.unlink()
        return array

    def _lay(self, scene: Scene, name: str) -> Path:
        path = self.folder / f"{name}.scene.json"
        path.write_text(json.dumps(scene), encoding="utf-8")
        return path

    def _run(self, *arguments: str) -> str:
        command = [self.path, *arguments]
        if arguments[0] != "--version":
            # One thread each: several pictures are drawn at a time, and the bytes are the same on any number.
            command += ["--threads", "1", "--quiet", "--no-remember"]
        ran = subprocess.run(command, capture_output=True, text=True, check=False)
        if ran.returncode != 0:
            raise ProgramError(ran.stderr.strip() or f"{self.path} ended with {ran.returncode}")
        return ran.stdout
