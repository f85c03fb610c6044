//! A compiled formula: a list of operations on a stack of numbers.

/// Numbers a formula may hold at once while it is evaluated.
pub(super) const STACK: usize = 32;

/// Names of the functions of one argument, then of two.
pub(super) const FUNCTION_NAMES: [&str; 13] =
    ["sqrt", "cbrt", "abs", "exp", "ln", "sin", "cos", "tan", "asin", "acos", "atan", "min", "max"];

/// What can go wrong while evaluating.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Fault {
    /// `x / 0`.
    #[error("this divides by zero")]
    DivisionByZero,
    /// Root of a negative number, logarithm of none, arcsine beyond 1, power without a value.
    #[error("this has no value")]
    NoValue,
    /// Infinite, or built from numbers that are not finite.
    #[error("this is not a finite number")]
    NotFinite,
}

/// Operation on the top of the stack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Op {
    Constant(f64),
    /// Index into the variables s1, s2, s3, I1, J2, J3.
    Variable(u8),
    Negate,
    Unary(Unary),
    Binary(Binary),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unary {
    Sqrt,
    Cbrt,
    Abs,
    Exp,
    Ln,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Min,
    Max,
}

/// A function by its name.
pub(super) fn function(name: &str) -> Option<Op> {
    Some(match name {
        "sqrt" => Op::Unary(Unary::Sqrt),
        "cbrt" => Op::Unary(Unary::Cbrt),
        "abs" => Op::Unary(Unary::Abs),
        "exp" => Op::Unary(Unary::Exp),
        "ln" => Op::Unary(Unary::Ln),
        "sin" => Op::Unary(Unary::Sin),
        "cos" => Op::Unary(Unary::Cos),
        "tan" => Op::Unary(Unary::Tan),
        "asin" => Op::Unary(Unary::Asin),
        "acos" => Op::Unary(Unary::Acos),
        "atan" => Op::Unary(Unary::Atan),
        "min" => Op::Binary(Binary::Min),
        "max" => Op::Binary(Binary::Max),
        _ => return None,
    })
}

impl Unary {
    fn of(self, x: f64) -> Result<f64, Fault> {
        let value = match self {
            Self::Sqrt => x.sqrt(),
            Self::Cbrt => x.cbrt(),
            Self::Abs => x.abs(),
            Self::Exp => x.exp(),
            Self::Ln if x == 0.0 => f64::NAN,
            Self::Ln => x.ln(),
            Self::Sin => x.sin(),
            Self::Cos => x.cos(),
            Self::Tan => x.tan(),
            Self::Asin => x.asin(),
            Self::Acos => x.acos(),
            Self::Atan => x.atan(),
        };
        sound(value)
    }
}

impl Binary {
    fn of(self, x: f64, y: f64) -> Result<f64, Fault> {
        let value = match self {
            Self::Add => x + y,
            Self::Subtract => x - y,
            Self::Multiply => x * y,
            Self::Divide if y == 0.0 => return Err(Fault::DivisionByZero),
            Self::Divide => x / y,
            Self::Power if x == 0.0 && y < 0.0 => return Err(Fault::DivisionByZero),
            Self::Power if y == 2.0 => x * x,
            Self::Power => x.powf(y),
            Self::Min => x.min(y),
            Self::Max => x.max(y),
        };
        sound(value)
    }
}

fn sound(value: f64) -> Result<f64, Fault> {
    match value {
        _ if value.is_finite() => Ok(value),
        _ if value.is_nan() => Err(Fault::NoValue),
        _ => Err(Fault::NotFinite),
    }
}

/// The operations, and the byte of the text each comes from.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Program {
    ops: Vec<(Op, u32)>,
}

impl Program {
    /// Evaluates; a fault comes with the byte of the text it happens at.
    pub(super) fn run(&self, variables: &[f64; 6]) -> Result<f64, (u32, Fault)> {
        if let Some(bad) = variables.iter().find(|x| !x.is_finite()) {
            debug_assert!(!bad.is_finite());
            return Err((0, Fault::NotFinite));
        }
        let mut stack = [0.0; STACK];
        let mut top = 0;
        for &(op, at) in &self.ops {
            let here = |fault| (at, fault);
            match op {
                Op::Constant(value) => push(&mut stack, &mut top, value),
                Op::Variable(index) => push(&mut stack, &mut top, variables[index as usize]),
                Op::Negate => stack[top - 1] = -stack[top - 1],
                Op::Unary(f) => stack[top - 1] = f.of(stack[top - 1]).map_err(here)?,
                Op::Binary(f) => {
                    top -= 1;
                    stack[top - 1] = f.of(stack[top - 1], stack[top]).map_err(here)?;
                }
            }
        }
        Ok(stack[0])
    }

    /// Appends an operation; operations on constants are done at once.
    pub(super) fn emit(&mut self, op: Op, at: u32) -> Result<(), (u32, Fault)> {
        let folded = match (op, self.ops.as_slice()) {
            (Op::Negate, [.., (Op::Constant(x), _)]) => Some((1, Ok(-x))),
            (Op::Unary(f), [.., (Op::Constant(x), _)]) => Some((1, f.of(*x))),
            (Op::Binary(f), [.., (Op::Constant(x), _), (Op::Constant(y), _)]) => Some((2, f.of(*x, *y))),
            // Whatever stands before it.
            (Op::Binary(Binary::Divide), [.., (Op::Constant(0.0), _)]) => {
                return Err((at, Fault::DivisionByZero));
            }
            _ => None,
        };
        match folded {
            Some((used, value)) => {
                let value = value.map_err(|fault| (at, fault))?;
                self.ops.truncate(self.ops.len() - used);
                self.ops.push((Op::Constant(value), at));
            }
            None => self.ops.push((op, at)),
        }
        Ok(())
    }

    /// Numbers on the stack at its fullest.
    pub(super) fn stack_needed(&self) -> usize {
        let (mut height, mut most) = (0_usize, 0);
        for (op, _) in &self.ops {
            match op {
                Op::Constant(_) | Op::Variable(_) => height += 1,
                Op::Binary(_) => height -= 1,
                Op::Negate | Op::Unary(_) => {}
            }
            most = most.max(height);
        }
        most
    }
}

fn push(stack: &mut [f64; STACK], top: &mut usize, value: f64) {
    stack[*top] = value;
    *top += 1;
}
