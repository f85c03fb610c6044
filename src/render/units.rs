//! Numbers with units, as they are written and as people type them.

use std::f64::consts::PI;

/// Prefixes, from the largest to the smallest.
const PREFIXES: [(f64, &str); 8] =
    [(1e12, "T"), (1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n")];

/// An SI prefix that brings `size` near 1..1000: its factor and its sign.
#[must_use]
pub fn si_prefix(size: f64) -> (f64, &'static str) {
    let size = size.abs();
    if size == 0.0 || !size.is_finite() {
        return (1.0, "");
    }
    PREFIXES.into_iter().find(|(factor, _)| size >= factor * (1.0 - 1e-9)).unwrap_or((1e-9, "n"))
}

/// A value with its unit: three or four significant digits and an SI prefix, `"1.25 ms"`.
#[must_use]
pub fn with_unit(value: f64, unit: &str) -> String {
    let (factor, prefix) = si_prefix(value);
    format!("{} {prefix}{unit}", short(value / factor))
}

/// A number with about four significant digits and no trailing zeros; a true minus sign.
#[must_use]
pub fn short(value: f64) -> String {
    let size = value.abs();
    let decimals = match size {
        s if s >= 100.0 => 1,
        s if s >= 10.0 => 2,
        _ => 3,
    };
    let text = format!("{size:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    let sign = if value < 0.0 && text != "0" { "−" } else { "" };
    format!("{sign}{text}")
}

/// Longest text that is read as a value.
const LONGEST_TEXT: usize = 64;

/// What else people write, by the unit that it is turned into.
const CONVERSIONS: [(&str, &[(&str, f64)]); 9] = [
    ("m", &[("in", 0.0254), ("ft", 0.3048)]),
    ("m/s", &[("km/h", 1.0 / 3.6), ("kph", 1.0 / 3.6), ("mph", 0.447_04), ("ft/s", 0.3048)]),
    ("kg/m3", &[("g/cm3", 1e3), ("g/ml", 1e3), ("kg/l", 1e3), ("kg/dm3", 1e3), ("t/m3", 1e3)]),
    ("Pa", &[("N/m2", 1.0), ("N/mm2", 1e6), ("kN/mm2", 1e9), ("bar", 1e5), ("psi", 6_894.757)]),
    ("°", &[("deg", 1.0), ("degrees", 1.0), ("rad", 180.0 / PI)]),
    ("rad/s", &[("°/s", PI / 180.0), ("deg/s", PI / 180.0), ("rpm", PI / 30.0), ("1/s", 1.0)]),
    ("N/m", &[("N/mm", 1e3), ("N/cm", 1e2)]),
    ("1/s", &[("/s", 1.0)]),
    ("", &[("%", 1e-2)]),
];

/// Reads a value: `15e6`, `15 M`, `15 MPa`, `15 µs` or, of a speed, `15 km/h`.
///
/// What follows the number is nothing, a prefix, the unit with or without one, or a unit that people use instead. All
/// else is refused, and not taken for a prefix with something behind it.
#[must_use]
pub fn parse_with_unit(text: &str, unit: &str) -> Option<f64> {
    let text = text.trim().replace('−', "-").replace(',', ".");
    if text.len() > LONGEST_TEXT {
        return None;
    }
    let is_of_number = |c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | 'e' | 'E');
    let most = text.find(|c| !is_of_number(c)).unwrap_or(text.len());
    // Of `5 e` and the like only the beginning is a number; the characters of numbers have one byte.
    let number = |end: usize| Some((text[..end].parse::<f64>().ok()?, &text[end..]));
    let (number, rest) = (1..=most).rev().find_map(number)?;
    Some(number * factor(&plain(rest), &plain(unit))?).filter(|value| value.is_finite())
}

/// What can be typed behind a number, in words: `"type a number, or one with Pa, kPa, MPa or GPa"`.
#[must_use]
pub fn what_to_type(unit: &str) -> String {
    let with = match unit {
        "" => return "type a number".to_owned(),
        "m" => "m, cm or mm",
        "m/s" => "m/s, mm/s or km/h",
        "Pa" => "Pa, kPa, MPa or GPa",
        "kg/m³" => "kg/m³ or g/cm³",
        "s" => "s, ms or µs",
        "°" => "° or rad",
        "rad/s" => "rad/s, °/s or rpm",
        "N/m" => "N/m, kN/m or N/mm",
        unit => unit,
    };
    format!("type a number, or one with {with}")
}

/// The same unit is written in several ways.
fn plain(unit: &str) -> String {
    let written = unit.chars().filter(|c| !c.is_whitespace() && *c != '^');
    written
        .map(|c| match c {
            '²' => '2',
            '³' => '3',
            'μ' => 'µ',
            c => c,
        })
        .collect()
}

/// What a number with this behind it is multiplied by.
fn factor(written: &str, unit: &str) -> Option<f64> {
    if written.is_empty() || written == unit {
        return Some(1.0);
    }
    let instead = CONVERSIONS.into_iter().filter(|(of, _)| *of == unit).flat_map(|(_, written)| written);
    if let Some((_, factor)) = instead.into_iter().find(|(name, _)| *name == written) {
        return Some(*factor);
    }
    // `20 m` in a field of m/s is metres that somebody forgot the rest of, and no thousandths.
    let is_begun = written == "m" && unit == "m/s";
    let prefix = written.strip_suffix(unit).unwrap_or(written);
    let has_unit = prefix.len() < written.len();
    let centi = [(1e-2, "c")].into_iter().filter(|_| has_unit);
    let read = PREFIXES.into_iter().chain([(1e-6, "u")]).chain(centi);
    let known = read.map(|(factor, name)| (name, factor)).find(|(name, _)| *name == prefix);
    // Kilograms and degrees take no further prefix.
    let takes = unit != "°" && !(has_unit && unit.starts_with("kg"));
    known.filter(|_| takes && !is_begun).map(|(_, factor)| factor)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn typed_values_may_have_prefix_and_unit() {
        let cases = [
            ("15e6", 15e6),
            ("15 MPa", 15e6),
            ("15M", 15e6),
            ("2,5 GPa", 2.5e9),
            ("200 kPa", 200e3),
            ("12 Pa", 12.0),
            ("5 N/mm²", 5e6),
            ("0", 0.0),
        ];
        for (text, value) in cases {
            assert_eq!(parse_with_unit(text, "Pa"), Some(value), "{text}");
        }
        assert_eq!(parse_with_unit("3 m", "m"), Some(3.0));
        assert_eq!(parse_with_unit("3 mm", "m"), Some(3e-3));
        assert_eq!(parse_with_unit("0.3", ""), Some(0.3));
        for text in ["", "Pa", "x", "1 2", "inf", "1e", "1 mpa", "1 MM", "1 MPa x", "nan", "é1", "1é"] {
            assert_eq!(parse_with_unit(text, "Pa"), None, "{text}");
        }
    }

    /// `36 km/h` was 36 thousand, and `10 mph` ten thousandths.
    #[test]
    fn units_that_people_use_instead_are_turned_or_refused() {
        let cases = [
            ("36 km/h", "m/s", 10.0),
            ("20 cm/s", "m/s", 0.2),
            ("5 km/s", "m/s", 5e3),
            ("10 mph", "m/s", 4.4704),
            ("10 cm", "m", 0.1),
            ("1 in", "m", 0.0254),
            ("7.8 g/cm3", "kg/m³", 7800.0),
            ("7.8 g/cm³", "kg/m³", 7800.0),
            ("2500 kg/m3", "kg/m³", 2500.0),
            ("30 deg", "°", 30.0),
            ("−30°", "°", -30.0),
            ("60 rpm", "rad/s", 2.0 * PI),
            ("0.5 1/s", "1/s", 0.5),
            ("30 μs", "s", 3e-5),
            ("10 %", "", 0.1),
        ];
        for (text, unit, value) in cases {
            let read = parse_with_unit(text, unit).unwrap_or(f64::NAN);
            assert!((read - value).abs() <= 1e-12 * value.abs(), "{text}: {read}");
        }
        for (text, unit) in [
            ("10 ft", "m/s"),
            ("20 m", "m/s"),
            ("10 m/h", "m/s"),
            ("10 %", "m"),
            ("5 kg", "m"),
            ("7.8 kg", "kg/m³"),
            ("7.8 kkg/m³", "kg/m³"),
            ("5 c", "m"),
            ("5 m°", "°"),
        ] {
            assert_eq!(parse_with_unit(text, unit), None, "{text} in {unit}");
        }
    }

    #[test]
    fn what_can_be_typed_is_understood() {
        for unit in ["m", "m/s", "Pa", "kg/m³", "s", "°", "rad/s", "N/m", "1/s"] {
            let told = what_to_type(unit);
            let (_, units) = told.split_once("one with ").unwrap();
            for written in units.split(", ").flat_map(|part| part.split(" or ")) {
                assert!(parse_with_unit(&format!("1 {written}"), unit).is_some(), "{written}");
            }
        }
    }

    #[test]
    fn numbers_read_well() {
        assert_eq!(with_unit(0.00125, "s"), "1.25 ms");
        assert_eq!(with_unit(2.5e8, "Pa"), "250 MPa");
        assert_eq!(with_unit(0.0, "s"), "0 s");
        assert_eq!(with_unit(-3e-6, "m"), "−3 µm");
        assert_eq!(with_unit(1000.0, "m"), "1 km");
    }
}
