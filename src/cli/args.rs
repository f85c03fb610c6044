//! Arguments that several subcommands share, and how values are read.

use super::failure::Failure;
use crate::frame::{ColorBy, UnknownColorBy};
use crate::scene::nearest;
use clap::Args;

/// Options that every subcommand has.
#[derive(Clone, Debug, Default, Args)]
pub struct CommonArgs {
    /// Override a value of the scene by its path, e.g. materials.steel.density=7800; repeatable
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse_override)]
    #[arg(help_heading = "Everywhere")]
    pub overrides: Vec<String>,
    /// Threads to use, all by default; results do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    #[arg(help_heading = "Everywhere")]
    pub threads: Option<u16>,
    /// Say nothing but errors, the results asked for, and what came to nothing
    #[arg(long, short, help_heading = "Everywhere")]
    pub quiet: bool,
}

/// The arguments of a subcommand and the common ones.
///
/// clap's global arguments would be shorter, but they lose the overrides before the subcommand
/// when there are others after it.
#[derive(Debug, Args)]
pub struct WithCommon<A: Args> {
    /// Arguments of the subcommand.
    #[command(flatten)]
    pub args: A,
    /// Common options given after the subcommand.
    #[command(flatten)]
    pub common: CommonArgs,
}

/// Stack of each thread: commands run on them, and a system's first thread has as much.
const STACK_BYTES: usize = 8 << 20;

/// For a subcommand without arguments of its own.
#[derive(Debug, Default, Args)]
pub struct NoArgs {}

impl CommonArgs {
    /// These options and those given later on the command line.
    pub fn followed_by(mut self, later: &Self) -> Self {
        self.overrides.extend_from_slice(&later.overrides);
        Self {
            overrides: self.overrides,
            threads: later.threads.or(self.threads),
            quiet: self.quiet || later.quiet,
        }
    }

    /// Starts the thread pool with the number of threads asked for.
    ///
    /// # Errors
    /// [`Failure::Run`] when the system refuses the threads.
    pub fn start_threads(&self) -> Result<(), Failure> {
        rayon::ThreadPoolBuilder::new()
            .num_threads(usize::from(self.threads.unwrap_or(0)))
            .stack_size(STACK_BYTES)
            .build_global()
            .map_err(|error| Failure::Run(format!("cannot start the threads: {error}; try --threads 1")))
    }
}

/// Checks that an override looks like `key=value`; whether the key exists, the scene decides.
fn parse_override(text: &str) -> Result<String, String> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() && !value.trim().is_empty() => Ok(text.to_owned()),
        _ => Err("expected KEY=VALUE, e.g. contact.friction=0.5".to_owned()),
    }
}

/// Splits a number from its unit: the number's text, and what `units` says of the first of them that the text ends in, or
/// 1 without a unit.
pub fn split_unit<'a>(text: &'a str, units: &[(&str, f64)]) -> (&'a str, f64) {
    let trimmed = text.trim();
    let with_unit = |(unit, factor): &(&str, f64)| Some((trimmed.strip_suffix(unit)?, *factor));
    let (number, factor) = units.iter().find_map(with_unit).unwrap_or((trimmed, 1.0));
    (number.trim_end(), factor)
}

/// Reads a time of zero or more: seconds, or a number with `s`, `ms`, `us` or `ns`.
///
/// # Errors
/// What is wrong and what is expected, for clap to print.
pub fn parse_time(text: &str) -> Result<f64, String> {
    const UNITS: [(&str, f64); 5] = [("ms", 1e3), ("us", 1e6), ("µs", 1e6), ("ns", 1e9), ("s", 1.0)];
    let (number, per_second) = split_unit(text, &UNITS);
    match number.parse::<f64>() {
        // Dividing by a power of ten is exact where multiplying by its inverse is not.
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value / per_second),
        Ok(_) => Err("a time must be finite and not negative".to_owned()),
        Err(_) => Err("expected a time in seconds, e.g. 0.5, 10ms or 250us".to_owned()),
    }
}

/// As [`parse_time`], but zero is refused.
///
/// # Errors
/// What is wrong and what is expected, for clap to print.
pub fn parse_duration(text: &str) -> Result<f64, String> {
    match parse_time(text)? {
        0.0 => Err("must be longer than zero".to_owned()),
        time_s => Ok(time_s),
    }
}

/// Reads a factor above zero.
///
/// # Errors
/// What is wrong and what is expected, for clap to print.
pub fn parse_factor(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err("expected a number above zero".to_owned()),
    }
}

/// Reads what surfaces are coloured by.
///
/// # Errors
/// The choices, and the nearest of them, for clap to print.
pub fn parse_color_by(text: &str) -> Result<ColorBy, String> {
    text.parse().map_err(|error: UnknownColorBy| match nearest(text, ColorBy::ALL.map(ColorBy::name)) {
        Some(name) => format!("did you mean `{name}`? {error}"),
        None => error.to_string(),
    })
}

/// Width and height of a picture in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
}

/// Reads a picture size such as `960x540`.
///
/// # Errors
/// What is wrong and what is expected, for clap to print.
pub fn parse_size(text: &str) -> Result<Size, String> {
    // What every GPU draws; smaller pictures show nothing.
    const RANGE: std::ops::RangeInclusive<u32> = 16..=8192;
    let parse = || {
        let (width, height) = text.trim().split_once(['x', 'X'])?;
        Some(Size { width: width.parse().ok()?, height: height.parse().ok()? })
    };
    let size = parse().ok_or("expected WIDTHxHEIGHT in pixels, e.g. 960x540")?;
    if RANGE.contains(&size.width) && RANGE.contains(&size.height) {
        Ok(size)
    } else {
        Err("width and height must lie between 16 and 8192 pixels".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read_exactly_with_their_units() {
        let cases = [
            ("0.5", 0.5),
            ("10ms", 0.01),
            ("250us", 250e-6),
            ("250 µs", 250e-6),
            ("3ns", 3e-9),
            ("2s", 2.0),
            ("1e-4", 1e-4),
            ("0", 0.0),
        ];
        for (text, seconds) in cases {
            assert_eq!(parse_time(text), Ok(seconds), "{text}");
        }
    }

    #[test]
    fn what_is_no_time_is_refused() {
        for text in ["", "ms", "-1", "nan", "inf", "1h", "1 2", "s"] {
            assert!(parse_time(text).is_err(), "{text}");
        }
        assert!(parse_duration("0ms").is_err());
    }

    #[test]
    fn slips_in_fields_find_the_field() {
        assert_eq!(parse_color_by("von_mises"), Ok(ColorBy::VonMises));
        for (text, field) in [("vonmises", "von-mises"), ("sped", "speed"), ("failure", "failure-index")] {
            let told = parse_color_by(text).unwrap_err();
            assert!(told.starts_with(&format!("did you mean `{field}`? cannot")), "{told}");
        }
        assert!(
            parse_color_by("beauty").unwrap_err().starts_with("cannot colour by 'beauty'; choose one of")
        );
    }

    #[test]
    fn sizes_are_read_and_bounded() {
        let size = parse_size("960x540");
        assert_eq!(size, Ok(Size { width: 960, height: 540 }));
        for text in ["960", "x", "960x", "0x10", "960x540x3", "-1x20", "9000x20"] {
            assert!(parse_size(text).is_err(), "{text}");
        }
    }

    #[test]
    fn an_override_needs_a_key_and_a_value() {
        assert!(parse_override("a.b=1").is_ok());
        assert!(parse_override("a.b=x=y").is_ok());
        for text in ["a.b", "=1", "a=", " =1"] {
            assert!(parse_override(text).is_err(), "{text}");
        }
    }
}
