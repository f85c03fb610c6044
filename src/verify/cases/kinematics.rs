//! The four elastic laws beside each other: equal where strain is small, and by how much they differ where it is not.

use super::super::specimen::{body, box_mesh, fixed, held, material, moved, nodes_where, quiet_world};
use super::super::{CaseError, Effort, Outcome, Plot, Quantity};
use super::patch::{lame_pa, neo_hookean_piola_pa, outer_product};
use super::{rods, waves};
use crate::fem::{ElasticConstants, ElementBatches, ForceScratch};
use crate::mesh::signed_volume_m3;
use crate::sim::{BodyMotion, Kinematics, World};
use glam::{DMat3, DQuat, DVec3};

const YOUNG_PA: f64 = 1e6;
const POISSON: f64 = 0.3;
const DENSITY: f64 = 1000.0;
const SIDE_M: f64 = 0.1;
/// Stretches of the confined and of the free block.
const CONFINED: [f64; 6] = [0.5, 0.7, 0.9, 1.1, 1.3, 1.5];
const FREE: [f64; 2] = [0.7, 1.3];

pub(in crate::verify) fn measure(effort: &Effort) -> Result<Outcome, CaseError> {
    let mut all = measure_small()?;
    all.extend(measure_waves(effort)?);
    all.extend(measure_rods(effort)?);
    let (confined, plot) = measure_confined()?;
    all.extend(confined);
    all.extend(measure_free(effort)?);
    all.extend(measure_crash(effort)?);
    Ok(Outcome { quantities: all, plots: vec![plot] })
}

/// A block of one material.
struct Block {
    elements: ElementBatches,
    nodes_m: Vec<DVec3>,
}

impl Block {
    fn new() -> Result<Self, CaseError> {
        let mesh = box_mesh(DVec3::ONE, [2, 2, 2], DVec3::splat(0.5))?;
        let constants = ElasticConstants::new(YOUNG_PA, POISSON, DENSITY)
            .map_err(|error| CaseError::Unmeasured(error.to_string()))?;
        let elements = ElementBatches::new(&mesh.nodes_m, &mesh.tets, &vec![constants; mesh.tets.len()])
            .map_err(|error| CaseError::Unmeasured(error.to_string()))?;
        Ok(Self { elements, nodes_m: mesh.nodes_m })
    }

    /// Mean first Piola-Kirchhoff stress of the unit cube under `f`, `-sum f X^T` (virial theorem), Pa.
    fn first_piola_pa(&self, f: DMat3, kinematics: Kinematics) -> DMat3 {
        let moved: Vec<DVec3> = self.nodes_m.iter().map(|x| f * *x).collect();
        let mut forces_n = vec![DVec3::ZERO; moved.len()];
        let scratch = &mut ForceScratch::default();
        self.elements.forces(scratch, &moved, kinematics.of_elements(DQuat::IDENTITY), &mut forces_n);
        let pairs = self.nodes_m.iter().zip(&forces_n);
        -pairs.map(|(x, f)| outer_product(*f, *x)).sum::<DMat3>()
    }
}

/// At small strain every law is Hooke's.
fn measure_small() -> Result<Vec<Quantity>, CaseError> {
    const STRAIN: f64 = 1e-6;
    let block = Block::new()?;
    let [lambda_pa, mu_pa] = lame_pa(YOUNG_PA, POISSON);
    let strain = DMat3::from_cols_array(&[1.0, 0.2, -0.3, 0.2, -0.5, 0.4, -0.3, 0.4, 0.7]) * STRAIN;
    let trace = strain.x_axis.x + strain.y_axis.y + strain.z_axis.z;
    let hooke = DMat3::IDENTITY * (lambda_pa * trace) + strain * (2.0 * mu_pa);
    let each = Kinematics::NAMED.iter().map(|(name, kinematics)| {
        let error = block.first_piola_pa(DMat3::IDENTITY + strain, *kinematics) - hooke;
        let worst = error.to_cols_array().into_iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        Quantity::absolute(
            format!("{name}: stress at a strain of 1e-6 / Hooke's"),
            "",
            worst / hooke.x_axis.x,
            0.0,
        )
        .by("sigma = lambda tr(eps) I + 2 mu eps")
        .within(1e-5, "terms of second order: some times the strain")
    });
    Ok(each.collect())
}

/// Pressure waves run equally fast in all of them.
fn measure_waves(effort: &Effort) -> Result<Vec<Quantity>, CaseError> {
    let [wave, ..] = waves::kinds();
    let mut all = Vec::new();
    for (name, kinematics) in Kinematics::NAMED {
        let speed_m_s = waves::speed_of(effort, &wave, (10, kinematics))?;
        all.push(
            Quantity::relative(
                format!("{name}: speed of waves in a thin bar"),
                "m/s",
                speed_m_s,
                wave.speed_m_s,
            )
            .by("c = sqrt(E/rho) (Graff 1975, 2.1)")
            .within(
                4e-3,
                "(k h)^2/24 with k h = pi/20 is 1e-3 for lumped mass; four times that in three dimensions",
            ),
        );
    }
    Ok(all)
}

/// The rods collide alike: their strain is 1e-3.
fn measure_rods(effort: &Effort) -> Result<Vec<Quantity>, CaseError> {
    let mut all = Vec::new();
    let mut green = None;
    for (name, kinematics) in Kinematics::NAMED {
        let found = rods::collide(effort, rods::setup([[10, 1, 1]; 2], kinematics, 0.3)?)?;
        let reference_s = *green.get_or_insert(found.length_s);
        if kinematics != Kinematics::Green {
            all.push(
                Quantity::relative(
                    format!("{name}: length of the rods' collision"),
                    "s",
                    found.length_s,
                    reference_s,
                )
                .by("the same with green")
                .within(5e-3, "the strain is 5e-4; single nodes open a step earlier or later"),
            );
        }
        all.push(
            Quantity::absolute(
                format!("{name}: largest energy error of the rods / initial"),
                "",
                found.energy_error,
                0.0,
            )
            .by("conservation of energy")
            .within(0.01, "as in `rods`"),
        );
    }
    Ok(all)
}

/// Stress along a stretch `s` with the sides held, Pa: `F = diag(s, 1, 1)`.
fn confined_pa(kinematics: Kinematics, s: f64) -> f64 {
    let [lambda_pa, mu_pa] = lame_pa(YOUNG_PA, POISSON);
    let modulus_pa = lambda_pa + 2.0 * mu_pa;
    match kinematics {
        Kinematics::Green => modulus_pa * s * (s * s - 1.0) / 2.0,
        Kinematics::BodyFrame | Kinematics::Corotated => modulus_pa * (s - 1.0),
        Kinematics::NeoHookean => {
            neo_hookean_piola_pa(&DMat3::from_diagonal(DVec3::new(s, 1.0, 1.0)), lambda_pa, mu_pa).x_axis.x
        }
    }
}

const CONFINED_SOURCE: [&str; 4] = [
    "(lambda + 2 mu) s (s^2 - 1)/2: softer and softer when pressed, most at s = 0.58",
    "(lambda + 2 mu) (s - 1)",
    "(lambda + 2 mu) (s - 1): no rotation, so the same as body-frame",
    "Smith, de Goes, Kim 2018, with lambda' = lambda + 5/6 mu, mu' = 4/3 mu",
];

fn measure_confined() -> Result<(Vec<Quantity>, Plot), CaseError> {
    let block = Block::new()?;
    let [lambda_pa, mu_pa] = lame_pa(YOUNG_PA, POISSON);
    let modulus_pa = lambda_pa + 2.0 * mu_pa;
    let along_pa = |kinematics, s: f64| {
        block.first_piola_pa(DMat3::from_diagonal(DVec3::new(s, 1.0, 1.0)), kinematics).x_axis.x
    };
    let mut all = Vec::new();
    let mut plot = Plot::new(
        "kinematics",
        "Force along a block with its sides held, over (lambda + 2 mu) times its section",
        ["stretch", "force"],
    );
    for ((name, kinematics), source) in Kinematics::NAMED.into_iter().zip(CONFINED_SOURCE) {
        let errors = CONFINED.map(|s| along_pa(kinematics, s) / confined_pa(kinematics, s) - 1.0);
        all.push(
            Quantity::absolute(
                format!("{name}: sides held, stretch 0.5 to 1.5, error of the force"),
                "",
                errors.into_iter().fold(0.0_f64, |most, e| most.max(e.abs())),
                0.0,
            )
            .by(source)
            .within(1e-12, "round-off"),
        );
        for s in [0.5, 0.9, 1.1, 1.5] {
            all.push(
                Quantity::relative(
                    format!("{name}: sides held, stretch {s}, force beside linear"),
                    "Pa",
                    along_pa(kinematics, s),
                    modulus_pa * (s - 1.0),
                )
                .by("(lambda + 2 mu) (s - 1); the laws differ by design"),
            );
        }
        let points =
            (0..=60).map(|i| -0.5 + 0.05 * f64::from(i)).map(|s| [s, along_pa(kinematics, s) / modulus_pa]);
        plot = plot.with(name, points.collect());
    }
    Ok((all, plot))
}

/// Sideways stretch and stress along `s` (Pa) of a block with free sides.
fn free_block(kinematics: Kinematics, s: f64) -> [f64; 2] {
    let [lambda_pa, mu_pa] = lame_pa(YOUNG_PA, POISSON);
    match kinematics {
        Kinematics::Green => {
            let strain = (s * s - 1.0) / 2.0;
            let sideways = (1.0 - 2.0 * POISSON * strain).sqrt();
            [sideways, YOUNG_PA * strain * s / (sideways * sideways)]
        }
        // Its Cauchy stress is that of the linear law.
        Kinematics::BodyFrame => [1.0 - POISSON * (s - 1.0), YOUNG_PA * (s - 1.0)],
        Kinematics::Corotated => {
            let sideways = 1.0 - POISSON * (s - 1.0);
            [sideways, YOUNG_PA * (s - 1.0) / (sideways * sideways)]
        }
        Kinematics::NeoHookean => {
            let piola = |sideways: f64| {
                let f = DMat3::from_diagonal(DVec3::new(s, sideways, sideways));
                neo_hookean_piola_pa(&f, lambda_pa, mu_pa)
            };
            // Pressure at the sides grows with their stretch.
            let (mut low, mut high) = (0.5, 1.5);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if piola(middle).y_axis.y > 0.0 { high = middle } else { low = middle }
            }
            [low, piola(low).x_axis.x / (low * low)]
        }
    }
}

/// A block that is pulled and pressed slowly, its sides free.
fn measure_free(effort: &Effort) -> Result<Vec<Quantity>, CaseError> {
    const SLOW: &str =
        "inertia and damping of a motion that lasts as long as a wave needs to cross 200 times";
    let mut all = Vec::new();
    for (name, kinematics) in Kinematics::NAMED {
        for stretch in FREE {
            let [sideways, cauchy_pa] = free_block(kinematics, stretch);
            let found = pull(effort, kinematics, stretch)?;
            let stress = Quantity::relative(
                format!("{name}: sides free, stretch {stretch}, Cauchy stress"),
                "Pa",
                found[1],
                cauchy_pa,
            )
            .by("uniaxial stress of the law, by its closed form or a root of it");
            let width = Quantity::relative(
                format!("{name}: sides free, stretch {stretch}, sideways"),
                "",
                found[0],
                sideways,
            )
            .by("no stress at the sides");
            all.extend([stress.within(0.01, SLOW), width.within(0.01, SLOW)]);
        }
    }
    Ok(all)
}

/// Sideways stretch and mean Cauchy stress along, Pa.
fn pull(effort: &Effort, kinematics: Kinematics, stretch: f64) -> Result<[f64; 2], CaseError> {
    const CROSSINGS: f64 = 200.0;
    // The masses of a single cell's nodes are uneven, which turns the one frame of `body-frame`: 1.1 % of the stress.
    let mesh = box_mesh(DVec3::splat(SIDE_M), [2; 3], DVec3::splat(0.5 * SIDE_M))?;
    let face = |axis: usize, at_m: f64| nodes_where(&mesh, |x| (x[axis] - at_m).abs() < 1e-9);
    let only = |axis: usize| std::array::from_fn(|i| i == axis);
    let wave_m_s = (YOUNG_PA / DENSITY).sqrt();
    let duration_s = CROSSINGS * SIDE_M / wave_m_s;
    let speed_m_s = (stretch - 1.0) * SIDE_M / duration_s;
    let mut boundary = vec![moved(face(2, SIDE_M), DVec3::Z * speed_m_s, only(2))];
    boundary.extend((0..3).map(|axis| held(face(axis, 0.0), only(axis))));
    let right = face(0, SIDE_M);
    let mut stuff = material(DENSITY, YOUNG_PA, POISSON);
    stuff.damping_per_s = 0.5 * wave_m_s / SIDE_M;
    let mut block = body("block", mesh, stuff);
    block.boundary = boundary;
    block.motion = BodyMotion::Deformable(kinematics);
    let mut world = World::new(quiet_world(vec![block]))?;
    effort.run(&mut world, duration_s, |_, _| {})?;
    let stresses = world.element_stresses(0);
    let mean_pa = stresses.iter().map(|s| s.cauchy_pa.z_axis.z).sum::<f64>() / stresses.len() as f64;
    let widths_m = right.iter().map(|node| world.positions_m(0)[*node as usize].x);
    Ok([widths_m.sum::<f64>() / right.len() as f64 / SIDE_M, mean_pa])
}

/// A soft cube hits a wall at twice the speed of its waves, which turns elements inside out, and bounces off.
fn measure_crash(effort: &Effort) -> Result<Vec<Quantity>, CaseError> {
    let mut all = Vec::new();
    for (name, kinematics) in Kinematics::NAMED.into_iter().filter(|(_, k)| *k != Kinematics::BodyFrame) {
        let found = crash(effort, kinematics)?;
        let [inverted_then, inverted_after, balance, shape] = found;
        all.push(
            Quantity::absolute(
                format!("{name}: crash, most elements inside out at once"),
                "%",
                100.0 * inverted_then,
                0.0,
            )
            .by("how far the crash goes; none would be a smaller crash"),
        );
        let after = Quantity::absolute(
            format!("{name}: crash, elements inside out afterwards"),
            "%",
            100.0 * inverted_after,
            0.0,
        )
        .by("elements at rest have their shape");
        let kept = Quantity::absolute(
            format!("{name}: crash, largest error of the energy balance / initial"),
            "",
            balance,
            0.0,
        )
        .by("kinetic + strain + dissipated is constant (METHOD 9)");
        let volume =
            Quantity::relative(format!("{name}: crash, volume afterwards / before"), "", 1.0 + shape, 1.0)
                .by("elements at rest have their volume");
        if kinematics == Kinematics::NeoHookean {
            all.push(after.within(0.0, "the law has no other rest than the shape as given"));
            all.push(kept.within(0.02, "steps of 0.8 of the limit at strains above one"));
            all.push(volume.within(0.01, "what is left of the vibration"));
        } else {
            // Both have a rest inside out, or nearly so.
            all.extend([after, kept, volume]);
        }
    }
    Ok(all)
}

fn crash(effort: &Effort, kinematics: Kinematics) -> Result<[f64; 4], CaseError> {
    let cells = if effort.quick { 4 } else { 6 };
    let half_m = 0.5 * SIDE_M;
    let wall = fixed("wall", box_mesh(DVec3::new(1.0, 1.0, 0.1), [4, 4, 1], DVec3::NEG_Z * 0.05)?);
    let mesh = box_mesh(DVec3::splat(SIDE_M), [cells; 3], DVec3::Z * (half_m + 1e-3))?;
    let tets = mesh.tets.clone();
    let volume_m3 = SIDE_M.powi(3);
    let wave_m_s = (YOUNG_PA / DENSITY).sqrt();
    let mut stuff = material(DENSITY, YOUNG_PA, POISSON);
    stuff.damping_per_s = 0.1 * wave_m_s / SIDE_M;
    let mut cube = body("cube", mesh, stuff);
    cube.velocity_m_s = DVec3::NEG_Z * 2.0 * wave_m_s;
    cube.motion = BodyMotion::Deformable(kinematics);
    let mut setup = quiet_world(vec![cube, wall]);
    setup.time.free_travel = false;
    let mut world = World::new(setup)?;
    let start = world.sample();
    let volumes = |world: &World| -> Vec<f64> {
        let x = world.positions_m(0);
        tets.iter().map(|tet| signed_volume_m3(&tet.map(|node| x[node as usize]))).collect()
    };
    let inverted =
        |v: &[f64]| v.iter().filter(|volume| **volume < 0.0).count() as f64 / v.len().max(1) as f64;
    let (mut most, mut balance_j, mut step) = (0.0_f64, 0.0_f64, 0_u32);
    effort.run(&mut world, 60.0 * SIDE_M / wave_m_s, |world, _| {
        balance_j = balance_j.max((world.sample().balance_j() - start.balance_j()).abs());
        step += 1;
        if step.is_multiple_of(10) {
            most = most.max(inverted(&volumes(world)));
        }
    })?;
    let after = volumes(&world);
    let share = after.iter().sum::<f64>() / volume_m3 - 1.0;
    Ok([most, inverted(&after), balance_j / start.kinetic_j, share])
}
