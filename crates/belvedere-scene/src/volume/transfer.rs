//! Transfer functions: colour and opacity of values.

use crate::Color;

/// Most points of a transfer function.
const MOST_POINTS: usize = 4096;

/// Largest opacity: a reference step lets a millionth through. Above it powers of the transmission lose all digits.
const MOST_OPAQUE: f64 = 1.0 - 1e-6;

/// A value with its colour and opacity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TransferPoint {
    /// Value of voxels.
    pub value: f64,
    /// Colour; its alpha is not used.
    pub color: Color,
    /// Share of light that one reference step absorbs, 0..=1.
    pub opacity: f64,
}

/// Errors of a transfer function.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TransferError {
    /// No points, or too many.
    #[error("the transfer function has {count} points, 1 to {MOST_POINTS} are possible")]
    Count {
        /// Points given.
        count: usize,
    },
    /// The values do not ascend, or are not finite.
    #[error("point {at} of the transfer function has the value {value}; values must be finite and ascend")]
    Value {
        /// Number of the point, from 1.
        at: usize,
        /// Its value.
        value: f64,
    },
    /// Opacity out of range.
    #[error("point {at} of the transfer function has opacity {opacity}, it must lie in 0..=1")]
    Opacity {
        /// Number of the point, from 1.
        at: usize,
        /// Its opacity.
        opacity: f64,
    },
    /// Reference step out of range.
    #[error("the reference step of the transfer function is {step}, it must be greater than 0 voxel edges")]
    Step {
        /// The step, voxel edges.
        step: f64,
    },
}

/// Colour and opacity of values: linear between points, constant beyond the first and last.
///
/// Opacities are those of a reference step: over a distance of `n` such steps `1 - (1 - opacity)^n` is absorbed. Two points may share
/// a value: there the function jumps.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferFunction {
    name: String,
    points: Vec<TransferPoint>,
    reference_step: f64,
}

impl TransferFunction {
    /// A function with points in ascending order of value.
    ///
    /// * `name`: for records.
    /// * `reference_step`: edges of a voxel, > 0.
    ///
    /// # Errors
    /// Every [`TransferError`].
    pub fn new(
        name: impl Into<String>,
        points: Vec<TransferPoint>,
        reference_step: f64,
    ) -> Result<Self, TransferError> {
        if !(1..=MOST_POINTS).contains(&points.len()) {
            return Err(TransferError::Count { count: points.len() });
        }
        let mut least = f64::NEG_INFINITY;
        for (i, p) in points.iter().enumerate() {
            if !(p.value.is_finite() && p.value >= least) {
                return Err(TransferError::Value { at: i + 1, value: p.value });
            }
            if !(0.0..=1.0).contains(&p.opacity) {
                return Err(TransferError::Opacity { at: i + 1, opacity: p.opacity });
            }
            least = p.value;
        }
        if !(reference_step > 0.0 && reference_step.is_finite()) {
            return Err(TransferError::Step { step: reference_step });
        }
        Ok(Self { name: name.into(), points, reference_step })
    }

    /// A function whose points are known to be in order, one voxel edge being the reference step.
    pub(super) fn trusted(name: &str, points: Vec<TransferPoint>) -> Self {
        Self { name: name.to_owned(), points, reference_step: 1.0 }
    }

    /// The same with another reference step, voxel edges, > 0.
    pub(super) fn with_reference_step(self, reference_step: f64) -> Self {
        Self { reference_step, ..self }
    }

    /// Name for records.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The points, in ascending order of value.
    pub fn points(&self) -> &[TransferPoint] {
        &self.points
    }

    /// Distance that opacities are stated for, edges of a voxel.
    pub fn reference_step(&self) -> f64 {
        self.reference_step
    }

    /// Red, green, blue (sRGB, 0..=1) and opacity of a value.
    pub fn at(&self, value: f64) -> [f64; 4] {
        let of = |p: &TransferPoint| {
            let [r, g, b] = [p.color.r, p.color.g, p.color.b].map(|c| f64::from(c) / 255.0);
            [r, g, b, p.opacity]
        };
        let above = self.points.partition_point(|p| p.value <= value);
        match (above.checked_sub(1).and_then(|i| self.points.get(i)), self.points.get(above)) {
            (Some(a), Some(b)) => {
                let t = (value - a.value) / (b.value - a.value);
                let (from, to) = (of(a), of(b));
                std::array::from_fn(|i| from[i] + t * (to[i] - from[i]))
            }
            (Some(p), None) | (None, Some(p)) => of(p),
            (None, None) => [0.0; 4],
        }
    }

    /// Opacity of a value, below 1 so that transmissions can be multiplied.
    pub fn opacity(&self, value: f64) -> f64 {
        self.at(value)[3].min(MOST_OPAQUE)
    }

    /// Greatest opacity of the values from `lo` to `hi`, both included.
    pub fn most_opaque(&self, lo: f64, hi: f64) -> f64 {
        let between = self.points.iter().filter(|p| p.value >= lo && p.value <= hi).map(|p| p.opacity);
        between.fold(self.opacity(lo).max(self.opacity(hi)), f64::max)
    }
}

/// Share of light absorbed over a distance in reference steps: `1 - (1 - opacity)^steps`.
pub fn absorbed(opacity: f64, steps: f64) -> f64 {
    1.0 - (1.0 - opacity).powf(steps)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(value: f64, gray: u8, opacity: f64) -> TransferPoint {
        TransferPoint { value, color: Color::rgb(gray, gray, gray), opacity }
    }

    #[test]
    fn values_between_points_are_interpolated_and_jumps_stay_jumps() {
        let points = vec![point(10.0, 0, 0.0), point(20.0, 255, 0.5), point(20.0, 51, 1.0), point(30.0, 51, 0.0)];
        let f = TransferFunction::new("test", points, 1.0).unwrap();
        assert_eq!(f.at(-5.0)[3], 0.0);
        assert_eq!(f.at(15.0), [0.5, 0.5, 0.5, 0.25]);
        assert_eq!(f.at(20.0)[3], 1.0);
        assert_eq!(f.at(25.0)[3], 0.5);
        assert_eq!(f.at(99.0), [0.2, 0.2, 0.2, 0.0]);
        assert!((f.opacity(20.0) - (1.0 - 1e-6)).abs() < 1e-12);
        assert_eq!([f.most_opaque(12.0, 14.0), f.most_opaque(12.0, 20.0), f.most_opaque(25.0, 40.0)], [0.2, 1.0, 0.5]);
    }

    #[test]
    fn what_cannot_be_is_refused() {
        let of = |points| TransferFunction::new("test", points, 1.0).unwrap_err().to_string();
        assert!(of(vec![]).contains("0 points"));
        assert!(of(vec![point(2.0, 0, 0.0), point(1.0, 0, 0.0)]).contains("point 2"));
        assert!(of(vec![point(2.0, 0, 1.5)]).contains("1.5"));
        assert!(of(vec![point(f64::NAN, 0, 0.0)]).contains("NaN"));
        assert!(TransferFunction::new("test", vec![point(0.0, 0, 0.0)], 0.0).is_err());
    }
}
