//! Quantiles of values.

/// Which value counts where a share falls between two.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rank {
    /// The lower one.
    Lower,
    /// The nearer one.
    Nearest,
    /// The upper one.
    Upper,
}

/// The value below which `share` of the values lie, `share` in 0..=1; 0 without values. Reorders the values.
///
/// Of n values in order it is that of number `share (n - 1)`, counted from 0 and rounded as `rank` says.
pub fn quantile(values: &mut [f64], share: f64, rank: Rank) -> f64 {
    let Some(last) = values.len().checked_sub(1) else { return 0.0 };
    let at = share * last as f64;
    let number = match rank {
        Rank::Lower => at.floor(),
        Rank::Nearest => at.round(),
        Rank::Upper => at.ceil(),
    };
    *values.select_nth_unstable_by((number as usize).min(last), f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_between_two_values_take_the_one_that_the_rank_says() {
        let of = |share: f64| {
            [Rank::Lower, Rank::Nearest, Rank::Upper].map(|r| quantile(&mut [4.0, 1.0, 3.0, 2.0], share, r))
        };
        assert_eq!(of(0.0), [1.0; 3]);
        assert_eq!(of(0.4), [2.0, 2.0, 3.0]);
        assert_eq!(of(0.6), [2.0, 3.0, 3.0]);
        assert_eq!(of(1.0), [4.0; 3]);
        assert_eq!(quantile(&mut [], 0.5, Rank::Upper), 0.0);
    }
}
