//! Colour ramps by height.

use crate::Color;

/// Height at which a ramp has a colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RampHeight {
    /// Metres.
    Metres(f64),
    /// Share of the ground's range of heights: 0 = lowest, 1 = highest.
    Share(f64),
    /// -1 = lowest ground, 0 = height 0, 1 = highest ground, linear between.
    Hinged(f64),
}

impl RampHeight {
    /// This height in metres, for ground with the given lowest and highest height.
    pub fn metres(self, [bottom, top]: [f64; 2]) -> f64 {
        match self {
            Self::Metres(z) => z,
            Self::Share(s) => bottom + s * (top - bottom),
            Self::Hinged(s) => s * if s < 0.0 { -bottom.min(0.0) } else { top.max(0.0) },
        }
    }
}

/// A colour at a height. Two stops at one height are a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RampStop {
    /// Height of the stop.
    pub height: RampHeight,
    /// The colour there.
    pub color: Color,
}

/// Colours by height, linear between the stops in sRGB.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Ramp {
    /// Stops, in any order; those of one height in the order from below to above.
    pub stops: Vec<RampStop>,
    /// Colour below the lowest stop; `None` = that of the stop.
    pub below: Option<Color>,
    /// Colour above the highest stop; `None` = that of the stop.
    pub above: Option<Color>,
}

impl Ramp {
    /// Stops in metres from below to above, for ground between two heights.
    pub fn resolved(&self, range_m: [f64; 2]) -> Vec<(f64, Color)> {
        let mut stops: Vec<(f64, Color)> = self.stops.iter().map(|s| (s.height.metres(range_m), s.color)).collect();
        stops.sort_by(|a, b| a.0.total_cmp(&b.0));
        stops
    }

    /// Colour at a height; grey without stops.
    /// * `stops`: from [`Ramp::resolved`].
    pub fn color_at(&self, stops: &[(f64, Color)], height_m: f64) -> Color {
        let (Some(&(lowest, first)), Some(&(highest, last))) = (stops.first(), stops.last()) else {
            return Color::rgb(205, 205, 202);
        };
        if height_m < lowest {
            return self.below.unwrap_or(first);
        }
        if height_m > highest {
            return self.above.unwrap_or(last);
        }
        let i = stops.partition_point(|s| s.0 <= height_m).clamp(1, stops.len().max(2) - 1);
        let ((z0, a), (z1, b)) = (stops[i - 1], stops[i.min(stops.len() - 1)]);
        let t = if z1 > z0 { (height_m - z0) / (z1 - z0) } else { 1.0 };
        let mix = |a: u8, b: u8| (f64::from(a) + t * (f64::from(b) - f64::from(a)) + 0.5) as u8;
        Color { r: mix(a.r, b.r), g: mix(a.g, b.g), b: mix(a.b, b.b), a: mix(a.a, b.a) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stop(height: RampHeight, v: u8) -> RampStop {
        RampStop { height, color: Color::rgb(v, v, v) }
    }

    #[test]
    fn colours_lie_between_their_stops_and_jump_at_steps() {
        use RampHeight::{Hinged, Metres, Share};
        let ramp = Ramp {
            stops: vec![
                stop(Metres(100.0), 50),
                stop(Metres(0.0), 0),
                stop(Metres(100.0), 200),
                stop(Metres(200.0), 250),
            ],
            below: Some(Color::rgb(1, 2, 3)),
            above: None,
        };
        let stops = ramp.resolved([0.0, 1.0]);
        let at = |z: f64| ramp.color_at(&stops, z);
        assert_eq!((at(-1.0), at(0.0).r, at(50.0).r, at(99.99).r), (Color::rgb(1, 2, 3), 0, 25, 50));
        assert_eq!((at(100.0).r, at(150.0).r, at(200.0).r, at(1e9).r), (200, 225, 250, 250));
        assert_eq!(Share(0.25).metres([-100.0, 300.0]), 0.0);
        assert_eq!((Hinged(-0.5).metres([-100.0, 300.0]), Hinged(0.5).metres([-100.0, 300.0])), (-50.0, 150.0));
        let one = Ramp { stops: vec![stop(Metres(5.0), 9)], ..Ramp::default() };
        assert_eq!(one.color_at(&one.resolved([0.0, 1.0]), 5.0).r, 9);
        assert_eq!(Ramp::default().color_at(&[], 5.0).r, 205);
    }
}
