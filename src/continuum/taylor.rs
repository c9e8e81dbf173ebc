//! Taylor models of the third order: functions of a box of joint values, enclosed.
//!
//! Over the box, `x ∈ [−1, 1]ⁿ` from its centre,
//!
//! ```text
//!     f(x) = c + Σ_a l_a x_a + Σ_{a≤b} q_ab x_a x_b + Σ_{a≤b≤c} t_abc x_a x_b x_c + [−r, r]
//! ```
//!
//! for **every** x. What arithmetic on the polynomials leaves out, terms of fourth order and more and its own rounding, goes to r. So
//! cancellation in sums is exact but for the fourth order, where interval arithmetic would lose it in the first.
//!
//! Makino and Berz, *Taylor models and other validated functional inclusion methods*, 2003.

#![allow(clippy::inline_always, reason = "what is dispatched is compiled for the processor only where it is inlined")]

use std::ops::{Add, Mul, Neg, Sub};

use pulp::{Arch, Simd, WithSimd};

use super::{LANES, Lanes};
use crate::lanes::Number;

/// Four Taylor models of N variables with Q = N (N + 1) / 2 products of two of them and C = Q (N + 2) / 3 of three.
#[derive(Debug, Clone, Copy)]
pub(super) struct Taylor<const N: usize, const Q: usize, const C: usize> {
    pub(super) c: Lanes,
    pub(super) l: [Lanes; N],
    /// Of `x_a x_b`, a ≤ b, row by row.
    pub(super) q: [Lanes; Q],
    /// Of `x_a x_b x_c`, a ≤ b ≤ c, in the order of a, b, c.
    pub(super) t: [Lanes; C],
    pub(super) r: Lanes,
    /// `Σ |l_a|`.
    linear: Lanes,
    /// `Σ |q_ab|`.
    quadratic: Lanes,
    /// `Σ |t_abc|`.
    cubic: Lanes,
}

/// A model all of whose terms but the first two are zero.
#[derive(Debug, Clone, Copy)]
pub(super) struct Affine<const N: usize> {
    pub(super) c: f64,
    pub(super) l: [f64; N],
}

/// Bounds the rounding of an operation on two models, as a share of the product or sum of their norms `|c| + Σ|l| + Σ|q| + r`: a
/// coefficient is a sum of at most four products, a norm one of at most fifty terms. Sums of a hundred such products are within it, too.
pub(super) const ROUNDING: f64 = 1e-13;

/// A function's Taylor coefficients at the centre of a range, and a bound of the fourth over the range.
pub(super) struct Expansion {
    pub(super) value: Lanes,
    pub(super) first: Lanes,
    pub(super) half_second: Lanes,
    pub(super) sixth_third: Lanes,
    /// A 24th of the greatest fourth derivative.
    pub(super) fourth: Lanes,
}

/// Place of `x_a x_b` among the products of two of n variables.
#[inline]
pub(super) const fn place(n: usize, a: usize, b: usize) -> usize {
    let (a, b) = if a < b { (a, b) } else { (b, a) };
    a * n - a * (a + 1) / 2 + b
}

/// Place of `x_a x_b x_c` among the products of three: behind those whose first is another, as those of two of the variables left.
pub(super) const fn place_of_three(n: usize, a: usize, b: usize, c: usize) -> usize {
    let least = if a <= b && a <= c {
        a
    } else if b <= c {
        b
    } else {
        c
    };
    let (mut b, c) = if least == a {
        (b, c)
    } else if least == b {
        (a, c)
    } else {
        (a, b)
    };
    let mut place_before = 0;
    let mut first = 0;
    while first < least {
        let left = n - first;
        place_before += left * (left + 1) / 2;
        first += 1;
    }
    b -= least;
    place_before + place(n - least, b, c - least)
}

impl<const N: usize, const Q: usize, const C: usize> Taylor<N, Q, C> {
    #[inline(always)]
    pub(super) fn new(c: Lanes, l: [Lanes; N], q: [Lanes; Q], t: [Lanes; C], r: Lanes) -> Self {
        let norm = |of: &[Lanes]| of.iter().fold(Lanes::ZERO, |sum, x| sum + x.abs());
        Self { c, l, q, t, r, linear: norm(&l), quadratic: norm(&q), cubic: norm(&t) }
    }

    #[inline(always)]
    pub(super) fn constant(c: f64) -> Self {
        let zero = Lanes::ZERO;
        Self {
            c: Lanes::all(c),
            l: [zero; N],
            q: [zero; Q],
            t: [zero; C],
            r: zero,
            linear: zero,
            quadratic: zero,
            cubic: zero,
        }
    }

    /// How far it can be from c.
    #[inline(always)]
    pub(super) fn spread(&self) -> Lanes {
        self.linear + self.quadratic + self.cubic + self.r
    }

    /// A bound of |f|.
    #[inline(always)]
    pub(super) fn norm(&self) -> Lanes {
        self.c.abs() + self.spread()
    }

    /// No value is less.
    #[inline(always)]
    pub(super) fn least(&self) -> Lanes {
        self.c - self.spread() - self.norm() * ROUNDING
    }

    /// No value is greater.
    #[inline(always)]
    pub(super) fn greatest(&self) -> Lanes {
        self.c + self.spread() + self.norm() * ROUNDING
    }

    pub(super) fn scaled(&self, factor: f64) -> Self {
        self.scaled_by(Lanes::all(factor))
    }

    pub(super) fn scaled_by(&self, factor: Lanes) -> Self {
        let size = factor.abs();
        Self {
            c: self.c * factor,
            l: self.l.map(|l| l * factor),
            q: self.q.map(|q| q * factor),
            t: self.t.map(|t| t * factor),
            r: (self.r + self.norm() * ROUNDING) * size,
            linear: self.linear * size,
            quadratic: self.quadratic * size,
            cubic: self.cubic * size,
        }
    }

    pub(super) fn plus(&self, constant: f64) -> Self {
        let rounding = (self.c.abs() + Lanes::all(constant.abs())) * ROUNDING;
        Self { c: self.c + Lanes::all(constant), r: self.r + rounding, ..*self }
    }

    pub(super) fn squared(&self) -> Self {
        Arch::new().dispatch(Square(self))
    }

    #[inline(always)]
    fn square(&self) -> Self {
        let mut square = Products::NONE;
        square.add_square(self);
        square.sum()
    }

    /// What the product of the two has beside the polynomial of third order.
    #[inline(always)]
    fn remainder(&self, other: &Self) -> Lanes {
        let (mine, others) = (self.cubic + self.r, other.cubic + other.r);
        let fourth = self.linear * others
            + mine * other.linear
            + self.quadratic * (other.quadratic + others)
            + mine * (other.quadratic + others);
        let first = self.c.abs() * other.r + self.r * other.c.abs();
        (fourth + first) * (1.0 + ROUNDING) + self.norm() * other.norm() * ROUNDING
    }

    /// The sum of the four, in every lane.
    pub(super) fn over_lanes(&self) -> Self {
        let sum = |lanes: Lanes| Lanes::all(lanes.sum());
        let r = sum(self.norm() * ROUNDING + self.r);
        Self::new(sum(self.c), self.l.map(sum), self.q.map(sum), self.t.map(sum), r)
    }

    /// Less the products with affine functions that are the same in all four.
    #[inline(always)]
    fn minus_products<const M: usize>(&self, of: &[Self; M], with: &[Affine<N>; M]) -> Self {
        let Self { mut c, mut l, mut q, mut t, mut r, .. } = *self;
        let mut size = self.norm();
        for (model, affine) in of.iter().zip(with) {
            c = c - model.c * affine.c;
            for (a, l) in l.iter_mut().enumerate() {
                *l = *l - (model.l[a] * affine.c + model.c * affine.l[a]);
            }
            let (mut second, mut third) = (0, 0);
            for a in 0..N {
                for b in a..N {
                    let mut sum = model.q[second] * affine.c + model.l[b] * affine.l[a];
                    if a != b {
                        sum += model.l[a] * affine.l[b];
                    }
                    q[second] = q[second] - sum;
                    for c in b..N {
                        let mut sum = model.t[third] * affine.c + model.q[place(N, b, c)] * affine.l[a];
                        if b != a {
                            sum += model.q[place(N, a, c)] * affine.l[b];
                        }
                        if c != b {
                            sum += model.q[second] * affine.l[c];
                        }
                        t[third] = t[third] - sum;
                        third += 1;
                    }
                    second += 1;
                }
            }
            let slope: f64 = affine.l.iter().map(|l| l.abs()).sum();
            let norm = affine.c.abs() + slope;
            r += (model.cubic * slope + model.r * norm) * (1.0 + ROUNDING);
            size += model.norm() * norm;
        }
        Self::new(c, l, q, t, r + size * ROUNDING)
    }

    /// Linear combination.
    pub(super) fn sum<'a>(terms: impl IntoIterator<Item = (f64, &'a Self)>) -> Self {
        Arch::new().dispatch(Sum(terms))
    }

    #[inline(always)]
    fn combination<'a>(terms: impl IntoIterator<Item = (f64, &'a Self)>) -> Self {
        let Self { mut c, mut l, mut q, mut t, mut r, .. } = Self::constant(0.0);
        let mut size = Lanes::ZERO;
        for (factor, model) in terms {
            if factor == 0.0 {
                continue;
            }
            c += model.c * factor;
            let add = |sums: &mut [Lanes], of: &[Lanes]| {
                for (sum, other) in sums.iter_mut().zip(of) {
                    *sum += *other * factor;
                }
            };
            add(&mut l, &model.l);
            add(&mut q, &model.q);
            add(&mut t, &model.t);
            r += model.r * factor.abs();
            size += model.norm() * factor.abs();
        }
        Self::new(c, l, q, t, r + size * ROUNDING)
    }

    /// `f(model)` by the expansion of f about the model's c.
    pub(super) fn through(&self, f: &Expansion) -> Self {
        Arch::new().dispatch(Through { model: self, f })
    }

    #[inline(always)]
    fn expanded(&self, f: &Expansion) -> Self {
        // d = f − c without what goes to the remainder; d² and d³ to the third order.
        let d = Self { c: Lanes::ZERO, ..*self };
        let square = d.square();
        let mut cube = [Lanes::ZERO; C];
        let mut third = 0;
        for a in 0..N {
            for b in a..N {
                for c in b..N {
                    let share = if a == c {
                        1.0
                    } else if a == b || b == c {
                        3.0
                    } else {
                        6.0
                    };
                    cube[third] = self.l[a] * self.l[b] * self.l[c] * share;
                    third += 1;
                }
            }
        }
        let q = std::array::from_fn(|k| f.first * self.q[k] + f.half_second * square.q[k]);
        let t = std::array::from_fn(|k| f.first * self.t[k] + (f.half_second * square.t[k] + f.sixth_third * cube[k]));
        let beyond = self.quadratic + self.cubic + self.r;
        let (linear, spread) = (self.linear, self.linear + beyond);
        // (l + b)³ − l³ = b (3 l² + 3 l b + b²).
        let of_cube = beyond * (linear * linear * 3.0 + linear * beyond * 3.0 + beyond * beyond);
        let spread2 = spread * spread;
        let r = f.first.abs() * self.r
            + f.half_second.abs() * square.r
            + f.sixth_third.abs() * of_cube
            + f.fourth * (spread2 * spread2);
        let size = f.value.abs()
            + f.first.abs() * spread
            + f.half_second.abs() * spread2
            + f.sixth_third.abs() * (spread2 * spread);
        Self::new(f.value, self.l.map(|l| f.first * l), q, t, r * (1.0 + ROUNDING) + size * ROUNDING)
    }

    /// `1/f`, and where it is one: f has no zero.
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
            sixth_third: -(square * square),
            fourth: (greatest * greatest) * (greatest * greatest) * greatest,
        };
        (self.through(&expansion), exists)
    }

    /// `1/√f`, and where it is one: f is positive.
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
            sixth_third: root * inverse * inverse * inverse * -0.3125,
            fourth: cube * cube * cube * (35.0 / 128.0),
        };
        (self.through(&expansion), exists)
    }

    /// This one where the condition holds, the other elsewhere.
    pub(super) fn or(&self, other: &Self, holds: [bool; LANES]) -> Self {
        Self {
            c: self.c.or(other.c, holds),
            l: std::array::from_fn(|a| self.l[a].or(other.l[a], holds)),
            q: std::array::from_fn(|k| self.q[k].or(other.q[k], holds)),
            t: std::array::from_fn(|k| self.t[k].or(other.t[k], holds)),
            r: self.r.or(other.r, holds),
            linear: self.linear.or(other.linear, holds),
            quadratic: self.quadratic.or(other.quadratic, holds),
            cubic: self.cubic.or(other.cubic, holds),
        }
    }
}

impl<const N: usize, const Q: usize, const C: usize> Add for &Taylor<N, Q, C> {
    type Output = Taylor<N, Q, C>;

    fn add(self, other: Self) -> Taylor<N, Q, C> {
        let l = std::array::from_fn(|a| self.l[a] + other.l[a]);
        let q = std::array::from_fn(|k| self.q[k] + other.q[k]);
        let t = std::array::from_fn(|k| self.t[k] + other.t[k]);
        let r = self.r + other.r + (self.norm() + other.norm()) * ROUNDING;
        Taylor::new(self.c + other.c, l, q, t, r)
    }
}

impl<const N: usize, const Q: usize, const C: usize> Sub for &Taylor<N, Q, C> {
    type Output = Taylor<N, Q, C>;

    fn sub(self, other: Self) -> Taylor<N, Q, C> {
        let l = std::array::from_fn(|a| self.l[a] - other.l[a]);
        let q = std::array::from_fn(|k| self.q[k] - other.q[k]);
        let t = std::array::from_fn(|k| self.t[k] - other.t[k]);
        let r = self.r + other.r + (self.norm() + other.norm()) * ROUNDING;
        Taylor::new(self.c - other.c, l, q, t, r)
    }
}

impl<const N: usize, const Q: usize, const C: usize> Neg for &Taylor<N, Q, C> {
    type Output = Taylor<N, Q, C>;

    fn neg(self) -> Taylor<N, Q, C> {
        Taylor { c: -self.c, l: self.l.map(|l| -l), q: self.q.map(|q| -q), t: self.t.map(|t| -t), ..*self }
    }
}

impl<const N: usize, const Q: usize, const C: usize> Mul for &Taylor<N, Q, C> {
    type Output = Taylor<N, Q, C>;

    fn mul(self, other: Self) -> Taylor<N, Q, C> {
        Arch::new().dispatch(Product(self, other))
    }
}

/// A sum of products, of no more than a hundred.
#[derive(Debug, Clone, Copy)]
pub(super) struct Products<const N: usize, const Q: usize, const C: usize> {
    c: Lanes,
    l: [Lanes; N],
    q: [Lanes; Q],
    t: [Lanes; C],
    r: Lanes,
}

impl<const N: usize, const Q: usize, const C: usize> Products<N, Q, C> {
    pub(super) const NONE: Self =
        Self { c: Lanes::ZERO, l: [Lanes::ZERO; N], q: [Lanes::ZERO; Q], t: [Lanes::ZERO; C], r: Lanes::ZERO };

    pub(super) fn add(&mut self, one: &Taylor<N, Q, C>, other: &Taylor<N, Q, C>) {
        Arch::new().dispatch(AddProduct { sum: self, one, other });
    }

    #[inline(always)]
    pub(super) fn sum(&self) -> Taylor<N, Q, C> {
        let Self { c, l, q, t, r } = *self;
        Taylor::new(c, l, q, t, r)
    }

    #[inline(always)]
    fn add_product(&mut self, one: &Taylor<N, Q, C>, other: &Taylor<N, Q, C>) {
        self.c += one.c * other.c;
        for (l, (one_l, other_l)) in self.l.iter_mut().zip(one.l.iter().zip(&other.l)) {
            *l += one.c * *other_l + *one_l * other.c;
        }
        for (q, (one_q, other_q)) in self.q.iter_mut().zip(one.q.iter().zip(&other.q)) {
            *q += one.c * *other_q + *one_q * other.c;
        }
        for (t, (one_t, other_t)) in self.t.iter_mut().zip(one.t.iter().zip(&other.t)) {
            *t += one.c * *other_t + *one_t * other.c;
        }
        let (mut second, mut third) = (0, 0);
        for a in 0..N {
            for b in a..N {
                let mut sum = one.l[a] * other.l[b];
                if a != b {
                    sum += one.l[b] * other.l[a];
                }
                self.q[second] += sum;
                for c in b..N {
                    let bc = place(N, b, c);
                    let mut sum = one.l[a] * other.q[bc] + one.q[bc] * other.l[a];
                    if b != a {
                        let ac = place(N, a, c);
                        sum += one.l[b] * other.q[ac] + one.q[ac] * other.l[b];
                    }
                    if c != b {
                        sum += one.l[c] * other.q[second] + one.q[second] * other.l[c];
                    }
                    self.t[third] += sum;
                    third += 1;
                }
                second += 1;
            }
        }
        self.r += one.remainder(other);
    }

    #[inline(always)]
    fn add_square(&mut self, of: &Taylor<N, Q, C>) {
        let two_c = of.c * 2.0;
        self.c += of.c * of.c;
        for (l, of_l) in self.l.iter_mut().zip(&of.l) {
            *l += two_c * *of_l;
        }
        for (q, of_q) in self.q.iter_mut().zip(&of.q) {
            *q += two_c * *of_q;
        }
        for (t, of_t) in self.t.iter_mut().zip(&of.t) {
            *t += two_c * *of_t;
        }
        let (mut second, mut third) = (0, 0);
        for a in 0..N {
            for b in a..N {
                let share = if a == b { 1.0 } else { 2.0 };
                self.q[second] += of.l[a] * of.l[b] * share;
                for c in b..N {
                    let mut sum = of.l[a] * of.q[place(N, b, c)];
                    if b != a {
                        sum += of.l[b] * of.q[place(N, a, c)];
                    }
                    if c != b {
                        sum += of.l[c] * of.q[second];
                    }
                    self.t[third] += sum * 2.0;
                    third += 1;
                }
                second += 1;
            }
        }
        self.r += of.remainder(of);
    }
}

/// `xx, xy, yy` of all columns, of the residuals `[x, y] = A − B K`.
pub(super) fn residual_squares<const N: usize, const Q: usize, const C: usize>(
    A: &[[Taylor<N, Q, C>; 2]],
    B: &[[Taylor<N, Q, C>; 6]; 2],
    K: &[[Affine<N>; 6]],
) -> [Products<N, Q, C>; 3] {
    let mut squares = [Products::NONE; 3];
    for (A, K) in A.iter().zip(K) {
        Arch::new().dispatch(AddResidual { squares: &mut squares, A, B, K });
    }
    squares
}

// What follows is compiled for every set of instructions that `Arch` tells apart.

struct Product<'a, const N: usize, const Q: usize, const C: usize>(&'a Taylor<N, Q, C>, &'a Taylor<N, Q, C>);

impl<const N: usize, const Q: usize, const C: usize> WithSimd for Product<'_, N, Q, C> {
    type Output = Taylor<N, Q, C>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let mut product = Products::NONE;
        product.add_product(self.0, self.1);
        product.sum()
    }
}

struct Square<'a, const N: usize, const Q: usize, const C: usize>(&'a Taylor<N, Q, C>);

impl<const N: usize, const Q: usize, const C: usize> WithSimd for Square<'_, N, Q, C> {
    type Output = Taylor<N, Q, C>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        self.0.square()
    }
}

struct AddProduct<'a, const N: usize, const Q: usize, const C: usize> {
    sum: &'a mut Products<N, Q, C>,
    one: &'a Taylor<N, Q, C>,
    other: &'a Taylor<N, Q, C>,
}

impl<const N: usize, const Q: usize, const C: usize> WithSimd for AddProduct<'_, N, Q, C> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.sum.add_product(self.one, self.other);
    }
}

struct AddResidual<'a, const N: usize, const Q: usize, const C: usize> {
    squares: &'a mut [Products<N, Q, C>; 3],
    A: &'a [Taylor<N, Q, C>; 2],
    B: &'a [[Taylor<N, Q, C>; 6]; 2],
    K: &'a [Affine<N>; 6],
}

impl<const N: usize, const Q: usize, const C: usize> WithSimd for AddResidual<'_, N, Q, C> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { squares: [xx, xy, yy], A, B, K } = self;
        let (x, y) = (A[0].minus_products(&B[0], K), A[1].minus_products(&B[1], K));
        xx.add_square(&x);
        xy.add_product(&x, &y);
        yy.add_square(&y);
    }
}

struct Through<'a, const N: usize, const Q: usize, const C: usize> {
    model: &'a Taylor<N, Q, C>,
    f: &'a Expansion,
}

impl<const N: usize, const Q: usize, const C: usize> WithSimd for Through<'_, N, Q, C> {
    type Output = Taylor<N, Q, C>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        self.model.expanded(self.f)
    }
}

struct Sum<I>(I);

impl<'a, const N: usize, const Q: usize, const C: usize, I> WithSimd for Sum<I>
where
    I: IntoIterator<Item = (f64, &'a Taylor<N, Q, C>)>,
{
    type Output = Taylor<N, Q, C>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        Taylor::combination(self.0)
    }
}
