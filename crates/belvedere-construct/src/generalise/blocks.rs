//! Blocks: the footprints that stand for the buildings of a cell.

use super::settings::GeneraliseSettings;
use super::shapes::{
    Land, area, closed, common, filled_below, grown, one, parted, rectangle_round, shrunk, simplified, union, widened,
    without_specks,
};
use geo::{Area, BooleanOps, MultiPolygon};

/// How a cell is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum CellKind {
    /// Hardly built: the ground is green, blocks follow the buildings.
    Green,
    /// Built here and there: the block follows the buildings.
    Sparse,
    /// Built: the block follows the cell.
    Built,
    /// All its buildings are landmarks: no block.
    Landmarks,
}

/// Kind of a cell, by its built share.
pub(super) fn kind(coverage: f64, ordinary: usize, settings: &GeneraliseSettings) -> CellKind {
    if coverage < settings.green_below {
        CellKind::Green
    } else if ordinary == 0 {
        CellKind::Landmarks
    } else if coverage < settings.sparse_below {
        CellKind::Sparse
    } else {
        CellKind::Built
    }
}

/// Largest part of a building that may stay outside its block, m^2.
const LEFT_OUT_M2: f64 = 2.0;
/// Distance by which such parts are widened to join the block, metres.
const JOINT_M: f64 = 0.1;
/// Largest distance by which merged outlines are simplified, share of the largest simplification.
const FINE: f64 = 0.2;
/// Holes smaller than this are chinks between merged outlines, m^2.
const CHINK_M2: f64 = 25.0;
/// Distance by which outlines may reach out of their cell where no building does, share of the largest simplification.
const STRAY: f64 = 0.6;
/// Least share of a piece of a block that buildings cover.
const LEAST_BUILT: f64 = 0.05;
/// Ground that a block may cover, over that of its buildings; and shares of the closed gaps at which it follows them beyond that.
const MOST_GROUND: f64 = 1.5;
const CLOSER: [f64; 3] = [1.0, 0.4, 0.15];

/// Least distance of blocks from landmarks that buildings touch, metres.
const BY_LANDMARKS_M: f64 = 0.2;

/// How coarsely blocks follow buildings.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grain {
    /// Gaps twice as wide are closed, metres.
    pub closing_m: f64,
    /// Largest distance by which outlines move, metres.
    pub simplify_m: f64,
    /// Largest such distance for small outlines, share of the square root of their area.
    pub of_size: f64,
    /// Smaller holes are filled, m^2.
    pub hole_m2: f64,
    /// Share of its least rectangle that an outline must fill to be drawn as that rectangle.
    pub as_rectangle: f64,
    /// Largest number of triangles of a block that follows its buildings closely, as a share of theirs.
    pub triangles: f64,
}

impl Grain {
    /// Grain of the finer level (`times` = 1), or of the coarser one (2).
    pub(super) fn of(settings: &GeneraliseSettings, times: f64) -> Self {
        let closing_m = 0.5 * (1.0 + times) * settings.closing_m;
        Self {
            closing_m,
            simplify_m: 0.25 * times * closing_m,
            of_size: 0.04 + 0.08 * times,
            hole_m2: (2.0 * closing_m).powi(2),
            as_rectangle: 0.95 - 0.2 * times,
            triangles: 0.4 / times,
        }
    }

    /// A grain that follows buildings more closely: courtyards stay open, and gaps that are wider than `share` of those that are closed.
    fn finer(self, share: f64) -> Self {
        let closing_m = share * self.closing_m;
        Self { closing_m, simplify_m: share * self.simplify_m, hole_m2: CHINK_M2, ..self }
    }
}

/// Input of a block.
pub(super) struct Site<'a> {
    /// Ground of the cell.
    pub cell: &'a Land,
    /// Buildings that the block stands for, at least one.
    pub ordinary: &'a [&'a Land],
    /// Buildings that keep their shape.
    pub landmarks: &'a [&'a Land],
    /// Blocks and landmarks of the finer level in the cell; empty if there is no finer level.
    pub finer: &'a [&'a Land],
}

/// Footprint of a block, and how it lies over its buildings.
pub(super) struct Footprint {
    /// Outline.
    pub land: Land,
    /// Ground that its buildings cover, overlaps counted once, m^2.
    pub built_m2: f64,
    /// Part of that ground that lies in the outline, m^2.
    pub covered_m2: f64,
}

/// Footprint of the block of a cell: all of its buildings but for slivers lie in it, each piece of it holds some, and it keeps clear
/// of landmarks. A piece of the cell that is built well becomes part of the block as a whole, unless the block then covers more than
/// [`MOST_GROUND`] times the ground of its buildings, which have `triangles`: then it follows them, as closely as its own triangles allow.
pub(super) fn footprint(site: &Site<'_>, grain: Grain, triangles: usize, settings: &GeneraliseSettings) -> Footprint {
    let ground = Ground::of(site, settings);
    let ratio = |shape: &Footprint| area(&shape.land) / shape.built_m2.max(f64::MIN_POSITIVE);
    let most = grain.triangles * triangles as f64;
    let mut best = ground.footprint(grain, settings.sparse_below, settings);
    let as_whole = ground.free.iter().any(|piece| ground.is_built(&one(piece.clone()), settings.sparse_below));
    let closer = CLOSER.map(|share| grain.finer(share));
    for grain in as_whole.then_some(grain).into_iter().chain(closer) {
        if ratio(&best) <= MOST_GROUND {
            break;
        }
        let shape = ground.footprint(grain, f64::INFINITY, settings);
        if super::shapes::triangles(&shape.land) as f64 > most {
            break;
        }
        if ratio(&shape) < ratio(&best) {
            best = shape;
        }
    }
    best
}

/// The ground of a cell and what stands on it.
struct Ground {
    /// Ground that a block may take.
    free: Land,
    /// Buildings that the block stands for, without landmarks.
    buildings: Land,
    /// Landmarks, a little larger.
    landmarks: Land,
    /// What the block is put together from: its buildings, or blocks of the finer level.
    standing: Land,
}

impl Ground {
    fn of(site: &Site<'_>, settings: &GeneraliseSettings) -> Self {
        let joined = |lands: &[&Land]| union(lands.iter().map(|l| (*l).clone()).collect());
        let (mut buildings, mut landmarks) = (joined(site.ordinary), joined(site.landmarks));
        let mut free = main_pieces(site.cell, settings.smallest_cell_m2);
        if !landmarks.0.is_empty() {
            buildings = without_specks(buildings.difference(&landmarks));
            landmarks = simplified(&widened(&landmarks, BY_LANDMARKS_M), BY_LANDMARKS_M);
            free = without_specks(free.difference(&landmarks));
        }
        let standing = match site.finer {
            [] => buildings.clone(),
            finer => joined(finer),
        };
        Self { free, buildings, landmarks, standing }
    }

    /// Whether buildings cover at least a share of a piece of the ground.
    fn is_built(&self, piece: &Land, share: f64) -> bool {
        let built =
            || if self.free.0.len() == 1 { area(&self.buildings) } else { area(&common(piece, &self.buildings)) };
        share.is_finite() && built() >= share * area(piece)
    }

    /// The footprint in which pieces become part of the block as a whole whose built share is at least `built_well`.
    fn footprint(&self, grain: Grain, built_well: f64, settings: &GeneraliseSettings) -> Footprint {
        let Self { free, buildings, landmarks, standing } = self;
        let built_m2 = area(buildings);
        let is_built = |piece: &Land| self.is_built(piece, built_well);
        let (well, other): (Vec<Land>, Vec<Land>) = free.iter().cloned().map(one).partition(is_built);
        let mut land = union(well.iter().map(|piece| whole(piece, settings)).collect());
        let rest = if well.is_empty() { buildings.clone() } else { buildings.difference(&union(well)) };
        let rest = large_pieces(rest, LEFT_OUT_M2);
        if !rest.0.is_empty() {
            let other = MultiPolygon(other.into_iter().flatten().collect());
            let near = common(&closed(standing, grain.closing_m), &other);
            let followed = following(&union(vec![near, rest]), &other, landmarks, grain);
            land = if land.0.is_empty() { followed } else { union(vec![land, followed]) };
        }
        land = filled_below(&land, landmarks, CHINK_M2);
        let mut outside = buildings.difference(&land);
        if outside.iter().any(|p| p.unsigned_area() > LEFT_OUT_M2) {
            land = union(vec![land, grown(&large_pieces(outside, LEFT_OUT_M2), JOINT_M)]);
            land = if landmarks.0.is_empty() { land } else { land.difference(landmarks) };
            land = simplified(&filled_below(&land, landmarks, CHINK_M2), FINE * grain.simplify_m);
            outside = buildings.difference(&land);
            let cut_off = large_pieces(outside.clone(), LEFT_OUT_M2);
            if !cut_off.0.is_empty() {
                land = union(vec![land, grown(&cut_off, JOINT_M)]);
                land = if landmarks.0.is_empty() { land } else { land.difference(landmarks) };
                outside = buildings.difference(&land);
            }
        }
        let covered_m2 = built_m2 - area(&outside);
        Footprint { land: occupied(parted(land), buildings), built_m2, covered_m2 }
    }
}

/// Polygons larger than this, m^2.
fn large_pieces(mut land: Land, than: f64) -> Land {
    land.0.retain(|p| p.unsigned_area() > than);
    land
}

/// A piece of a cell as a block: clear of the streets where it is wide enough.
fn whole(piece: &Land, settings: &GeneraliseSettings) -> Land {
    let least = 0.5 * area(piece);
    for inset in [settings.inset_m, 0.5 * settings.inset_m] {
        let free = shrunk(piece, inset);
        if area(&free) >= least {
            return common(&simplified(&free, settings.simplify_m.min(inset)), piece);
        }
    }
    piece.clone()
}

/// Outlines around buildings with gaps closed, `near`, made simple; they leave `ground` by little, and keep clear of `landmarks`.
fn following(near: &Land, ground: &Land, landmarks: &Land, grain: Grain) -> Land {
    let filled = filled_below(near, landmarks, grain.hole_m2);
    let simple = filled.iter().map(|polygon| {
        if let Some(rectangle) = rectangle_round(polygon, grain.as_rectangle).map(one)
            && (polygon.exterior().0.len() <= 5 || area(&common(&rectangle, ground)) > 0.97 * area(&rectangle))
        {
            return rectangle;
        }
        let by = grain.simplify_m.min(grain.of_size * polygon.unsigned_area().sqrt());
        simplified(&grown(&one(polygon.clone()), STRAY * by), by)
    });
    let simple = union(simple.collect());
    let reach = grown(ground, STRAY * grain.simplify_m);
    let strays = !large_pieces(simple.difference(&reach), LEFT_OUT_M2).0.is_empty();
    let simple = if strays { common(&simple, &union(vec![reach, near.clone()])) } else { simple };
    if landmarks.0.is_empty() { simple } else { simple.difference(landmarks) }
}

/// The pieces of a cell that are large enough for themselves, or all if none is.
fn main_pieces(cell: &Land, smallest: f64) -> Land {
    let large: Vec<_> = cell.iter().filter(|p| p.unsigned_area() >= smallest).cloned().collect();
    if large.is_empty() { cell.clone() } else { MultiPolygon(large) }
}

/// The pieces on which buildings stand, or the one that holds most of them.
fn occupied(land: Land, buildings: &Land) -> Land {
    if land.0.len() < 2 {
        return land;
    }
    let built = |p: &geo::Polygon<f64>| area(&common(&one(p.clone()), buildings));
    let pieces: Vec<_> = land.into_iter().map(|p| (built(&p), p)).collect();
    let most = pieces.iter().map(|(built, _)| *built).fold(0.0, f64::max);
    let stays = |built: f64, p: &geo::Polygon<f64>| {
        built >= most || built >= (LEAST_BUILT * p.unsigned_area()).max(LEFT_OUT_M2)
    };
    MultiPolygon(pieces.into_iter().filter(|(built, p)| stays(*built, p)).map(|(_, p)| p).collect())
}
