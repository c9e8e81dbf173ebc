//! Several numbers at once, and formulas that are of one number or of several.
//!
//! What is written for a [`Number`] gives the same bits for each of several numbers as for it alone. Compiled where `pulp` dispatches to
//! the processor's vector instructions, which it only is as far as it is inlined there, the compiler works on them side by side.

#![allow(clippy::inline_always, reason = "what is dispatched is compiled for the processor only where it is inlined")]

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// One number, or several.
pub(crate) trait Number:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Mul<f64, Output = Self>
{
    /// The same in every place.
    fn all(value: f64) -> Self;

    /// A function of each.
    fn map(self, f: impl Fn(f64) -> f64) -> Self;

    /// A function of each and of the other's in its place.
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self;

    /// Whether it holds of every one.
    fn every(self, holds: impl Fn(f64) -> bool) -> bool;

    /// The square root of each.
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.map(f64::sqrt)
    }
}

impl Number for f64 {
    #[inline(always)]
    fn all(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        f(self)
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        f(self, other)
    }

    #[inline(always)]
    fn every(self, holds: impl Fn(f64) -> bool) -> bool {
        holds(self)
    }
}

/// N numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Lanes<const N: usize>(pub(crate) [f64; N]);

impl<const N: usize> Lanes<N> {
    pub(crate) const ZERO: Self = Self([0.0; N]);

    #[inline(always)]
    pub(crate) const fn of(numbers: [f64; N]) -> Self {
        Self(numbers)
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        self.map(f64::abs)
    }

    /// These where the condition holds, those of `other` elsewhere.
    #[inline(always)]
    pub(crate) fn or(self, other: Self, holds: [bool; N]) -> Self {
        Self(std::array::from_fn(|i| if holds[i] { self.0[i] } else { other.0[i] }))
    }

    pub(crate) fn sum(self) -> f64 {
        self.0.iter().sum()
    }
}

impl<const N: usize> Number for Lanes<N> {
    #[inline(always)]
    fn all(value: f64) -> Self {
        Self([value; N])
    }

    #[inline(always)]
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self(self.0.map(f))
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }

    #[inline(always)]
    fn every(self, holds: impl Fn(f64) -> bool) -> bool {
        self.0.iter().fold(true, |every, &number| every & holds(number))
    }
}

impl<const N: usize> Add for Lanes<N> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl<const N: usize> AddAssign for Lanes<N> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<const N: usize> Sub for Lanes<N> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl<const N: usize> Mul for Lanes<N> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl<const N: usize> Mul<f64> for Lanes<N> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        self.map(|a| a * factor)
    }
}

impl<const N: usize> Div for Lanes<N> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }
}

impl<const N: usize> Neg for Lanes<N> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}
