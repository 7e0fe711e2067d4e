//! From drawn surfaces to the finished picture, for any renderer.
//!
//! A renderer draws surfaces: colours, depths, ids. What else belongs to a picture is the same for all of them and needs no more than
//! [`drawn::Drawn`] tells: [`stylise`] darkens edges, [`marks`] draws lines, points and names and decides by lines of sight what of them
//! is hidden ([`traced_marks`] by those of the exact tracer), [`layers`] mixes pictures of whole representations, [`branches`]
//! joins pictures where rays part, [`veil`] lays solids that something shines through over all of it, and [`canvas`] draws on finished pixels.
//! [`finish`] puts these in their order. [`tint`] has the colours of ground before it is lit.

pub mod branches;
pub mod buffers;
pub mod canvas;
pub mod color;
pub mod depths;
pub mod drawn;
pub mod finish;
pub mod layers;
pub mod marks;
pub mod noise;
pub mod skyline;
pub mod stylise;
pub mod tint;
pub mod traced_marks;
pub mod unsharp;
pub mod veil;
