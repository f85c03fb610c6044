//! Numbers with their limits and their unit.

/// The limits and the unit of a number.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quantity {
    unit: &'static str,
    above: f64,
    at_least: f64,
    at_most: f64,
    below: f64,
}

impl Quantity {
    /// Any finite number.
    pub const fn any(unit: &'static str) -> Self {
        Self { unit, above: f64::NEG_INFINITY, at_least: f64::MIN, at_most: f64::MAX, below: f64::INFINITY }
    }

    /// A number that pictures, which work with single precision, can take.
    pub const fn drawable(unit: &'static str) -> Self {
        let mut quantity = Self::any(unit);
        (quantity.at_least, quantity.at_most) = (-1e38, 1e38);
        quantity
    }

    /// A number above zero.
    pub const fn positive(unit: &'static str) -> Self {
        let mut quantity = Self::any(unit);
        quantity.above = 0.0;
        quantity
    }

    /// Zero or above.
    pub const fn not_negative(unit: &'static str) -> Self {
        let mut quantity = Self::any(unit);
        quantity.at_least = 0.0;
        quantity
    }

    /// Between two limits that are themselves excluded.
    pub const fn strictly_between(low: f64, high: f64, unit: &'static str) -> Self {
        let mut quantity = Self::any(unit);
        quantity.above = low;
        quantity.below = high;
        quantity
    }

    /// The same, up to and with a largest value.
    pub const fn up_to(mut self, high: f64) -> Self {
        self.at_most = high;
        self
    }

    /// The same, below a value that is itself excluded.
    pub const fn less_than(mut self, high: f64) -> Self {
        self.below = high;
        self
    }

    /// Whether a number is within the limits.
    pub fn allows(self, number: f64) -> bool {
        number.is_finite()
            && number > self.above
            && number >= self.at_least
            && number <= self.at_most
            && number < self.below
    }

    /// `above 0 and at most 1`.
    pub fn limits_in_words(self) -> String {
        let mut limits = Vec::new();
        if self.above.is_finite() {
            limits.push(format!("above {}", self.above));
        }
        if self.at_least > f64::MIN {
            limits.push(format!("at least {}", in_short(self.at_least)));
        }
        if self.at_most < f64::MAX {
            limits.push(format!("at most {}", in_short(self.at_most)));
        }
        if self.below.is_finite() {
            limits.push(format!("below {}", self.below));
        }
        if limits.is_empty() {
            limits.push("a finite number".to_owned());
        }
        limits.join(" and ")
    }

    /// ` (kg/m3)`, or nothing.
    pub fn unit_in_words(self) -> String {
        if self.unit.is_empty() { String::new() } else { format!(" ({})", self.unit) }
    }

    /// A number that passes, to go on with after a problem.
    pub fn stand_in(self) -> f64 {
        [1.0, 0.0, 0.1, self.at_least].into_iter().find(|&number| self.allows(number)).unwrap_or(0.25)
    }
}

/// Without forty zeros.
fn in_short(number: f64) -> String {
    if number.abs() < 1e9 { number.to_string() } else { format!("{number:e}") }
}
