//! Samples at which styling sections show a layer.

use crate::raster::thin::ThinShow;
use belvedere_sight::sections::{Exposure, Intervals, Sections};

/// Shows a layer sample by sample.
pub(crate) struct LayerShow<'a> {
    pub(crate) sections: &'a Sections<'a>,
    pub(crate) exposure: &'a Exposure,
    pub(crate) layer: usize,
}

impl<'a> ThinShow for LayerShow<'a> {
    type At = Intervals<'a>;

    #[inline]
    fn at(&self, parameter: f64) -> Intervals<'a> {
        self.sections.intervals(parameter)
    }

    #[inline]
    fn shows(&self, at: &Intervals<'a>, sample: usize, [x, y]: [i32; 2]) -> bool {
        self.sections.is_drawn_by(self.layer, at.holding(self.exposure.threshold(sample, x, y)))
    }
}
