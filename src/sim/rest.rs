//! Coming to rest: return to free travel, static contact, sleep (METHOD 3 and 4.3).

use super::body::{Body, Regime};
use super::broad::{NearPair, centre_distance_m};
use crate::contact::Constraint;
use crate::contact::constraint::Feature;
use glam::DVec3;

/// Consecutive checks that must find nothing changing.
const QUIET_CHECKS: u32 = 3;
/// Speed below which a body may count as resting, as a share of `sqrt(g r)`.
const REST_SPEED_SHARE: f64 = 2e-3;
/// Change of penetration and distance (over the local size) and of the contact parameters between checks,
/// and change of that change, below which they count as vanished.
const STILL: f64 = 1e-3;
/// Time between checks in crossings of the body by a wave.
const CROSSINGS: f64 = 4.0;
/// Steps without contact before a body may travel freely.
const STEPS_WITHOUT_TOUCH: u64 = 12;

/// What is remembered of one contact pair at a check.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PairRecord {
    key: ([u32; 2], Feature),
    /// Penetration over size, two contact parameters, distance of the bodies' centres over size.
    values: [f64; 4],
}

/// Follows one body towards rest.
#[derive(Clone, Debug, Default)]
pub(super) struct RestTracker {
    next_check_s: f64,
    quiet_checks: u32,
    /// Pairs at the last two checks, newest last.
    history: [Vec<PairRecord>; 2],
    pub last_touch_step: u64,
}

impl RestTracker {
    /// Starts anew, after something acted on the body.
    pub fn disturb(&mut self) {
        self.quiet_checks = 0;
        self.history = Default::default();
    }

    pub fn is_quiet(&self) -> bool {
        self.quiet_checks >= QUIET_CHECKS
    }

    pub fn is_due(&self, time_s: f64) -> bool {
        time_s >= self.next_check_s
    }

    /// Looks whether the body rests: slow, and its contacts unchanged in value and trend.
    pub fn check(&mut self, index: usize, world: &RestView) {
        let body = &world.bodies[index];
        self.next_check_s = world.time_s + CROSSINGS * body.crossing_s();
        let speed_m_s = REST_SPEED_SHARE * (world.gravity_m_s2 * body.radius_m).sqrt();
        let limit_j = 0.5 * body.reference.mass_kg * speed_m_s * speed_m_s;
        let now = records(index, world);
        let is_still = unchanged(&self.history, &now) && body.half_step_kinetic_j(world.step_s) <= limit_j;
        self.quiet_checks = if is_still { self.quiet_checks + 1 } else { 0 };
        self.history.swap(0, 1);
        self.history[1] = now;
    }
}

/// What rest detection sees.
pub(super) struct RestView<'a> {
    pub bodies: &'a [Body],
    pub constraints: &'a [Constraint],
    pub time_s: f64,
    /// Length of the last step, s.
    pub step_s: f64,
    pub gravity_m_s2: f64,
}

fn records(index: usize, world: &RestView) -> Vec<PairRecord> {
    let pressing = world
        .constraints
        .iter()
        .filter(|c| c.impulse_n_s != DVec3::ZERO && c.bodies.contains(&(index as u32)));
    let mut found: Vec<PairRecord> = pressing
        .map(|c| {
            let [a, b] = c.bodies.map(|b| &world.bodies[b as usize]);
            let distance = centre_distance_m(a, b) / c.size_m;
            PairRecord {
                key: (c.bodies, c.feature),
                values: [c.gap_m / c.size_m, c.weights[2], c.weights[3], distance],
            }
        })
        .collect();
    found.sort_by_key(|r| r.key);
    found
}

/// Whether first and second backward differences vanish for every pair that all three checks know.
fn unchanged(history: &[Vec<PairRecord>; 2], now: &[PairRecord]) -> bool {
    let at = |records: &[PairRecord], key| {
        records.binary_search_by(|r| r.key.cmp(&key)).ok().map(|i| records[i].values)
    };
    now.iter().all(|record| {
        let (Some(one), Some(two)) = (at(&history[1], record.key), at(&history[0], record.key)) else {
            // Redundant pairs take turns in carrying the load: those that come and go say nothing.
            return true;
        };
        (0..4).all(|k| {
            let first = record.values[k] - one[k];
            let second = first - (one[k] - two[k]);
            first.abs() <= STILL && second.abs() <= STILL
        })
    })
}

/// Whether an elastic body touches nothing and has stopped vibrating; books what is dropped and lets it
/// travel freely if so.
pub(super) fn try_free_travel(
    body: &mut Body,
    is_near_mover: bool,
    steps_since_touch: u64,
    tolerance: f64,
) -> bool {
    if !body.can_travel_freely() {
        return false;
    }
    let vibration_j = body.vibration_j();
    body.vibration_reference_j = body.vibration_reference_j.max(vibration_j);
    // Round-off of the rigid part's energy must not count as vibration.
    let floor_j = 1e-12 * body.kinetic_j();
    let is_calm = vibration_j <= tolerance * body.vibration_reference_j + floor_j;
    if !is_calm || is_near_mover || steps_since_touch < STEPS_WITHOUT_TOUCH {
        return false;
    }
    let motion = body.rigid_part();
    body.ledger.dropped_j += vibration_j;
    body.take_rigid_state(&motion);
    body.regime = Regime::Free(motion);
    body.vibration_reference_j = 0.0;
    true
}

/// Whether any near pair links the body to another one that moves by its own dynamics.
pub(super) fn is_near_mover(index: usize, bodies: &[Body], pairs: &[NearPair]) -> bool {
    pairs.iter().any(|p| {
        let [a, b] = p.bodies;
        a != b && p.bodies.contains(&index) && {
            let other = if a == index { b } else { a };
            bodies[other].regime != Regime::Fixed
        }
    })
}

/// Sends a body to sleep where it is; its kinetic energy is booked as dissipated.
pub(super) fn fall_asleep(body: &mut Body) {
    body.ledger.dropped_j += body.kinetic_j();
    body.velocity_m_s.fill(DVec3::ZERO);
    body.regime = Regime::Asleep;
}
