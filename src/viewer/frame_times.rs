//! How long frames take: from the events to the finished picture.

use std::fmt;
use std::time::Duration;

/// Times of frames.
#[derive(Clone, Debug, Default)]
pub struct FrameTimes {
    times: Vec<Duration>,
}

impl FrameTimes {
    /// Notes one.
    pub fn note(&mut self, time: Duration) {
        self.times.push(time);
    }

    /// The time within which a share of the frames was done; zero without any.
    #[must_use]
    pub fn within(&self, share: f64) -> Duration {
        let mut sorted = self.times.clone();
        sorted.sort_unstable();
        let last = sorted.len().saturating_sub(1);
        let index = (share * last as f64).round() as usize;
        sorted.get(index.min(last)).copied().unwrap_or_default()
    }
}

/// `frames answer within 21 ms at the median, 30 ms in 95 %, 44 ms at worst`.
impl fmt::Display for FrameTimes {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ms = |share| 1e3 * self.within(share).as_secs_f64();
        let (median, most, worst) = (ms(0.5), ms(0.95), ms(1.0));
        write!(
            formatter,
            "frames answer within {median:.1} ms at the median, {most:.1} ms in 95 %, {worst:.1} ms at worst"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn median_and_worst_are_those_of_the_times() {
        let mut times = FrameTimes::default();
        assert_eq!(times.within(0.5), Duration::ZERO);
        for ms in [5, 1, 90, 3, 2] {
            times.note(Duration::from_millis(ms));
        }
        assert_eq!(times.within(0.5), Duration::from_millis(3));
        assert_eq!(times.within(1.0), Duration::from_millis(90));
        assert!(times.to_string().contains("3.0 ms at the median"));
    }
}
