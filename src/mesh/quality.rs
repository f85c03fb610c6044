//! How good the elements of a mesh are, and a report on a whole mesh.

use super::{Pieces, Surface, TetMesh, signed_volume_m3};
use glam::DVec3;
use std::fmt;

/// Below this quality an element counts as a sliver.
pub const SLIVER_QUALITY: f64 = 0.02;

/// Sizes of one tetrahedron.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElementShape {
    /// Volume, m3; negative when the element is left-handed.
    pub volume_m3: f64,
    /// Smallest of the four altitudes, m.
    pub min_altitude_m: f64,
    /// Shortest edge, m.
    pub shortest_edge_m: f64,
    /// Longest edge, m.
    pub longest_edge_m: f64,
    /// `6 sqrt(2) |V| / longest_edge^3`: 1 for a regular tetrahedron, 0 for a flat one.
    pub quality: f64,
}

impl ElementShape {
    /// Measures the tetrahedron with these corners, metres.
    #[must_use]
    pub fn of(corners_m: &[DVec3; 4]) -> Self {
        let volume_m3 = signed_volume_m3(corners_m);
        let (shortest_edge_m, longest_edge_m) = edge_range_m(corners_m);
        let largest_face_m2 = largest_face_m2(corners_m);
        Self {
            volume_m3,
            min_altitude_m: ratio_or_zero(3.0 * volume_m3.abs(), largest_face_m2),
            shortest_edge_m,
            longest_edge_m,
            quality: ratio_or_zero(6.0 * std::f64::consts::SQRT_2 * volume_m3.abs(), longest_edge_m.powi(3)),
        }
    }
}

fn ratio_or_zero(numerator: f64, denominator: f64) -> f64 {
    if denominator > 0.0 { numerator / denominator } else { 0.0 }
}

fn edge_range_m([a, b, c, d]: &[DVec3; 4]) -> (f64, f64) {
    [*b - *a, *c - *a, *d - *a, *c - *b, *d - *b, *d - *c]
        .iter()
        .fold((f64::INFINITY, 0.0), |(low, high), edge| (low.min(edge.length()), high.max(edge.length())))
}

fn largest_face_m2(corners_m: &[DVec3; 4]) -> f64 {
    super::surface::TET_FACES
        .iter()
        .map(|face| {
            let [a, b, c] = face.map(|corner| corners_m[corner]);
            (b - a).cross(c - a).length() / 2.0
        })
        .fold(0.0, f64::max)
}

/// A value and the element it was found in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorstElement {
    /// Index of the element, from 0.
    pub element: usize,
    /// The value.
    pub value: f64,
}

/// What there is to know about a mesh before it is used.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshReport {
    /// Number of nodes.
    pub nodes: usize,
    /// Number of tetrahedra.
    pub tets: usize,
    /// Region names, each with its number of tetrahedra.
    pub regions: Vec<(String, usize)>,
    /// Smallest and largest coordinates, m; `None` without nodes.
    pub bounds_m: Option<(DVec3, DVec3)>,
    /// Sum of the signed volumes, m3.
    pub volume_m3: f64,
    /// Pieces that hang together by whole faces.
    pub parts: usize,
    /// Pieces that hang together by nodes at least.
    pub parts_by_nodes: usize,
    /// Boundary triangles.
    pub surface_triangles: usize,
    /// Boundary edges where more than two boundary triangles meet.
    pub non_manifold_edges: usize,
    /// Boundary edges of an odd number of boundary triangles.
    pub open_edges: usize,
    /// Faces of more than two tetrahedra.
    pub overused_faces: usize,
    /// Elements of no or negative volume.
    pub inverted: usize,
    /// Elements of a quality below [`SLIVER_QUALITY`].
    pub slivers: usize,
    /// Worst quality.
    pub worst_quality: Option<WorstElement>,
    /// Smallest altitude, m: with the stiffest material it sets the stable step.
    pub smallest_altitude_m: Option<WorstElement>,
}

impl MeshReport {
    /// Examines a mesh.
    #[must_use]
    pub fn of(mesh: &TetMesh) -> Self {
        let surface = Surface::of(&mesh.tets);
        let shapes: Vec<ElementShape> =
            (0..mesh.tets.len()).map(|tet| ElementShape::of(&mesh.corners_m(tet))).collect();
        Self {
            nodes: mesh.nodes_m.len(),
            tets: mesh.tets.len(),
            regions: region_counts(mesh),
            bounds_m: mesh.bounds_m(),
            volume_m3: shapes.iter().map(|shape| shape.volume_m3).sum(),
            parts: Pieces::by_faces(&mesh.tets).count,
            parts_by_nodes: Pieces::by_nodes(mesh).count,
            surface_triangles: surface.triangles.len(),
            non_manifold_edges: surface.non_manifold_edges,
            open_edges: surface.open_edges,
            overused_faces: surface.overused_faces,
            inverted: shapes.iter().filter(|s| s.volume_m3 <= 0.0).count(),
            slivers: shapes.iter().filter(|s| s.quality < SLIVER_QUALITY).count(),
            worst_quality: worst(shapes.iter().map(|s| s.quality)),
            smallest_altitude_m: worst(shapes.iter().map(|s| s.min_altitude_m)),
        }
    }

    /// Whether a simulation can use the mesh as it is.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        self.tets > 0 && self.inverted == 0 && self.open_edges == 0 && self.overused_faces == 0
    }
}

fn region_counts(mesh: &TetMesh) -> Vec<(String, usize)> {
    let mut counts = vec![0; mesh.region_names.len()];
    for &region in &mesh.regions {
        counts[region as usize] += 1;
    }
    mesh.region_names.iter().cloned().zip(counts).collect()
}

fn worst(values: impl Iterator<Item = f64>) -> Option<WorstElement> {
    values
        .enumerate()
        .map(|(element, value)| WorstElement { element, value })
        .min_by(|a, b| a.value.total_cmp(&b.value))
}

impl fmt::Display for MeshReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "nodes               {}", self.nodes)?;
        writeln!(f, "tetrahedra          {}", self.tets)?;
        self.write_regions(f)?;
        if let Some((low, high)) = self.bounds_m {
            let size = high - low;
            writeln!(f, "bounding box        {} .. {} m", point(low), point(high))?;
            writeln!(f, "size                {} m", point(size))?;
        }
        writeln!(f, "volume              {} m3", short(self.volume_m3))?;
        self.write_parts(f)?;
        self.write_surface(f)?;
        self.write_elements(f)
    }
}

impl MeshReport {
    fn write_regions(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let regions: Vec<String> =
            self.regions.iter().map(|(name, count)| format!("{name} ({count})")).collect();
        writeln!(f, "regions             {}", regions.join(", "))
    }

    fn write_parts(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "parts               {}", self.parts)?;
        if self.parts_by_nodes < self.parts {
            write!(f, " (joined only at single nodes or edges; {} if those count)", self.parts_by_nodes)?;
        }
        writeln!(f)
    }

    fn write_surface(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = match (self.open_edges, self.non_manifold_edges) {
            (0, 0) => "closed".to_owned(),
            (0, n) => format!("closed; more than two triangles meet at {n} edge(s)"),
            (n, _) => format!("NOT closed: {n} open edge(s)"),
        };
        writeln!(f, "surface             {} triangles, {kind}", self.surface_triangles)?;
        if self.overused_faces > 0 {
            writeln!(
                f,
                "overlapping         {} face(s) belong to more than two tetrahedra",
                self.overused_faces
            )?;
        }
        Ok(())
    }

    fn write_elements(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(worst) = self.worst_quality {
            writeln!(
                f,
                "worst quality       {:.2e} at element {} (1 is regular; {} below {SLIVER_QUALITY})",
                worst.value, worst.element, self.slivers
            )?;
        }
        if let Some(worst) = self.smallest_altitude_m {
            writeln!(f, "smallest altitude   {:.3e} m at element {}", worst.value, worst.element)?;
        }
        write!(f, "inverted or flat    {}", self.inverted)
    }
}

fn point(x: DVec3) -> String {
    format!("({} {} {})", short(x.x), short(x.y), short(x.z))
}

/// Six significant digits, without an exponent where that reads well.
fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !(1e-3..1e6).contains(&value.abs()) {
        return format!("{value:.5e}");
    }
    let decimals = match value.abs() {
        size if size < 1.0 => 6,
        size if size < 100.0 => 5,
        _ => 2,
    };
    let text = format!("{value:.decimals$}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_regular_tetrahedron_has_quality_one() {
        let corners = [
            DVec3::new(1.0, 1.0, 1.0),
            DVec3::new(1.0, -1.0, -1.0),
            DVec3::new(-1.0, 1.0, -1.0),
            DVec3::new(-1.0, -1.0, 1.0),
        ];
        let shape = ElementShape::of(&corners);
        assert!((shape.quality - 1.0).abs() < 1e-12);
        assert!((shape.longest_edge_m - 8.0_f64.sqrt()).abs() < 1e-12);
        let altitude = 8.0_f64.sqrt() * (2.0_f64 / 3.0).sqrt();
        assert!((shape.min_altitude_m - altitude).abs() < 1e-12);
    }

    #[test]
    fn a_point_has_no_quality_rather_than_nan() {
        let shape = ElementShape::of(&[DVec3::ONE; 4]);
        assert_eq!((shape.quality, shape.min_altitude_m), (0.0, 0.0));
    }

    #[test]
    fn the_report_counts_what_is_wrong() {
        let nodes = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.3, 0.3, -1e-4)];
        let mesh = TetMesh::with_one_region(nodes, vec![[0, 1, 2, 3], [0, 1, 2, 4]]);
        let report = MeshReport::of(&mesh);
        assert_eq!((report.inverted, report.slivers, report.parts), (1, 1, 1));
        assert_eq!(report.worst_quality.map(|w| w.element), Some(1));
        assert!(!report.is_sound());
        let text = report.to_string();
        assert!(text.contains("inverted or flat    1"), "{text}");
        assert!(text.contains("all (2)"), "{text}");
    }

    #[test]
    fn numbers_read_well() {
        let texts = [0.0, 4.123_536, -0.5, 1000.0, 1.2246e-4, 3.829_67e7].map(short);
        assert_eq!(texts, ["0", "4.12354", "-0.5", "1000", "1.22460e-4", "3.82967e7"]);
    }
}
