//! Contact that changes on the way, said by names: numbers of bodies hang on who came in before.

use super::{BodySetup, ContactMethod, ContactParameters, PairFriction, SimError, World};

/// What changes; everything else stays as it is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContactChange {
    /// Friction coefficient of every pair that has none of its own.
    pub friction_coefficient: Option<f64>,
    /// Friction coefficients of one body with every other one, those that come later included.
    pub body_friction: Vec<(String, f64)>,
    /// Friction coefficients of pairs.
    pub pairs: Vec<([String; 2], f64)>,
    /// Whether bodies collide with themselves.
    pub self_collision: Option<bool>,
    /// See [`ContactParameters::rest_speed_m_s`].
    pub rest_speed_m_s: Option<Option<f64>>,
    /// Enforcement.
    pub method: Option<ContactMethod>,
}

impl ContactChange {
    /// What leads from `then` to `now`, where bodies have these names. A common friction of all pairs of `ground`, if
    /// there is one, holds for whoever comes later as well.
    #[must_use]
    pub fn between(
        then: &ContactParameters,
        now: &ContactParameters,
        names: &[String],
        ground: Option<usize>,
    ) -> Self {
        let mut change = Self {
            friction_coefficient: differing(then.friction_coefficient, now.friction_coefficient),
            self_collision: differing(then.self_collision, now.self_collision),
            rest_speed_m_s: differing(then.rest_speed_m_s, now.rest_speed_m_s),
            method: differing(then.method, now.method),
            ..Self::default()
        };
        let new = |pair: &&PairFriction| !then.pair_friction.contains(pair);
        let with_ground = |pair: &&PairFriction| ground.is_some_and(|ground| pair.bodies.contains(&ground));
        let mut of_ground =
            now.pair_friction.iter().filter(with_ground).map(|pair| pair.friction_coefficient);
        let common = of_ground.next().filter(|first| of_ground.all(|other| other == *first));
        let is_ground_new = now.pair_friction.iter().filter(with_ground).any(|pair| new(&pair));
        let common = common.filter(|_| is_ground_new);
        if let (Some(friction), Some(name)) = (common, ground.and_then(|ground| names.get(ground))) {
            change.body_friction.push((name.clone(), friction));
        }
        for pair in now.pair_friction.iter().filter(new) {
            let [a, b] = pair.bodies.map(|body| names.get(body).cloned());
            if let (Some(a), Some(b), false) = (a, b, common.is_some() && with_ground(&pair)) {
                change.pairs.push(([a, b], pair.friction_coefficient));
            }
        }
        change
    }

    /// Whether it changes anything.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Adds a change that follows at the same time.
    pub fn merge(&mut self, next: Self) {
        self.friction_coefficient = next.friction_coefficient.or(self.friction_coefficient);
        self.self_collision = next.self_collision.or(self.self_collision);
        self.rest_speed_m_s = next.rest_speed_m_s.or(self.rest_speed_m_s);
        self.method = next.method.or(self.method);
        for (name, friction) in next.body_friction {
            self.body_friction.retain(|(known, _)| *known != name);
            self.pairs.retain(|(pair, _)| !pair.contains(&name));
            self.body_friction.push((name, friction));
        }
        for (pair, friction) in next.pairs {
            self.pairs.retain(|(known, _)| *known != pair);
            self.pairs.push((pair, friction));
        }
    }
}

fn differing<T: PartialEq>(then: T, now: T) -> Option<T> {
    (now != then).then_some(now)
}

/// A body that comes in later.
#[derive(Clone, Debug, PartialEq)]
pub struct Entrance {
    /// The body.
    pub body: BodySetup,
    /// Its friction coefficients with bodies that are there by then.
    pub friction: Vec<(String, f64)>,
}

impl ContactParameters {
    fn set_pair(&mut self, a: usize, b: usize, friction_coefficient: f64) {
        let bodies = [a.min(b), a.max(b)];
        match self.pair_friction.iter_mut().find(|pair| pair.bodies == bodies) {
            Some(pair) => pair.friction_coefficient = friction_coefficient,
            None => self.pair_friction.push(PairFriction { bodies, friction_coefficient }),
        }
    }
}

impl World {
    /// Makes the planned changes that are due. Whoever changes something by hand does so after them, as it will be when
    /// his change is planned.
    ///
    /// # Errors
    /// [`SimError::Setup`] from a body that comes in and is unsound.
    pub fn catch_up(&mut self) -> Result<(), SimError> {
        self.make_planned_changes().map(drop)
    }

    /// Changes how bodies meet, from the next step on.
    ///
    /// # Errors
    /// [`SimError::Setup`] when a parameter is unsound; the world keeps its parameters then.
    pub fn change_contact(&mut self, change: &ContactChange) -> Result<(), SimError> {
        let mut contact = self.setup.contact.clone();
        contact.friction_coefficient = change.friction_coefficient.unwrap_or(contact.friction_coefficient);
        contact.self_collision = change.self_collision.unwrap_or(contact.self_collision);
        contact.rest_speed_m_s = change.rest_speed_m_s.unwrap_or(contact.rest_speed_m_s);
        contact.method = change.method.unwrap_or(contact.method);
        for (name, friction) in &change.body_friction {
            let Some(body) = self.body_called(name) else { continue };
            let others = (0..self.bodies.len()).filter(|other| *other != body);
            others.for_each(|other| contact.set_pair(body, other, *friction));
        }
        for ([a, b], friction) in &change.pairs {
            if let (Some(a), Some(b)) = (self.body_called(a), self.body_called(b)) {
                contact.set_pair(a, b, *friction);
            }
        }
        self.set_contact_parameters(contact)?;
        for (name, friction) in &change.body_friction {
            self.body_friction.retain(|(known, _)| known != name);
            self.body_friction.push((name.clone(), *friction));
        }
        Ok(())
    }

    /// Adds a body at the present time, with its friction; see [`Self::add_body`].
    ///
    /// # Errors
    /// As [`Self::add_body`].
    pub fn enter(&mut self, entrance: &Entrance) -> Result<usize, SimError> {
        let index = self.add_body(entrance.body.clone())?;
        let changed = self.body_friction.clone();
        for (other, friction) in entrance.friction.iter().chain(&changed) {
            if let Some(other) = self.body_called(other).filter(|other| *other != index) {
                self.setup.contact.set_pair(other, index, *friction);
            }
        }
        Ok(index)
    }

    fn body_called(&self, name: &str) -> Option<usize> {
        self.bodies.iter().position(|body| body.name == name)
    }
}
