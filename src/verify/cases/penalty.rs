//! Penalty springs against Lagrange multipliers on one scene, over four decades of stiffness (METHOD 5).

use super::super::{CaseError, Effort, Outcome, Plot, Quantity, Scale};
use super::rods::{self, Collision, collide};
use crate::scene::Scene;
use crate::sim::ContactMethod;

pub(in crate::verify) fn measure(effort: &Effort) -> Result<Outcome, CaseError> {
    let exponents: &[i32] = if effort.quick { &[6, 8, 10] } else { &[6, 7, 8, 9, 10] };
    let ours = rods_by(effort, None)?;
    let mut all = vec![
        penetration("Lagrange", &ours)
            .by("no penetration (METHOD 5)")
            .within(1e-3, "what passes leave, a thousandth of an element"),
        length("Lagrange", &ours).within(0.0227, "the thesis's own error"),
        Quantity::relative("Lagrange: shortest step in contact / stable step", "", ours.contact_step, 1.0)
            .by("contact does not reduce the stable step (METHOD 5)")
            .within(1e-9, "the steps are those of the bodies themselves; rounding"),
    ];
    let mut deeper = f64::INFINITY;
    let mut curves: [Vec<[f64; 2]>; 3] = Default::default();
    for exponent in exponents {
        let stiffness_n_m = 10.0_f64.powi(*exponent);
        let found = rods_by(effort, Some(stiffness_n_m))?;
        let name = format!("penalty 1e{exponent} N/m");
        deeper = deeper.min(found.penetration);
        all.extend([penetration(&name, &found), length(&name, &found), step(&name, &found, &ours)]);
        all.push(
            Quantity::relative(format!("{name}: peak force / Lagrange's"), "", found.peak_n, ours.peak_n)
                .by("our own run with multipliers"),
        );
        let energy = Quantity::absolute(
            format!("{name}: largest energy error / initial"),
            "",
            found.energy_error,
            0.0,
        )
        .by("conservation of energy");
        // Soft springs take a large part of the energy, and what they hold counts as of the start of a step.
        let is_stiffest = Some(exponent) == exponents.last();
        all.push(if is_stiffest {
            energy.within(0.0367, "the thesis's own error of its rods")
        } else {
            energy
        });
        let values = [
            found.penetration,
            (found.length_s / rods::theory_length_s() - 1.0).abs(),
            found.steps as f64 / ours.steps as f64,
        ];
        curves.iter_mut().zip(values).for_each(|(curve, value)| curve.push([stiffness_n_m, value]));
    }
    all.push(
        Quantity::absolute(
            "Lagrange's penetration / the least of penalty",
            "",
            ours.penetration / deeper,
            0.0,
        )
        .by("METHOD 5: what the thesis argues for")
        .within(1.0, "multipliers go in less than springs of any stiffness"),
    );
    let names = ["penetration / element", "error of the length", "steps / Lagrange's"];
    let plot = Plot::new("penalty", "Penalty springs over their stiffness", ["stiffness, N/m", "see legend"])
        .scaled([Scale::Log, Scale::Log]);
    let plot = names.into_iter().zip(curves).fold(plot, |plot, (name, curve)| plot.with(name, curve));
    let least = 10.0_f64.powi(exponents[0]);
    let most = 10.0_f64.powi(exponents[exponents.len() - 1]);
    let line = vec![[least, ours.penetration], [most, ours.penetration]];
    Ok(Outcome { quantities: all, plots: vec![plot.with("penetration / element, Lagrange", line)] })
}

/// The shipped rods, by multipliers or by springs of a stiffness, N/m.
fn rods_by(effort: &Effort, stiffness_n_m: Option<f64>) -> Result<Collision, CaseError> {
    let mut setup = Scene::load("rods-collision", &[])?.setup;
    if let Some(stiffness_n_m) = stiffness_n_m {
        setup.contact.method = ContactMethod::Penalty { stiffness_n_m };
    }
    collide(effort, setup)
}

fn penetration(name: &str, found: &Collision) -> Quantity {
    Quantity::absolute(format!("{name}: deepest penetration / element"), "", found.penetration, 0.0)
        .by("no penetration")
}

fn length(name: &str, found: &Collision) -> Quantity {
    Quantity::relative(
        format!("{name}: length of the collision"),
        "s",
        found.length_s,
        rods::theory_length_s(),
    )
    .by("2 L sqrt(rho/E) (METHOD 8, V1)")
}

fn step(name: &str, found: &Collision, ours: &Collision) -> Quantity {
    Quantity::relative(format!("{name}: steps"), "", found.steps as f64, ours.steps as f64)
        .by("steps with multipliers")
}
