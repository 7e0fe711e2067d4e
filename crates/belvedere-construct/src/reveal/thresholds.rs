//! The thresholds by which pictures that reveal something are chosen, each with its reason. Shares are of the whole subject, 0..=1. "Taste" is
//! what nobody has measured.

/// Visible share from which on nothing more is tried, and a goal counts as reached.
///
/// Taste: a hundredth of a route is what one hardly misses. With 0.995 half as much may
/// stay hidden, and pictures move more for it; with 0.98 a gap of a fiftieth of a route counts as none.
pub const ENOUGH: f64 = 0.99;

/// Visible share of what is in the frame from which on nothing counts as hidden, so that nothing is bent.
///
/// Half of what [`ENOUGH`] leaves open. With 0.99 a picture that just reaches its goal is never bent; with 0.9975 single samples that
/// graze a ridge, of some hundreds along a route, bend pictures in which all is seen.
pub const NOTHING_HIDDEN: f64 = 0.995;

/// The same where a technique is asked for that shows all: what rounding may leave of a share that is a sum over thousands of samples.
pub const ALL_SHOWN: f64 = 0.9999;

/// Visible share that a bend must show in addition to a picture without it, or with another.
///
/// A tenth of the hundredth that is printed: half or double chooses otherwise only between pictures whose printed shares are the same.
pub const LEAST_GAIN: f64 = 0.001;

/// The same between two views of a target, whose shares are those of points.
///
/// Taste: one of fifty points, a point more or less, is chance. With 0.01 one of a hundred decides; with 0.04 two of fifty must be shown in
/// addition.
pub const VIEW_GAIN: f64 = 0.02;

/// Visible share for which a view of a target may move things by the whole picture.
///
/// Taste: of two views that show the same, that with the smaller bend is taken. With half of it a bend that moves everything by half the picture
/// may be taken for a fortieth more, with double only for a tenth more.
pub const MOTION_PRICE: f64 = 0.1;

/// Visible share of a target from which on further views are not searched for bends, after [`VIEWS_AT_LEAST`].
///
/// Taste: views come in the order of what they show without a bend, so that later ones seldom show more with one. With 0.6 fewer views are
/// searched, with 0.9 more.
pub const MUCH: f64 = 0.8;

/// Views of a target that are searched for bends in any case, unless one shows [`ENOUGH`]. Taste.
pub const VIEWS_AT_LEAST: usize = 3;

/// Visible share that a spline must show in addition to curved rays, because it moves the whole picture, and they a part of it.
///
/// Taste. With half of it splines come more often, with double more seldom.
pub const SPLINE_GAIN: f64 = 0.03;

/// Samples of features by which curved rays are chosen, at most. Time grows with them; half of them leave stretches of a seventieth of the
/// route between two samples.
pub const SAMPLES_TO_BEND_FOR: usize = 150;

/// Points of routes in a city by which bends are chosen, at most. As [`SAMPLES_TO_BEND_FOR`]; walls make each line of sight dearer.
pub const SAMPLES_IN_A_CITY: usize = 120;

/// Points of routes in a city by which shares are judged, about: one is less than a tenth of a hundredth, the printed digit.
pub const SAMPLES_TO_JUDGE: f64 = 1500.0;

/// Angle between the directions of two drafts of a target at least, radians: about a fourteenth of the circle, so that neighbours on a sheet
/// are told apart. Taste.
pub const DRAFTS_APART: f64 = 0.45;

/// Views of a target from which drafts are taken: two for every draft of the largest sheet.
pub const DRAFT_VIEWS: usize = 48;
