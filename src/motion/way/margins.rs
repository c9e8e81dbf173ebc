//! What must hold on a way.

/// Margins in m that must stay positive all along a way, such as the distance of two bodies less their clearance. They are
/// numbered from 0; all moves have the same ones.
pub trait Margins: Sync {
    /// The margins at joint values `q` (rad or m), to be asked for one by one: what they share, such as where the links are, is
    /// computed once.
    fn at<'a>(&'a self, q: &'a [f64]) -> Measure<'a>;

    /// For each margin, a bound on its change along the straight move, m: between the shares s and t of the move it changes by no
    /// more than `change · |s − t|`. The same there and back; not negative. All that is proven rests on these bounds.
    fn changes(&self, from: &[f64], to: &[f64]) -> Vec<f64>;
}

/// Measures at one configuration: `measure(i, enough)` is margin i in m where that is less than `enough`, else any lower bound of
/// it that is no less than `enough`. So bodies whose bounding spheres are far enough apart need no closer look.
///
/// What is measured must not exceed the margin by more than rounding, 10⁻¹⁰ m. NaN counts as unsafe.
pub type Measure<'a> = Box<dyn Fn(usize, f64) -> f64 + 'a>;
