//! Numbers of several elements side by side, one machine register wide.
//!
//! `Lanes<S>` is `S::F64_LANES` numbers (8 with AVX-512, 4 with AVX2, 1 without either), with plain
//! `+`, `-`, `*`, `/` and square roots. Each is rounded by itself, never fused, so every instruction set
//! gives the same bytes. Everything here and in the kernel must be `inline(always)`: an operation
//! that stays a call is compiled for the oldest processor and costs ten times as much.

use pulp::Simd;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Elements in one batch: the widest register of 64-bit numbers.
pub(super) const BATCH: usize = 8;

/// One number of each of the `BATCH` elements; starts on a cache line.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Row(pub [f64; BATCH]);

impl Row {
    pub(super) const ZERO: Self = Self([0.0; BATCH]);

    /// The numbers of the `group`-th register.
    #[inline(always)]
    pub(super) fn load<S: Simd>(&self, simd: S, group: usize) -> Lanes<S> {
        Lanes { simd, value: S::as_simd_f64s(&self.0).0[group] }
    }

    #[inline(always)]
    pub(super) fn store<S: Simd>(&mut self, group: usize, lanes: Lanes<S>) {
        S::as_mut_simd_f64s(&mut self.0).0[group] = lanes.value;
    }
}

/// One register of numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lanes<S: Simd> {
    simd: S,
    value: S::f64s,
}

/// A vector per lane.
pub(super) type Lanes3<S> = [Lanes<S>; 3];

impl<S: Simd> Lanes<S> {
    #[inline(always)]
    pub(super) fn splat(simd: S, number: f64) -> Self {
        Self { simd, value: simd.splat_f64s(number) }
    }

    #[inline(always)]
    pub(super) fn simd(self) -> S {
        self.simd
    }

    #[inline(always)]
    pub(super) fn max(self, other: Self) -> Self {
        Self { simd: self.simd, value: self.simd.max_f64s(self.value, other.value) }
    }

    #[inline(always)]
    pub(super) fn min(self, other: Self) -> Self {
        Self { simd: self.simd, value: self.simd.min_f64s(self.value, other.value) }
    }

    #[inline(always)]
    pub(super) fn abs(self) -> Self {
        Self { simd: self.simd, value: self.simd.abs_f64s(self.value) }
    }

    #[inline(always)]
    pub(super) fn sqrt(self) -> Self {
        Self { simd: self.simd, value: self.simd.sqrt_f64s(self.value) }
    }

    /// `yes` where the number is above zero, `no` elsewhere and where it is none.
    #[inline(always)]
    pub(super) fn if_positive(self, yes: Self, no: Self) -> Self {
        let simd = self.simd;
        let mask = simd.greater_than_f64s(self.value, simd.splat_f64s(0.0));
        Self { simd, value: simd.select_f64s(mask, yes.value, no.value) }
    }
}

impl<S: Simd> Add for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { simd: self.simd, value: self.simd.add_f64s(self.value, other.value) }
    }
}

impl<S: Simd> Sub for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { simd: self.simd, value: self.simd.sub_f64s(self.value, other.value) }
    }
}

impl<S: Simd> Mul for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self { simd: self.simd, value: self.simd.mul_f64s(self.value, other.value) }
    }
}

impl<S: Simd> Div for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self { simd: self.simd, value: self.simd.div_f64s(self.value, other.value) }
    }
}

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { simd: self.simd, value: self.simd.neg_f64s(self.value) }
    }
}

/// `a . b` per lane.
#[inline(always)]
pub(super) fn dot<S: Simd>(a: Lanes3<S>, b: Lanes3<S>) -> Lanes<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `a - b` per lane.
#[inline(always)]
pub(super) fn subtract<S: Simd>(a: Lanes3<S>, b: Lanes3<S>) -> Lanes3<S> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `a x b` per lane.
#[inline(always)]
pub(super) fn cross<S: Simd>(a: Lanes3<S>, b: Lanes3<S>) -> Lanes3<S> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
