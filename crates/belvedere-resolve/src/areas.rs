//! Area layers: their surfaces, and the sources of this choice.

use super::ground::Ground;
use super::loader::Loader;
use super::{builtin, by_property, vectors};
use crate::BelvedereError;
use crate::record::AreaRecord;
use belvedere_core::{Warning, WarningKind};
use belvedere_document::{AreaDoc, AreaStyleDoc, LayerDoc, Paths, SurfaceDoc};
use belvedere_io::OnGround;
use belvedere_io::vector::AreaKind;
use belvedere_scene::{AreaLayer, AreaSurface, Color, LayerKind, Scene};

/// An area layer.
pub(super) fn layer(
    loader: &mut Loader<'_>,
    index: usize,
    doc: &AreaDoc,
    ground: &Ground<'_>,
) -> Result<LayerKind, BelvedereError> {
    let (OnGround { mut features, beyond }, found) = match &doc.source {
        Paths::One(name) if builtin::is_name(name) => {
            let (features, surface) = loader
                .builtin(index, name, |kind| kind.areas().map(|layer| (layer.features.clone(), layer.surface)))?;
            (OnGround { features, beyond: 0.0 }, AreaKind { surface, why: format!("{name} says so") })
        }
        paths => vectors::areas(loader, index, &doc.id, paths, ground)?,
    };
    if features.is_empty() {
        return Err(loader.fail(index, "source", "no area lies on the terrain; check that the source covers it"));
    }
    let style = &doc.style;
    let stated = stated(loader, style);
    if stated.is_none() && found.surface == AreaSurface::Outline {
        let remark = format!("{}: drawn as outlines; surface says what they are", found.why);
        loader.note(index, [Warning::new(WarningKind::Assumed, remark)]);
    }
    let AreaKind { surface, why } = stated.unwrap_or(found);
    loader.areas.push(AreaRecord { layer: doc.id.clone(), kind: surface.name(), areas: features.len(), why });
    let fill = match &style.color {
        Some(color) => loader.color(index, color)?,
        None => surface.color(),
    };
    features.iter_mut().for_each(|f| f.style = by_property::as_opaque_as(fill, f.style));
    Ok(AreaLayer {
        features,
        fill,
        outline: match &style.outline {
            Some(color) => loader.optional_color(index, color)?,
            None => surface.outline(),
        },
        width_px: style.width_px,
        surface,
        hidden: style.hidden,
        lift_m: style.lift_m,
        label_px: (style.labels || style.label.is_some()).then_some(style.label_px),
        beyond,
    }
    .into())
}

/// Surface given by options or the scene.
fn stated(loader: &Loader<'_>, style: &AreaStyleDoc) -> Option<AreaKind> {
    let by_option = loader.options.area_style.and_then(surface);
    let by_option = by_option.map(|s| (s, format!("asked for: area style {}", s.name())));
    let by_key = style.surface.and_then(surface).map(|s| (s, format!("the scene says surface = \"{}\"", s.name())));
    let by_water = style.water.map(|water| {
        let surface = if water { AreaSurface::Water } else { AreaSurface::Plain };
        (surface, format!("the scene says water = {water}"))
    });
    by_option.or(by_key).or(by_water).map(|(surface, why)| AreaKind { surface, why })
}

/// `None`: it is to be found from the file.
fn surface(doc: SurfaceDoc) -> Option<AreaSurface> {
    Some(match doc {
        SurfaceDoc::Auto => return None,
        SurfaceDoc::Outline => AreaSurface::Outline,
        SurfaceDoc::Plain => AreaSurface::Plain,
        SurfaceDoc::Water => AreaSurface::Water,
        SurfaceDoc::Forest => AreaSurface::Forest,
        SurfaceDoc::Glacier => AreaSurface::Glacier,
        SurfaceDoc::Park => AreaSurface::Park,
    })
}

/// The style of an area layer for another surface than its own: colours become those of the surface.
pub fn restyle(style: &mut AreaStyleDoc, kind: SurfaceDoc) {
    (style.surface, style.water, style.color, style.outline) = (Some(kind), None, None, None);
}

/// Writes the surfaces found, and their colours, into the areas of a document.
pub fn fill_surfaces(layers: &mut [LayerDoc], scene: &Scene) {
    for doc in layers {
        let LayerDoc::Area(doc) = doc else { continue };
        let layer = scene.layers.iter().find(|l| l.id == doc.id);
        let Some(layer) = layer.and_then(|layer| layer.kind.areas()) else { continue };
        doc.style.water = None;
        doc.style.surface = Some(match layer.surface {
            AreaSurface::Outline => SurfaceDoc::Outline,
            AreaSurface::Plain => SurfaceDoc::Plain,
            AreaSurface::Water | AreaSurface::Sea => SurfaceDoc::Water,
            AreaSurface::Forest => SurfaceDoc::Forest,
            AreaSurface::Glacier => SurfaceDoc::Glacier,
            AreaSurface::Park => SurfaceDoc::Park,
        });
        doc.style.color.get_or_insert_with(|| hex(layer.fill));
        doc.style.outline.get_or_insert_with(|| layer.outline.map_or_else(|| "none".into(), hex));
    }
}

fn hex(Color { r, g, b, a }: Color) -> String {
    let alpha = if a == 255 { String::new() } else { format!("{a:02x}") };
    format!("#{r:02x}{g:02x}{b:02x}{alpha}")
}
