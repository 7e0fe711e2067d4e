//! Roots by regula falsi (Illinois).

/// Argument in `[a.0, b.0]` where `f` changes its sign, to 1e-13 of itself; `a` and `b` are arguments with values of `f` of different sign.
///
/// Regula falsi that halves the weight of an end kept twice (Illinois), and halves the bracket where that is too slow.
pub(crate) fn root(mut a: (f64, f64), mut b: (f64, f64), f: impl Fn(f64) -> f64) -> f64 {
    let mut kept = 0i32;
    for step in 0..120 {
        let width = b.0 - a.0;
        if width.abs() <= 1e-13 * a.0.abs().max(b.0.abs()) {
            break;
        }
        if a.1 == 0.0 {
            return a.0;
        }
        if b.1 == 0.0 {
            return b.0;
        }
        let falsi = a.0 + width * (a.1 / (a.1 - b.1));
        let inside = falsi > a.0.min(b.0) && falsi < a.0.max(b.0);
        let x = if inside && step % 8 != 7 { falsi } else { a.0 + 0.5 * width };
        let y = f(x);
        if y.is_nan() {
            break;
        }
        if (y > 0.0) == (a.1 > 0.0) {
            a = (x, y);
            if kept == 1 {
                b.1 *= 0.5;
            }
            kept = 1;
        } else {
            b = (x, y);
            if kept == -1 {
                a.1 *= 0.5;
            }
            kept = -1;
        }
    }
    if a.1.abs() < b.1.abs() { a.0 } else { b.0 }
}

#[cfg(test)]
mod tests {
    use super::root;

    #[test]
    fn roots_are_found_to_the_last_digits() {
        let square = |x: f64| x * x - 2.0;
        assert!((root((0.0, square(0.0)), (2.0, square(2.0)), square) - 2f64.sqrt()).abs() < 1e-13);
        let steep = |x: f64| 1.0 - x.exp() / 3.0;
        assert!((root((0.0, steep(0.0)), (5.0, steep(5.0)), steep) - 3f64.ln()).abs() < 1e-13);
        let f = |x: f64| x.sin() - 0.3;
        assert!((root((0.0, f(0.0)), (1.5, f(1.5)), f) - 0.3f64.asin()).abs() < 1e-13);
    }
}
