//! Nodes that the response has thrown about: how far their ways may change after all.

/// Of two bodies (or of one with itself, twice): by how much the ways of their nodes in the step may differ, once the response is
/// done, from those that their present velocities tell.
#[derive(Clone, Debug)]
pub struct ThrownNodes {
    /// What is reckoned with for two nodes that have hardly been thrown, m.
    slack_m: f64,
    /// By body and node; empty while no node has been thrown.
    nodes: [Vec<Thrown>; 2],
}

#[derive(Clone, Copy, Debug)]
struct Thrown {
    /// Change of way since the start of the response that the looks so far reckon with, m.
    allowed_m: f64,
    /// Change of way so far, m.
    change_m: f64,
    /// Whether it is more than was allowed at the last look.
    is_due: bool,
}

impl Thrown {
    /// What it may still change of its way, m: from the way of its present velocity, which has changed already.
    fn slack_m(&self) -> f64 {
        self.allowed_m + self.change_m
    }
}

impl ThrownNodes {
    /// No node has been thrown; two of them may come nearer to each other by `slack_m`.
    #[must_use]
    pub fn none(slack_m: f64) -> Self {
        Self { slack_m, nodes: [Vec::new(), Vec::new()] }
    }

    /// Takes note of what the response has done so far: `changes_m` gives node and change of way (m) of both bodies, each of which
    /// has `node_counts` nodes. What it has told of once it tells of again. Returns whether any change is larger than allowed; from
    /// then on twice as much is.
    pub fn follow(&mut self, changes_m: [&[(u32, f64)]; 2], node_counts: [usize; 2]) -> bool {
        let most_m = |of: &[(u32, f64)]| of.iter().map(|x| x.1).fold(0.0, f64::max);
        let has_thrown = !self.nodes[0].is_empty();
        if !has_thrown && changes_m.iter().map(|of| most_m(of)).sum::<f64>() <= self.slack_m {
            return false;
        }
        let still = Thrown { allowed_m: 0.5 * self.slack_m, change_m: 0.0, is_due: false };
        let mut is_any_due = false;
        for ((nodes, changes_m), count) in self.nodes.iter_mut().zip(changes_m).zip(node_counts) {
            nodes.resize(count, still);
            for (node, change_m) in changes_m {
                let node = &mut nodes[*node as usize];
                node.change_m = *change_m;
                node.is_due = *change_m > node.allowed_m;
                if node.is_due {
                    node.allowed_m = 2.0 * change_m;
                    is_any_due = true;
                }
            }
        }
        is_any_due
    }

    /// Whether a node has to be looked at again.
    pub(super) fn is_due(&self, side: usize, node: u32) -> bool {
        self.nodes[side].get(node as usize).is_some_and(|node| node.is_due)
    }

    /// What a node alone may still change of its way, m.
    pub(super) fn of_node_m(&self, side: usize, node: u32) -> f64 {
        self.nodes[side].get(node as usize).map_or(0.5 * self.slack_m, Thrown::slack_m)
    }

    /// By how much features with these nodes of the body `side` and of the other may come nearer to each other, m.
    pub(super) fn slack_m(&self, side: usize, own: &[u32], other: &[u32]) -> f64 {
        let most_m = |side: usize, nodes: &[u32]| {
            nodes.iter().map(|node| self.of_node_m(side, *node)).fold(0.0, f64::max)
        };
        if self.nodes[0].is_empty() { self.slack_m } else { most_m(side, own) + most_m(1 - side, other) }
    }

    /// The most that [`Self::slack_m`] is for any features, m.
    pub(super) fn most_m(&self) -> f64 {
        if self.nodes[0].is_empty() {
            return self.slack_m;
        }
        let most_m = |nodes: &Vec<Thrown>| nodes.iter().map(Thrown::slack_m).fold(0.0, f64::max);
        self.nodes.iter().map(most_m).sum()
    }
}
