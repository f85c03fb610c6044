//! Energy balance of shipped scenes: kinetic + strain + potential + dissipated = work done (METHOD 9).

use super::super::balance::{Balance, penetration};
use super::super::specimen::GRAVITY_M_S2;
use super::super::{CaseError, Effort, Outcome, Plot, Quantity};
use crate::scene::Scene;
use crate::sim::{Stage, World};

const QUICK: &[&str] = &["hammer-ground", "bounce", "bar-torn"];
const ALL: &[&str] = &[
    "hammer-ground",
    "hammer-table",
    "hammer-lamp",
    "cup-wall",
    "bounce",
    "stack",
    "bar-torn",
    "beam-notch",
    "cube-wall",
    "plate-tensile",
    "plate-mohr-coulomb",
    "plate-tresca",
];

pub(in crate::verify) fn measure(effort: &Effort) -> Result<Outcome, CaseError> {
    let mut all = vec![fall(effort)?];
    let mut plots = Vec::new();
    for name in if effort.quick { QUICK } else { ALL } {
        let scene = Scene::load(name, &[])?;
        let mut world = World::new(scene.setup)?;
        let mut balance = Balance::of(&world);
        let mut curves: [Vec<[f64; 2]>; 5] = Default::default();
        effort.run(&mut world, scene.description.duration_s, |world, report| {
            let s = world.sample();
            balance.follow(&s);
            let energies = [s.kinetic_j, s.strain_j, s.potential_j, s.dissipated_j, s.balance_j()];
            curves.iter_mut().zip(energies).for_each(|(curve, j)| curve.push([report.time_s, j]));
        })?;
        all.push(
            balance
                .quantity(name)
                .within(0.01, "steps of central differences; a quarter of the thesis's 3.67 % of its rods"),
        );
        all.push(penetration(name, &world).within(1e-3, "what passes leave, a thousandth of an element"));
        if *name == "hammer-ground" {
            let names = ["kinetic", "strain", "potential", "dissipated", "sum less work"];
            let plot = Plot::new("energy", "Energy of hammer-ground", ["time, s", "energy, J"]);
            plots
                .push(names.into_iter().zip(curves).fold(plot, |plot, (name, curve)| plot.with(name, curve)));
        }
    }
    Ok(Outcome { quantities: all, plots })
}

/// When the ball of `bounce` first touches the ground.
fn fall(effort: &Effort) -> Result<Quantity, CaseError> {
    const HEIGHT_M: f64 = 1.0;
    let scene = Scene::load("bounce", &[])?;
    let mut world = World::new(scene.setup)?;
    effort.run_while(&mut world, |_, report| report.stage != Stage::Beginning, 1.0)?;
    Ok(Quantity::relative(
        "bounce: time of the first touch",
        "s",
        world.time_s(),
        (2.0 * HEIGHT_M / GRAVITY_M_S2).sqrt(),
    )
    .by("sqrt(2 h/g)")
    .within(1e-9, "free travel and first touch are exact to round-off and a stated tolerance (METHOD 3)"))
}
