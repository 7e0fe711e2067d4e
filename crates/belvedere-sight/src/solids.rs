//! Which solids of a scene count: those that hide what is behind them, or others.

use belvedere_scene::{LayerKind, MeshLayer};

/// Boxes, meshes and molecules of a scene that meet lines of sight, by the opacity of their layers ([`LayerKind::opacity`]).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Solids {
    /// Those that hide what is behind them: nothing shines through them.
    #[default]
    Opaque,
    /// All that are drawn: a layer whose opacity is 0 is not.
    Drawn,
    /// Those of one layer that something shines through, by its index, and nothing else, ground included.
    Alone(usize),
}

/// Share of a layer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LayerPart {
    /// No part of it.
    Nothing,
    /// The triangles of a mesh that something shines through, or the others.
    Triangles {
        /// Whether something shines through them.
        see_through: bool,
    },
    /// All of it.
    Everything,
}

impl Solids {
    /// What of a layer, by its index, is among them.
    pub fn of(self, index: usize, kind: &LayerKind) -> LayerPart {
        let has_plate = kind.triangles().is_some_and(|mesh| mesh.has_plate);
        let part =
            |see_through: bool| if has_plate { LayerPart::Triangles { see_through } } else { LayerPart::Nothing };
        match self {
            Self::Alone(layer) if layer != index => LayerPart::Nothing,
            Self::Alone(_) if has_plate => LayerPart::Triangles { see_through: true },
            Self::Drawn if kind.opacity() <= 0.0 => part(false),
            Self::Opaque if kind.is_see_through() => part(false),
            _ => LayerPart::Everything,
        }
    }
}

impl LayerPart {
    /// Whether a triangle of a mesh, by its number, belongs to it.
    pub fn holds(self, mesh: &MeshLayer, triangle: usize) -> bool {
        match self {
            Self::Nothing => false,
            Self::Triangles { see_through } => mesh.is_see_through_at(triangle) == see_through,
            Self::Everything => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use belvedere_core::DVec3;
    use belvedere_scene::{BoxLayer, Color, Mesh, MeshColors};

    #[test]
    fn a_layer_that_shines_hides_nothing_but_by_its_plate() {
        let boxes = |opacity| LayerKind::Boxes(BoxLayer { opacity, ..BoxLayer::default() });
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let mesh = Mesh::in_parts(&corners, vec![[0, 1, 2], [0, 1, 3]], MeshColors::Layer, vec![0, 1]).expect("mesh");
        let town = MeshLayer { opacity: 0.4, has_plate: true, ..MeshLayer::new(mesh, Color::rgb(1, 2, 3)) };
        for (opacity, opaque, drawn) in [
            (1.0, LayerPart::Everything, LayerPart::Everything),
            (0.5, LayerPart::Nothing, LayerPart::Everything),
            (0.0, LayerPart::Nothing, LayerPart::Nothing),
        ] {
            let found = [Solids::Opaque, Solids::Drawn].map(|solids| solids.of(2, &boxes(opacity)));
            assert_eq!(found, [opaque, drawn], "{opacity}");
        }
        assert_eq!(Solids::Alone(1).of(2, &boxes(0.5)), LayerPart::Nothing);
        assert_eq!(Solids::Alone(2).of(2, &boxes(0.5)), LayerPart::Everything);
        let held = |solids: Solids| {
            let held = solids.of(0, &LayerKind::Mesh(town.clone()));
            [0, 1].map(|triangle| held.holds(&town, triangle))
        };
        assert_eq!(held(Solids::Opaque), [true, false], "the plate alone hides");
        assert_eq!(held(Solids::Drawn), [true, true]);
        assert_eq!(held(Solids::Alone(0)), [false, true]);
    }
}
