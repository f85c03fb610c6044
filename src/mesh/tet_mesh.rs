//! The plain data of a tetrahedral mesh.

use glam::DVec3;

/// A tetrahedral mesh in its reference position, SI units.
///
/// Every tetrahedron `[a, b, c, d]` is right-handed: `(b-a) x (c-a) . (d-a) > 0`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TetMesh {
    /// Node positions, metres.
    pub nodes_m: Vec<DVec3>,
    /// Corner node indices of each tetrahedron.
    pub tets: Vec<[u32; 4]>,
    /// Region of each tetrahedron, an index into `region_names`; same length as `tets`.
    pub regions: Vec<u32>,
    /// Names of the regions (`"head"`, `"handle"`, or a mesh file's tag as text); at least one.
    pub region_names: Vec<String>,
}

impl TetMesh {
    /// A mesh of one region called `"all"`.
    #[must_use]
    pub fn with_one_region(nodes_m: Vec<DVec3>, tets: Vec<[u32; 4]>) -> Self {
        let regions = vec![0; tets.len()];
        Self { nodes_m, tets, regions, region_names: vec!["all".to_owned()] }
    }

    /// The four corner positions of tetrahedron `index`, metres.
    #[must_use]
    pub fn corners_m(&self, index: usize) -> [DVec3; 4] {
        self.tets[index].map(|node| self.nodes_m[node as usize])
    }

    /// Sum of the tetrahedra's volumes, cubic metres.
    #[must_use]
    pub fn volume_m3(&self) -> f64 {
        (0..self.tets.len()).map(|index| signed_volume_m3(&self.corners_m(index))).sum()
    }

    /// Smallest and largest coordinates over all nodes, metres; `None` without nodes.
    #[must_use]
    pub fn bounds_m(&self) -> Option<(DVec3, DVec3)> {
        bounds_m(&self.nodes_m)
    }
}

/// Lowest and highest corner of the box around points, m; `None` without any.
#[must_use]
pub fn bounds_m(points: &[DVec3]) -> Option<(DVec3, DVec3)> {
    let first = *points.first()?;
    Some(points.iter().fold((first, first), |(low, high), x| (low.min(*x), high.max(*x))))
}

/// Volume of a tetrahedron, positive when it is right-handed.
#[must_use]
pub fn signed_volume_m3(corners_m: &[DVec3; 4]) -> f64 {
    let [a, b, c, d] = *corners_m;
    (b - a).cross(c - a).dot(d - a) / 6.0
}
