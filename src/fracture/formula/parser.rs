//! Recursive descent from the words of a formula to its program.
//!
//! ```text
//! sum     = product (("+" | "-") product)*
//! product = signed (("*" | "/") signed)*
//! signed  = ("-" | "+") signed | power
//! power   = atom ("^" signed)?              -2^2 is -4, 2^3^2 is 2^9
//! atom    = number | name | name "(" sum ("," sum)* ")" | "(" sum ")"
//! ```

use super::lexer::{Token, Word, words};
use super::program::{Binary, Fault, Op, Program, STACK, function};
use super::{FormulaError, FormulaProblem, error_at};

/// Levels of nesting: keeps the recursion shallow for any text.
const MOST_LEVELS: u32 = 100;
/// Names of the variables, in the order of [`Op::Variable`].
const VARIABLES: [&str; 6] = ["s1", "s2", "s3", "I1", "J2", "J3"];
const CONSTANTS: [(&str, f64); 5] = [
    ("pi", std::f64::consts::PI),
    ("deg", std::f64::consts::PI / 180.0),
    ("kPa", 1e3),
    ("MPa", 1e6),
    ("GPa", 1e9),
];
const OPERAND: &str = "a number, a name or `(`";

/// Compiles a formula.
pub(super) fn compile(text: &str, parameters: &[(&str, f64)]) -> Result<Program, FormulaError> {
    check_parameters(text, parameters)?;
    let words = words(text)?;
    let mut parser = Parser { text, parameters, words, next: 0, levels: 0, program: Program::default() };
    parser.sum()?;
    if parser.word().token != Token::End {
        return Err(parser.unexpected("an operator or the end"));
    }
    if parser.program.stack_needed() > STACK {
        return Err(parser.error(0, FormulaProblem::TooDeep));
    }
    Ok(parser.program)
}

fn check_parameters(text: &str, parameters: &[(&str, f64)]) -> Result<(), FormulaError> {
    for (index, &(name, value)) in parameters.iter().enumerate() {
        let is_word = |c: char| c.is_alphanumeric() || c == '_';
        let is_taken = VARIABLES.contains(&name)
            || CONSTANTS.iter().any(|constant| constant.0 == name)
            || function(name).is_some();
        let reason =
            if !name.starts_with(|c: char| c.is_alphabetic() || c == '_') || !name.chars().all(is_word) {
                "is not a name: letters, digits and _, a letter first"
            } else if is_taken {
                "has a name that means something else in formulas; choose another"
            } else if parameters[..index].iter().any(|earlier| earlier.0 == name) {
                "is given twice"
            } else if !value.is_finite() {
                "is not a finite number"
            } else {
                continue;
            };
        let at = text.find(name).unwrap_or(0);
        let problem = FormulaProblem::Parameter { name: name.to_owned(), reason };
        return Err(error_at(text, u32::try_from(at).unwrap_or(0), problem));
    }
    Ok(())
}

struct Parser<'a> {
    text: &'a str,
    parameters: &'a [(&'a str, f64)],
    words: Vec<Word<'a>>,
    next: usize,
    levels: u32,
    program: Program,
}

impl<'a> Parser<'a> {
    fn word(&self) -> Word<'a> {
        self.words[self.next.min(self.words.len() - 1)]
    }

    fn error(&self, at: u32, problem: FormulaProblem) -> FormulaError {
        error_at(self.text, at, problem)
    }

    fn unexpected(&self, expected: &'static str) -> FormulaError {
        let Word { token, at } = self.word();
        let problem = match token {
            Token::End => FormulaProblem::Ends { expected },
            _ => {
                let end = self.words[self.next + 1].at;
                let found = self.text[at as usize..end as usize].trim_end().to_owned();
                FormulaProblem::Unexpected { found, expected }
            }
        };
        self.error(at, problem)
    }

    /// Takes the next word if it is one of these signs.
    fn take(&mut self, signs: &str) -> Option<(char, u32)> {
        match self.word() {
            Word { token: Token::Sign(sign), at } if signs.contains(sign) => {
                self.next += 1;
                Some((sign, at))
            }
            _ => None,
        }
    }

    fn expect(&mut self, sign: &str, expected: &'static str) -> Result<(), FormulaError> {
        match self.take(sign) {
            Some(_) => Ok(()),
            None => Err(self.unexpected(expected)),
        }
    }

    fn emit(&mut self, op: Op, at: u32) -> Result<(), FormulaError> {
        let always = |(at, fault): (u32, Fault)| {
            error_at(self.text, at, FormulaProblem::Fault { fault, state: String::new() })
        };
        self.program.emit(op, at).map_err(always)
    }

    fn sum(&mut self) -> Result<(), FormulaError> {
        self.product()?;
        while let Some((sign, at)) = self.take("+-") {
            self.product()?;
            let op = if sign == '+' { Binary::Add } else { Binary::Subtract };
            self.emit(Op::Binary(op), at)?;
        }
        Ok(())
    }

    fn product(&mut self) -> Result<(), FormulaError> {
        self.signed()?;
        while let Some((sign, at)) = self.take("*/") {
            self.signed()?;
            let op = if sign == '*' { Binary::Multiply } else { Binary::Divide };
            self.emit(Op::Binary(op), at)?;
        }
        Ok(())
    }

    /// Every nesting passes through here, so that this alone counts levels.
    fn signed(&mut self) -> Result<(), FormulaError> {
        self.levels += 1;
        if self.levels > MOST_LEVELS {
            return Err(self.error(self.word().at, FormulaProblem::TooDeep));
        }
        match self.take("+-") {
            Some((sign, at)) => {
                self.signed()?;
                if sign == '-' {
                    self.emit(Op::Negate, at)?;
                }
            }
            None => self.power()?,
        }
        self.levels -= 1;
        Ok(())
    }

    fn power(&mut self) -> Result<(), FormulaError> {
        self.atom()?;
        if let Some((_, at)) = self.take("^") {
            self.signed()?;
            self.emit(Op::Binary(Binary::Power), at)?;
        }
        Ok(())
    }

    fn atom(&mut self) -> Result<(), FormulaError> {
        let Word { token, at } = self.word();
        match token {
            Token::Number(value) => {
                self.next += 1;
                self.emit(Op::Constant(value), at)
            }
            Token::Name(name) => {
                self.next += 1;
                if self.word().token == Token::Sign('(') { self.call(name, at) } else { self.name(name, at) }
            }
            Token::Sign('(') => {
                self.next += 1;
                self.sum()?;
                self.expect(")", "an operator or `)`")
            }
            _ => Err(self.unexpected(OPERAND)),
        }
    }

    fn name(&mut self, name: &str, at: u32) -> Result<(), FormulaError> {
        let constants = CONSTANTS.iter().chain(self.parameters);
        if let Some(index) = VARIABLES.iter().position(|&variable| variable == name) {
            return self.emit(Op::Variable(index as u8), at);
        }
        if let Some(&(_, value)) = constants.into_iter().find(|constant| constant.0 == name) {
            return self.emit(Op::Constant(value), at);
        }
        let parameters = self.parameters.iter().map(|(name, _)| format!(", {name}")).collect();
        Err(self.error(at, FormulaProblem::UnknownName { name: name.to_owned(), parameters }))
    }

    fn call(&mut self, name: &str, at: u32) -> Result<(), FormulaError> {
        let Some(op) = function(name) else {
            return Err(self.error(at, FormulaProblem::UnknownFunction(name.to_owned())));
        };
        self.expect("(", "`(`")?;
        self.sum()?;
        if matches!(op, Op::Binary(_)) {
            self.expect(",", "`,` and a second argument")?;
            self.sum()?;
        }
        self.expect(")", "an operator or `)`")?;
        self.emit(op, at)
    }
}
