//! Samples at which styling sections show a layer.

use crate::raster::thin::ThinShow;
use belvedere_composite::sections::{Exposure, Intervals, Sections};

/// Shows a layer sample by sample.
pub(crate) struct LayerShow<'a> {
    pub(crate) sections: &'a Sections<'a>,
    pub(crate) exposure: &'a Exposure,
    pub(crate) layer: usize,
}

impl ThinShow for LayerShow<'_> {
    type At = Intervals;

    #[inline]
    fn at(&self, parameter: f64) -> Intervals {
        self.sections.intervals(parameter)
    }

    #[inline]
    fn shows(&self, at: &Intervals, sample: usize, [x, y]: [i32; 2]) -> bool {
        self.sections.is_drawn_by(self.layer, at.holding(self.exposure.threshold(sample, x, y)))
    }
}
