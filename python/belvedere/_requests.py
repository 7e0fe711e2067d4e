"""Options of requests, made from their schema by python/tests/request_options.py."""

from __future__ import annotations

from typing import Any, Literal, Mapping, Sequence, TypedDict


class RevealOptions(TypedDict, total=False):
    """Options of :func:`belvedere.reveal` beside those of its signature; each is that of the command line of this name."""

    #: Style of areas, instead of the one that their properties and names give
    area_style: Literal["auto", "outline", "plain", "water", "forest", "glacier", "park"] | None

    #: Biological assembly of molecules, such as 1: draws the copies that the file describes (`info` lists them); asymmetric = the atoms of the file alone
    assembly: str | None

    #: Quiet clouds over a share of the sky, 0..=1; 0.4 without a value
    clouds: float | None

    #: Colours of molecules: auto (by element; ribbons and surfaces by chain), element, chain, residue, structure, or one colour #rrggbb
    color_by: str | None

    #: Draw lines of equal height on the ground, every M metres of true height; by default at an interval that fits the scale
    contours: bool | float | None

    #: Lower the ground with the distance, as on a sphere, with refraction
    curved_earth: bool

    #: Pixels per inch, 300 with --paper unless --size is given; lengths that the scene states in pixels are 1/96 inch each
    dpi: float | None

    #: How the ground ends where its data end: soft (it fades), block (it is cut, with sides), mat (it stands on a plain surface), plain
    edge: Literal["plain", "soft", "mat", "block"] | None

    #: Multiply heights over the median height of the terrain by F, 0.01 to 100; the straight picture keeps the true heights
    exaggeration: float | None

    #: Haze: on (the default: dims the farther part of the view), off, or the visibility in kilometres
    haze: bool | float | None

    #: Style of hidden parts of features; by default lines are dashed, outlines of areas cut, points faint
    hidden: Literal["show", "fade", "dash", "cut"] | None

    #: Write the names of lines, areas and points
    labels: bool

    #: What covers the ground instead of a guess by climate and relief: a raster of ESA WorldCover, CORINE or NLCD, or areas of OpenStreetMap
    landcover: str | None

    #: Light the scene as the sun does over the eye at this time, such as 2026-07-01T15:00:00Z or 2026-07-01T17:00+02:00: shading by the sun alone while it is up (unless --relief says otherwise), with cast shadows
    light_time: str | None

    #: What the lines of a file are, as FILE=CLASS, instead of what their properties and the name of the file say: route (drawn as if nothing were known), main_road, road, track, path, railway, lift, river, stream, piste_green, piste_blue, piste_red, piste_black, piste or border; may be given several times
    line_class: Sequence[Any]

    #: White margin of the paper on every side, millimetres; PNG, TIFF, JPEG and WebP leave it out
    margin_mm: float | None

    #: Model of a file of molecules that holds several, from 1, or all
    model: int | Literal["all"] | None

    #: Property that holds the names of features, instead of the one that looks most like a name
    name_field: str | None

    #: Lift the limits of plausible ground: no lower than a fifth of the relief below the lowest point, no steeper than twice the 99.9th percentile of the terrain's slopes
    no_limits: bool

    #: Draw no shadows on molecules, which have them without --shadows
    no_shadows: bool

    #: Tint of the terrain: auto (the default: meadows, forest, rock and snow as the climate of the place has them), swiss, winter, autumn, alpine, desert, glacial, atlas, clear, plain, night, or a file of colours by height (GDAL colour-relief text, GMT .cpt)
    palette: str | None

    #: Paper: A0 to A6 (landscape where the picture is wider than high), A3-portrait, A3-landscape, or a size such as 420x297mm; pixels, widths of lines and heights of letters follow from it
    paper: str | None

    #: Tint the ground by height alone: no forest, rock or snow by rule, and no relief finer than the data
    plain: bool

    #: Shading of the terrain; swiss by default, sun with --light-time
    relief: Literal["swiss", "sun", "none"] | None

    #: Renderer, as of `render`: auto, cpu, exact, or one that the program registers
    renderer: str

    #: What molecules are shown as, instead of what the scene says; without a scene auto
    representation: Literal["ball_and_stick", "space_filling", "sticks", "ribbon", "surface", "auto"] | None

    #: Coverage samples per pixel: 1, 4 or 16; 4 by default
    samples: int | None

    #: Draw cast shadows
    shadows: bool

    #: Sky: auto (by the height of the sun), day, dusk, night, white, a colour #rrggbb, or transparent (PNG and SVG)
    sky: str | None

    #: Coordinate system of the terrain's file, instead of the stated one
    source_crs: str | None

    #: Technique that bends the picture; by default a spline, with --see curved rays
    technique: Literal["auto", "spline", "terrain", "both", "curved_rays"] | None

    #: Title in the picture
    title: str | None

    #: Colours and opacities of volumes with --see: auto, solid, engine, ct-bone, ct-soft, vessels, grey, or a file
    transfer: str | None

    #: Axis that points upwards in the picture, with --see: x, y, z, -x, -y or -z
    up: Sequence[Any] | None

    #: Unit of the terrain's heights, instead of the stated one
    vertical_unit: Literal["m", "ft", "us-ft"] | None


class RenderOptions(TypedDict, total=False):
    """Options of :meth:`belvedere.Scene.render` beside those of its signature; each is that of the command line of this name."""

    #: Style of the areas of all layers, instead of the scene's; auto = the one that properties and names give
    area_style: Literal["auto", "outline", "plain", "water", "forest", "glacier", "park"] | None

    #: Biological assembly of molecules, such as 1: draws the copies that the file describes (`info` lists them); asymmetric = the atoms of the file alone
    assembly: str | None

    #: Quiet clouds over a share of the sky, 0..=1; 0.4 without a value
    clouds: float | None

    #: Colours of molecules: auto (by element; ribbons and surfaces by chain), element, chain, residue, structure, or one colour #rrggbb
    color_by: str | None

    #: Draw lines of equal height on the ground, every M metres of true height; by default at an interval that fits the scale
    contours: bool | float | None

    #: How the ground ends where its data end: soft (it fades), block (it is cut, with sides), mat (it stands on a plain surface), plain
    edge: Literal["plain", "soft", "mat", "block"] | None

    #: Haze: on (the default: dims the farther part of the view), off, or the visibility in kilometres
    haze: bool | float | None

    #: Direction in the middle of the panorama, degrees clockwise from north; 0 by default
    heading: float | None

    #: What covers the ground instead of a guess by climate and relief: a raster of ESA WorldCover, CORINE or NLCD, or areas of OpenStreetMap
    landcover: str | None

    #: Model of a file of molecules that holds several, from 1, or all
    model: int | Literal["all"] | None

    #: Draw the sea as ordinary ground
    no_sea: bool

    #: Tint of the terrain instead of the scene's: a name, as of `reveal`, or a file of colours by height (GDAL text, GMT .cpt)
    palette: str | None

    #: Draw the whole circle around a place: x,y of the scene, lon,lat in degrees, or 46.5N,11.3E, and the height of the eye in metres or as +20 over the ground; 2 m over it by default
    panorama: str | Sequence[Any] | None

    #: Direction of the middle row, degrees below the horizon; 0 by default
    pitch: float | None

    #: Tint the ground by height alone: no forest, rock or snow by rule, and no relief finer than the data
    plain: bool

    #: Largest distance from the line that is shown; by default four times the clearance of a traced centreline, else a tenth of its length
    radius: float | None

    #: What molecules are shown as, instead of what the scene says; without a scene auto
    representation: Literal["ball_and_stick", "space_filling", "sticks", "ribbon", "surface", "auto"] | None

    #: Side from which the line is seen, degrees about it; 0 by default, where what was above stays above as far as it can
    side: float | None

    #: Sky: auto (by the height of the sun), day, dusk, night, white, a colour #rrggbb, or transparent (PNG and SVG)
    sky: str | None

    #: Angle from the left to the right side of the panorama, degrees; 360 by default
    span: float | None

    #: Unroll it from a sphere, with evenly spaced angles from row to row, instead of a cylinder
    sphere: bool

    #: Straighten what lies around a line, such as a vessel, and cut it open along the line: a file (CSV `x,y,z`, OBJ, JSON), a line layer, or X,Y,Z:X,Y,Z, two points of a volume between which the centreline is traced
    straighten: Sequence[Any] | str | None

    #: Thresholds per pixel in transitions between styling sections, 1 to 4096; 64 by default, 1 is a dither
    thresholds: int | None

    #: Look at it from outside instead of cutting it open
    uncut: bool


class AnimateOptions(TypedDict, total=False):
    """Options of :func:`belvedere.animate` beside those of its signature; each is that of the command line of this name."""

    #: How representations of styling sections are composited; single by default
    compositing: Literal["single", "dither", "layers"] | None

    #: Pixels per inch, 300 with --paper unless --size is given; lengths that the scene states in pixels are 1/96 inch each
    dpi: float | None

    #: Largest error of the terrain's level of detail, pixels, 0 to 64; 0.5 by default, 0 draws every grid cell
    lod: float | None

    #: White margin of the paper on every side, millimetres; PNG, TIFF, JPEG and WebP leave it out
    margin_mm: float | None

    #: Paper: A0 to A6 (landscape where the picture is wider than high), A3-portrait, A3-landscape, or a size such as 420x297mm; pixels, widths of lines and heights of letters follow from it
    paper: str | None

    #: Renderer: auto (the scene's, else the fastest that there is), cpu (the rasteriser on the processor), exact (the tracer along the curved ray of every sample: slow, without subdivision error, the reference), or one that the program registers
    renderer: str

    #: Thresholds per pixel in transitions between styling sections, 1 to 4096; 64 by default, 1 is a dither
    thresholds: int | None


class DisoccludeOptions(TypedDict, total=False):
    """Options of :func:`belvedere.disocclude` beside those of its signature; each is that of the command line of this name."""

    #: Style of areas in the picture, instead of the one that their properties and names give
    area_style: Literal["auto", "outline", "plain", "water", "forest", "glacier", "park"] | None

    #: Lower the ground with the distance, as on a sphere, with refraction
    curved_earth: bool

    #: Most the ground may move, metres: the dearest stretches of the features are given up until it moves no more
    move_at_most: float | None

    #: Property that holds the names of features, instead of the one that looks most like a name
    name_field: str | None

    #: Show what is in view to programs that cut the cells of the heights from north-east to south-west as well: auto, the default, if the ground moves by less than 1.3 times as much, always or never; without a value always
    robust: Literal["auto", "always", "never"] | None

    #: Share of the features in view to show, such as 0.95 or 95%: the dearest stretches beyond it are given up, and less ground moves; 100% shows all, whatever it costs (default: all that leaves the landscape like itself)
    show: float | None

    #: Unit of the terrain's heights, instead of the stated one
    vertical_unit: Literal["m", "ft", "us-ft"] | None
