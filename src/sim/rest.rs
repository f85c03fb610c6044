//! Coming to rest: return to free travel, static contact, sleep (METHOD 3 and 4.3).
//!
//! METHOD 4.3 calls a contact static when penetration, contact parameters and the distance of the bodies do not
//! change over three looks. Pairs of features take turns in carrying a load, so that single pairs never come to
//! rest; their resultants do. What is followed here is, per body and averaged over a window of time: where it is and how it
//! is turned, and the force and its centre from each body that presses on it. Windows are measured by the time
//! in which gravity moves a body by its own size: whatever creeps, slides, rolls or tips over is seen to
//! move within a few of them, while vibration averages out and is bounded by its energy.

use super::body::{Body, Regime};
use super::broad::NearPair;
use super::{BodyMotion, PrescribedMotion};
use crate::contact::Constraint;
use crate::math::rotation_from_vector;
use glam::{DQuat, DVec3};

/// Windows in a row, after the first, that must find nothing changing.
const QUIET_WINDOWS: u32 = 3;
/// Length of a window over `sqrt(r / g)`.
const WINDOW_SHARE: f64 = 0.4;
/// Looks at the body in a window, at least.
const LOOKS: u32 = 12;
/// Largest speed of vibration (of the kinetic energy) of a resting body, as a share of `sqrt(g r)`.
const REST_SPEED_SHARE: f64 = 5e-3;
/// Way and turn since the first quiet window, over the body's radius and in radians, that count as none.
const STILL: f64 = 3e-4;
/// Change of a resultant force from window to window, as a share of all that press on the body, that counts
/// as none; and of its centre, as a share of the body's radius.
const STEADY_FORCE: f64 = 0.05;
/// See [`STEADY_FORCE`].
const STEADY_CENTRE: f64 = 0.02;
/// Time between checks for free travel in crossings of the body by a wave.
const CROSSINGS: f64 = 4.0;
/// Steps without contact before a body may travel freely.
const STEPS_WITHOUT_TOUCH: u64 = 12;

/// What one other body does to the body in a window.
#[derive(Clone, Copy, Debug)]
struct Pressure {
    other: u32,
    impulse_n_s: DVec3,
    /// Sum of the lengths of the impulses, N s, alone and times their places, N s m.
    length_n_s: f64,
    moment_n_s_m: DVec3,
}

impl Pressure {
    fn centre_m(&self) -> DVec3 {
        self.moment_n_s_m / self.length_n_s.max(f64::MIN_POSITIVE)
    }
}

/// A window of time.
#[derive(Clone, Debug, Default)]
struct Window {
    start_s: f64,
    looks: u32,
    centre_sum_m: DVec3,
    /// Sum of the rotation vectors from the tracker's orientation, rad.
    turn_sum_rad: DVec3,
    /// Largest kinetic energy seen, J.
    kinetic_j: f64,
    /// By the other body, ascending.
    pressures: Vec<Pressure>,
}

impl Window {
    fn from(start_s: f64) -> Self {
        Self { start_s, ..Self::default() }
    }

    /// Mean place, m, and turn, rad.
    fn pose(&self) -> (DVec3, DVec3) {
        let looks = f64::from(self.looks.max(1));
        (self.centre_sum_m / looks, self.turn_sum_rad / looks)
    }

    /// Whether the same bodies press as in `before`, as hard and in the same place.
    fn presses_as(&self, before: &Self, durations_s: [f64; 2], radius_m: f64) -> bool {
        let [now_s, before_s] = durations_s;
        let total_n = self.pressures.iter().map(|p| p.length_n_s).sum::<f64>() / now_s;
        let zero =
            |other| Pressure { other, impulse_n_s: DVec3::ZERO, length_n_s: 0.0, moment_n_s_m: DVec3::ZERO };
        let of = |window: &Self, other| {
            window.pressures.iter().find(|p| p.other == other).copied().unwrap_or(zero(other))
        };
        self.pressures.iter().chain(&before.pressures).all(|p| {
            let (a, b) = (of(self, p.other), of(before, p.other));
            let change_n = (a.impulse_n_s / now_s - b.impulse_n_s / before_s).length();
            let lever_m = (a.centre_m() - b.centre_m()).length();
            let is_slight = a.length_n_s / now_s <= STEADY_FORCE * total_n;
            change_n <= STEADY_FORCE * total_n && (is_slight || lever_m <= STEADY_CENTRE * radius_m)
        })
    }
}

/// Follows one body towards rest.
#[derive(Clone, Debug, Default)]
pub(super) struct RestTracker {
    next_check_s: f64,
    next_look_s: f64,
    quiet_windows: u32,
    window: Window,
    last: Option<(Window, f64)>,
    /// Centre and orientation of the first of the quiet windows; turns count from there.
    anchor: Option<DVec3>,
    orientation: DQuat,
    pub last_touch_step: u64,
}

impl RestTracker {
    /// Starts anew, after something acted on the body.
    pub fn disturb(&mut self, time_s: f64) {
        *self =
            Self { window: Window::from(time_s), last_touch_step: self.last_touch_step, ..Self::default() };
    }

    pub fn is_quiet(&self) -> bool {
        self.quiet_windows >= QUIET_WINDOWS
    }

    pub fn is_due(&self, time_s: f64) -> bool {
        time_s >= self.next_check_s
    }

    /// Adds what a pair of features did in a step to the present window.
    pub fn record(&mut self, other: u32, impulse_n_s: DVec3, place_m: DVec3) {
        let pressures = &mut self.window.pressures;
        let at = pressures.partition_point(|p| p.other < other);
        if pressures.get(at).is_none_or(|p| p.other != other) {
            let (impulse_n_s, moment_n_s_m) = (DVec3::ZERO, DVec3::ZERO);
            pressures.insert(at, Pressure { other, impulse_n_s, length_n_s: 0.0, moment_n_s_m });
        }
        let length_n_s = impulse_n_s.length();
        pressures[at].impulse_n_s += impulse_n_s;
        pressures[at].length_n_s += length_n_s;
        pressures[at].moment_n_s_m += place_m * length_n_s;
    }

    /// Looks at the body, and at the end of a window whether it rests.
    pub fn check(&mut self, index: usize, world: &RestView) {
        let body = &world.bodies[index];
        self.next_check_s = world.time_s + CROSSINGS * body.crossing_s();
        if world.time_s < self.next_look_s {
            return;
        }
        let window_s = world.window_s(body);
        self.next_look_s = world.time_s + window_s / f64::from(LOOKS);
        self.look(body, world.step_s);
        if self.window.looks >= LOOKS && world.time_s - self.window.start_s >= window_s {
            self.end_window(index, world);
        }
    }

    fn look(&mut self, body: &Body, step_s: f64) {
        let weights = body.mass_kg.iter().zip(&body.position_m);
        let centre_m = weights.map(|(m, x)| *x * *m).sum::<DVec3>() / body.reference.mass_kg;
        let orientation = body.best_fit_orientation(centre_m);
        if self.anchor.is_none() && self.window.looks == 0 {
            self.orientation = orientation;
        }
        let window = &mut self.window;
        window.looks += 1;
        window.centre_sum_m += centre_m;
        window.turn_sum_rad += (orientation * self.orientation.inverse()).to_scaled_axis();
        window.kinetic_j = window.kinetic_j.max(body.half_step_kinetic_j(step_s));
    }

    fn end_window(&mut self, index: usize, world: &RestView) {
        let body = &world.bodies[index];
        let duration_s = (world.time_s - self.window.start_s).max(f64::MIN_POSITIVE);
        let pose = self.window.pose();
        let is_still = self.anchor.is_some_and(|centre_m| {
            (pose.0 - centre_m).length() <= STILL * body.radius_m && pose.1.length() <= STILL
        });
        let is_steady = self
            .last
            .as_ref()
            .is_some_and(|(last, last_s)| self.window.presses_as(last, [duration_s, *last_s], body.radius_m));
        let is_calm = self.window.kinetic_j <= world.rest_energy_j(body);
        if is_still && is_steady && is_calm && self.may_rest(body, world) {
            self.quiet_windows += 1;
        } else {
            self.quiet_windows = 0;
            self.orientation = (rotation_from_vector(pose.1) * self.orientation).normalize();
            self.anchor = Some(pose.0);
        }
        let next = Window::from(world.time_s);
        self.last = Some((std::mem::replace(&mut self.window, next), duration_s));
    }

    /// Whether nothing will act on the body without being noticed in its sleep: moving supports, growing
    /// loads, pulls, bodies with a prescribed motion still to come.
    fn may_rest(&self, body: &Body, world: &RestView) -> bool {
        let is_held_still = body.prescribed.iter().all(|p| p.velocity_m_s == DVec3::ZERO);
        let is_loaded_fully = body.loads.iter().all(|load| load.ramp_s <= world.time_s);
        let others = self.window.pressures.iter().map(|p| &world.bodies[p.other as usize]);
        is_held_still
            && is_loaded_fully
            && body.grips.is_empty()
            && others.into_iter().all(|b| has_stopped(&b.motion, world.time_s))
    }
}

/// Whether a prescribed motion is over.
fn has_stopped(motion: &BodyMotion, time_s: f64) -> bool {
    let moves = |m: &PrescribedMotion| m.velocity_m_s != DVec3::ZERO || m.spin_rad_s != DVec3::ZERO;
    match motion {
        BodyMotion::Kinematic(m) => time_s >= m.stop_s || !moves(m),
        _ => true,
    }
}

/// What rest detection sees.
pub(super) struct RestView<'a> {
    pub bodies: &'a [Body],
    pub time_s: f64,
    /// Length of the island's last step, s.
    pub step_s: f64,
    pub gravity_m_s2: f64,
}

impl RestView<'_> {
    /// Length of a body's windows, s; as short as may be without gravity.
    fn window_s(&self, body: &Body) -> f64 {
        if self.gravity_m_s2 > 0.0 { WINDOW_SHARE * (body.radius_m / self.gravity_m_s2).sqrt() } else { 0.0 }
    }

    /// Kinetic energy up to which a body may rest, J.
    fn rest_energy_j(&self, body: &Body) -> f64 {
        let speed_m_s = REST_SPEED_SHARE * (self.gravity_m_s2 * body.radius_m).sqrt();
        0.5 * body.reference.mass_kg * speed_m_s * speed_m_s
    }
}

/// Adds the impulses of a step to the windows of the bodies they act on.
pub(super) fn record(trackers: &mut [RestTracker], c: &Constraint) {
    let [a, b] = c.bodies;
    trackers[a as usize].record(b, c.impulse_n_s, c.place_m);
    trackers[b as usize].record(a, -c.impulse_n_s, c.place_m);
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
