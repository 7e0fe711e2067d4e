//! The part of curved rays that displaces a pass.

/// The part of curved rays that displaces a pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Way {
    /// A record ([`belvedere_core::View::displace_in`]), or the first and the last one of several that displace as one map
    /// ([`belvedere_core::CurvedRays::is_continuous`]). Views without curved rays have one record.
    Records([usize; 2]),
    /// A segment of the rays, see [`belvedere_core::View::displace_along`].
    Segment(u32),
}
