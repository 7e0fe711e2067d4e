//! What is odd about the features of a table, counted.

use belvedere_core::{Warning, WarningKind};

/// Numbers of oddities among the features of a table.
#[derive(Debug, Default)]
pub(super) struct Odd {
    pub(super) without_geometry: usize,
    pub(super) other_system: usize,
    pub(super) short_lines: usize,
    pub(super) short_rings: usize,
    pub(super) not_finite: usize,
}

impl Odd {
    /// One sentence for each kind of oddity that occurred.
    pub(super) fn warnings(&self, table: &str) -> impl Iterator<Item = Warning> {
        use WarningKind::{Ignored, Repaired};
        let of = |kind: WarningKind, count: usize, what: &str| {
            Warning::counted(kind, count, what).map(|w| w.placed(format_args!("table \"{table}\"")))
        };
        [
            of(Ignored, self.without_geometry, "features without geometry were dropped"),
            of(
                Repaired,
                self.other_system,
                "features name another coordinate system than their table; that of the table was taken",
            ),
            of(Ignored, self.not_finite, "points, lines and rings with positions that are not finite were dropped"),
            of(Ignored, self.short_lines, "lines of fewer than 2 points were dropped"),
            of(Ignored, self.short_rings, "polygon rings of fewer than 3 points were dropped"),
        ]
        .into_iter()
        .flatten()
    }
}
