//! Where a lens model turns back.

/// The first zero of `f` on (0, `end`], if it has one: scanned on a geometric grid fine enough for the slopes of lens models, then
/// bisected.
pub(super) fn first_zero(end: f64, f: impl Fn(f64) -> f64) -> Option<f64> {
    const STEPS: i32 = 4000;
    const START: f64 = 1e-3;
    let ratio = (end / START).powf(1.0 / f64::from(STEPS));
    let (mut low, mut high, mut steps) = (0.0, START, 0);
    while f(high) > 0.0 {
        if steps == STEPS {
            return None;
        }
        low = high;
        high *= ratio;
        steps += 1;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if f(middle) > 0.0 { low = middle } else { high = middle }
    }
    Some(low)
}
