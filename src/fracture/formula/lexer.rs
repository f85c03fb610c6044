//! The words of a formula.

use super::{FormulaError, FormulaProblem, error_at};

/// A word.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Token<'a> {
    Number(f64),
    Name(&'a str),
    /// One of `+ - * / ^ ( ) ,`.
    Sign(char),
    End,
}

/// A word and the byte it starts at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Word<'a> {
    pub token: Token<'a>,
    pub at: u32,
}

/// Cuts a formula into words; the last one is the end.
pub(super) fn words(text: &str) -> Result<Vec<Word<'_>>, FormulaError> {
    let mut words = Vec::new();
    let mut at = 0;
    while let Some(first) = text[at..].chars().next() {
        let rest = &text[at..];
        let (token, length) = match first {
            c if c.is_whitespace() => {
                at += c.len_utf8();
                continue;
            }
            c if c.is_ascii_digit() || c == '.' => {
                let length = number_length(rest);
                (Token::Number(number(text, at, length)?), length)
            }
            c if is_word(c) => {
                let length = rest.find(|c| !is_word(c)).unwrap_or(rest.len());
                (Token::Name(&rest[..length]), length)
            }
            c if "+-*/^(),".contains(c) => (Token::Sign(c), 1),
            c => {
                let expected = "a number, a name or one of + - * / ^ ( )";
                let problem = FormulaProblem::Unexpected { found: c.to_string(), expected };
                return Err(error_at(text, position(at), problem));
            }
        };
        words.push(Word { token, at: position(at) });
        at += length;
    }
    words.push(Word { token: Token::End, at: position(at) });
    Ok(words)
}

fn position(at: usize) -> u32 {
    u32::try_from(at).unwrap_or(u32::MAX)
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Length of digits, point and exponent, and of anything glued to them that makes them wrong.
fn number_length(rest: &str) -> usize {
    let mut before = ' ';
    for (index, c) in rest.char_indices() {
        let is_exponent_sign = matches!(c, '+' | '-') && matches!(before, 'e' | 'E');
        if !(is_word(c) || c == '.' || is_exponent_sign) {
            return index;
        }
        before = c;
    }
    rest.len()
}

fn number(text: &str, at: usize, length: usize) -> Result<f64, FormulaError> {
    let word = &text[at..at + length];
    match word.replace('_', "").parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(error_at(text, position(at), FormulaProblem::Number(word.to_owned()))),
    }
}
