//! One element looked at closely.

use crate::fracture::Criterion;
use crate::sim::{BodyMotion, World};
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
    /// How its body moves, where that is rigid: elements mean nothing then.
    pub rigid: Option<RigidBody>,
}

/// A body that does not deform.
#[derive(Clone, Debug, PartialEq)]
pub struct RigidBody {
    /// Its prescribed velocity, m/s, and spin, rad/s, now; `None` for what never moves.
    pub motion: Option<(DVec3, DVec3)>,
    /// Coefficients of friction, each with whom.
    pub friction: Vec<(f64, String)>,
}

impl RigidBody {
    /// A body of the world; `None` for one that deforms.
    fn of(world: &World, body: usize) -> Option<Self> {
        let (setup, now_s) = (world.setup(), world.time_s());
        let motion = match &setup.bodies.get(body)?.motion {
            BodyMotion::Deformable(_) => return None,
            BodyMotion::Fixed => None,
            BodyMotion::Kinematic(motion) if (motion.start_s..motion.stop_s).contains(&now_s) => {
                Some((motion.velocity_m_s, motion.spin_rad_s))
            }
            BodyMotion::Kinematic(_) => Some((DVec3::ZERO, DVec3::ZERO)),
        };
        let mut friction: Vec<(f64, Vec<&str>)> = Vec::new();
        for pair in setup.contact.pair_friction.iter().filter(|pair| pair.bodies.contains(&body)) {
            // Some are still to come, some are gone.
            let is_there = |other: &usize| *other < world.body_count() && !world.is_removed(*other);
            let others = pair.bodies.into_iter().filter(|other| *other != body).filter(is_there);
            let names = others.map(|other| setup.bodies[other].name.as_str());
            match friction.iter_mut().find(|(known, _)| *known == pair.friction_coefficient) {
                Some((_, known)) => known.extend(names),
                None => friction.push((pair.friction_coefficient, names.collect())),
            }
        }
        friction.retain(|(_, names)| !names.is_empty());
        let with_rest = if friction.is_empty() { "all bodies" } else { "all others" };
        let in_words = |(coefficient, names): (f64, Vec<&str>)| match names.len() {
            0..=2 => (coefficient, names.join(", ")),
            count => (coefficient, format!("{count} bodies")),
        };
        let mut friction: Vec<(f64, String)> = friction.into_iter().map(in_words).collect();
        friction.push((setup.contact.friction_coefficient, with_rest.to_owned()));
        Some(Self { motion, friction })
    }
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
            rigid: RigidBody::of(world, body),
        })
    }
}
