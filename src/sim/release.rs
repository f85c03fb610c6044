//! The opening of a crack: what held its faces together lets go over the time in which the crack runs on by about one
//! element, not at once.
//!
//! At the instant of a cut nothing moves on otherwise than before: every node of the changed elements is held by
//! the force that gives it the acceleration it had, equal and opposite over the twins of a node. These forces then fade.
//! They are the cohesion of the crack's process zone, which the mesh does not resolve, and the energy they take from
//! the opening faces is what breaking costs; it is booked as dissipated. Letting go at once would throw that energy into the
//! highest modes of the mesh, where central differences tell energies badly and from where it breaks what is sound.

use glam::DVec3;

/// Forces of one instant of cracking, which fade.
#[derive(Clone, Debug, PartialEq)]
struct Release {
    from_s: f64,
    duration_s: f64,
    /// By node, N.
    forces_n: Vec<(u32, DVec3)>,
    /// Share of the forces at the start and at the end of the last step.
    shares: [f64; 2],
}

/// All cracks that are opening in a body.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Releases {
    list: Vec<Release>,
}

impl Releases {
    /// Adds forces, by node in N, that fade from now on.
    pub fn add(&mut self, time_s: f64, duration_s: f64, forces_n: Vec<(u32, DVec3)>) {
        if duration_s > 0.0 && !forces_n.is_empty() {
            self.list.push(Release { from_s: time_s, duration_s, forces_n, shares: [1.0; 2] });
        }
    }

    /// Adds the forces as they are at a time to `sum_n`, one entry per node; those that have faded are forgotten
    /// a step later.
    pub fn advance(&mut self, time_s: f64, sum_n: &mut [DVec3]) {
        self.list.retain(|release| release.shares != [0.0; 2]);
        for release in &mut self.list {
            let share = fading((time_s - release.from_s) / release.duration_s);
            release.shares = [release.shares[1], share];
            for (node, force_n) in &release.forces_n {
                sum_n[*node as usize] += *force_n * share;
            }
        }
    }

    /// The forces on a node as they are now, N.
    pub fn force_n(&self, node: u32) -> DVec3 {
        let of = |release: &Release| -> DVec3 {
            let at_node = release.forces_n.iter().filter(|(n, _)| *n == node);
            at_node.map(|(_, force_n)| *force_n * release.shares[1]).sum()
        };
        self.list.iter().map(of).sum()
    }

    /// Work of the forces over the last step, in which the nodes moved with `velocities_m_s`, J.
    pub fn work_j(&self, velocities_m_s: &[DVec3], step_s: f64) -> f64 {
        let of = |release: &Release| -> f64 {
            let power = |(node, force): &(u32, DVec3)| force.dot(velocities_m_s[*node as usize]);
            let mean_share = 0.5 * (release.shares[0] + release.shares[1]);
            mean_share * step_s * release.forces_n.iter().map(power).sum::<f64>()
        };
        self.list.iter().map(of).sum()
    }

    /// A node that has been doubled shares its forces with its twin, which takes `share` of them.
    pub fn share_with_twin(&mut self, node: u32, twin: u32, share: f64) {
        for release in &mut self.list {
            let Some(at) = release.forces_n.iter().position(|(n, _)| *n == node) else { continue };
            let force_n = release.forces_n[at].1;
            release.forces_n[at].1 = force_n * (1.0 - share);
            release.forces_n.push((twin, force_n * share));
        }
    }
}

/// From 1 at 0 to 0 at 1, smooth at both ends.
fn fading(progress: f64) -> f64 {
    let x = progress.clamp(0.0, 1.0);
    1.0 - x * x * (3.0 - 2.0 * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_fade_do_their_work_and_are_forgotten() {
        let mut releases = Releases::default();
        releases.add(1.0, 2.0, vec![(0, DVec3::X * 3.0), (1, DVec3::X * -3.0)]);
        let velocities_m_s = [DVec3::X * -0.5, DVec3::X * 0.5];
        let (steps, mut work_j) = (1000, 0.0);
        for step in 1..=steps {
            let mut sum_n = [DVec3::ZERO; 2];
            releases.advance(1.0 + 2.0 * f64::from(step) / f64::from(steps), &mut sum_n);
            assert!((sum_n[0] + sum_n[1]).length() < 1e-15);
            work_j += releases.work_j(&velocities_m_s, 2.0 / f64::from(steps));
        }
        // Half of what constant forces would have done on ways of one metre each.
        assert!((work_j + 0.5 * 3.0 * 2.0).abs() < 1e-6, "{work_j}");
        for _ in 0..2 {
            let mut sum_n = [DVec3::ZERO; 2];
            releases.advance(4.0, &mut sum_n);
            assert_eq!(sum_n, [DVec3::ZERO; 2]);
        }
        assert!(releases.list.is_empty());
    }
}
