//! Panics inside libraries become errors where a verb ends.

use crate::BelvedereError;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Result of `work`; [`BelvedereError::Internal`] if it panics.
///
/// What `work` changes must not be used after a panic: verbs make their results anew.
pub(crate) fn guarded<T>(work: impl FnOnce() -> Result<T, BelvedereError>) -> Result<T, BelvedereError> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
        let what = text.unwrap_or("no message").lines().next().unwrap_or_default().to_owned();
        Err(BelvedereError::Internal { what })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_an_error_and_an_error_stays() {
        let panics = guarded::<()>(|| panic!("index {} of {}\nmore", 3, 2));
        let text = panics.expect_err("a panic").to_string();
        assert!(text.contains("internal error (index 3 of 2)") && !text.contains("more"), "{text}");
        assert!(matches!(guarded(|| Ok(7)), Ok(7)));
        assert!(matches!(guarded::<()>(|| Err(BelvedereError::EyeIsTarget)), Err(BelvedereError::EyeIsTarget)));
    }
}
