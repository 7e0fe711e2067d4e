//! Features of a layer that are drawn alike.

use belvedere_scene::{Color, FeatureStyle, LineClass};

/// Features of one style, in the order of the layer.
pub(super) struct Alike<'l, F> {
    pub(super) color: Color,
    /// Casing of its own.
    pub(super) casing: Option<Color>,
    pub(super) class: Option<LineClass>,
    /// Width or diameter in that of the layer.
    pub(super) scale: f64,
    pub(super) features: Vec<&'l F>,
}

/// The features of a layer by their styles, thin ones first, and else in the order in which the styles appear.
///
/// * `of`: style of a feature; `color`: that of the layer.
pub(super) fn alike<F>(features: &[F], color: Color, of: impl Fn(&F) -> Option<FeatureStyle>) -> Vec<Alike<'_, F>> {
    let mut groups: Vec<Alike<'_, F>> = Vec::new();
    for feature in features {
        let style = of(feature).unwrap_or_default();
        let (own, scale) = (style.color.unwrap_or(color), style.scale.max(0.0));
        let FeatureStyle { casing, class, .. } = style;
        let same = |g: &&mut Alike<'_, F>| (g.color, g.casing, g.class, g.scale) == (own, casing, class, scale);
        match groups.iter_mut().find(same) {
            Some(group) => group.features.push(feature),
            None => groups.push(Alike { color: own, casing, class, scale, features: vec![feature] }),
        }
    }
    groups.sort_by(|a, b| a.scale.total_cmp(&b.scale));
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn features_are_grouped_by_style_and_wide_ones_come_last() {
        let (layer, red) = (Color::rgb(1, 2, 3), Color::rgb(200, 0, 0));
        let style = |color, scale| Some(FeatureStyle { color, scale, ..FeatureStyle::default() });
        let features = [style(Some(red), 2.0), None, style(None, 1.0), style(Some(red), 2.0), style(Some(red), 1.0)];
        let groups = alike(&features, layer, |f| *f);
        let told: Vec<_> = groups.iter().map(|g| (g.color, g.scale, g.features.len())).collect();
        assert_eq!(told, [(layer, 1.0, 2), (red, 1.0, 1), (red, 2.0, 2)]);
    }
}
