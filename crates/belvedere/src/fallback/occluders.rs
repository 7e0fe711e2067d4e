//! Occluders of a target, part by part: single boxes, named parts of meshes, other layers as a whole.

use belvedere_construct::rays::{Target, TargetSight};
use belvedere_core::{Aabb, DVec2, DVec3, View};
use belvedere_scene::molecule::MoleculeLayer;
use belvedere_scene::{BoxLayer, BoxShape, Layer, LayerKind, OwnLayer, Scene};

/// Depths up to this many near distances of the camera count as lying on its near plane.
const AT_EYE: f64 = 1.0 + 1e-9;

/// A part of a layer.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Part {
    /// Index of the layer.
    pub(super) layer: usize,
    /// Number of the box, or of the part of the mesh; `None` = the whole layer.
    pub(super) number: Option<usize>,
    /// Corners of its bounding box, scene coordinates.
    pub(super) corners: Vec<DVec3>,
    /// The target's own part of the layer, which is unchanged: numbers of atoms of a molecule, ascending.
    pub(super) spared: Vec<u32>,
}

/// An axis-parallel rectangle in the picture, pixels, and the depth range of its contents.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extent {
    pub(super) low: DVec2,
    pub(super) high: DVec2,
    pub(super) depth: [f64; 2],
}

impl Extent {
    /// Extent of the images of points; `None` if one of them has no image in front of the camera.
    pub(super) fn of(view: &View, points: &[DVec3]) -> Option<Self> {
        let nothing =
            Self { low: DVec2::INFINITY, high: DVec2::NEG_INFINITY, depth: [f64::INFINITY, f64::NEG_INFINITY] };
        points.iter().try_fold(nothing, |e, p| {
            let image = view.project(*p).ok().filter(|i| i.depth > AT_EYE * view.pinhole().near)?;
            let depth = [e.depth[0].min(image.depth), e.depth[1].max(image.depth)];
            Some(Self { low: e.low.min(image.pixel), high: e.high.max(image.pixel), depth })
        })
    }

    /// Whether both overlap or come closer than a margin.
    pub(super) fn meets(&self, other: &Self, margin_px: f64) -> bool {
        let (low, high) = (other.low - margin_px, other.high + margin_px);
        self.low.cmplt(high).all() && self.high.cmpgt(low).all()
    }
}

/// The parts of a layer that do not belong to the target.
fn parts(scene: &Scene, index: usize, target: &Target) -> Vec<Part> {
    let layer = &scene.layers[index];
    let own = target.own_parts.as_ref().filter(|(layer, _)| *layer == index).map_or(&[][..], |(_, parts)| parts);
    let spared = Vec::new;
    let whole =
        |bounds: Aabb| vec![Part { layer: index, number: None, corners: bounds.corners().to_vec(), spared: spared() }];
    match &layer.kind {
        _ if target.own_layers.contains(&index) => Vec::new(),
        LayerKind::Boxes(b) => {
            let part = |(k, b): (usize, &BoxShape)| Part {
                layer: index,
                number: Some(k),
                corners: b.corners().to_vec(),
                spared: spared(),
            };
            b.boxes.iter().enumerate().filter(|(k, _)| !own.contains(&(*k as u32))).map(part).collect()
        }
        LayerKind::Mesh(m) | LayerKind::Own(OwnLayer { surface: m, .. }) if m.mesh.part(0).is_some() => {
            let mut bounds = std::collections::BTreeMap::<u32, Aabb>::new();
            for t in 0..m.mesh.triangles().len() {
                let Some(part) = m.mesh.part(t).filter(|p| !own.contains(p)) else { continue };
                let of = bounds.entry(part).or_insert(Aabb::EMPTY);
                *of = of.union(Aabb::of(m.mesh.corners(t)));
            }
            let part = |(k, b): (u32, Aabb)| Part {
                layer: index,
                number: Some(k as usize),
                corners: b.corners().to_vec(),
                spared: spared(),
            };
            bounds.into_iter().map(part).collect()
        }
        LayerKind::Molecule(m) if !own.is_empty() => {
            let mesh = &m.surface.mesh;
            let others = (0..mesh.triangles().len()).filter(|&t| !is_one_of(own, mesh.part(t)));
            let rest = Aabb::of(others.flat_map(|t| mesh.corners(t)));
            let part = |b: Aabb| Part { spared: own.to_vec(), ..whole(b).remove(0) };
            Some(rest).filter(|b| !b.is_empty()).map(part).into_iter().collect()
        }
        LayerKind::Line(_) | LayerKind::Area(_) | LayerKind::Point(_) => Vec::new(),
        _ => Some(layer.bounds()).filter(|b| !b.is_empty()).map_or_else(Vec::new, whole),
    }
}

/// Whether a triangle's part is in a list of ascending numbers.
pub(super) fn is_one_of(numbers: &[u32], part: Option<u32>) -> bool {
    part.is_some_and(|part| numbers.binary_search(&part).is_ok())
}

/// The scene with the target alone; `None` for points and lines, which have no surface of their own.
pub(super) fn target_alone(scene: &Scene, target: &Target) -> Option<Scene> {
    if target.own_layers.is_empty() && target.own_parts.is_none() {
        return None;
    }
    let own = target.own_parts.as_ref();
    Some(filtered(scene, &|i| {
        let mut kind = scene.layers[i].kind.clone();
        kind.set_opacity(1.0);
        if target.own_layers.contains(&i) {
            return Some(kind);
        }
        let (_, numbers) = own.filter(|(layer, _)| *layer == i)?;
        match &mut kind {
            LayerKind::Boxes(b) => {
                b.boxes = numbers.iter().filter_map(|&k| b.boxes.get(k as usize).copied()).collect();
            }
            LayerKind::Mesh(m) | LayerKind::Own(OwnLayer { surface: m, .. }) => {
                m.mesh = m.mesh.only(&|t| is_one_of(numbers, m.mesh.part(t)))
            }
            LayerKind::Molecule(m) => keep_atoms(m, numbers),
            _ => {}
        }
        Some(kind)
    }))
}

fn keep_atoms(layer: &mut MoleculeLayer, atoms: &[u32]) {
    let mesh = &layer.surface.mesh;
    layer.surface.mesh = mesh.only(&|t| is_one_of(atoms, mesh.part(t)));
}

/// The parts of the layers that hide some of `target`, each tested as if it were alone.
pub(super) fn find(scene: &Scene, view: &View, target: &Target, layers: &[usize]) -> Vec<Part> {
    let empty = filtered(scene, &|_| None);
    let open = TargetSight::new(&empty, target).shown(view, 0.0);
    let extent = Extent::of(view, &target.points);
    let hides = |part: &Part| {
        let apart = extent.as_ref().zip(Extent::of(view, &part.corners));
        // The image of a ball is larger than that of its centre.
        let margin = 2.0 + target.radius() * view.pinhole().scale_px() / extent.map_or(1.0, |e| e.depth[0]);
        if apart.is_some_and(|(e, p)| !e.meets(&p, margin) || p.depth[0] > e.depth[1]) {
            return false;
        }
        let alone = filtered(scene, &|i| (i == part.layer).then(|| only(&scene.layers[i], part.number)));
        let seen = TargetSight::new(&alone, target).shown(view, 0.0);
        seen.share < open.share || seen.light < open.light - 1e-3
    };
    layers.iter().flat_map(|&i| parts(scene, i, target)).filter(hides).collect()
}

/// The scene with the same ids and numbers of layers, whose contents `kind` gives; empty layers where it gives none.
fn filtered(scene: &Scene, kind: &dyn Fn(usize) -> Option<LayerKind>) -> Scene {
    let nothing = || LayerKind::Boxes(BoxLayer::default());
    let layer = |(i, l): (usize, &Layer)| Layer {
        id: l.id.clone(),
        must_see: l.must_see,
        kind: kind(i).unwrap_or_else(nothing),
    };
    Scene {
        title: scene.title.clone(),
        crs: scene.crs,
        unit: scene.unit,
        layers: scene.layers.iter().enumerate().map(layer).collect(),
        representations: scene.representations.clone(),
        fonts: scene.fonts.clone(),
        drawings: scene.drawings.clone(),
    }
}

/// A layer with a single part.
fn only(layer: &Layer, number: Option<usize>) -> LayerKind {
    let mut kind = layer.kind.clone();
    match (&mut kind, number) {
        (LayerKind::Boxes(b), Some(k)) => b.boxes = b.boxes.get(k).copied().into_iter().collect(),
        (LayerKind::Mesh(m) | LayerKind::Own(OwnLayer { surface: m, .. }), Some(k)) => {
            m.mesh = m.mesh.only(&|t| m.mesh.part(t) == Some(k as u32))
        }
        _ => {}
    }
    kind
}

/// The scene without some parts.
pub(super) fn without(scene: &Scene, parts: &[&Part]) -> Scene {
    filtered(scene, &|i| {
        let gone: Vec<Option<usize>> = parts.iter().filter(|p| p.layer == i).map(|p| p.number).collect();
        let mut kind = scene.layers[i].kind.clone();
        if let Some(whole) = parts.iter().find(|p| p.layer == i && p.number.is_none()) {
            return match &mut kind {
                LayerKind::Molecule(m) if !whole.spared.is_empty() => {
                    keep_atoms(m, &whole.spared);
                    Some(kind)
                }
                _ => None,
            };
        }
        let stays = |k: usize| !gone.contains(&Some(k));
        match &mut kind {
            LayerKind::Boxes(b) if !gone.is_empty() => {
                let all = b.boxes.iter().enumerate().filter(|(k, _)| stays(*k)).map(|(_, b)| *b);
                b.boxes = all.collect();
            }
            LayerKind::Mesh(m) | LayerKind::Own(OwnLayer { surface: m, .. }) if !gone.is_empty() => {
                m.mesh = m.mesh.only(&|t| m.mesh.part(t).is_none_or(|p| stays(p as usize)));
            }
            _ => {}
        }
        Some(kind)
    })
}
