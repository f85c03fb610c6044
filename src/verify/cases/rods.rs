//! Two steel rods collide, against one-dimensional wave theory (METHOD 8, V1;
//! W. Goldsmith, *Impact*, 1960, chapter 3).

use super::super::specimen::{body, box_mesh, material, moved, nodes_where, quiet_world, window_peak_n};
use super::super::{CaseError, Effort, Outcome, Plot, Quantity, Scale};
use crate::contact::Settling;
use crate::scene::Scene;
use crate::sim::{BodyMotion, Kinematics, World, WorldSetup};
use glam::DVec3;

/// Length of each rod, m.
pub const LENGTH_M: f64 = 0.254;
/// Width of each rod, m.
pub const WIDTH_M: f64 = 0.0254;
/// Heights of the rods, m.
pub const HEIGHTS_M: [f64; 2] = [0.0254, 0.0224];
/// Gap at the start, m.
pub const GAP_M: f64 = 2.54e-5;
/// Speed of each rod, m/s.
pub const SPEED_M_S: f64 = 5.1359;
const DENSITY: f64 = 7844.0;
const YOUNG_PA: f64 = 206.82e9;
/// Speed at which the strain of the rods, `v/c`, is a hundred-thousandth, m/s.
const SLOW_M_S: f64 = 0.051_359;
/// Fewer elements along show no order yet.
const COARSEST_OF_ORDER: f64 = 20.0;
/// Long enough for the collision and what follows it, s.
const DURATION_S: f64 = 2e-4;
/// Steps as in the shipped scene.
const CFL: f64 = 0.3;

/// What a collision of two rods looked like.
#[derive(Clone, Debug, PartialEq)]
pub struct Collision {
    /// Of the collision's length: the rectangular pulse with the force's spread in time, s.
    pub length_s: f64,
    /// Time from the first impulse to the last, s.
    pub last_impulse_s: f64,
    /// Impulse, N s.
    pub impulse_n_s: f64,
    /// Largest change of the linear momentum over that of one rod.
    pub momentum_error: f64,
    /// Largest error of kinetic and strain energy over the initial energy.
    pub energy_error: f64,
    /// Impulse against each rod's change of momentum, over the impulse.
    pub impulse_errors: [f64; 2],
    /// Velocities after the collision, m/s.
    pub velocities_m_s: [f64; 2],
    /// Most passes of a step.
    pub most_passes: u32,
    /// Share of the steps in contact whose multipliers settled within three passes.
    pub settled_in_three: f64,
    /// Largest last change of a multiplier.
    pub last_change: f64,
    /// Passes and last change in the first, the middle and the last step in contact.
    pub begin_middle_end: [(u32, f64); 3],
    /// Change of the multipliers after each pass of those steps: (pass, change).
    pub settling: [Vec<[f64; 2]>; 3],
    /// Deepest penetration over the size of an element.
    pub penetration: f64,
    /// Largest contact force, N, as a mean over a tenth of the collision: nodes that meet make shorter blows.
    pub peak_n: f64,
    /// Shortest step in contact over the share of the stable step that the setup asks for.
    pub contact_step: f64,
    /// Steps taken.
    pub steps: u64,
    /// Contact force over time, (s, N).
    pub force: Vec<[f64; 2]>,
    /// Kinetic and strain energy over time, (s, J).
    pub energies: [Vec<[f64; 2]>; 2],
    /// Passes over time.
    pub passes: Vec<[f64; 2]>,
}

/// Length of the collision by wave theory, `2 L sqrt(rho/E)`, s.
#[must_use]
pub fn theory_length_s() -> f64 {
    2.0 * LENGTH_M * (DENSITY / YOUNG_PA).sqrt()
}

/// Impedances `Z = A sqrt(rho E)`, kg/s.
fn impedances_kg_s() -> [f64; 2] {
    HEIGHTS_M.map(|height_m| height_m * WIDTH_M * (DENSITY * YOUNG_PA).sqrt())
}

/// Contact force by wave theory, `Z1 Z2 (v1 - v2)/(Z1 + Z2)`, N.
fn theory_force_n() -> f64 {
    let [a, b] = impedances_kg_s();
    a * b / (a + b) * 2.0 * SPEED_M_S
}

/// Velocities after the collision by wave theory, `v_i' = 2 v_c - v_i`, `v_c = (Z1 v1 + Z2 v2)/(Z1 + Z2)`, m/s.
#[must_use]
pub fn theory_velocities_m_s() -> [f64; 2] {
    let [a, b] = impedances_kg_s();
    let common_m_s = SPEED_M_S * (a - b) / (a + b);
    [2.0 * common_m_s - SPEED_M_S, 2.0 * common_m_s + SPEED_M_S]
}

/// The two rods with the given cells, kinematics and share of the stable step, without Poisson's ratio.
///
/// # Errors
/// [`CaseError`] when there are no such meshes.
pub fn setup(cells: [[u32; 3]; 2], kinematics: Kinematics, cfl: f64) -> Result<WorldSetup, CaseError> {
    setup_of(HEIGHTS_M, SPEED_M_S, cells, kinematics, cfl)
}

fn setup_of(
    heights_m: [f64; 2],
    speed_m_s: f64,
    cells: [[u32; 3]; 2],
    kinematics: Kinematics,
    cfl: f64,
) -> Result<WorldSetup, CaseError> {
    let mut bodies = Vec::new();
    let gap_m = GAP_M * speed_m_s / SPEED_M_S;
    for i in 0..2 {
        let side = [-1.0, 1.0][i];
        let centre = DVec3::X * side * 0.5 * (LENGTH_M + gap_m);
        let mesh = box_mesh(DVec3::new(LENGTH_M, WIDTH_M, heights_m[i]), cells[i], centre)?;
        let mut rod = body(["left", "right"][i], mesh, material(DENSITY, YOUNG_PA, 0.0));
        rod.velocity_m_s = DVec3::X * -side * speed_m_s;
        rod.motion = BodyMotion::Deformable(kinematics);
        bodies.push(rod);
    }
    let mut setup = quiet_world(bodies);
    setup.time.cfl = cfl;
    Ok(setup)
}

/// Lets two rods collide.
///
/// # Errors
/// [`CaseError`] when they never touch, or the run fails.
pub fn collide(effort: &Effort, setup: WorldSetup) -> Result<Collision, CaseError> {
    let cfl = setup.time.cfl;
    let mut world = World::new(setup)?;
    let mut contact_step = f64::INFINITY;
    let start = world.sample();
    let before: Vec<DVec3> = (0..2).map(|b| world.body_momentum_kg_m_s(b)).collect();
    let scale = before[0].length();
    let (mut momentum_error, mut energy_error) = (0.0_f64, 0.0_f64);
    let (mut worst, mut in_three) = (Settling::default(), 0_u32);
    let mut steps = Vec::new();
    let (mut force, mut energies, mut passes) = (Vec::new(), [Vec::new(), Vec::new()], Vec::new());
    let mut in_contact = Vec::new();
    effort.run(&mut world, DURATION_S, |world, report| {
        let sample = world.sample();
        let change = sample.linear_momentum_kg_m_s - start.linear_momentum_kg_m_s;
        momentum_error = momentum_error.max(change.length() / scale);
        let energy = (sample.kinetic_j + sample.strain_j) / start.kinetic_j - 1.0;
        energy_error = energy_error.max(energy.abs());
        let settling = report.settling;
        worst.include(&settling);
        if settling.passes > 0 {
            let stable_s = world.stable_step_s(0).min(world.stable_step_s(1));
            contact_step = contact_step.min(report.step_s / (cfl * stable_s));
            in_three += u32::from(settling.passes <= 3 && settling.last_change < 1e-4);
            in_contact.push(settling);
            passes.push([report.time_s, f64::from(settling.passes)]);
        }
        force.push([report.time_s, report.contact_force_n]);
        steps.push([report.step_s, report.contact_force_n]);
        energies[0].push([report.time_s, sample.kinetic_j]);
        energies[1].push([report.time_s, sample.strain_j]);
    })?;
    let episodes = world.contact_episodes();
    let (Some(first), Some(last)) = (episodes.first(), episodes.last()) else {
        return Err(CaseError::Unmeasured("the rods never touch".to_owned()));
    };
    let impulse: DVec3 = episodes.iter().map(|e| e.impulse_n_s).sum();
    let changes: Vec<DVec3> = (0..2).map(|b| world.body_momentum_kg_m_s(b) - before[b]).collect();
    let moments = [0, in_contact.len() / 2, in_contact.len().saturating_sub(1)];
    let moments = moments.map(|index| in_contact.get(index).copied().unwrap_or_default());
    // The very last step only opens the pairs, and nothing changes in its passes.
    let last_pressing = in_contact.iter().rfind(|settling| settling.changes[0] > 0.0);
    let last_pressing = last_pressing.copied().unwrap_or_default();
    let of_passes = |settling: Settling| {
        let passes = (1..=settling.passes).zip(settling.changes);
        passes.map(|(pass, change)| [f64::from(pass), change]).collect()
    };
    Ok(Collision {
        length_s: first.pulse_length_s,
        last_impulse_s: last.end_s - first.begin_s,
        impulse_n_s: impulse.length(),
        momentum_error,
        energy_error,
        impulse_errors: [
            (impulse - changes[0]).length() / impulse.length(),
            (impulse + changes[1]).length() / impulse.length(),
        ],
        velocities_m_s: [0, 1].map(|b| world.body_momentum_kg_m_s(b).x / world.mass_kg(b)),
        most_passes: worst.passes,
        settled_in_three: f64::from(in_three) / in_contact.len().max(1) as f64,
        last_change: worst.last_change,
        begin_middle_end: moments.map(|settling| (settling.passes, settling.last_change)),
        settling: [moments[0], moments[1], last_pressing].map(of_passes),
        penetration: world.largest_penetration_ratio(),
        peak_n: window_peak_n(&steps, theory_length_s() / 10.0),
        contact_step,
        steps: world.steps(),
        force,
        energies,
        passes,
    })
}

/// A shipped scene of the rods with overrides.
fn collide_scene(effort: &Effort, name: &str, overrides: &[&str]) -> Result<Collision, CaseError> {
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    collide(effort, Scene::load(name, &overrides)?.setup)
}

const THEORY_LENGTH: &str = "2 L sqrt(rho/E), one-dimensional wave theory (METHOD 8, V1)";

const THEORY_ORDER: &str = "the front that ends it, in a row of masses, widens as h^(2/3) (Airy; L. Brillouin, Wave Propagation in Periodic Structures, \
    1946); the first blow of the end's own mass is of first order";

/// The quantities of one collision, their names beginning with `name`.
fn quantities(name: &str, found: &Collision) -> Vec<Quantity> {
    let expected_n_s = theory_force_n() * theory_length_s();
    let mut all = vec![
        Quantity::relative(
            format!("{name}: length of the collision"),
            "s",
            found.length_s,
            theory_length_s(),
        )
        .by(THEORY_LENGTH)
        .within(0.0227, "the thesis's own error"),
        Quantity::relative(format!("{name}: impulse"), "N s", found.impulse_n_s, expected_n_s)
            .by("2 L sqrt(rho/E) Z1 Z2 (v1 - v2)/(Z1 + Z2) (METHOD 8)")
            .within(0.0216, "the thesis's impulses were off by 2.16 and 2.35 %"),
        Quantity::absolute(format!("{name}: change of momentum / a rod's"), "", found.momentum_error, 0.0)
            .by("conservation of momentum")
            .within(1e-9, "round-off of all steps, by construction (thesis: 1.39 %)"),
        Quantity::absolute(format!("{name}: largest energy error / initial"), "", found.energy_error, 0.0)
            .by("conservation of energy")
            .within(
                0.01,
                "impacts give back what they took; central differences swing by less (thesis: 3.67 %)",
            ),
    ];
    for (i, side) in ["left", "right"].into_iter().enumerate() {
        all.push(
            Quantity::absolute(
                format!("{name}: impulse against change of momentum, {side}"),
                "",
                found.impulse_errors[i],
                0.0,
            )
            .by("Newton's second law")
            .within(1e-9, "round-off, by construction (thesis: 2.35 and 2.16 %)"),
        );
        let expected_m_s = theory_velocities_m_s()[i];
        all.push(
            Quantity::relative(
                format!("{name}: velocity after, {side}"),
                "m/s",
                found.velocities_m_s[i],
                expected_m_s,
            )
            .by("2 v_c - v_i, v_c = (Z1 v1 + Z2 v2)/(Z1 + Z2) (METHOD 8)")
            .within(0.05, "2.5 % of the closing speed, that is, the thesis's error of the impulse"),
        );
    }
    all.push(passes_beyond_three(name, found, "three passes settle (METHOD 8, thesis figure 5.8)"));
    for (when, (passes, change)) in ["start", "middle", "end"].into_iter().zip(found.begin_middle_end) {
        all.push(
            Quantity::absolute(
                format!("{name}: last change of a multiplier, {when} ({passes} passes)"),
                "",
                change,
                0.0,
            )
            .by("METHOD 5: passes stop at 0.01 %")
            .within(1e-4, "the thesis's own 0.01 %"),
        );
    }
    all
}

/// By how many passes the worst step needed more than three.
fn passes_beyond_three(name: &str, found: &Collision, source: &'static str) -> Quantity {
    let beyond = f64::from(found.most_passes.saturating_sub(3));
    Quantity::absolute(format!("{name}: most Gauss-Seidel passes - 3"), "", beyond, 0.0)
        .by(source)
        .within(0.0, "no step may need more")
}

pub(in crate::verify) fn measure(effort: &Effort) -> Result<Outcome, CaseError> {
    let name = "rods-collision";
    let green = collide_scene(effort, name, &[])?;
    let frames = ["bodies.left.kinematics=body-frame", "bodies.right.kinematics=body-frame"];
    let body_frame = collide_scene(effort, name, &frames)?;
    let rubbing = collide_scene(effort, name, &["contact.friction=0.5"])?;
    let bulging = collide_scene(effort, name, &["materials.rod.poisson_ratio=0.3"])?;
    let mut all = quantities("10 along", &green);
    all.push(
        Quantity::relative(
            "10 along: from the first impulse to the last",
            "s",
            green.last_impulse_s,
            theory_length_s(),
        )
        .by(THEORY_LENGTH),
    );
    all.extend(quantities("body-frame", &body_frame));
    for (label, found) in [("friction 0.5", &rubbing), ("nu = 0.3", &bulging)] {
        all.push(
            Quantity::relative(
                format!("{label}: length of the collision"),
                "s",
                found.length_s,
                theory_length_s(),
            )
            .by(THEORY_LENGTH)
            .within(0.0227, "the thesis's own error"),
        );
        all.push(passes_beyond_three(label, found, "three passes settle with and without slip (METHOD 8)"));
    }
    let theory = theory_force_n();
    let begin_s = green.force.iter().find(|[_, f]| *f > 0.0).map_or(0.0, |[t, _]| *t);
    let end_s = begin_s + theory_length_s();
    let force =
        Plot::new("impact-force", "Impact force of two rods (thesis figure 5.7)", ["time, s", "force, N"])
            .with("10 elements along", green.force)
            .with(
                "wave theory",
                vec![
                    [0.0, 0.0],
                    [begin_s, 0.0],
                    [begin_s, theory],
                    [end_s, theory],
                    [end_s, 0.0],
                    [DURATION_S, 0.0],
                ],
            );
    let [kinetic, strain] = green.energies;
    let total = kinetic.iter().zip(&strain).map(|(k, s)| [k[0], k[1] + s[1]]).collect();
    let energy = Plot::new("rods-energy", "Energy of two rods", ["time, s", "energy, J"])
        .with("kinetic", kinetic)
        .with("strain", strain)
        .with("both", total);
    let settling = measure_settling(effort)?;
    Ok(Outcome { quantities: all, plots: vec![force, energy, settling] })
}

/// How much the multipliers change in each pass, with and without slip, at three moments. The passes go on as if
/// nothing were good enough.
fn measure_settling(effort: &Effort) -> Result<Plot, CaseError> {
    let mut plot = Plot::new(
        "gauss-seidel",
        "Largest change of a multiplier in each Gauss-Seidel pass (thesis figures 5.8, 5.9)",
        ["pass", "change over the largest multiplier"],
    )
    .scaled([Scale::Linear, Scale::Log]);
    for (label, friction) in [("no friction", 0.0), ("friction 0.5", 0.5)] {
        let overrides = [format!("contact.friction={friction}")];
        let mut setup = Scene::load("rods-collision", &overrides)?.setup;
        if let crate::sim::ContactMethod::Lagrange { tolerance, .. } = &mut setup.contact.method {
            *tolerance = f64::MIN_POSITIVE;
        }
        let found = collide(effort, setup)?;
        for (when, curve) in ["start", "middle", "end"].into_iter().zip(found.settling) {
            plot = plot.with(format!("{label}, {when}"), curve);
        }
    }
    Ok(plot)
}

pub(in crate::verify) fn measure_fine(effort: &Effort) -> Result<Outcome, CaseError> {
    let found = collide_scene(effort, "rods-collision-fine", &[])?;
    let mut all = quantities("40 along", &found);
    all.push(
        Quantity::relative(
            "40 along: from the first impulse to the last",
            "s",
            found.last_impulse_s,
            theory_length_s(),
        )
        .by(THEORY_LENGTH),
    );
    let plot = Plot::new(
        "impact-force-fine",
        "Impact force of two rods, 40 elements along",
        ["time, s", "force, N"],
    )
    .with("40 elements along", found.force);
    Ok(Outcome { quantities: all, plots: vec![plot] })
}

/// Length of the collision over meshes, each twice as fine as the one before, at a speed at which wave theory is exact: the
/// thesis's own strains the rods by `v/c`, a thousandth, which alone makes its collision longer by three quarters of that.
pub(in crate::verify) fn measure_refinement(effort: &Effort) -> Result<Outcome, CaseError> {
    let cells: &[u32] = if effort.quick { &[10, 20, 40, 80, 160] } else { &[5, 10, 20, 40, 80, 160, 320] };
    let mut all = Vec::new();
    let mut plot = Plot::new(
        "rods-refinement",
        "Length of the collision under refinement",
        ["elements along each rod", "relative error"],
    )
    .scaled([Scale::Log, Scale::Log]);
    for (name, heights_m) in [("equal", [HEIGHTS_M[0]; 2]), ("thesis", HEIGHTS_M)] {
        let (mut pulses, mut tails) = (Vec::new(), Vec::new());
        for &along in cells {
            let setup = setup_of(heights_m, SLOW_M_S, [[along, 1, 1]; 2], Kinematics::Green, CFL)?;
            let found = collide(effort, setup)?;
            all.push(
                Quantity::relative(
                    format!("{name}, {along} along: length of the collision"),
                    "s",
                    found.length_s,
                    theory_length_s(),
                )
                .by(THEORY_LENGTH)
                .within(
                    if along >= 10 { 0.0227 } else { 0.05 },
                    "the thesis's own error with ten elements along; half of them may be twice as far off",
                ),
            );
            pulses.push([f64::from(along), found.length_s / theory_length_s() - 1.0]);
            tails.push([f64::from(along), found.last_impulse_s / theory_length_s() - 1.0]);
        }
        let fine = |points: &[[f64; 2]]| -> Vec<[f64; 2]> {
            points.iter().copied().filter(|point| point[0] >= COARSEST_OF_ORDER).collect()
        };
        for (what, order) in [
            (
                "rectangular pulse, observed order without the first",
                slope(&without_first_order(&fine(&pulses))),
            ),
            ("first to last impulse, observed order", slope(&fine(&tails))),
        ] {
            all.push(
                Quantity::absolute(format!("{name}: {what}"), "", order, 2.0 / 3.0).by(THEORY_ORDER).within(
                    0.1,
                    "a ragged end: the last impulse comes at the end of a step, and the nodes part one by one",
                ),
            );
        }
        plot = plot
            .with(format!("{name}, rectangular pulse"), absolute(&pulses))
            .with(format!("{name}, first to last impulse"), absolute(&tails));
    }
    all.push(measure_softening(effort)?);
    Ok(Outcome { quantities: all, plots: vec![plot] })
}

/// How much longer the thesis's speed makes the collision of equal rods than a slow one.
///
/// Of St. Venant and Kirchhoff's law the nominal stress is `E (e + 3/2 e^2 + ...)` at the stretch `1 + e`, so that a jump by
/// `e = -v/c` travels with `c (1 + 3/4 e)` both ways.
fn measure_softening(effort: &Effort) -> Result<Quantity, CaseError> {
    let length_s = |speed_m_s| {
        let setup = setup_of([HEIGHTS_M[0]; 2], speed_m_s, [[80, 1, 1]; 2], Kinematics::Green, CFL)?;
        Ok::<f64, CaseError>(collide(effort, setup)?.length_s)
    };
    let longer = (length_s(SPEED_M_S)? - length_s(SLOW_M_S)?) / theory_length_s();
    let wave_m_s = (YOUNG_PA / DENSITY).sqrt();
    Ok(Quantity::relative(
        "equal, 80 along: longer at the thesis's speed, share of the length",
        "",
        longer,
        0.75 * SPEED_M_S / wave_m_s,
    )
    .by("3/4 v/c, waves of finite strain in St. Venant and Kirchhoff's law")
    .within(0.1, "the end of the pulse is ragged by more than this difference"))
}

/// Errors without their part of first order in the element, by Richardson's extrapolation; meshes each twice as fine as the one before.
fn without_first_order(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    points.windows(2).map(|pair| [pair[0][0], 2.0 * pair[1][1] - pair[0][1]]).collect()
}

fn absolute(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    points.iter().map(|&[x, y]| [x, y.abs()]).collect()
}

/// Order of convergence: minus the slope of the straight line of least squares through the logarithms.
fn slope(points: &[[f64; 2]]) -> f64 {
    let logs: Vec<[f64; 2]> = points.iter().map(|p| p.map(|x| x.abs().ln())).collect();
    let n = logs.len() as f64;
    let [mx, my] = [0, 1].map(|i| logs.iter().map(|p| p[i]).sum::<f64>() / n);
    let products: f64 = logs.iter().map(|p| (p[0] - mx) * (p[1] - my)).sum();
    -products / logs.iter().map(|p| (p[0] - mx).powi(2)).sum::<f64>()
}

/// Rods that meet head-on while one of them moves sideways so fast that they slide all the while: friction's
/// impulse is mu times the normal one (Coulomb; Goldsmith 1960, 2.6). Free rods bend, so that their ends tilt: for the
/// ratio of the impulses they are guided along their ways.
pub(in crate::verify) fn measure_oblique(effort: &Effort) -> Result<Outcome, CaseError> {
    let mut all = Vec::new();
    for (name, kinematics) in [("green", Kinematics::Green), ("body-frame", Kinematics::BodyFrame)] {
        let guided = slide_along(effort, kinematics, true)?;
        let free = slide_along(effort, kinematics, false)?;
        all.extend([
            Quantity::relative(format!("{name}, guided: sideways / normal impulse"), "", guided.ratio, FRICTION)
                .by("Coulomb: J_t = mu J_n while it slides (Goldsmith 1960, 2.6)")
                .within(1e-3, "the sides bulge not at all (nu = 0), so that ends stay plane; friction gives way to no rounding"),
            Quantity::relative(format!("{name}, free: sideways / normal impulse"), "", free.ratio, FRICTION)
                .by("Coulomb; the ends of free rods tilt by some thousandths"),
            Quantity::absolute(format!("{name}, free: largest error of the energy balance / initial"), "", free.balance_error, 0.0)
                .by("kinetic + strain + dissipated is constant (METHOD 9)")
                .within(0.01, "as in the head-on collision"),
            Quantity::absolute(format!("{name}, guided: largest error of the energy balance / initial"), "", guided.balance_error, 0.0)
                .by("kinetic + strain + dissipated = work of the guides (METHOD 9)"),
            Quantity::relative(format!("{name}, guided: friction's energy"), "J", guided.dissipated_j, guided.expected_j)
                .by("mu J_n times the speed of sliding")
                .within(0.01, "as the energy of the head-on collision"),
            Quantity::absolute(format!("{name}, free: change of the angular momentum"), "", free.turned, 0.0)
                .by("conservation of angular momentum (METHOD 5)")
                .within(
                    if kinematics == Kinematics::Green { 1e-9 } else { 1e-3 },
                    "round-off with green; the linear stiffness of body-frame does not conserve it (METHOD 5)",
                ),
        ]);
    }
    Ok(all.into())
}

const FRICTION: f64 = 0.2;
const SIDEWAYS_M_S: f64 = 20.0;

/// What a collision with sliding looked like.
struct Slid {
    /// Sideways impulse over the normal one.
    ratio: f64,
    /// Largest error of the energy balance over the initial energy.
    balance_error: f64,
    /// Change of the angular momentum over its start.
    turned: f64,
    /// Energy dissipated, J.
    dissipated_j: f64,
    /// Energy that Coulomb's friction takes, J.
    expected_j: f64,
}

fn slide_along(effort: &Effort, kinematics: Kinematics, is_guided: bool) -> Result<Slid, CaseError> {
    let mut setup = setup([[10, 2, 2], [10, 2, 2]], kinematics, CFL)?;
    setup.contact.friction_coefficient = FRICTION;
    setup.bodies[0].velocity_m_s.y = SIDEWAYS_M_S;
    if is_guided {
        for (body, speed_m_s) in setup.bodies.iter_mut().zip([SIDEWAYS_M_S, 0.0]) {
            let all = nodes_where(&body.mesh, |_| true);
            body.boundary = vec![moved(all, DVec3::Y * speed_m_s, [false, true, true])];
        }
    }
    let mut world = World::new(setup)?;
    let start = world.sample();
    let mut balance_j = 0.0_f64;
    effort.run(&mut world, DURATION_S, |world, _| {
        balance_j = balance_j.max((world.sample().balance_j() - start.balance_j()).abs());
    })?;
    let impulse: DVec3 = world.contact_episodes().iter().map(|e| e.impulse_n_s).sum();
    let end = world.sample();
    let turned = (end.angular_momentum_kg_m2_s - start.angular_momentum_kg_m2_s).length();
    Ok(Slid {
        ratio: impulse.y.abs() / impulse.x.abs(),
        balance_error: balance_j / start.kinetic_j,
        turned: turned / start.angular_momentum_kg_m2_s.length(),
        dissipated_j: end.dissipated_j,
        expected_j: FRICTION * impulse.x.abs() * SIDEWAYS_M_S,
    })
}
