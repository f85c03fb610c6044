//! Failure functions typed as a formula: `sqrt(3*J2) + a*I1 - Y`.
//!
//! The text may use the principal stresses `s1 >= s2 >= s3` and the invariants `I1, J2, J3`
//! ([`StressMeasures`], Pa and its powers), named parameters, the constants `pi`, `deg` (radians
//! in a degree), `kPa`, `MPa`, `GPa`, the operators `+ - * / ^`, parentheses, and the functions
//! `sqrt cbrt abs exp ln sin cos tan asin acos atan min max`. It fails where its value is >= 0.
//!
//! The text is compiled once; evaluating it allocates nothing. Every error names its column.

mod lexer;
mod parser;
mod program;

use super::stress::StressMeasures;
use glam::DVec3;
pub use program::Fault;
use program::Program;

/// A compiled formula.
#[derive(Clone, Debug, PartialEq)]
pub struct Formula {
    text: String,
    program: Program,
    unstressed_value: f64,
}

/// What is wrong with a formula, and where.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("column {column} of `{text}`: {problem}")]
pub struct FormulaError {
    /// The formula.
    pub text: String,
    /// Column, in characters from 1.
    pub column: usize,
    /// What is wrong there.
    pub problem: FormulaProblem,
}

/// What can be wrong with a formula.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FormulaProblem {
    /// The text ends too early.
    #[error("the formula ends where {expected} is expected")]
    Ends {
        /// What is missing.
        expected: &'static str,
    },
    /// Something else was expected.
    #[error("`{found}` stands where {expected} is expected")]
    Unexpected {
        /// What stands there.
        found: String,
        /// What is expected.
        expected: &'static str,
    },
    /// A number that cannot be read.
    #[error("`{0}` is not a number")]
    Number(String),
    /// A name that means nothing.
    #[error("`{name}` is not known; known are s1, s2, s3, I1, J2, J3, pi, deg, kPa, MPa, GPa{parameters}")]
    UnknownName {
        /// The name.
        name: String,
        /// `, a, b`: the parameters given.
        parameters: String,
    },
    /// A function that does not exist.
    #[error("there is no function `{0}`; there are {known}", known = program::FUNCTION_NAMES.join(", "))]
    UnknownFunction(String),
    /// A parameter that cannot be used.
    #[error("parameter `{name}` {reason}")]
    Parameter {
        /// Its name.
        name: String,
        /// Why not.
        reason: &'static str,
    },
    /// Too deeply nested.
    #[error("the formula is nested too deeply here")]
    TooDeep,
    /// Cannot be evaluated.
    #[error("{fault}{state}")]
    Fault {
        /// What happens.
        fault: Fault,
        /// For which stress, as the end of a sentence; empty when for any.
        state: String,
    },
    /// Fails without any load.
    #[error("without stress the formula gives {0}; it must be negative there, or everything breaks at once")]
    FailsUnstressed(f64),
}

impl Formula {
    /// Compiles a formula with the values of its named parameters.
    ///
    /// # Errors
    /// [`FormulaError`] with the column: text that does not parse, names that mean nothing, a
    /// division by zero or another fault that happens for any stress or for one of the simple
    /// states (none, uniaxial, shear, hydrostatic, biaxial), a value that is not negative without stress.
    pub fn new(text: &str, parameters: &[(&str, f64)]) -> Result<Self, FormulaError> {
        let program = parser::compile(text, parameters)?;
        let mut formula = Self { text: text.to_owned(), program, unstressed_value: f64::NAN };
        formula.unstressed_value = formula.evaluate(&StressMeasures::of(DVec3::ZERO))?;
        if formula.unstressed_value >= 0.0 {
            return Err(formula.error(0, FormulaProblem::FailsUnstressed(formula.unstressed_value)));
        }
        for state_pa in simple_states_pa() {
            formula.evaluate(&StressMeasures::of(state_pa))?;
        }
        Ok(formula)
    }

    /// The text it was compiled from.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Value without stress; negative.
    #[must_use]
    pub fn unstressed_value(&self) -> f64 {
        self.unstressed_value
    }

    /// The failure function of a state: fails from 0 on. Its unit is the formula's own.
    ///
    /// # Errors
    /// A fault (division by zero, root of a negative number) at this state, with the column.
    pub fn evaluate(&self, stress: &StressMeasures) -> Result<f64, FormulaError> {
        let [s1, s2, s3] = stress.s_pa;
        let variables = [s1, s2, s3, stress.i1_pa, stress.j2_pa2, stress.j3_pa3];
        self.program.run(&variables).map_err(|(at, fault)| {
            let state = format!(" for the principal stresses {s1:.3e}, {s2:.3e}, {s3:.3e} Pa");
            self.error(at, FormulaProblem::Fault { fault, state })
        })
    }

    fn error(&self, at: u32, problem: FormulaProblem) -> FormulaError {
        error_at(&self.text, at, problem)
    }
}

/// An error at a byte of the text.
fn error_at(text: &str, at: u32, problem: FormulaProblem) -> FormulaError {
    let column = text.char_indices().take_while(|(index, _)| *index < at as usize).count() + 1;
    FormulaError { text: text.to_owned(), column, problem }
}

/// States at which a formula must have a value, Pa.
fn simple_states_pa() -> impl Iterator<Item = DVec3> {
    let shapes = [
        DVec3::X,
        -DVec3::X,
        DVec3::new(1.0, 0.0, -1.0),
        DVec3::ONE,
        -DVec3::ONE,
        DVec3::new(1.0, 1.0, 0.0),
        DVec3::new(-1.0, -1.0, 0.0),
        DVec3::new(-1.0, -1.0, -2.0),
    ];
    [1.0, 1e6].into_iter().flat_map(move |size_pa| shapes.map(|shape| shape * size_pa))
}

#[cfg(test)]
mod tests;
