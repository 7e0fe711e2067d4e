"""Reports as typed values; each keeps the whole report of the engine in ``raw``, as the command line writes it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Mapping

__all__ = ["Note", "Displacement", "Shares", "RevealReport", "MeasureReport", "GroundReport", "FilmReport", "Picked", "PresetShape", "PresetCheck"]

Raw = Mapping[str, Any]


@dataclass(frozen=True)
class Note:
    """A warning: an oddity that did not stop the work."""

    #: What the reader learns, such as ``"suspect"`` or ``"filled"``.
    kind: str
    #: One sentence.
    text: str
    #: Layer, feature, file or stage that it is about, or an empty text.
    subject: str = ""
    #: Figures by name; units stand at the end of the names, shares are in 0..=1.
    figures: Mapping[str, float] = field(default_factory=dict)
    #: Key of a layer, a scene or a call that settles it, such as ``"source_crs"``, or an empty text.
    key: str = ""

    def __str__(self) -> str:
        return self.text


def notes_of(raw: list[Any]) -> list[Note]:
    """Warnings of the engine."""
    return [Note(n["kind"], n["text"], n.get("subject") or "", n.get("figures") or {}, n.get("key") or "") for n in raw]


@dataclass(frozen=True)
class Displacement:
    """How far the points that a picture shows are displaced."""

    #: Largest distance in space, scene units.
    max_m: float
    #: Largest distance in the picture, pixels.
    max_px: float
    raw: Raw = field(repr=False)

    @classmethod
    def of(cls, raw: Raw) -> Displacement:
        """The typed form of a report."""
        return cls(float(raw["max_m"]), float(raw["max_px"]), raw)


@dataclass(frozen=True)
class Shares:
    """Shares of the whole required features, 0..=1; what lies outside the picture is not visible."""

    #: Visible share.
    visible: float
    #: Share inside the picture, hidden or not.
    in_frame: float


@dataclass(frozen=True)
class RevealReport:
    """What was found."""

    #: Technique that bends the picture; ``None`` if it is straight.
    technique: str | None
    #: In the straight picture.
    straight: Shares
    #: In the bent picture.
    bent: Shares
    raw: Raw = field(repr=False)

    @classmethod
    def of(cls, raw: Raw) -> RevealReport:
        """The typed form of a report."""
        straight = Shares(raw["visible_straight"], raw["in_frame_straight"])
        return cls(raw.get("technique"), straight, Shares(raw["visible_bent"], raw["in_frame_bent"]), raw)


@dataclass(frozen=True)
class MeasureReport:
    """What a picture shows of the required features."""

    #: Visible share of the whole features in the scene's view; ``None`` without features.
    visible: float | None
    #: Share inside the picture, likewise.
    in_frame: float | None
    #: Stages in order of application.
    stages: tuple[str, ...]
    #: Warnings of opening the scene and of measuring.
    warnings: tuple[Note, ...]
    raw: Raw = field(repr=False)

    @classmethod
    def of(cls, raw: Raw) -> MeasureReport:
        """The typed form of a report."""
        return cls(raw["visible"], raw["in_frame"], tuple(raw["stages"]), tuple(notes_of(raw["warnings"])), raw)


@dataclass(frozen=True)
class GroundReport:
    """What the terrain solver did."""

    #: Visible share of the whole features on the written heights, 0..=1.
    visible: float
    #: The same before.
    visible_before: float
    #: Share of the features in view.
    in_view: float
    #: Whether visibility is guaranteed on the written heights.
    guaranteed: bool
    #: Largest and root mean square displacement of the ground, metres.
    max_m: float
    rms_m: float
    raw: Raw = field(repr=False)

    @classmethod
    def of(cls, raw: Raw) -> GroundReport:
        """The typed form of a report."""
        shares = (raw["visible_whole"], raw["visible_whole_before"], raw["in_view"])
        return cls(*shares, raw["guaranteed"], raw["max_m"], raw["rms_m"], raw)


@dataclass(frozen=True)
class FilmReport:
    """Frames and film of an animation."""

    #: Folder of the numbered frames.
    folder: str
    #: The film; ``None`` if none was asked for, or it could not be encoded.
    film: str | None
    #: Why there is no film, and the command that makes it.
    film_missing: str | None
    #: Frames of the animation, and those that this call drew.
    frames: int
    drawn: int
    fps: float
    warnings: tuple[Note, ...]
    raw: Raw = field(repr=False)

    @classmethod
    def of(cls, raw: Raw) -> FilmReport:
        """The typed form of a report."""
        folder, film, missing = raw["folder"], raw["film"], raw["film_missing"]
        return cls(folder, film, missing, raw["frames"], raw["drawn"], raw["fps"], tuple(notes_of(raw["warnings"])), raw)


@dataclass(frozen=True)
class Picked:
    """What is seen at a pixel."""

    #: Undisplaced world point, scene coordinates.
    point: tuple[float, float, float]
    #: Depth at which it is seen, scene units.
    depth: float
    #: Segment of the curved ray: 2k is the straight part of viewpoint k, 2j-1 the transition of turn j.
    segment: int
    #: Id of the layer.
    layer: str
    #: Name of the feature, part or atom, if it has one.
    feature: str | None
    raw: Raw = field(repr=False)

    @classmethod
    def of(cls, raw: Raw) -> Picked:
        """The typed form of a report."""
        x, y, z = raw["point"]
        return cls((x, y, z), raw["depth"], raw["segment"], raw["layer"], raw["feature"], raw)


@dataclass(frozen=True)
class PresetShape:
    """The curve of a preset in figures."""

    name: str
    #: Viewing angle, degrees.
    phi_deg: float
    #: Slopes at the near end, the pivot and the far end, degrees.
    slopes_deg: tuple[float, float, float]
    #: Length, curve units.
    length: float
    raw: Raw = field(repr=False)

    @classmethod
    def of(cls, raw: Raw) -> PresetShape:
        """The typed form of a report."""
        near, pivot, far = raw["slopes_deg"]
        return cls(raw["name"], raw["phi"], (near, pivot, far), raw["length"], raw)


@dataclass(frozen=True)
class PresetCheck:
    """At which viewing angles a preset document is usable."""

    #: ``valid``, ``usable-in-part`` or ``not-usable``.
    verdict: str
    #: Ranges of viewing angles at which all ground faces the eye, degrees.
    usable_deg: tuple[tuple[float, float], ...]
    presets: tuple[PresetShape, ...]
    warnings: tuple[Note, ...]
    raw: Raw = field(repr=False)

    @classmethod
    def of(cls, raw: Raw) -> PresetCheck:
        """The typed form of a report."""
        usable = tuple((r["from_deg"], r["to_deg"]) for r in raw["usable"])
        return cls(raw["verdict"], usable, tuple(map(PresetShape.of, raw["presets"])), tuple(notes_of(raw["warnings"])), raw)
