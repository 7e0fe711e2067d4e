//! Colours.

/// sRGB colour with straight alpha, 8 bits per channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Color {
    /// Red.
    pub r: u8,
    /// Green.
    pub g: u8,
    /// Blue.
    pub b: u8,
    /// Alpha, 255 = opaque.
    pub a: u8,
}

impl Color {
    /// Opaque colour.
    pub const fn rgb(r: u8, g: u8, b: u8) -> Self {
        Self { r, g, b, a: 255 }
    }

    /// Product of this colour and `filter`, channel by channel in linear light; alphas are multiplied, too.
    pub fn times(self, filter: Self) -> Self {
        if filter == Self::rgb(255, 255, 255) {
            return self;
        }
        if self == Self::rgb(255, 255, 255) {
            return filter;
        }
        let light = |v: u8| {
            let v = f32::from(v) / 255.0;
            if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
        };
        let code = |v: f32| if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
        let part = |a: u8, b: u8| (255.0 * code(light(a) * light(b))).round() as u8;
        let alpha = (u32::from(self.a) * u32::from(filter.a) + 127) / 255;
        Self { r: part(self.r, filter.r), g: part(self.g, filter.g), b: part(self.b, filter.b), a: alpha as u8 }
    }

    /// This colour with another alpha.
    pub const fn with_alpha(self, a: u8) -> Self {
        Self { a, ..self }
    }
}
