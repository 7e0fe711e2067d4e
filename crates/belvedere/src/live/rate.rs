//! Quality of moving pictures, chosen so that they are drawn in time whatever the scene costs.
//!
//! There are two knobs: pixels, and the detail of what is drawn. A late picture lowers both at once; the quality rises step by step, and only
//! where the times of the last pictures tell that the next one will be in time.

/// Time that a moving picture should take, milliseconds.
pub(super) const TARGET_MS: f64 = 30.0;
/// Time above which a picture is late, and below which the next one may be better, milliseconds.
const LATE_MS: f64 = 36.0;
const EARLY_MS: f64 = 21.0;
/// Early pictures in a row before the quality rises.
const CALM: u32 = 2;
/// Narrowest picture: quarter octaves below the full width, 0.21 of it.
const NARROWEST: u8 = 9;
/// Coarsest detail.
const COARSEST: u8 = 3;
/// Share of the pixels below which detail is given up first: half of the width.
const FEW_PIXELS: f64 = 0.25;
/// How much cheaper a coarser detail is thought to be before it was tried.
const GAIN: f64 = 2.0;
/// Pictures after which a time is forgotten.
const FRESH: u32 = 300;
/// Largest change of time that one picture is trusted with.
const LEAST_SHARE: f64 = 0.05;

/// Quality of a moving picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Quality {
    /// Quarter octaves by which it is narrower than the full picture.
    narrowing: u8,
    coarseness: u8,
}

impl Quality {
    /// All pixels, all detail.
    pub const FULL: Self = Self { narrowing: 0, coarseness: 0 };
    /// As few pixels and as little detail as possible.
    pub const LEAST: Self = Self { narrowing: NARROWEST, coarseness: COARSEST };
    /// Before anything was drawn.
    const FIRST: Self = Self { narrowing: 5, coarseness: 2 };

    /// Width as a share of the full width, 0.21..=1.
    pub fn width(self) -> f64 {
        (-0.25 * f64::from(self.narrowing)).exp2()
    }

    /// Detail: 0, as the scene says, to 3, coarsest.
    pub fn coarseness(self) -> u8 {
        self.coarseness
    }

    /// Size of the picture for a full size, pixels.
    pub fn size(self, image: [u32; 2]) -> [u32; 2] {
        image.map(|n| ((f64::from(n) * self.width()).round() as u32).max(16))
    }

    /// Share of the pixels.
    fn pixels(self) -> f64 {
        self.width().powi(2)
    }

    /// Worst error of ground drawn with less detail, pixels of the moving picture.
    pub(super) fn ground_px(self) -> f64 {
        [1.0, 2.0, 3.0, 5.0][self.coarseness as usize]
    }

    /// Worst error of bent edges drawn straight, pixels of the moving picture.
    pub(super) fn edge_px(self) -> f64 {
        [0.5, 2.0, 4.0, 8.0][self.coarseness as usize]
    }

    /// Most triangles of a mesh; `None` = all.
    pub(super) fn mesh_triangles(self) -> Option<usize> {
        [None, Some(400_000), Some(120_000), Some(40_000)][self.coarseness as usize]
    }

    /// Distance between the samples of a volume, in units of that of the scene.
    pub(super) fn volume_step(self) -> f64 {
        [1.0, 2.0, 3.0, 4.0][self.coarseness as usize]
    }
}

/// Chooses the quality of the next moving picture by the times of the last ones.
#[derive(Debug)]
pub(super) struct Rate {
    quality: Quality,
    /// By coarseness: share of the pixels, time and number of the last picture drawn with it.
    costs: [Option<(f64, f64, u32)>; COARSEST as usize + 1],
    calm: u32,
    pictures: u32,
}

impl Default for Rate {
    fn default() -> Self {
        Self { quality: Quality::FIRST, costs: [None; 4], calm: 0, pictures: 0 }
    }
}

impl Rate {
    /// Quality of the next picture.
    pub(super) fn quality(&self) -> Quality {
        self.quality
    }

    /// Notes the time of a picture of this quality, milliseconds, and chooses the quality of the next one.
    pub(super) fn note(&mut self, milliseconds: f64) {
        self.pictures += 1;
        let (pixels, level) = (self.quality.pixels(), self.quality.coarseness as usize);
        self.costs[level] = Some((pixels, milliseconds, self.pictures));
        if milliseconds > LATE_MS {
            self.calm = 0;
            self.fall(milliseconds);
        } else if milliseconds < EARLY_MS {
            self.calm += 1;
            if self.calm >= CALM {
                self.calm = 0;
                self.rise(milliseconds);
            }
        } else {
            self.calm = 0;
        }
    }

    /// Notes that a picture was broken off because it took too long.
    ///
    /// * `milliseconds`: time until then; what it would have taken is not known.
    pub(super) fn broken_off(&mut self, milliseconds: f64) {
        self.note(2.0 * milliseconds.max(LATE_MS));
    }

    fn fall(&mut self, milliseconds: f64) {
        let Quality { narrowing, mut coarseness } = self.quality;
        let mut pixels = self.quality.pixels() * (TARGET_MS / milliseconds).max(LEAST_SHARE);
        while pixels < FEW_PIXELS && coarseness < COARSEST {
            pixels *= self.gain(coarseness, milliseconds);
            coarseness += 1;
        }
        let wanted = (-2.0 * pixels.log2()).ceil().clamp(0.0, f64::from(NARROWEST)) as u8;
        let least = narrowing + u8::from(coarseness == self.quality.coarseness);
        self.quality = Quality { narrowing: wanted.max(least).min(NARROWEST), coarseness };
    }

    fn rise(&mut self, milliseconds: f64) {
        let Quality { narrowing, coarseness } = self.quality;
        let wider = |steps: u8| milliseconds * (0.5 * f64::from(steps)).exp2() <= TARGET_MS;
        let steps = (1..=narrowing.min(3)).rev().find(|steps| wider(*steps));
        let finer = coarseness > 0 && self.expected(coarseness - 1, milliseconds) <= TARGET_MS;
        match steps {
            Some(steps) if !finer || self.quality.pixels() < FEW_PIXELS => self.quality.narrowing -= steps,
            _ if finer => self.quality.coarseness -= 1,
            _ => {}
        }
    }

    fn known(&self, coarseness: u8) -> Option<(f64, f64)> {
        let (pixels, milliseconds, at) = self.costs[coarseness as usize]?;
        (self.pictures - at < FRESH).then_some((pixels, milliseconds))
    }

    /// Time expected of another detail with the pixels of this picture, rather too long than too short: with fewer pixels than were drawn
    /// then it saves half of their share.
    ///
    /// * `milliseconds`: time of this picture.
    fn expected(&self, coarseness: u8, milliseconds: f64) -> f64 {
        let Some((pixels, then)) = self.known(coarseness) else { return GAIN * milliseconds };
        let share = self.quality.pixels() / pixels;
        then * if share >= 1.0 { share } else { 0.5 + 0.5 * share }
    }

    /// How many times as many pixels the next coarser detail draws in the same time.
    fn gain(&self, coarseness: u8, milliseconds: f64) -> f64 {
        let per_pixel = |level| self.known(level).map(|(pixels, time)| time / pixels);
        let this = if coarseness == self.quality.coarseness {
            Some(milliseconds / self.quality.pixels())
        } else {
            per_pixel(coarseness)
        };
        match (this, per_pixel(coarseness + 1)) {
            (Some(this), Some(coarser)) => (this / coarser).clamp(1.0, 8.0),
            _ => GAIN,
        }
    }
}

#[cfg(test)]
mod tests;
