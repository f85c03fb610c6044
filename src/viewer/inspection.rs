//! One element looked at closely.

use crate::fracture::Criterion;
use crate::sim::World;
use glam::{DMat3, DVec3};

/// What there is to know of an element now.
#[derive(Clone, Debug, PartialEq)]
pub struct Inspection {
    /// Name of its body.
    pub body: String,
    /// Its number in it.
    pub element: u32,
    /// Material.
    pub material: String,
    /// Fragment it belongs to; `None` for what cannot break.
    pub fragment: Option<u32>,
    /// Cauchy stress, Pa, tension positive.
    pub cauchy_pa: DMat3,
    /// Principal stresses, Pa, largest first.
    pub principal_pa: DVec3,
    /// Failure index: 0 unstressed, 1 fails; `None` for what cannot break.
    pub failure_index: Option<f64>,
    /// When it fails.
    pub criterion: Option<Criterion>,
}

impl Inspection {
    /// An element of a body; `None` when there is none.
    #[must_use]
    pub fn of(world: &World, body: usize, element: u32) -> Option<Self> {
        if body >= world.body_count() || world.is_removed(body) {
            return None;
        }
        let stress = *world.element_stresses(body).get(element as usize)?;
        let material = world.material_of(body, element)?;
        Some(Self {
            body: world.setup().bodies[body].name.clone(),
            element,
            material: material.name.clone(),
            fragment: world.fragment_of_element(body).get(element as usize).copied(),
            cauchy_pa: stress.cauchy_pa,
            principal_pa: stress.principal_pa,
            failure_index: world.failure_indices(body).get(element as usize).copied(),
            criterion: material.fracture.clone(),
        })
    }
}
