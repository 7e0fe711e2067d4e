//! Names of areas, each in the middle of the room that its area has.

use crate::marks::path::LinePoint;
use crate::marks::pole::{Pole, pole};
use crate::marks::request::{LabelRequest, rank_of};
use crate::marks::{MarkBuilder, Marker, darker};
use belvedere_core::DVec3;
use belvedere_scene::{AreaLayer, Color, Symbol};
use rayon::prelude::*;
use std::collections::HashMap;

/// Colour of a name and its rank.
type Look = (Color, Option<f64>);

impl MarkBuilder<'_> {
    /// Each name of a layer once, in the largest of the areas that bear it, where that place is seen; names of large areas come first.
    ///
    /// * `index`: of the layer in the scene.
    pub(super) fn area_names(&self, index: usize, layer: &AreaLayer) -> Vec<LabelRequest> {
        let Some(size_px) = layer.label_px else { return Vec::new() };
        let named = layer.features.par_iter().filter(|f| !f.name.trim().is_empty());
        let poles: Vec<(&str, Look, Pole)> = named
            .filter_map(|f| {
                let own = f.style.unwrap_or_default();
                let color = layer.outline.unwrap_or(own.color.unwrap_or(layer.fill));
                Some((f.name.trim(), (color, own.rank), pole(&f.rings)?))
            })
            .collect();
        let mut largest: HashMap<&str, (Look, Pole)> = HashMap::new();
        for (name, look, pole) in poles {
            let best = largest.entry(name).or_insert((look, pole));
            if pole.distance > best.1.distance {
                *best = (look, pole);
            }
        }
        let mut names: Vec<(&str, Look, Pole)> = largest.into_iter().map(|(n, (look, pole))| (n, look, pole)).collect();
        // Those with a rank first, else those with the most room.
        names.sort_by(|a, b| {
            let by_rank = rank_of(b.1.1).total_cmp(&rank_of(a.1.1));
            by_rank.then(b.2.distance.total_cmp(&a.2.distance)).then(a.0.cmp(b.0))
        });
        let (shown, is_shown) = self.shows(index);
        let mut requests = Vec::new();
        for (name, (color, rank), pole) in names {
            // On no ground nothing is painted.
            let Some(height) = self.scene.terrain().and_then(|ground| ground.surface_at(pole.at)) else { continue };
            let p: DVec3 = pole.at.extend(height + layer.lift_m);
            if shown != belvedere_sight::sections::Shown::Everything && !is_shown(p) {
                continue;
            }
            // Nothing is drawn there but the name.
            let marker = Marker { symbol: Symbol::Dot, half_px: 0.0, casing: false, hidden: layer.hidden };
            let on_line = LinePoint { p, along: 0.0, on_ground: true };
            let seen = self.mark(&on_line, layer.lift_m, marker, &mut Vec::new());
            let color = darker(color.with_alpha(255));
            let rank = rank_of(rank);
            requests.extend(seen.iter().map(|seen| LabelRequest {
                over: true,
                rank,
                ..seen.request(name, size_px, color)
            }));
        }
        requests
    }
}
