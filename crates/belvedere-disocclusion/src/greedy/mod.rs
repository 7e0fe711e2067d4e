//! The greedy pass: cell by cell, far to near, the ground is scaled and displaced until every point is seen.
//!
//! `equations` holds the formulas, `pass` the order of the points and the changes of the cells, `hits` the search for ground that
//! hides a point, `blocks` the bounds by which most of that search is skipped.

mod blocks;
mod equations;
mod hits;
mod naive;
mod pass;
#[cfg(test)]
mod reference;
#[cfg(test)]
mod tests;
mod transform;

pub use blocks::BlockMaxima;
pub use naive::Naive;
pub use pass::GreedyCounters;
