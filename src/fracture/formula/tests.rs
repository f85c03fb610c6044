//! Tests of formulas.

use super::*;
use proptest::prelude::*;

fn value(text: &str, stress_pa: [f64; 3]) -> f64 {
    // Shifted so that the value without stress is negative, as is asked of a criterion.
    let formula = Formula::new(&format!("{text} - 1e9"), &[("k", 3.0), ("phi", 30.0)]).unwrap();
    formula.evaluate(&StressMeasures::of(DVec3::from_array(stress_pa))).unwrap() + 1e9
}

fn error(text: &str) -> (usize, String) {
    let error = Formula::new(text, &[("k", 3.0), ("zero", 0.0)]).unwrap_err();
    (error.column, error.problem.to_string())
}

#[test]
fn precedence_functions_and_names() {
    let s = [7.0, 2.0, -5.0];
    let cases = [
        ("1 + 2*s1 - 6/k", 13.0),
        ("-s1^2", -49.0),
        ("2^3^2", 512.0),
        ("2^-1 * s2", 1.0),
        ("(s1 - s3)/2/3", 2.0),
        ("s1 - s2 - s3", 10.0),
        ("--s1 + +s2", 9.0),
        ("max(min(s1, k), s3)", 3.0),
        ("sin(phi*deg)*2", 1.0),
        ("sqrt(abs(s3 - 4))", 3.0),
        ("I1", 4.0),
        ("1.5e+1 + 2.E-1*s1 + 1_0", 26.4),
        ("2*(s1)", 14.0),
    ];
    for (text, expected) in cases {
        // 1e9 was taken away and added again: six digits are left.
        assert!((value(text, s) - expected).abs() < 1e-5, "{text}");
    }
}

#[test]
fn textbook_criteria_agree_with_the_built_in_measures() {
    let mises = Formula::new("sqrt(3*J2) - Y", &[("Y", 250e6)]).unwrap();
    assert_eq!(mises.unstressed_value(), -250e6);
    let f = mises.evaluate(&StressMeasures::of(DVec3::new(0.0, 300e6, 0.0))).unwrap();
    assert!((f - 50e6).abs() < 1e-6);
    let lode = Formula::new("J3/1e3 + 2*J2^1.5/1e3 - 1", &[]).unwrap();
    assert!(lode.evaluate(&StressMeasures::of(DVec3::new(-1.0, 4.0, 2.0))).is_ok());
}

#[test]
fn what_does_not_parse_is_refused_with_its_column() {
    let cases = [
        ("", 1, "ends where a number"),
        ("s1 -", 5, "ends where a number"),
        ("s1 - * 2", 6, "`*` stands where a number"),
        ("(s1 - k", 8, "ends where an operator or `)`"),
        ("s1 - k)", 7, "`)` stands where an operator"),
        ("s1 k", 4, "`k` stands where an operator"),
        ("2 s1", 3, "`s1` stands where"),
        ("2s1 - 5", 1, "`2s1` is not a number"),
        ("1.2.3", 1, "`1.2.3` is not a number"),
        ("s1 - 1e999", 6, "not a number"),
        ("s4 - k", 1, "`s4` is not known"),
        ("s1 - K", 6, "s1, s2, s3, I1, J2, J3, pi, deg, kPa, MPa, GPa, k, zero"),
        ("root(J2) - k", 1, "no function `root`"),
        ("min(s1) - k", 7, "second argument"),
        ("sqrt(J2, k)", 8, "`,` stands where"),
        ("s1 > k", 4, "`>` stands where"),
        ("σ1 − k", 4, "`−` stands where"),
        ("s1 - sqrt", 6, "`sqrt` is not known"),
    ];
    for (text, column, part) in cases {
        let (found, message) = error(text);
        assert!(message.contains(part), "{text}: {message}");
        assert_eq!(found, column, "{text}: {message}");
    }
    let whole = Formula::new("s1 - q", &[]).unwrap_err().to_string();
    assert!(whole.starts_with("column 6 of `s1 - q`: `q` is not known"), "{whole}");
}

#[test]
fn division_by_zero_and_other_faults_are_refused_with_their_column() {
    let cases = [
        ("s1/0 - k", 3, "divides by zero"),
        ("s1/(k - 3) - k", 3, "divides by zero"),
        ("s1/zero - k", 3, "divides by zero"),
        // Only without stress, in shear, in hydrostatic tension, uniaxially:
        ("s1/s3 - k", 3, "divides by zero for the principal stresses 0.000e0, 0.000e0, 0.000e0 Pa"),
        ("1/(s1-s3-2) - k", 2, "divides by zero for"),
        ("zero^-1 - k", 5, "divides by zero"),
        ("sqrt(s1) - k", 1, "no value"),
        ("ln(s1 + 1) - k", 1, "no value"),
        ("ln(zero) - k", 1, "no value"),
        ("exp(s1*s1) - k", 1, "not a finite number"),
        ("s1 + k", 1, "without stress the formula gives 3"),
        ("s1 - zero", 1, "must be negative there"),
    ];
    for (text, column, part) in cases {
        let (found, message) = error(text);
        assert!(message.contains(part), "{text}: {message}");
        assert_eq!(found, column, "{text}: {message}");
    }
}

#[test]
fn faults_that_no_simple_state_shows_are_reported_when_they_happen() {
    let formula = Formula::new("s1 - k + 1/(s1 - 12.5)", &[("k", 3.0)]).unwrap();
    let error = formula.evaluate(&StressMeasures::of(DVec3::new(12.5, 0.0, 0.0))).unwrap_err();
    assert_eq!(error.column, 11);
    assert!(formula.evaluate(&StressMeasures::of(DVec3::NAN)).is_err());
}

#[test]
fn parameters_must_be_names_of_their_own() {
    for (name, part) in
        [("s1", "something else"), ("2k", "not a name"), ("", "not a name"), ("a b", "not a name")]
    {
        let text = Formula::new("s1 - 1", &[(name, 1.0)]).unwrap_err().to_string();
        assert!(text.contains(part), "{text}");
    }
    assert!(Formula::new("s1 - k", &[("k", 1.0), ("k", 2.0)]).is_err());
    assert!(Formula::new("s1 - k", &[("k", f64::NAN)]).is_err());
}

#[test]
fn deep_nesting_is_an_error_not_a_crash() {
    for text in ["(".repeat(100_000), "-".repeat(100_000), "2^".repeat(100_000)] {
        assert!(error(&text).1.contains("deeply"));
    }
    let right_heavy = format!("{}1{}", "s1-(".repeat(40), ")".repeat(40));
    assert!(error(&right_heavy).1.contains("deeply"));
    assert!(Formula::new(&format!("{}s1 - 5{}", "(".repeat(90), ")".repeat(90)), &[]).is_ok());
}

proptest! {
    #[test]
    fn no_text_crashes_it(text in "[s1-3IJk0-9.e+*/^(), maxqrtδ-]{0,40}") {
        if let Ok(formula) = Formula::new(&text, &[("k", 1.0)]) {
            let _ = formula.evaluate(&StressMeasures::of(DVec3::new(3.0, -2.0, 1e5)));
        }
    }
}
