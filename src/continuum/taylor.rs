//! Taylor models of the second order: functions of a box of joint values, enclosed.
//!
//! Over the box, `x ∈ [−1, 1]ⁿ` from its centre,
//!
//! ```text
//!     f(x) = c + Σ_a l_a x_a + Σ_{a≤b} q_ab x_a x_b + [−r, r]
//! ```
//!
//! for **every** x. What arithmetic on the polynomials leaves out, terms of third order and more and its own rounding, goes to r. So
//! cancellation in sums is exact but for the third order, where interval arithmetic would lose it in the first.
//!
//! Makino and Berz, *Taylor models and other validated functional inclusion methods*, 2003.

use std::ops::{Add, Mul, Neg, Sub};

use super::lanes::{LANES, Lanes};

/// Four Taylor models of N variables with Q = N (N + 1) / 2 products of two of them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Taylor<const N: usize, const Q: usize> {
    pub(super) c: Lanes,
    pub(super) l: [Lanes; N],
    /// Of `x_a x_b`, a ≤ b, row by row.
    pub(super) q: [Lanes; Q],
    pub(super) r: Lanes,
    /// `Σ |l_a|`.
    linear: Lanes,
    /// `Σ |q_ab|`.
    quadratic: Lanes,
}

/// A model all of whose terms but the first two are zero.
#[derive(Debug, Clone, Copy)]
pub(super) struct Affine<const N: usize> {
    pub(super) c: f64,
    pub(super) l: [f64; N],
}

/// Bounds the rounding of an operation on two models, as a share of the product or sum of their norms `|c| + Σ|l| + Σ|q| + r`: a
/// coefficient is a sum of at most four products, a norm one of at most fifty terms.
pub(super) const ROUNDING: f64 = 1e-13;

/// A function's Taylor coefficients at the centre of a range, and a bound of the third over the range.
pub(super) struct Expansion {
    pub(super) value: Lanes,
    pub(super) first: Lanes,
    pub(super) half_second: Lanes,
    pub(super) sixth_third: Lanes,
}

impl<const N: usize, const Q: usize> Taylor<N, Q> {
    #[inline]
    pub(super) fn new(c: Lanes, l: [Lanes; N], q: [Lanes; Q], r: Lanes) -> Self {
        let linear = l.iter().fold(Lanes::ZERO, |sum, l| sum + l.abs());
        let quadratic = q.iter().fold(Lanes::ZERO, |sum, q| sum + q.abs());
        Self { c, l, q, r, linear, quadratic }
    }

    #[inline]
    pub(super) fn constant(c: f64) -> Self {
        Self {
            c: Lanes::all(c),
            l: [Lanes::ZERO; N],
            q: [Lanes::ZERO; Q],
            r: Lanes::ZERO,
            linear: Lanes::ZERO,
            quadratic: Lanes::ZERO,
        }
    }

    /// How far it can be from c.
    #[inline]
    pub(super) fn spread(&self) -> Lanes {
        self.linear + self.quadratic + self.r
    }

    /// A bound of |f|.
    #[inline]
    pub(super) fn norm(&self) -> Lanes {
        self.c.abs() + self.spread()
    }

    /// No value is less.
    #[inline]
    pub(super) fn least(&self) -> Lanes {
        self.c - self.spread() - self.norm() * ROUNDING
    }

    /// No value is greater.
    #[inline]
    pub(super) fn greatest(&self) -> Lanes {
        self.c + self.spread() + self.norm() * ROUNDING
    }

    #[inline]
    pub(super) fn scaled(&self, factor: f64) -> Self {
        self.scaled_by(Lanes::all(factor))
    }

    #[inline]
    pub(super) fn scaled_by(&self, factor: Lanes) -> Self {
        let size = factor.abs();
        Self {
            c: self.c * factor,
            l: self.l.map(|l| l * factor),
            q: self.q.map(|q| q * factor),
            r: (self.r + self.norm() * ROUNDING) * size,
            linear: self.linear * size,
            quadratic: self.quadratic * size,
        }
    }

    #[inline]
    pub(super) fn plus(&self, constant: f64) -> Self {
        let rounding = (self.c.abs() + Lanes::all(constant.abs())) * ROUNDING;
        Self { c: self.c + Lanes::all(constant), r: self.r + rounding, ..*self }
    }

    #[inline]
    pub(super) fn squared(&self) -> Self {
        let two_c = self.c * 2.0;
        let mut q = [Lanes::ZERO; Q];
        let mut k = 0;
        for a in 0..N {
            q[k] = two_c * self.q[k] + self.l[a] * self.l[a];
            k += 1;
            let two_l = self.l[a] * 2.0;
            for b in a + 1..N {
                q[k] = two_c * self.q[k] + two_l * self.l[b];
                k += 1;
            }
        }
        Self::new(self.c * self.c, self.l.map(|l| two_c * l), q, self.remainder(self))
    }

    /// What the product of the two has beside the polynomial of second order.
    #[inline]
    fn remainder(&self, other: &Self) -> Lanes {
        let (mine, others) = (self.quadratic + self.r, other.quadratic + other.r);
        let third = self.linear * others + mine * other.linear + mine * others;
        let first = self.c.abs() * other.r + self.r * other.c.abs();
        (third + first) * (1.0 + ROUNDING) + self.norm() * other.norm() * ROUNDING
    }

    /// Sum of the products with affine functions that are the same in all four.
    #[inline]
    pub(super) fn minus_products<const M: usize>(&self, of: &[Self; M], with: &[Affine<N>; M]) -> Self {
        let Self { mut c, mut l, mut q, mut r, .. } = *self;
        let mut size = self.norm();
        for (model, affine) in of.iter().zip(with) {
            c = c - model.c * affine.c;
            for (a, l) in l.iter_mut().enumerate() {
                *l = *l - (model.l[a] * affine.c + model.c * affine.l[a]);
            }
            let mut k = 0;
            for a in 0..N {
                q[k] = q[k] - (model.q[k] * affine.c + model.l[a] * affine.l[a]);
                k += 1;
                for b in a + 1..N {
                    q[k] = q[k] - (model.q[k] * affine.c + (model.l[a] * affine.l[b] + model.l[b] * affine.l[a]));
                    k += 1;
                }
            }
            let slope: f64 = affine.l.iter().map(|l| l.abs()).sum();
            let norm = affine.c.abs() + slope;
            r += (model.quadratic * slope + model.r * norm) * (1.0 + ROUNDING);
            size += model.norm() * norm;
        }
        Self::new(c, l, q, r + size * ROUNDING)
    }

    /// Linear combination.
    #[inline]
    pub(super) fn sum<'a>(terms: impl IntoIterator<Item = (f64, &'a Self)>) -> Self {
        let (mut c, mut l, mut q) = (Lanes::ZERO, [Lanes::ZERO; N], [Lanes::ZERO; Q]);
        let (mut r, mut size) = (Lanes::ZERO, Lanes::ZERO);
        for (factor, model) in terms {
            if factor == 0.0 {
                continue;
            }
            c += model.c * factor;
            for (l, other) in l.iter_mut().zip(&model.l) {
                *l += *other * factor;
            }
            for (q, other) in q.iter_mut().zip(&model.q) {
                *q += *other * factor;
            }
            r += model.r * factor.abs();
            size += model.norm() * factor.abs();
        }
        Self::new(c, l, q, r + size * ROUNDING)
    }

    /// `f(model)` by the expansion of f about the model's c.
    #[inline]
    pub(super) fn through(&self, f: &Expansion) -> Self {
        let mut q = [Lanes::ZERO; Q];
        let mut k = 0;
        for a in 0..N {
            q[k] = f.first * self.q[k] + f.half_second * (self.l[a] * self.l[a]);
            k += 1;
            let two_l = self.l[a] * 2.0;
            for b in a + 1..N {
                q[k] = f.first * self.q[k] + f.half_second * (two_l * self.l[b]);
                k += 1;
            }
        }
        let beyond = self.quadratic + self.r;
        let spread = self.linear + beyond;
        let r = f.first.abs() * self.r
            + f.half_second.abs() * (self.linear * beyond * 2.0 + beyond * beyond)
            + f.sixth_third * (spread * spread * spread);
        let size = f.value.abs() + f.first.abs() * spread + f.half_second.abs() * (spread * spread);
        Self::new(f.value, self.l.map(|l| f.first * l), q, r * (1.0 + ROUNDING) + size * ROUNDING)
    }

    /// `1/f`, and where it is one: f has no zero.
    #[inline]
    pub(super) fn recip(&self) -> (Self, [bool; LANES]) {
        let least = self.c.abs() - self.spread() - self.norm() * ROUNDING;
        let exists = least.0.map(|least| least > 0.0);
        let inverse = self.c.map(f64::recip);
        let square = inverse * inverse;
        let greatest = least.map(f64::recip);
        let expansion = Expansion {
            value: inverse,
            first: -square,
            half_second: square * inverse,
            sixth_third: (greatest * greatest) * (greatest * greatest),
        };
        (self.through(&expansion), exists)
    }

    /// `1/√f`, and where it is one: f is positive.
    #[inline]
    pub(super) fn recip_sqrt(&self) -> (Self, [bool; LANES]) {
        let least = self.least();
        let exists = least.0.map(|least| least > 0.0);
        let root = self.c.map(|c| c.sqrt().recip());
        let inverse = root * root;
        let greatest = least.map(|least| least.sqrt().recip());
        let cube = greatest * greatest * greatest;
        let expansion = Expansion {
            value: root,
            first: root * inverse * -0.5,
            half_second: root * inverse * inverse * 0.375,
            sixth_third: cube * cube * greatest * 0.3125,
        };
        (self.through(&expansion), exists)
    }

    /// This one where the condition holds, the other elsewhere.
    pub(super) fn or(&self, other: &Self, holds: [bool; LANES]) -> Self {
        Self {
            c: self.c.or(other.c, holds),
            l: std::array::from_fn(|a| self.l[a].or(other.l[a], holds)),
            q: std::array::from_fn(|k| self.q[k].or(other.q[k], holds)),
            r: self.r.or(other.r, holds),
            linear: self.linear.or(other.linear, holds),
            quadratic: self.quadratic.or(other.quadratic, holds),
        }
    }
}

impl<const N: usize, const Q: usize> Add for &Taylor<N, Q> {
    type Output = Taylor<N, Q>;

    #[inline]
    fn add(self, other: Self) -> Taylor<N, Q> {
        let l = std::array::from_fn(|a| self.l[a] + other.l[a]);
        let q = std::array::from_fn(|k| self.q[k] + other.q[k]);
        let r = self.r + other.r + (self.norm() + other.norm()) * ROUNDING;
        Taylor::new(self.c + other.c, l, q, r)
    }
}

impl<const N: usize, const Q: usize> Sub for &Taylor<N, Q> {
    type Output = Taylor<N, Q>;

    #[inline]
    fn sub(self, other: Self) -> Taylor<N, Q> {
        let l = std::array::from_fn(|a| self.l[a] - other.l[a]);
        let q = std::array::from_fn(|k| self.q[k] - other.q[k]);
        let r = self.r + other.r + (self.norm() + other.norm()) * ROUNDING;
        Taylor::new(self.c - other.c, l, q, r)
    }
}

impl<const N: usize, const Q: usize> Neg for &Taylor<N, Q> {
    type Output = Taylor<N, Q>;

    #[inline]
    fn neg(self) -> Taylor<N, Q> {
        Taylor { c: -self.c, l: self.l.map(|l| -l), q: self.q.map(|q| -q), ..*self }
    }
}

impl<const N: usize, const Q: usize> Mul for &Taylor<N, Q> {
    type Output = Taylor<N, Q>;

    #[inline]
    fn mul(self, other: Self) -> Taylor<N, Q> {
        let l = std::array::from_fn(|a| self.c * other.l[a] + self.l[a] * other.c);
        let mut q = [Lanes::ZERO; Q];
        let mut k = 0;
        for a in 0..N {
            q[k] = self.c * other.q[k] + self.q[k] * other.c + self.l[a] * other.l[a];
            k += 1;
            for b in a + 1..N {
                q[k] = self.c * other.q[k] + self.q[k] * other.c + (self.l[a] * other.l[b] + self.l[b] * other.l[a]);
                k += 1;
            }
        }
        Taylor::new(self.c * other.c, l, q, self.remainder(other))
    }
}
