//! The greatest value of a quadratic on the cube, from above.

use super::taylor::{ROUNDING, Taylor, place};

/// `c + l·x + Σ_{a≤b} q_ab x_a x_b`, within r, on `x ∈ [−1, 1]ⁿ`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Quadratic<const N: usize, const Q: usize> {
    pub(super) c: f64,
    pub(super) l: [f64; N],
    pub(super) q: [f64; Q],
    pub(super) r: f64,
}

/// A part of the cube: the quadratic about its centre.
#[derive(Debug, Clone, Copy)]
struct Part<const N: usize, const Q: usize> {
    about: Quadratic<N, Q>,
    bound: f64,
    /// The variable whose halves are told apart next.
    widest: usize,
}

/// Rounds over the limits in search of multipliers.
const SWEEPS: usize = 2;

/// Steps of a search for one.
const SECTIONS: usize = 14;

/// Where a convex function is the least between 0 and `most`, by golden section.
fn minimiser(most: f64, f: impl Fn(f64) -> f64) -> f64 {
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let (mut low, mut high) = (0.0, most);
    let (mut a, mut b) = (high - golden * (high - low), low + golden * (high - low));
    let (mut f_a, mut f_b) = (f(a), f(b));
    for _ in 0..SECTIONS {
        if f_a <= f_b {
            (high, b, f_b) = (b, a, f_a);
            a = high - golden * (high - low);
            f_a = f(a);
        } else {
            (low, a, f_a) = (a, b, f_b);
            b = low + golden * (high - low);
            f_b = f(b);
        }
    }
    if f_a <= f_b { a } else { b }
}

/// Most parts that a cube is divided into.
const MOST_PARTS: usize = 64;

impl<const N: usize, const Q: usize> Quadratic<N, Q> {
    /// No value on the cube is greater. By bisection, until the gap is a small share of r.
    pub(super) fn greatest(&self) -> f64 {
        let mut parts = vec![Part::of(*self)];
        let mut found = self.c;
        for _ in 0..MOST_PARTS {
            let Some((i, most)) = parts.iter().enumerate().max_by(|a, b| a.1.bound.total_cmp(&b.1.bound)) else {
                break;
            };
            if most.bound - found <= 0.05 * self.r || !most.bound.is_finite() {
                break;
            }
            let part = parts.swap_remove(i);
            for side in [-0.5, 0.5] {
                let half = Part::of(part.about.halved(part.widest, side));
                found = found.max(half.about.c);
                parts.push(half);
            }
        }
        let most = parts.iter().map(|part| part.bound).fold(f64::NEG_INFINITY, f64::max);
        most + self.r + 1e-12 * self.size()
    }

    /// The variable that it depends on most; the remainder depends on them by their third `moves`.
    pub(super) fn widest(&self, moves: &[f64; N]) -> usize {
        let all: f64 = moves.iter().sum();
        let mut sides: [f64; N] = std::array::from_fn(|a| self.l[a].abs() + 3.0 * self.r * moves[a] / all);
        let mut k = 0;
        for a in 0..N {
            for b in a..N {
                sides[a] += self.q[k].abs();
                sides[b] += self.q[k].abs();
                k += 1;
            }
        }
        (0..N).fold(0, |most, a| if sides[a] > sides[most] { a } else { most })
    }

    /// Of the model's lane; its terms of third order go to r.
    pub(super) fn of<const C: usize>(model: &Taylor<N, Q, C>, lane: usize) -> Self {
        Self {
            c: model.c.0[lane],
            l: model.l.map(|l| l.0[lane]),
            q: model.q.map(|q| q.0[lane]),
            r: model.r.0[lane] + model.t.iter().map(|t| t.0[lane].abs()).sum::<f64>() * (1.0 + ROUNDING),
        }
    }

    /// No value on the cube is less, roughly.
    pub(super) fn least(&self) -> f64 {
        let spread: f64 = self.l.iter().chain(&self.q).map(|x| x.abs()).sum();
        self.c - spread - self.r
    }

    /// With so many times the other added.
    pub(super) fn plus(&self, factor: f64, other: &Self) -> Self {
        let mut sum = *self;
        sum.c += factor * other.c;
        for (sum, l) in sum.l.iter_mut().zip(&other.l) {
            *sum += factor * l;
        }
        for (sum, q) in sum.q.iter_mut().zip(&other.q) {
            *sum += factor * q;
        }
        sum.r += factor.abs() * other.r;
        sum
    }

    #[cfg(test)]
    pub(super) fn at(&self, x: &[f64; N]) -> f64 {
        let mut k = 0;
        let mut value = self.c;
        for a in 0..N {
            value += self.l[a] * x[a];
            for b in a..N {
                value += self.q[k] * x[a] * x[b];
                k += 1;
            }
        }
        value
    }

    fn quick_bound(&self) -> f64 {
        Part::of(*self).bound + self.r
    }

    /// No value is greater where none of the `limits` is negative: by Lagrange's bound, `max f + Σ λ_i h_i` with λ ≥ 0, whose
    /// multipliers are sought one at a time.
    pub(super) fn greatest_within(&self, limits: &[Self]) -> f64 {
        let mut sum = *self;
        let limits: Vec<&Self> = limits.iter().filter(|limit| limit.least() < 0.0).collect();
        if limits.is_empty() {
            return self.greatest();
        }
        let slope = |of: &Self| of.l.iter().fold(0.0f64, |most, l| most.max(l.abs()));
        let mut λ = vec![0.0; limits.len()];
        for _ in 0..SWEEPS {
            for (λ, limit) in λ.iter_mut().zip(&limits) {
                let most = 2.0 * slope(self) / slope(limit).max(f64::MIN_POSITIVE) + 2.0 * *λ;
                let without = sum.plus(-*λ, limit);
                let without = Self { r: sum.r - *λ * limit.r, ..without };
                let best = minimiser(most, |λ| without.plus(λ, limit).quick_bound());
                if without.plus(best, limit).quick_bound() < sum.quick_bound() {
                    (sum, *λ) = (without.plus(best, limit), best);
                }
            }
        }
        // Anew, for its rounding.
        let sum = limits.iter().zip(&λ).fold(*self, |sum, (limit, &λ)| sum.plus(λ, limit));
        let size: f64 = limits.iter().zip(&λ).map(|(limit, λ)| λ * limit.size()).sum();
        let within = sum.greatest() + 1e-12 * size;
        if λ.iter().any(|&λ| λ > 0.0) { within.min(self.greatest()) } else { within }
    }

    fn size(&self) -> f64 {
        self.c.abs() + self.l.iter().chain(&self.q).map(|x| x.abs()).sum::<f64>() + self.r
    }

    /// As a function of the half of the cube on one side of a variable's middle.
    fn halved(&self, variable: usize, side: f64) -> Self {
        let Self { mut c, mut l, mut q, r } = *self;
        let own = place(N, variable, variable);
        c += side * (l[variable] + side * q[own]);
        l[variable] = 0.5 * (l[variable] + 2.0 * side * q[own]);
        for other in (0..N).filter(|&other| other != variable) {
            let k = place(N, variable, other);
            l[other] += side * q[k];
            q[k] *= 0.5;
        }
        q[own] *= 0.25;
        Self { c, l, q, r }
    }
}

impl<const N: usize, const Q: usize> Part<N, Q> {
    /// Each variable by itself exactly, the products of two by their size.
    fn of(about: Quadratic<N, Q>) -> Self {
        let mut bound = about.c;
        let (mut widest, mut width) = (0, -1.0);
        let mut k = 0;
        let mut sides = [0.0; N];
        for a in 0..N {
            let (l, q) = (about.l[a].abs(), about.q[k]);
            bound += if q < 0.0 && l < -2.0 * q { -0.25 * l * l / q } else { l + q };
            // What the variable's own part gains beyond its middle is lost of the value at the centre.
            sides[a] += if q < 0.0 && l < -2.0 * q { -0.25 * l * l / q } else { l + q };
            k += 1;
            for b in a + 1..N {
                let product = about.q[k].abs();
                bound += product;
                sides[a] += product;
                sides[b] += product;
                k += 1;
            }
        }
        for (a, &side) in sides.iter().enumerate() {
            if side > width {
                (widest, width) = (a, side);
            }
        }
        Self { about, bound, widest }
    }
}
