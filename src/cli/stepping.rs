//! Advancing a world to a moment, without a window: no thread, no wall clock in the way.

use super::console::seconds;
use super::failure::Failure;
use super::interrupt;
use crate::sim::{Sample, StepReport, World};

/// Why [`advance`] returned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrival {
    /// The world stands at the time asked for.
    Reached,
    /// The user wants an end.
    Interrupted,
}

/// Steps in a row that may leave time standing before the run counts as stuck.
const STANDING_STEPS: u32 = 1000;

/// Steps `world` until `target_s`, calling `after_step` after every step.
///
/// # Errors
/// [`Failure::Run`] when a step fails or time no longer moves, and whatever `after_step` returns.
pub fn advance(
    world: &mut World,
    target_s: f64,
    mut after_step: impl FnMut(&World, &StepReport) -> Result<(), Failure>,
) -> Result<Arrival, Failure> {
    let mut standing = 0;
    while !reached(world.time_s(), target_s) {
        if interrupt::requested() {
            return Ok(Arrival::Interrupted);
        }
        let before_s = world.time_s();
        let report = world.step(target_s)?;
        after_step(world, &report)?;
        standing = if world.time_s() > before_s { 0 } else { standing + 1 };
        if standing >= STANDING_STEPS {
            return Err(stuck(world));
        }
    }
    Ok(Arrival::Reached)
}

/// Whether `time_s` is `target_s` up to the rounding of many sums.
///
/// A step over what is left then would be too short for the contact forces, which divide by it.
pub fn reached(time_s: f64, target_s: f64) -> bool {
    const ROUNDING: f64 = 1e-12;
    time_s >= target_s * (1.0 - ROUNDING)
}

/// The balances now.
///
/// # Errors
/// [`Failure::Run`] when they are not finite: what follows would mean nothing.
pub fn sound_sample(world: &World) -> Result<Sample, Failure> {
    let sample = world.sample();
    let momenta = [sample.linear_momentum_kg_m_s, sample.angular_momentum_kg_m2_s];
    if sample.balance_j().is_finite() && momenta.iter().all(|momentum| momentum.is_finite()) {
        return Ok(sample);
    }
    Err(Failure::Run(format!(
        "energy or momentum is no longer finite at t = {}; the run has blown up (check velocities and \
         material numbers, or try a smaller time.cfl)",
        seconds(world.time_s())
    )))
}

fn stuck(world: &World) -> Failure {
    let time = seconds(world.time_s());
    Failure::Run(format!(
        "time stands still at t = {time}: {STANDING_STEPS} steps did not move it; bodies may \
         be wedged into each other (look at the moment in the viewer, or try a smaller time.cfl)"
    ))
}

/// The moments at which to stop: multiples of `every_s`, then the end.
///
/// Multiples, not sums, so that the thousandth moment is not off by a thousand roundings.
pub fn moments(every_s: f64, end_s: f64) -> impl Iterator<Item = f64> {
    (1_u64..)
        .map(move |index| index as f64 * every_s)
        .take_while(move |&moment_s| !reached(moment_s, end_s))
        .chain(std::iter::once(end_s))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    #[test]
    fn moments_end_at_the_end_and_only_once() {
        let all: Vec<f64> = moments(0.25, 1.0).collect();
        assert_eq!(all, [0.25, 0.5, 0.75, 1.0]);
        let uneven: Vec<f64> = moments(0.4, 1.0).collect();
        assert_eq!(uneven, [0.4, 0.8, 1.0]);
        // 3 * 0.1 is a rounding above 0.3.
        assert_eq!(moments(0.1, 0.3).count(), 3);
        assert_eq!(moments(5.0, 0.3).collect::<Vec<_>>(), [0.3]);
    }

    #[test]
    fn advancing_ends_at_the_moment_and_tells_of_each_step() {
        let mut world = World::new(Scene::load("bounce", &[]).unwrap().setup).unwrap();
        let mut time_s = 0.0;
        let arrival = advance(&mut world, 0.0105, |_, report| {
            time_s += report.step_s;
            Ok(())
        });
        assert_eq!(arrival.unwrap(), Arrival::Reached);
        assert!((time_s - 0.0105).abs() < 1e-12 && reached(world.time_s(), 0.0105));
    }
}
