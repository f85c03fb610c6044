//! The step: free travel, beginning of collision, collision, end of collision (METHOD 3).

use super::body::Regime;
use super::broad::islands;
use super::collide::{ContactOutcome, ContactScene, penetration, renew_close, respond};
use super::elastic::StepContext;
use super::rest::{RestView, fall_asleep, is_near_mover, record, try_free_travel};
use super::touch::{Touch, first_touch, prescribed_positions};
use super::world::FreeInterval;
use super::{BodyMotion, SimError, Stage, StepReport, World};
use crate::contact::CollisionList;
use glam::DVec3;
use std::time::Instant;

/// Time, in crossings of the slowest body by a wave, in which the energy of an impact leaks away that no rebound
/// has fetched: a body that landed softly must not jump when it is pushed much later. A rebound comes after a few.
const IMPACT_CROSSINGS: f64 = 100.0;

/// Share of a time below which it is told from another.
const ROUNDING: f64 = 1e-12;

/// Number and length of the equal elastic steps, of at most `step_s`, in a time.
fn substeps(duration_s: f64, step_s: f64) -> (u32, f64) {
    let count = (duration_s / step_s * (1.0 - 1e-12)).ceil().max(1.0);
    (count as u32, duration_s / count)
}

/// What the islands did in one step, added up.
#[derive(Default)]
struct Collected {
    report: StepReport,
    outcomes: Vec<ContactOutcome>,
    impulse_sum_n_s: f64,
    spring_j: f64,
}

impl World {
    /// Advances by one step. Nothing happens once `limit_s` (absolute time) is reached.
    ///
    /// With an elastic body, a step is the elastic step of the slowest contact island (faster ones take
    /// several inside it). It ends where it ends, at most by itself beyond the limit: what happens does not depend on
    /// when somebody looks. Without, it is free travel up to the next touch or exactly the limit.
    ///
    /// # Errors
    /// [`SimError::NotFinite`] when the run blows up.
    pub fn step(&mut self, limit_s: f64) -> Result<StepReport, SimError> {
        if self.time_s >= limit_s {
            return Ok(StepReport { time_s: self.time_s, ..StepReport::default() });
        }
        let limit_s = limit_s.min(self.make_planned_changes()?);
        self.let_go();
        let started = Instant::now();
        let before = self.phases.counted_s();
        let was_colliding = !self.list.is_empty();
        let is_elastic = self.bodies.iter().any(|b| b.regime == Regime::Elastic);
        let mut report = if is_elastic { self.elastic_step()? } else { self.free_step(limit_s) };
        self.steps += 1;
        if was_colliding && self.list.is_empty() && is_elastic {
            report.stage = Stage::End;
        }
        report.time_s = self.time_s;
        self.last = report;
        // A free interval may end a rounding error before the limit: whoever asked for it looks now.
        if self.time_s >= limit_s * (1.0 - ROUNDING) {
            self.place_free_bodies();
        }
        let counted = self.phases.counted_s() - before;
        self.phases.other_s += started.elapsed().as_secs_f64() - counted;
        Ok(report)
    }

    /// Free travel to the limit, the interval's end or the first touch.
    fn free_step(&mut self, limit_s: f64) -> StepReport {
        let start_s = self.time_s;
        let is_moving = |b: &super::body::Body| matches!(b.regime, Regime::Free(_) | Regime::Kinematic);
        if !self.bodies.iter().any(is_moving) {
            self.time_s = limit_s;
            return StepReport { step_s: limit_s - start_s, stage: Stage::Resting, ..StepReport::default() };
        }
        let interval = self.free_interval.take().unwrap_or_else(|| self.begin_free_interval());
        let end_s = interval.touch.map_or(interval.end_s, |t| t.time_s.max(start_s));
        let stop_s = end_s.min(limit_s);
        let gravity = self.setup.gravity_m_s2;
        for (body, motion) in self.bodies.iter_mut().zip(&interval.motions) {
            if let Some(motion) = motion {
                body.regime = Regime::Free(motion.after(stop_s - interval.start_s, gravity));
            }
        }
        self.move_kinematic_bodies(stop_s);
        self.time_s = stop_s;
        let mut stage = Stage::Free;
        if stop_s < end_s {
            self.free_interval = Some(interval);
        } else if let Some(touch) = interval.touch {
            self.begin_collision(touch);
            stage = Stage::Beginning;
        }
        StepReport { step_s: stop_s - start_s, stage, ..StepReport::default() }
    }

    fn begin_free_interval(&self) -> FreeInterval {
        let (start_s, end_s) = (self.time_s, self.time_s + self.setup.time.free_interval_s);
        let motion = |b: &super::body::Body| if let Regime::Free(m) = b.regime { Some(m) } else { None };
        FreeInterval {
            start_s,
            end_s,
            touch: first_touch(&self.bodies, start_s, end_s, self.setup.gravity_m_s2),
            motions: self.bodies.iter().map(motion).collect(),
        }
    }

    /// Moves bodies in free and prescribed motion from the world's time to `end_s`.
    fn move_rigid_bodies(&mut self, end_s: f64) {
        let (start_s, gravity) = (self.time_s, self.setup.gravity_m_s2);
        for body in &mut self.bodies {
            if let Regime::Free(motion) = &mut body.regime {
                *motion = motion.after(end_s - start_s, gravity);
            }
        }
        self.move_kinematic_bodies(end_s);
    }

    fn move_kinematic_bodies(&mut self, end_s: f64) {
        for body in &mut self.bodies {
            if let (Regime::Kinematic, BodyMotion::Kinematic(motion)) = (body.regime, &body.motion) {
                body.position_m = prescribed_positions(body, motion, end_s);
            }
        }
    }

    /// Node positions and velocities of bodies in free travel are only written when somebody looks: at the limit of a
    /// step, or here in between. At the start they are where they were put.
    pub fn place_free_bodies(&mut self) {
        if self.time_s == 0.0 {
            return;
        }
        for body in &mut self.bodies {
            if let Regime::Free(motion) = body.regime {
                body.take_rigid_state(&motion);
            }
        }
    }

    /// The two bodies that touch, and whatever they rest on, deform from now on.
    fn begin_collision(&mut self, touch: Touch) {
        for body in touch.bodies {
            self.wake(body);
        }
    }

    /// Makes a free or sleeping body elastic.
    pub(super) fn wake(&mut self, index: usize) {
        self.free_interval = None;
        let body = &mut self.bodies[index];
        match body.regime {
            Regime::Free(motion) => {
                body.take_rigid_state(&motion);
                body.vibration_reference_j = 0.0;
            }
            Regime::Asleep => {}
            _ => return,
        }
        body.regime = Regime::Elastic;
        let context = StepContext { time_s: self.time_s, step_s: 0.0, gravity_m_s2: self.setup.gravity_m_s2 };
        // A waking body was finite when it fell asleep or took off; a blow-up shows in its first step.
        let _ = body.update_acceleration(&context);
        self.rest[index].disturb(self.time_s);
        self.rest[index].last_touch_step = self.steps;
    }

    /// One step of every island with an elastic body.
    fn elastic_step(&mut self) -> Result<StepReport, SimError> {
        let start_s = self.time_s;
        self.free_interval = None;
        let clock = Instant::now();
        let guess_s = self.smallest_step_s();
        self.wake_neighbours(guess_s);
        let groups = islands(&self.bodies, &self.broad.pairs);
        let steps_s: Vec<f64> = groups.iter().map(|g| self.island_step_s(g)).collect();
        let longest_s = steps_s.iter().copied().fold(0.0, f64::max);
        let shortest_s = steps_s.iter().copied().fold(f64::INFINITY, f64::min);
        let valid_s = self.broad.valid_for_s(&self.bodies).max(shortest_s);
        let mut end_s = start_s + longest_s.min(valid_s).min(self.setup.time.free_interval_s);
        let touch = self.free_touch(end_s);
        if let Some(touch) = touch {
            end_s = touch.time_s.max(start_s);
        }
        self.phases.detection_s += clock.elapsed().as_secs_f64();
        self.limit_pulls(end_s);
        let mut collected = Collected::default();
        let was_held = std::mem::take(&mut self.list);
        let mut held = was_held.keep(|body| self.bodies[body as usize].regime == Regime::Asleep);
        self.set_kinematic_velocities(end_s);
        if end_s > start_s {
            for (group, step_s) in groups.iter().zip(&steps_s) {
                let mut list = was_held.clone();
                self.advance_island(group, *step_s, end_s, &mut list, &mut collected)?;
                held.merge(list.keep(|body| group.contains(&(body as usize))));
            }
        } else {
            held = was_held;
        }
        self.move_rigid_bodies(end_s);
        self.list = held;
        self.time_s = end_s;
        self.finish(&mut collected, end_s - start_s);
        if let Some(touch) = touch {
            self.begin_collision(touch);
            collected.report.stage = Stage::Beginning;
        }
        self.let_cracks_grow()?;
        let duration_s = end_s - start_s;
        for (group, step_s) in groups.iter().zip(&steps_s) {
            self.settle(group, substeps(duration_s, *step_s).1);
        }
        Ok(collected.report)
    }

    /// Cracks grow where elastic bodies fail; what depends on their surfaces is renewed.
    fn let_cracks_grow(&mut self) -> Result<(), SimError> {
        let clock = Instant::now();
        for index in 0..self.bodies.len() {
            let body = &mut self.bodies[index];
            if body.breaking.is_none() || body.regime != Regime::Elastic {
                continue;
            }
            let context =
                StepContext { time_s: self.time_s, step_s: 0.0, gravity_m_s2: self.setup.gravity_m_s2 };
            let had_cracked = body.surface.has_cracked();
            let grown = body.let_cracks_grow(&context).map_err(|e| e.in_step(self.steps + 1))?;
            let Some((changes, numbers)) = grown else { continue };
            if had_cracked {
                self.broad.follow_cut(&self.bodies, index, &numbers, &changes.parents());
            } else {
                // Boxes of a cracked body are fattened less.
                self.broad.forget(index);
            }
            self.list.forget_numbers_of(index as u32);
            self.frame_parts[index].forget_surface();
            self.rest[index].disturb(self.time_s);
            self.fragments += changes.new_fragments.len();
        }
        self.phases.fracture_s += clock.elapsed().as_secs_f64();
        Ok(())
    }

    fn smallest_step_s(&self) -> f64 {
        let elastic = self.bodies.iter().filter(|b| b.regime == Regime::Elastic);
        elastic.map(|b| b.stable_step_s()).fold(f64::INFINITY, f64::min).min(self.setup.time.free_interval_s)
    }

    /// Renews the broad phase and wakes what an elastic body has come near, until nothing new is woken.
    fn wake_neighbours(&mut self, step_s: f64) {
        loop {
            self.broad.renew_bounds(&self.bodies, step_s);
            for (index, body) in self.bodies.iter_mut().enumerate() {
                // Nodes of bodies in free travel are only placed when something may meet them.
                if let (Regime::Free(motion), true) = (body.regime, self.broad.is_close(index)) {
                    body.take_rigid_state(&motion);
                }
            }
            self.broad.update(&self.bodies, self.time_s, step_s);
            let near = self.sleepers_near();
            if near.is_empty() {
                return;
            }
            near.into_iter().for_each(|b| self.wake(b));
        }
    }

    /// Free and sleeping bodies that a moving one has come near.
    fn sleepers_near(&self) -> Vec<usize> {
        let is_sleeping = |b: &usize| matches!(self.bodies[*b].regime, Regime::Free(_) | Regime::Asleep);
        let mut near: Vec<usize> =
            self.broad.pairs.iter().flat_map(|p| p.bodies).filter(is_sleeping).collect();
        near.sort_unstable();
        near.dedup();
        near
    }

    /// First touch of free bodies with others that do not deform, before `end_s`; looked for once per free
    /// interval, since nothing acts on them in between.
    fn free_touch(&mut self, end_s: f64) -> Option<Touch> {
        let regimes: Vec<u8> = self.bodies.iter().map(|b| b.regime.number()).collect();
        let is_valid = self.plan.regimes == regimes && end_s <= self.plan.until_s;
        if !is_valid {
            let until_s = (self.time_s + self.setup.time.free_interval_s).max(end_s);
            let touch = first_touch(&self.bodies, self.time_s, until_s, self.setup.gravity_m_s2);
            self.plan = super::world::FreePlan { regimes, until_s, touch };
        }
        self.plan.touch.filter(|t| t.time_s <= end_s)
    }

    /// Step of an island, s: a share of the stability limit of its worst body.
    fn island_step_s(&self, group: &[usize]) -> f64 {
        let time = &self.setup.time;
        let critical = group.iter().map(|b| self.bodies[*b].stable_step_s()).fold(f64::INFINITY, f64::min);
        let mut step_s = time.cfl * critical;
        if let super::ContactMethod::Penalty { stiffness_n_m } = self.setup.contact.method {
            let penalty_s = time.cfl * self.penalty_step_s(group, stiffness_n_m);
            step_s = (step_s.powi(-2) + penalty_s.powi(-2)).powf(-0.5);
        }
        step_s.min(time.max_step_s)
    }

    /// Stability limit that springs of this stiffness put on the lightest surface nodes, s. Factor 2: a node may be
    /// held by its own spring and, as a corner of a patch, by others' springs.
    fn penalty_step_s(&self, group: &[usize], stiffness_n_m: f64) -> f64 {
        let lightest_kg = group
            .iter()
            .map(|b| &self.bodies[*b])
            .flat_map(|b| b.surface.nodes.iter().map(|n| b.mass_kg[*n as usize]))
            .fold(f64::INFINITY, f64::min);
        2.0 / (2.0 * 2.0 * stiffness_n_m / lightest_kg).sqrt()
    }

    fn set_kinematic_velocities(&mut self, end_s: f64) {
        let duration_s = end_s - self.time_s;
        if duration_s <= 0.0 {
            return;
        }
        for body in &mut self.bodies {
            if let (Regime::Kinematic, BodyMotion::Kinematic(motion)) = (body.regime, &body.motion) {
                let end = prescribed_positions(body, motion, end_s);
                let ways = end.iter().zip(&body.position_m);
                body.velocity_m_s = ways.map(|(to, from)| (*to - *from) / duration_s).collect();
            }
        }
    }

    /// Takes an island to `end_s` in equal elastic steps.
    fn advance_island(
        &mut self,
        group: &[usize],
        step_s: f64,
        end_s: f64,
        list: &mut CollisionList,
        collected: &mut Collected,
    ) -> Result<(), SimError> {
        let duration_s = end_s - self.time_s;
        let (count, h) = substeps(duration_s, step_s);
        for substep in 0..count {
            let time_s = self.time_s + f64::from(substep + 1) * h;
            let context = StepContext { time_s, step_s: h, gravity_m_s2: self.setup.gravity_m_s2 };
            self.elastic_substep(group, &context, list, collected)?;
        }
        Ok(())
    }

    /// One elastic step of one island: predict, detect, respond, move, forces.
    fn elastic_substep(
        &mut self,
        group: &[usize],
        context: &StepContext,
        list: &mut CollisionList,
        collected: &mut Collected,
    ) -> Result<(), SimError> {
        let clock = Instant::now();
        for &b in group {
            self.bodies[b].kick_first_half(context);
        }
        let kicked = Instant::now();
        let outcome = self.collide(group, context, list);
        *list = CollisionList::of(&outcome.constraints, self.impact_left(group, context.step_s));
        let collided = Instant::now();
        for &b in group {
            let body = &mut self.bodies[b];
            body.drift(context.step_s);
            body.advance_frame(context.step_s);
            body.update_acceleration(context).map_err(|e| e.in_step(self.steps + 1))?;
            body.kick_second_half(context);
        }
        self.phases.elastic_s +=
            kicked.duration_since(clock).as_secs_f64() + collided.elapsed().as_secs_f64();
        self.phases.response_s += collided.duration_since(kicked).as_secs_f64();
        self.book(outcome, context, collected);
        Ok(())
    }

    /// Share of the stored energy of impacts that is left after a step.
    fn impact_left(&self, group: &[usize], step_s: f64) -> f64 {
        let crossing_s = group.iter().map(|b| self.bodies[*b].crossing_s()).fold(0.0, f64::max);
        (-step_s / (IMPACT_CROSSINGS * crossing_s)).exp()
    }

    fn collide(&mut self, group: &[usize], context: &StepContext, list: &CollisionList) -> ContactOutcome {
        let in_group = |b: &usize| group.binary_search(b).is_ok();
        let near = self.broad.pairs.iter_mut().filter(|p| p.bodies.iter().any(in_group));
        renew_close((&self.bodies, list), near, &self.setup.contact, context.step_s);
        let mut scene = ContactScene {
            bodies: &mut self.bodies,
            pairs: self.broad.pairs.iter().filter(|p| p.bodies.iter().any(in_group)).collect(),
            parameters: &self.setup.contact,
            list,
            step_s: context.step_s,
            gravity_m_s2: self.setup.gravity_m_s2.length(),
        };
        respond(&mut scene)
    }

    /// Adds an outcome to the balances, the log and the report.
    fn book(&mut self, outcome: ContactOutcome, context: &StepContext, collected: &mut Collected) {
        let report = &mut collected.report;
        report.elastic_steps += 1;
        if outcome.constraints.is_empty() {
            return;
        }
        let response = &outcome.response;
        self.contact_dissipated_j += response.dissipated_j;
        self.contact_work_j += response.prescribed_work_j;
        let pressing = || outcome.constraints.iter().filter(|c| c.impulse_n_s != DVec3::ZERO);
        let (depth_m, depth_ratio) = penetration(&self.bodies, &outcome.constraints);
        report.max_penetration_m = report.max_penetration_m.max(depth_m);
        report.max_penetration_ratio = report.max_penetration_ratio.max(depth_ratio);
        if pressing().next().is_some() {
            report.settling.include(&response.settling);
            let sum: f64 = pressing().map(|c| c.impulse_n_s.length()).sum();
            collected.impulse_sum_n_s += sum;
            for c in pressing() {
                self.log.record(c, context.time_s - context.step_s, context.step_s);
                record(&mut self.rest, c);
            }
            for body in pressing().flat_map(|c| c.bodies) {
                self.rest[body as usize].last_touch_step = self.steps;
            }
        }
        collected.spring_j += outcome.spring_j;
        collected.outcomes.push(outcome);
    }

    fn finish(&mut self, collected: &mut Collected, duration_s: f64) {
        let report = &mut collected.report;
        report.step_s = duration_s;
        let constraints = || collected.outcomes.iter().flat_map(|o| &o.constraints);
        let pressing = constraints().filter(|c| c.impulse_n_s != DVec3::ZERO).count();
        report.contact_pairs = pressing as u32;
        report.contact_force_n = if duration_s > 0.0 { collected.impulse_sum_n_s / duration_s } else { 0.0 };
        report.stage = if pressing > 0 { Stage::Collision } else { Stage::Vibrating };
        self.spring_j = collected.spring_j + self.list.stores().energy_j();
        self.marks = super::publish::marks(constraints(), duration_s);
        self.largest_penetration_ratio = self.largest_penetration_ratio.max(report.max_penetration_ratio);
    }

    /// Lets bodies of an island that have calmed down travel freely or sleep; `step_s` was its elastic step.
    fn settle(&mut self, group: &[usize], step_s: f64) {
        for &index in group {
            if !self.rest[index].is_due(self.time_s) {
                continue;
            }
            let mut tracker = std::mem::take(&mut self.rest[index]);
            let view = RestView {
                bodies: &self.bodies,
                time_s: self.time_s,
                step_s,
                gravity_m_s2: self.setup.gravity_m_s2.length(),
            };
            tracker.check(index, &view);
            let since_touch = self.steps - tracker.last_touch_step.min(self.steps);
            self.rest[index] = tracker;
            if self.setup.time.free_travel {
                let near = is_near_mover(index, &self.bodies, &self.broad.pairs);
                let tolerance = self.setup.time.vibration_tolerance;
                try_free_travel(&mut self.bodies[index], near, since_touch, tolerance);
            }
        }
        let rests = |b: &usize| self.bodies[*b].regime == Regime::Elastic && self.rest[*b].is_quiet();
        if self.setup.time.sleeping && group.iter().all(rests) {
            group.iter().for_each(|b| fall_asleep(&mut self.bodies[*b]));
        }
    }
}
