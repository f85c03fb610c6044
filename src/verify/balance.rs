//! What every run is held to: its energy balances, and nothing goes deep into anything.

use super::Quantity;
use crate::sim::{Sample, World};

/// How well the energy of a world balances on its way.
pub(super) struct Balance {
    start_j: f64,
    error_j: f64,
    most_j: f64,
}

impl Balance {
    /// From the present moment of a world on.
    pub fn of(world: &World) -> Self {
        Self { start_j: world.sample().balance_j(), error_j: 0.0, most_j: 0.0 }
    }

    /// Takes a later moment in.
    pub fn follow(&mut self, s: &Sample) {
        self.error_j = self.error_j.max((s.balance_j() - self.start_j).abs());
        self.most_j = self.most_j.max(s.kinetic_j).max(s.external_work_j).max(s.potential_j.abs());
    }

    /// Largest error over the largest energy, of a run of this name.
    pub fn quantity(&self, run: &str) -> Quantity {
        let name = format!("{run}: largest error of the balance / largest energy");
        Quantity::absolute(name, "", self.error_j / self.most_j, 0.0)
            .by("kinetic + strain + potential + dissipated - work is constant (METHOD 9)")
    }
}

/// Deepest penetration over the size of elements until now, in a run of this name.
pub(super) fn penetration(run: &str, world: &World) -> Quantity {
    let name = format!("{run}: deepest penetration / element");
    Quantity::absolute(name, "", world.largest_penetration_ratio(), 0.0).by("no penetration (METHOD 5)")
}
