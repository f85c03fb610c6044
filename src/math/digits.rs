//! Round numbers: of what somebody points at or drags, only so many digits are meant.

use glam::DVec3;

/// The nearest number of so many significant digits, without any round-off behind them.
#[must_use]
pub fn to_digits(value: f64, digits: u32) -> f64 {
    to_digits_of(value, value, digits)
}

/// The nearest number that is known as well as one of this `size` with so many significant digits.
#[must_use]
pub fn to_digits_of(value: f64, size: f64, digits: u32) -> f64 {
    let size = size.abs();
    if !(value.is_finite() && size.is_normal()) {
        return value;
    }
    let decimals = f64::from(digits) - 1.0 - size.log10().floor();
    // Reading decimals gives the number that they stand for, which multiplying and dividing does not.
    let rounded = if decimals >= 0.0 {
        format!("{value:.0$}", decimals as usize).parse().unwrap_or(value)
    } else {
        let unit = 10f64.powf(-decimals);
        (value / unit).round() * unit
    };
    // No negative zero.
    if rounded.is_finite() { rounded + 0.0 } else { value }
}

/// The same of each component.
#[must_use]
pub fn vector_to_digits_of(vector: DVec3, size: f64, digits: u32) -> DVec3 {
    DVec3::from(vector.to_array().map(|part| to_digits_of(part, size, digits)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_numbers_have_no_more_digits_than_are_meant() {
        let told = |value: f64, digits| format!("{:?}", to_digits(value, digits));
        assert_eq!([told(0.1 + 0.2, 4), told(123_456.789, 4)], ["0.3", "123500.0"]);
        assert_eq!(
            [told(-0.001_234_56, 4), told(0.0, 4), told(6.0 / 7e9, 3)],
            ["-0.001235", "0.0", "8.57e-10"]
        );
        assert!(to_digits(f64::MAX, 3).is_finite());
        assert!(to_digits(f64::NAN, 4).is_nan());
        let place_m = vector_to_digits_of(DVec3::new(1.0 / 3.0, -1e-9, 12.000_001), 0.3, 4);
        assert_eq!(format!("{:?}", place_m.to_array()), "[0.3333, 0.0, 12.0]");
    }
}
