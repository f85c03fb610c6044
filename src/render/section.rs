//! Bodies cut open by a plane: what lies beyond it is left out, and the cut is filled with the section of the
//! tetrahedra, so that fields are seen inside. What comes out is a body that everything else draws as usual.

use super::camera::Camera;
use crate::frame::{BodyFrame, Interior, SurfaceTopology, VertexFields};
use glam::Vec3;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A plane; what lies on the side its normal points to is left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// Unit normal.
    pub normal: Vec3,
    /// Where the plane is along its normal, from the origin, metres.
    pub position_m: f32,
}

impl Cut {
    /// A plane with a normal of any length; `None` where that has no direction.
    #[must_use]
    pub fn new(normal: Vec3, position_m: f32) -> Option<Self> {
        let normal = normal.try_normalize().filter(|_| position_m.is_finite())?;
        Some(Self { normal, position_m })
    }

    /// How far a point lies beyond the plane, metres; negative on the side that stays.
    #[must_use]
    pub fn beyond_m(&self, point_m: [f32; 3]) -> f32 {
        self.normal.dot(Vec3::from(point_m)) - self.position_m
    }

    /// Between which distances beyond the plane a body lies, metres; `None` without a point that is a number.
    #[must_use]
    pub fn reach_m(&self, body: &BodyFrame) -> Option<[f32; 2]> {
        let places = body.positions_m.iter().map(|point| self.beyond_m(*point));
        let places = places.filter(|beyond_m| beyond_m.is_finite());
        places.map(|m| [m, m]).reduce(|[a, b], [c, d]| [a.min(c), b.max(d)])
    }

    /// Whether a camera looks into the section, and not at the back of what it has left; one seen edge-on counts.
    #[must_use]
    pub fn is_looked_into(normal: Vec3, camera: &Camera) -> bool {
        /// Sine of the angle up to which a plane is edge-on.
        const EDGE_ON: f32 = 1e-3;
        normal.dot(camera.axes()[2]) > -EDGE_ON
    }

    /// The positions along `normal` between which the plane meets a box, metres.
    #[must_use]
    pub fn span_m(normal: Vec3, (low_m, high_m): ([f32; 3], [f32; 3])) -> [f32; 2] {
        let (low, high) = (Vec3::from(low_m), Vec3::from(high_m));
        let middle = normal.dot(0.5 * (low + high));
        let reach = normal.abs().dot(0.5 * (high - low));
        [middle - reach, middle + reach]
    }

    /// The position along `normal` at which the plane goes through the middle of a box, metres.
    #[must_use]
    pub fn middle_m(normal: Vec3, bounds_m: ([f32; 3], [f32; 3])) -> f32 {
        let [low, high] = Self::span_m(normal, bounds_m);
        0.5 * (low + high)
    }
}

/// A body cut open, and which of its triangles are the section.
#[derive(Debug)]
pub(crate) struct Opened {
    /// The body without what lies beyond; it has no interior any more.
    pub body: BodyFrame,
    /// First triangle of the section; those before are of the surface.
    pub section_start: usize,
}

/// Cuts one body open. Without an interior the cut is not filled.
pub(crate) fn open_body(body: &BodyFrame, cut: &Cut) -> Opened {
    let mut pieces = Pieces::default();
    let source = Source::new(&body.positions_m, &body.fields, cut);
    let mut known = BTreeMap::new();
    for index in 0..body.surface.triangles.len() {
        pieces.add_surface(&body.surface, index, &source, &mut known);
    }
    let section_start = pieces.surface.triangles.len();
    if let Some(interior) = &body.interior {
        pieces.add_section(interior, cut);
    }
    let body = BodyFrame {
        surface: Arc::new(pieces.surface),
        positions_m: pieces.positions_m,
        fields: pieces.fields,
        interior: None,
        ..body.clone()
    };
    Opened { body, section_start }
}

/// Points with values, and how far beyond the plane they lie.
struct Source<'a> {
    positions_m: &'a [[f32; 3]],
    fields: &'a VertexFields,
    beyond_m: Vec<f32>,
}

impl<'a> Source<'a> {
    fn new(positions_m: &'a [[f32; 3]], fields: &'a VertexFields, cut: &Cut) -> Self {
        let beyond_m = positions_m.iter().map(|place| cut.beyond_m(*place)).collect();
        Self { positions_m, fields, beyond_m }
    }

    /// Distances beyond the plane of the corners; `None` where one is missing or not a number.
    fn beyond_m<const N: usize>(&self, corners: [u32; N]) -> Option<[f32; N]> {
        let found = corners.map(|corner| self.beyond_m.get(corner as usize).copied().unwrap_or(f32::NAN));
        found.iter().all(|distance| distance.is_finite()).then_some(found)
    }
}

/// New vertices by what they were made from: a vertex twice, or the two ends of an edge that the plane crosses.
type Known = BTreeMap<[u32; 2], u32>;

/// What is left of a body, under construction.
#[derive(Default)]
struct Pieces {
    surface: SurfaceTopology,
    positions_m: Vec<[f32; 3]>,
    fields: VertexFields,
}

impl Pieces {
    /// The part of a triangle of the surface that stays.
    fn add_surface(&mut self, from: &SurfaceTopology, index: usize, source: &Source<'_>, known: &mut Known) {
        let corners = from.triangles[index];
        let Some(beyond_m) = source.beyond_m(corners) else { return };
        let mut polygon = Vec::with_capacity(4);
        for k in 0..3 {
            let next = (k + 1) % 3;
            if beyond_m[k] <= 0.0 {
                polygon.push(self.vertex([corners[k]; 2], source, known));
            }
            if (beyond_m[k] <= 0.0) != (beyond_m[next] <= 0.0) {
                polygon.push(self.vertex([corners[k], corners[next]], source, known));
            }
        }
        let of = |list: &[u32]| list.get(index).copied();
        let is_crack = from.triangle_is_crack.get(index).copied();
        let tags = [of(&from.triangle_material), of(&from.triangle_fragment), of(&from.triangle_element)];
        self.add_polygon(&polygon, tags, [is_crack.unwrap_or(false), false]);
    }

    /// The section of the tetrahedra, facing what was left out.
    fn add_section(&mut self, interior: &Interior, cut: &Cut) {
        let source = Source::new(&interior.positions_m, &interior.fields, cut);
        let topology = &interior.topology;
        // Vertices of its own, so that the section's shading does not run into that of the skin.
        let mut known = BTreeMap::new();
        for (element, tet) in topology.tets.iter().enumerate() {
            let Some(beyond_m) = source.beyond_m(*tet) else { continue };
            let mut polygon: Vec<u32> = Vec::with_capacity(4);
            for edge in section_edges(beyond_m) {
                polygon.push(self.vertex(edge.map(|k| tet[k]), &source, &mut known));
            }
            if polygon.len() > 2 && self.faces_away(&polygon, cut.normal) {
                polygon.reverse();
            }
            let of = |list: &[u32]| list.get(element).copied();
            let tags = [of(&topology.element_material), of(&topology.element_fragment), Some(element as u32)];
            self.add_polygon(&polygon, tags, [false, true]);
        }
    }

    fn faces_away(&self, polygon: &[u32], normal: Vec3) -> bool {
        let at = |k: usize| Vec3::from(self.positions_m[polygon[k] as usize]);
        let area = |a: usize, b: usize| (at(a) - at(0)).cross(at(b) - at(0));
        let sum = (2..polygon.len()).map(|k| area(k - 1, k)).sum::<Vec3>();
        sum.dot(normal) < 0.0
    }

    /// A convex polygon as triangles, with the material, fragment and element of the whole.
    fn add_polygon(&mut self, polygon: &[u32], tags: [Option<u32>; 3], [is_crack, is_section]: [bool; 2]) {
        let surface = &mut self.surface;
        for k in 2..polygon.len() {
            surface.triangles.push([polygon[0], polygon[k - 1], polygon[k]]);
            surface.triangle_material.push(tags[0].unwrap_or(0));
            surface.triangle_fragment.push(tags[1].unwrap_or(0));
            surface.triangle_element.push(tags[2].unwrap_or(0));
            surface.triangle_is_crack.push(is_crack);
            surface.triangle_is_section.push(is_section);
        }
    }

    /// The vertex at a corner (named twice), or where the plane crosses an edge.
    fn vertex(&mut self, [a, b]: [u32; 2], source: &Source<'_>, known: &mut Known) -> u32 {
        // One sense for both elements at an edge: the same numbers to the bit.
        let [a, b] = [a.min(b), a.max(b)];
        if let Some(found) = known.get(&[a, b]) {
            return *found;
        }
        let [from, to] = [a, b].map(|v| v as usize);
        let (at_a, at_b) = (source.beyond_m[from], source.beyond_m[to]);
        let share = if at_a == at_b { 0.0 } else { (at_a / (at_a - at_b)).clamp(0.0, 1.0) };
        let mix = |x: f32, y: f32| x + share * (y - x);
        let [p, q] = [source.positions_m[from], source.positions_m[to]];
        self.positions_m.push(std::array::from_fn(|i| mix(p[i], q[i])));
        for (values, old) in self.fields.all_mut().into_iter().zip(source.fields.all()) {
            if let (Some(x), Some(y)) = (old.get(from), old.get(to)) {
                values.push(mix(*x, *y));
            }
        }
        let vertex = self.positions_m.len() as u32 - 1;
        known.insert([a, b], vertex);
        vertex
    }
}

/// The edges of a tetrahedron that the plane crosses, in order around the section: none, three or four.
fn section_edges(beyond_m: [f32; 4]) -> Vec<[usize; 2]> {
    let (beyond, stays): (Vec<usize>, Vec<usize>) = (0..4).partition(|k| beyond_m[*k] > 0.0);
    match (stays.as_slice(), beyond.as_slice()) {
        (&[a], &[b, c, d]) | (&[b, c, d], &[a]) => vec![[a, b], [a, c], [a, d]],
        (&[a, b], &[c, d]) => vec![[a, c], [a, d], [b, d], [b, c]],
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{BodyRole, Frame, InteriorTopology};
    use crate::render::look_inside;

    /// A unit cube of six tetrahedra around its diagonal, with a value that grows along x.
    fn cube() -> BodyFrame {
        let corner = |k: u32| [k & 1, (k >> 1) & 1, (k >> 2) & 1].map(|bit| bit as f32);
        let positions_m: Vec<[f32; 3]> = (0..8).map(corner).collect();
        let orders = [[1, 2, 4], [2, 1, 4], [4, 1, 2], [1, 4, 2], [2, 4, 1], [4, 2, 1]];
        let tets: Vec<[u32; 4]> = orders.iter().map(|[a, b, _]| [0, *a, a + b, 7]).collect();
        let x: Vec<f32> = positions_m.iter().map(|p| p[0]).collect();
        let fields = VertexFields { speed_m_s: x, ..VertexFields::default() };
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
        let topology = Arc::new(InteriorTopology { tets, ..InteriorTopology::default() });
        BodyFrame {
            surface: Arc::new(SurfaceTopology { triangles, ..SurfaceTopology::default() }),
            positions_m: positions_m.clone(),
            fields: fields.clone(),
            interior: Some(Arc::new(Interior { topology, positions_m, fields, stress_pa: Vec::new() })),
            ..BodyFrame::default()
        }
    }

    /// Sums over the triangles of a part: of their areas as vectors, and of a third of point times area.
    fn area_and_volume(body: &BodyFrame, part: std::ops::Range<usize>) -> (Vec3, f32) {
        let mut sums = (Vec3::ZERO, 0.0);
        for triangle in &body.surface.triangles[part] {
            let [a, b, c] = triangle.map(|v| Vec3::from(body.positions_m[v as usize]));
            let area = 0.5 * (b - a).cross(c - a);
            sums.0 += area;
            sums.1 += area.dot(a + b + c) / 9.0;
        }
        sums
    }

    #[test]
    fn what_is_left_is_closed_and_has_the_right_volume() {
        for (normal, position_m, volume) in [
            (Vec3::X, 0.3, 0.3),
            (Vec3::NEG_Y, -0.25, 0.75),
            (Vec3::new(0.0, 1.0, 1.0), 0.5_f32.sqrt(), 0.5),
            (Vec3::ONE, 0.5 / 3.0_f32.sqrt(), 0.125 / 6.0),
            // Through nodes, and beside the cube.
            (Vec3::Z, 1.0, 1.0),
            (Vec3::Z, 2.0, 1.0),
            (Vec3::Z, -1.0, 0.0),
        ] {
            let cut = Cut::new(normal, position_m).unwrap();
            let Opened { body, section_start } = open_body(&cube(), &cut);
            let all = 0..body.surface.triangles.len();
            let (area, found) = area_and_volume(&body, all.clone());
            assert!((found - volume).abs() < 1e-5, "{normal}: {found}, not {volume}");
            assert!(area.length() < 1e-5, "{normal}: open by {area}");
            let section = area_and_volume(&body, section_start..all.end).0;
            assert!(section.cross(cut.normal).length() < 1e-5 && section.dot(cut.normal) >= 0.0, "{section}");
            for (place, value) in body.positions_m.iter().zip(&body.fields.speed_m_s) {
                assert!((place[0] - value).abs() < 1e-6 && cut.beyond_m(*place) < 1e-6);
            }
            assert_eq!(body.positions_m.len(), body.fields.speed_m_s.len());
        }
    }

    /// A section is matte and has a dark line around it, not along the elements in it; the skin has none.
    #[test]
    fn a_section_is_outlined() {
        use crate::render::geometry::{Coloring, GeometryBuilder};
        let cut = Cut::new(Vec3::Z, 0.4).unwrap();
        let Opened { body, section_start } = open_body(&cube(), &cut);
        let frame = Frame { bodies: vec![body], ..Frame::default() };
        let range = crate::render::Range { low: 0.0, high: 1.0 };
        let coloring = Coloring { color_by: crate::frame::ColorBy::Material, range, cross_scale_pa: None };
        let mut builder = GeometryBuilder::default();
        let vertices = &builder.build(&frame, None, coloring).vertices;
        let mut outline_m = 0.0;
        for (index, corners) in vertices.as_chunks::<3>().0.iter().enumerate() {
            let is_section = index >= section_start;
            assert_eq!(corners[0].color_and_gloss[3] == 0, is_section);
            let lines = corners[0].normal_and_crack[3];
            assert!(is_section || lines == 0);
            let place = |k: usize| Vec3::from(corners[k % 3].position_m);
            let marked = (0..3).filter(|k| lines >> k & 1 == 1);
            outline_m += marked.map(|k| place(k + 1).distance(place(k + 2))).sum::<f32>();
        }
        assert!((outline_m - 4.0).abs() < 1e-4, "{outline_m}");
    }

    #[test]
    fn without_an_interior_and_with_broken_numbers_the_surface_alone_is_cut() {
        let cut = Cut::new(Vec3::X, 0.5).unwrap();
        let mut hollow = cube();
        hollow.interior = None;
        hollow.positions_m[7] = [f32::NAN; 3];
        let opened = open_body(&hollow, &cut);
        assert_eq!(opened.section_start, opened.body.surface.triangles.len());
        assert!(opened.body.positions_m.iter().flatten().all(|x| x.is_finite()));
        let fixed = BodyFrame { role: BodyRole::Fixed, ..cube() };
        let frame = Frame { bodies: vec![fixed, cube()], ..Frame::default() };
        let opened = look_inside(&frame, Some(&cut), None);
        assert_eq!(opened.bodies[0].positions_m.len(), 8);
        assert!(opened.bodies[1].positions_m.iter().all(|place| place[0] <= 0.5));
        assert!(Cut::new(Vec3::ZERO, 0.0).is_none() && Cut::new(Vec3::X, f32::NAN).is_none());
    }

    #[test]
    fn the_span_of_a_box_holds_its_corners() {
        let span = Cut::span_m(Vec3::new(0.6, -0.8, 0.0), ([0.0; 3], [1.0, 2.0, 3.0]));
        assert!((span[0] + 1.6).abs() < 1e-6 && (span[1] - 0.6).abs() < 1e-6, "{span:?}");
    }
}
