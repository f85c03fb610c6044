//! How large the round-off of a world's balances is: what lies below is nothing that happens.

use super::body::Body;
use super::{BodySetup, Material, World};

/// Strains below this come from rounding: digits of positions, over the size of elements in the size of scenes.
const STRAIN: f64 = 1e-12;
/// Share of its distance from the origin by which the place of a body is not known.
const PLACE: f64 = 1e-13;

/// Sizes below which balances are nothing but round-off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RoundOff {
    /// Of energies, J.
    pub energy_j: f64,
    /// Of momenta, kg m/s.
    pub momentum_kg_m_s: f64,
}

impl World {
    /// Sizes below which the balances are nothing but round-off.
    #[must_use]
    pub fn round_off(&self) -> RoundOff {
        let gravity_m_s2 = self.setup.gravity_m_s2.length();
        let deformable = self.bodies.iter().zip(&self.setup.bodies).filter(|(body, _)| body.is_deformable());
        deformable.map(|(body, setup)| of_body(body, setup, gravity_m_s2)).fold(
            RoundOff::default(),
            |sum, own| RoundOff {
                energy_j: sum.energy_j + own.energy_j,
                momentum_kg_m_s: sum.momentum_kg_m_s + own.momentum_kg_m_s,
            },
        )
    }
}

/// A strain of the whole body, the waves that it makes, and the height of its place above the origin.
fn of_body(body: &Body, setup: &BodySetup, gravity_m_s2: f64) -> RoundOff {
    let mass_kg = body.reference.mass_kg;
    let speeds_m_s = setup.materials.iter().map(Material::bar_wave_speed_m_s);
    let wave_speed_m_s = speeds_m_s.fold(0.0, f64::max);
    let momentum_kg_m_s = mass_kg * wave_speed_m_s * STRAIN;
    let reach_m = body.reference.centre_m.length() + body.radius_m;
    // E V = m c^2.
    let strain_j = 0.5 * momentum_kg_m_s * wave_speed_m_s * STRAIN;
    RoundOff { energy_j: strain_j + mass_kg * gravity_m_s2 * reach_m * PLACE, momentum_kg_m_s }
}

#[cfg(test)]
mod tests {
    use crate::scene::Scene;
    use crate::sim::World;

    #[test]
    fn it_is_far_below_all_that_happens_and_above_what_is_found_at_rest() {
        let world = |name: &str| World::new(Scene::load(name, &[]).unwrap().setup).unwrap();
        let resting = world("pile-split");
        let (sample, round_off) = (resting.sample(), resting.round_off());
        assert!(sample.kinetic_j.abs().max(sample.strain_j.abs()) < round_off.energy_j, "{sample:?}");
        let mut falling = world("bounce");
        falling.step(1e-4).unwrap();
        let (sample, round_off) = (falling.sample(), falling.round_off());
        assert!(sample.kinetic_j > 100.0 * round_off.energy_j, "{} {round_off:?}", sample.kinetic_j);
        let momentum_kg_m_s = sample.linear_momentum_kg_m_s.length();
        assert!(momentum_kg_m_s > 100.0 * round_off.momentum_kg_m_s, "{momentum_kg_m_s} {round_off:?}");
    }
}
