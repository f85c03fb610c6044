//! One number with what it should be.

/// How the error of a quantity is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// `value / reference - 1`.
    Relative,
    /// `value - reference`, in the quantity's unit.
    Absolute,
}

/// A measured value, what it should be, and how far off it may be.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// What was measured.
    pub name: String,
    /// Its unit; empty for a pure number.
    pub unit: &'static str,
    /// Our value.
    pub value: f64,
    /// What it should be.
    pub reference: f64,
    /// Where the reference comes from: an equation, a book, METHOD.
    pub source: &'static str,
    /// How the error is measured.
    pub measure: Measure,
    /// Largest error that passes; `None` for what is shown and not judged.
    pub bound: Option<f64>,
    /// Why the bound is what it is.
    pub reason: &'static str,
}

impl Quantity {
    /// A quantity whose error is a share of its reference. It is shown only, until [`Quantity::within`] gives a bound.
    #[must_use]
    pub fn relative(name: impl Into<String>, unit: &'static str, value: f64, reference: f64) -> Self {
        let measure = Measure::Relative;
        Self { name: name.into(), unit, value, reference, source: "", measure, bound: None, reason: "" }
    }

    /// A quantity whose error is in its own unit; see [`Quantity::relative`].
    #[must_use]
    pub fn absolute(name: impl Into<String>, unit: &'static str, value: f64, reference: f64) -> Self {
        Self { measure: Measure::Absolute, ..Self::relative(name, unit, value, reference) }
    }

    /// Says where the reference comes from.
    #[must_use]
    pub fn by(self, source: &'static str) -> Self {
        Self { source, ..self }
    }

    /// Says how far off the value may be, and why.
    #[must_use]
    pub fn within(self, bound: f64, reason: &'static str) -> Self {
        Self { bound: Some(bound), reason, ..self }
    }

    /// The error, as [`Quantity::measure`] says.
    #[must_use]
    pub fn error(&self) -> f64 {
        match self.measure {
            Measure::Relative => self.value / self.reference - 1.0,
            Measure::Absolute => self.value - self.reference,
        }
    }

    /// Whether the error is within the bound; what is not a number never is.
    #[must_use]
    pub fn passes(&self) -> bool {
        self.bound.is_none_or(|bound| self.error().abs() <= bound)
    }

    /// `pass`, `falls short`, or `shown` without a bound.
    #[must_use]
    pub fn verdict(&self) -> &'static str {
        match (self.bound, self.passes()) {
            (None, _) => "shown",
            (Some(_), true) => "pass",
            (Some(_), false) => "falls short",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_judged_by_their_measure_and_nothing_that_is_no_number_passes() {
        let near = Quantity::relative("a", "m", 2.02, 2.0).within(0.011, "");
        assert!(near.passes() && (near.error() - 0.01).abs() < 1e-12);
        let far = Quantity::absolute("a", "m", 2.02, 2.0).within(0.011, "");
        assert_eq!(far.verdict(), "falls short");
        assert_eq!(Quantity::absolute("a", "", f64::NAN, 0.0).within(1.0, "").verdict(), "falls short");
        assert_eq!(Quantity::relative("a", "", 9.0, 1.0).verdict(), "shown");
    }
}
