//! The best of some candidates that are tried in turn.

/// When one candidate is better than another, and when none is tried any more.
pub struct Choice<'a, A> {
    /// The higher the better.
    pub score: &'a dyn Fn(&A) -> f64,
    /// Score that a later candidate must gain.
    pub least_gain: f64,
    /// Whether an answer, the best of so many, makes further ones needless.
    pub enough: &'a dyn Fn(&A, usize) -> bool,
}

impl<A> Choice<'_, A> {
    /// Judges candidates until one is enough; the best of them and of `first`.
    ///
    /// # Errors
    /// Those of `judge`.
    pub fn best<C, E>(
        &self,
        first: Option<A>,
        candidates: impl IntoIterator<Item = C>,
        mut judge: impl FnMut(C) -> Result<A, E>,
    ) -> Result<Option<A>, E> {
        let mut best = first;
        for (tried, candidate) in candidates.into_iter().enumerate() {
            if best.as_ref().is_some_and(|best| (self.enough)(best, tried)) {
                break;
            }
            let next = judge(candidate)?;
            if best.as_ref().is_none_or(|best| (self.score)(&next) >= (self.score)(best) + self.least_gain) {
                best = Some(next);
            }
        }
        Ok(best)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn later_candidates_must_gain_and_none_is_tried_after_enough() {
        let choice = Choice { score: &|a: &f64| *a, least_gain: 0.1, enough: &|a, tried| *a >= 0.9 && tried >= 2 };
        let mut judged = Vec::new();
        let mut best = |first, all: &[f64]| {
            judged.clear();
            let best = choice.best(first, all.iter().copied(), |c| {
                judged.push(c);
                Ok::<_, ()>(c)
            });
            (best.expect("no error"), judged.len())
        };
        assert_eq!(best(None, &[0.5, 0.55, 0.65, 0.7]), (Some(0.65), 4));
        assert_eq!(best(None, &[0.95, 0.2, 1.2]), (Some(0.95), 2), "the first is enough, but two are tried");
        assert_eq!(best(Some(0.5), &[0.55]), (Some(0.5), 1));
        assert_eq!(best(None, &[]), (None, 0));
    }
}
