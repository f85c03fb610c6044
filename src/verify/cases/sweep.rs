//! Scenes that break, at any criterion and at strengths from a tenth to ten times their own: whatever a user chooses, the run
//! comes to its end, its energy balances and nothing goes through anything.

use super::super::balance::{Balance, penetration};
use super::super::{CaseError, Effort, Outcome, Quantity};
use crate::fracture::{Criterion, Strength};
use crate::mesh::bounds_m;
use crate::scene::Scene;
use crate::scene::description::GROUND;
use crate::sim::World;
use glam::DVec3;
use rayon::prelude::*;

/// Strengths over the scene's own.
const FACTORS: [f64; 3] = [0.1, 1.0, 10.0];
const FRICTION_ANGLE_RAD: f64 = std::f64::consts::FRAC_PI_6;

/// Runs a built-in scene fifteen times; with little effort only at its own strengths.
pub(in crate::verify) fn measure(effort: &Effort, scene: &str) -> Result<Outcome, CaseError> {
    let runs: Vec<Run> = runs(scene, effort.quick)
        .filter(|run| effort.only.is_none_or(|only| run.name().contains(only)))
        .collect();
    let measured: Result<Vec<_>, _> = runs.par_iter().map(|run| run.measure(effort)).collect();
    Ok(measured?.concat().into())
}

/// The names of the runs.
pub(in crate::verify) fn names(is_quick: bool) -> Vec<String> {
    runs("", is_quick).map(|run| run.name()).collect()
}

fn runs(scene: &str, is_quick: bool) -> impl Iterator<Item = Run<'_>> {
    let factors = if is_quick { &FACTORS[1..2] } else { &FACTORS };
    factors
        .iter()
        .flat_map(move |factor| criteria(1.0).map(|(criterion, _)| Run { scene, criterion, factor: *factor }))
}

/// The five criteria at a strength.
fn criteria(strength_pa: f64) -> [(&'static str, Strength); 5] {
    let friction_angle_rad = FRICTION_ANGLE_RAD;
    [
        ("tensile", Strength::Tensile { tensile_strength_pa: strength_pa }),
        ("Tresca", Strength::Tresca { shear_strength_pa: strength_pa }),
        ("von Mises", Strength::VonMises { shear_strength_pa: strength_pa }),
        ("Mohr-Coulomb", Strength::MohrCoulomb { cohesion_pa: strength_pa, friction_angle_rad }),
        ("Drucker-Prager", Strength::DruckerPrager { cohesion_pa: strength_pa, friction_angle_rad }),
    ]
}

/// One scene under one criterion at one strength.
struct Run<'a> {
    scene: &'a str,
    criterion: &'static str,
    factor: f64,
}

impl Run<'_> {
    /// What takes the place of a material's criterion.
    fn instead_of(&self, own: &Criterion) -> Option<Criterion> {
        let strength_pa = self.factor * first_strength_pa(own)?;
        let (_, strength) = criteria(strength_pa).into_iter().find(|(name, _)| *name == self.criterion)?;
        Criterion::single(strength).ok()
    }

    fn name(&self) -> String {
        format!("{} x {}", self.criterion, self.factor)
    }

    fn measure(&self, effort: &Effort) -> Result<Vec<Quantity>, CaseError> {
        let mut scene = Scene::load(self.scene, &[])?;
        for material in scene.setup.bodies.iter_mut().flat_map(|body| &mut body.materials) {
            if let Some(own) = &material.fracture {
                material.fracture = self.instead_of(own);
            }
        }
        let duration_s = scene.description.duration_s;
        let ground = scene.setup.bodies.iter().position(|body| body.name == GROUND);
        let mut world = World::new(scene.setup)?;
        let mut balance = Balance::of(&world);
        let mut told_tenths = 0;
        let ran = effort.run(&mut world, duration_s, |world, _| {
            let sample = world.sample();
            balance.follow(&sample);
            let tenths = (10.0 * world.time_s() / duration_s) as u32;
            if tenths > told_tenths && tenths < 10 {
                told_tenths = tenths;
                let (percent, steps) = (10 * tenths, world.steps());
                self.tell(effort, &format!("{percent} % after {steps} steps, {} pieces", sample.fragments));
            }
        });
        // A run that breaks off is a result like others; that somebody wants an end is not.
        if let Err(CaseError::Stopped) = ran {
            return Err(CaseError::Stopped);
        }
        let run = self.name();
        let fragments = world.sample().fragments as f64;
        let mut all = vec![
            Quantity::relative(
                format!("{run}: time reached / duration"),
                "",
                world.time_s() / duration_s,
                1.0,
            )
            .by("a run comes to its end (METHOD 8)")
            .within(1e-2, "the last step may go a little beyond the end"),
            Quantity::absolute(format!("{run}: fragments"), "", fragments, 0.0).by("shown only"),
            balance.quantity(&run).within(0.01, "of all that breaks, as METHOD 8 asks for"),
            penetration(&run, &world).within(
                1e-2,
                "a hundredth of an element is far from going through; `scenes` holds a thousandth",
            ),
        ];
        if let Some(depth) = ground.and_then(|ground| depth_in_ground(&world, ground)) {
            let name = format!("{run}: deepest node below the ground / its thickness");
            all.push(
                Quantity::absolute(name, "", depth, 0.0)
                    .by("no fragment falls through the ground (METHOD 8)")
                    .within(1e-3, "what was pressed in a little may be, what fell through is not"),
            );
        }
        self.tell(effort, &told(&world, duration_s, &all));
        Ok(all)
    }

    /// A line on this run, for whoever waits for it.
    fn tell(&self, effort: &Effort, what: &str) {
        (effort.tell)(&format!("{}, {}: {what}", self.scene, self.name()));
    }
}

/// How a run ended, so that nobody has to wait for the others to learn it.
fn told(world: &World, duration_s: f64, quantities: &[Quantity]) -> String {
    let short: Vec<_> = quantities
        .iter()
        .filter(|quantity| !quantity.passes())
        .map(|quantity| format!("{} {:.1e}", quantity.name, quantity.value))
        .collect();
    let verdict =
        if short.is_empty() { "passes".to_owned() } else { format!("falls short: {}", short.join("; ")) };
    format!(
        "{} of {duration_s} s, {} pieces after {} steps; {verdict}",
        world.time_s(),
        world.sample().fragments,
        world.steps()
    )
}

/// The strength that a criterion asks for first, Pa; `None` for a formula.
fn first_strength_pa(criterion: &Criterion) -> Option<f64> {
    match criterion.rules().first()?.strength {
        Strength::Tensile { tensile_strength_pa: pa }
        | Strength::Tresca { shear_strength_pa: pa }
        | Strength::VonMises { shear_strength_pa: pa }
        | Strength::MohrCoulomb { cohesion_pa: pa, .. }
        | Strength::DruckerPrager { cohesion_pa: pa, .. } => Some(pa),
        Strength::Formula(_) => None,
    }
}

/// How deep the lowest node within the ground's borders is under its upper face, over the thickness of the ground.
fn depth_in_ground(world: &World, ground: usize) -> Option<f64> {
    let (low, high) = bounds_m(world.positions_m(ground))?;
    let is_over = |x: &&DVec3| (low.x..=high.x).contains(&x.x) && (low.y..=high.y).contains(&x.y);
    let others = (0..world.body_count()).filter(|body| *body != ground);
    let nodes = others.flat_map(|body| world.positions_m(body)).filter(is_over);
    Some(nodes.map(|x| high.z - x.z).fold(0.0, f64::max) / (high.z - low.z))
}
