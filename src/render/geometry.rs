//! From a frame to triangles with normals and colours, ready for the GPU.

use crate::frame::{BodyFrame, BodyRole, ColorBy, Frame, SurfaceTopology};
use crate::math::in_rows;
use crate::render::color_map::{body_srgb, to_byte};
use crate::render::crosses::cross_vertices;
use crate::render::range::Range;
use glam::Vec3;
use rayon::prelude::*;
use std::sync::Arc;

/// One corner of a triangle; every triangle has its own three.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct SurfaceVertex {
    /// World position, metres.
    pub position_m: [f32; 3],
    /// Unit normal as signed normalized integers. The fourth is `i16::MAX` on crack faces; elsewhere it has a
    /// bit for each edge that is drawn as a dark line, bit `k` for the edge opposite to corner `k`: where a crack
    /// reaches the skin, and around sections.
    pub normal_and_crack: [i16; 4],
    /// Base colour, sRGB, and gloss in the fourth.
    pub color_and_gloss: [u8; 4],
    /// Position on the colour map, 0..1; negative where the base colour counts.
    pub map_position: f32,
}

/// Faces that meet at less than this angle look smooth ...
const SMOOTH_BELOW_DEG: f32 = 30.0;
/// ... and at more than this one sharp; a blend between both, so that nothing pops while a body
/// bends.
const SHARP_ABOVE_DEG: f32 = 45.0;
/// Gloss of moving and of fixed bodies, 0..255.
const GLOSS: [u8; 2] = [255, 40];
/// Fixed bodies step back: this share of their colour gives way to grey.
const FIXED_GREY_SHARE: f32 = 0.55;
const FIXED_GREY: f32 = 0.62;
/// Raw inside of a broken body, sRGB, and its share in the colour of crack faces.
const CRACK_SRGB: [f32; 3] = [0.96, 0.53, 0.24];
const CRACK_SHARE: f32 = 0.72;
/// A section is matte and as pale as paper: this share of its colour gives way to white. Values keep their colours.
const SECTION_WHITE_SHARE: f32 = 0.3;

/// Position on the colour map of what is drawn in its base colour.
pub const NO_VALUE: f32 = -1.0;

/// All triangles of a frame and their extent.
#[derive(Debug, Default)]
pub struct Geometry {
    /// Three for each triangle.
    pub vertices: Vec<SurfaceVertex>,
    /// Positions of the vertices of the bodies, metres: what casts shadows,
    pub casters_m: Vec<[f32; 3]>,
    /// and its triangles. Corners share vertices here, as no colours and normals part them.
    pub caster_triangles: Vec<[u32; 3]>,
    /// Smallest and largest coordinates, metres; `None` without triangles.
    pub bounds_m: Option<(Vec3, Vec3)>,
    /// Root mean square distance of a body's surface vertices from their centre, the largest of
    /// all moving bodies (of all, when none moves), metres: a length that hardly changes in
    /// time.
    pub body_radius_m: f32,
}

/// What the colours depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coloring {
    /// Meaning.
    pub color_by: ColorBy,
    /// Ends of the colour map; not used for colours without values.
    pub range: Range,
    /// Stress of the longest line of the stress crosses, Pa; without it these are not drawn.
    pub cross_scale_pa: Option<f32>,
}

/// Builds geometry frame after frame, and remembers what depends on topology only.
#[derive(Debug, Default)]
pub struct GeometryBuilder {
    topologies: Vec<CachedTopology>,
    geometry: Geometry,
}

impl GeometryBuilder {
    /// The triangles of all bodies but the `hidden` one (an index into the frame's bodies).
    pub fn build(&mut self, frame: &Frame, hidden: Option<usize>, coloring: Coloring) -> &Geometry {
        self.update_topologies(frame);
        let drawn = |index: usize| Some(index) != hidden && self.topologies[index].fits(frame, index);
        let shown: Vec<usize> = (0..frame.bodies.len()).filter(|i| drawn(*i)).collect();

        let corners: usize = shown.iter().map(|i| 3 * frame.bodies[*i].surface.triangles.len()).sum();
        self.geometry.vertices.resize(corners, SurfaceVertex::default());
        let mut rest = self.geometry.vertices.as_mut_slice();
        for &index in &shown {
            let body = Painter::new(&frame.bodies[index], index, coloring);
            let (part, others) = rest.split_at_mut(3 * body.frame.surface.triangles.len());
            body.fill(&mut self.topologies[index], part);
            rest = others;
        }
        self.gather_casters(frame, &shown);
        if let Some(scale_pa) = coloring.cross_scale_pa {
            self.geometry.vertices.extend(cross_vertices(&frame.crosses, scale_pa));
        }
        self.geometry.bounds_m = bounds_m(frame, &shown);
        self.geometry.body_radius_m = largest_radius_m(frame, &shown);
        &self.geometry
    }

    fn gather_casters(&mut self, frame: &Frame, shown: &[usize]) {
        let Geometry { casters_m, caster_triangles, .. } = &mut self.geometry;
        casters_m.clear();
        caster_triangles.clear();
        for &index in shown {
            let (body, first) = (&frame.bodies[index], casters_m.len() as u32);
            let used = self.topologies[index].starts.len() - 1;
            casters_m.extend_from_slice(&body.positions_m[..used]);
            caster_triangles.extend(body.surface.triangles.iter().map(|t| t.map(|corner| first + corner)));
        }
    }

    /// What was built last.
    #[must_use]
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    fn update_topologies(&mut self, frame: &Frame) {
        self.topologies.truncate(frame.bodies.len());
        for (index, body) in frame.bodies.iter().enumerate() {
            match self.topologies.get_mut(index) {
                Some(known) if Arc::ptr_eq(&known.surface, &body.surface) => {}
                Some(known) => *known = CachedTopology::new(&body.surface),
                None => self.topologies.push(CachedTopology::new(&body.surface)),
            }
        }
    }
}

/// Which triangles meet at each vertex. Holding the surface keeps its address from being reused.
#[derive(Debug)]
struct CachedTopology {
    surface: Arc<SurfaceTopology>,
    /// For vertex `v`, its triangles are `triangles[starts[v]..starts[v + 1]]`.
    starts: Vec<u32>,
    triangles: Vec<u32>,
    /// Fourth component of the normals, see [`SurfaceVertex::normal_and_crack`].
    line_marks: Vec<i16>,
    /// Scratch: area-weighted normal of each triangle.
    face_normals: Vec<Vec3>,
}

impl CachedTopology {
    fn new(surface: &Arc<SurfaceTopology>) -> Self {
        let corners = || surface.triangles.iter().flatten();
        let vertices = corners().max().map_or(0, |&last| last as usize + 1);
        let of_corners = corners().enumerate().map(|(corner, vertex)| (*vertex, corner as u32 / 3));
        let (starts, triangles) = in_rows(of_corners, vertices);
        let mut topology = Self {
            surface: Arc::clone(surface),
            starts,
            triangles,
            line_marks: Vec::new(),
            face_normals: Vec::new(),
        };
        if surface.triangle_is_crack.contains(&true) || surface.triangle_is_section.contains(&true) {
            topology.line_marks = (0..surface.triangles.len()).map(|t| topology.line_mark(t)).collect();
        }
        topology
    }

    /// Where this triangle has dark lines: where cracks reach the skin, and around sections; or that it is a crack's face.
    fn line_mark(&self, triangle: usize) -> i16 {
        if self.is_crack(triangle) {
            return i16::MAX;
        }
        let corners = self.surface.triangles[triangle];
        let is_section = self.is_section(triangle);
        let has_line = |k: usize| {
            let [a, b] = [corners[(k + 1) % 3], corners[(k + 2) % 3]];
            let around = self.around(a).iter().map(|t| *t as usize);
            let mut others = around.filter(|t| *t != triangle && self.surface.triangles[*t].contains(&b));
            // Sections share no vertices with the skin.
            if is_section { others.next().is_none() } else { others.any(|t| self.is_crack(t)) }
        };
        (0..3).filter(|k| has_line(*k)).map(|k| 1 << k).sum()
    }

    /// Whether the body has all the vertices its triangles name; if not, it is left out.
    fn fits(&self, frame: &Frame, index: usize) -> bool {
        frame.bodies[index].positions_m.len() + 1 >= self.starts.len()
    }

    fn around(&self, vertex: u32) -> &[u32] {
        let vertex = vertex as usize;
        &self.triangles[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }

    fn is_crack(&self, triangle: usize) -> bool {
        is_set(&self.surface.triangle_is_crack, triangle)
    }

    fn is_section(&self, triangle: usize) -> bool {
        is_set(&self.surface.triangle_is_section, triangle)
    }

    /// The normal to draw at a corner: the mean over the faces around `vertex` that continue
    /// the face `triangle` smoothly, weighted by area.
    fn corner_normal(&self, triangle: usize, vertex: u32) -> Vec3 {
        let own = self.face_normals[triangle];
        let own_unit = own.normalize_or_zero();
        let mut sum = Vec3::ZERO;
        for &other in self.around(vertex) {
            let normal = self.face_normals[other as usize];
            let same_kind = self.is_crack(other as usize) == self.is_crack(triangle);
            if same_kind {
                let cosine = own_unit.dot(normal) / normal.length().max(f32::MIN_POSITIVE);
                sum += normal * smoothness(cosine);
            }
        }
        sum.try_normalize().unwrap_or(own_unit)
    }
}

/// 1 for faces that meet smoothly, 0 at a sharp edge.
fn smoothness(cosine: f32) -> f32 {
    let sharp = SHARP_ABOVE_DEG.to_radians().cos();
    let smooth = SMOOTH_BELOW_DEG.to_radians().cos();
    let share = ((cosine - sharp) / (smooth - sharp)).clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}

fn is_set(flags: &[bool], index: usize) -> bool {
    flags.get(index).copied().unwrap_or(false)
}

/// Fills the corners of one body.
struct Painter<'a> {
    frame: &'a BodyFrame,
    index: usize,
    color_by: ColorBy,
    range: Range,
    values: Option<&'a [f32]>,
}

impl<'a> Painter<'a> {
    fn new(frame: &'a BodyFrame, index: usize, coloring: Coloring) -> Self {
        Self {
            frame,
            index,
            color_by: coloring.color_by,
            range: coloring.range,
            values: coloring.color_by.values_of(frame),
        }
    }

    fn fill(&self, topology: &mut CachedTopology, corners: &mut [SurfaceVertex]) {
        let triangles = &self.frame.surface.triangles;
        topology.face_normals.clear();
        topology.face_normals.extend(triangles.iter().map(|t| self.face_normal(*t)));
        let topology = &*topology;
        // Small bodies are not worth another thread's waking.
        let chunks = corners.par_chunks_mut(3).with_min_len(4096);
        chunks.enumerate().for_each(|(triangle, corners)| {
            let color_and_gloss = self.color_and_gloss(triangle);
            let lines = topology.line_marks.get(triangle).copied().unwrap_or(0);
            for (corner, &vertex) in corners.iter_mut().zip(&triangles[triangle]) {
                let [x, y, z] = topology.corner_normal(triangle, vertex).to_array().map(to_signed_normalized);
                *corner = SurfaceVertex {
                    position_m: self.frame.positions_m[vertex as usize],
                    normal_and_crack: [x, y, z, lines],
                    color_and_gloss,
                    map_position: self.map_position(vertex),
                };
            }
        });
    }

    fn face_normal(&self, triangle: [u32; 3]) -> Vec3 {
        let [a, b, c] = triangle.map(|v| Vec3::from(self.frame.positions_m[v as usize]));
        (b - a).cross(c - a)
    }

    fn map_position(&self, vertex: u32) -> f32 {
        self.values
            .and_then(|values| values.get(vertex as usize))
            .map_or(NO_VALUE, |value| self.range.position(*value))
    }

    fn color_and_gloss(&self, triangle: usize) -> [u8; 4] {
        let is_fixed = self.frame.role == BodyRole::Fixed;
        let mut color = self.base_srgb(triangle);
        if is_fixed {
            color = mix(color, [FIXED_GREY; 3], FIXED_GREY_SHARE);
        }
        if is_set(&self.frame.surface.triangle_is_crack, triangle) {
            color = mix(color, CRACK_SRGB, CRACK_SHARE);
        }
        let is_section = is_set(&self.frame.surface.triangle_is_section, triangle);
        if is_section {
            color = mix(color, [1.0; 3], SECTION_WHITE_SHARE);
        }
        let [r, g, b] = color.map(to_byte);
        [r, g, b, if is_section { 0 } else { GLOSS[usize::from(is_fixed)] }]
    }

    fn base_srgb(&self, triangle: usize) -> [f32; 3] {
        if self.color_by == ColorBy::Fragment && self.frame.role == BodyRole::Deformable {
            let fragment = self.frame.surface.triangle_fragment.get(triangle).copied().unwrap_or(0);
            return body_srgb(self.index + fragment as usize);
        }
        if matches!(self.color_by, ColorBy::Body | ColorBy::Fragment) {
            return body_srgb(self.index);
        }
        let material = self.frame.surface.triangle_material.get(triangle);
        let palette = &self.frame.palette_srgb;
        material
            .and_then(|material| palette.get(*material as usize))
            .or_else(|| palette.first())
            .copied()
            .unwrap_or_else(|| body_srgb(self.index))
    }
}

fn mix(a: [f32; 3], b: [f32; 3], share: f32) -> [f32; 3] {
    std::array::from_fn(|i| a[i] + share * (b[i] - a[i]))
}

pub fn to_signed_normalized(value: f32) -> i16 {
    (value.clamp(-1.0, 1.0) * f32::from(i16::MAX)).round() as i16
}

fn points(body: &BodyFrame) -> impl Iterator<Item = Vec3> + '_ {
    let points = body.positions_m.iter().map(|p| Vec3::from(*p));
    points.filter(|p| p.is_finite())
}

fn bounds_m(frame: &Frame, shown: &[usize]) -> Option<(Vec3, Vec3)> {
    let points = shown.iter().flat_map(|i| points(&frame.bodies[*i]));
    points.map(|p| (p, p)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
}

fn largest_radius_m(frame: &Frame, shown: &[usize]) -> f32 {
    let largest = |only_moving: bool| {
        let bodies = shown.iter().map(|i| &frame.bodies[*i]);
        bodies.filter(|body| !only_moving || body.role != BodyRole::Fixed).map(radius_m).fold(0.0, f32::max)
    };
    let moving = largest(true);
    if moving > 0.0 { moving } else { largest(false) }
}

fn radius_m(body: &BodyFrame) -> f32 {
    let count = points(body).count().max(1) as f32;
    let center = points(body).sum::<Vec3>() / count;
    let squares: f32 = points(body).map(|p| p.distance_squared(center)).sum();
    (squares / count).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two unit triangles that share the edge from the origin along y and meet at an angle.
    fn hinge(angle_deg: f32) -> Frame {
        let (sin, cos) = angle_deg.to_radians().sin_cos();
        let surface = SurfaceTopology { triangles: vec![[0, 1, 2], [0, 3, 1]], ..Default::default() };
        Frame {
            bodies: vec![BodyFrame {
                surface: Arc::new(surface),
                positions_m: vec![[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [cos, 0.0, -sin]],
                ..Default::default()
            }],
            ..Default::default()
        }
    }

    fn coloring(color_by: ColorBy) -> Coloring {
        Coloring { color_by, range: Range { low: 0.0, high: 2.0 }, cross_scale_pa: None }
    }

    fn normals_along_hinge(frame: &Frame) -> [[i16; 4]; 2] {
        let mut builder = GeometryBuilder::default();
        let geometry = builder.build(frame, None, coloring(ColorBy::Material));
        [geometry.vertices[0], geometry.vertices[3]].map(|v| v.normal_and_crack)
    }

    #[test]
    fn shallow_edges_share_a_normal_and_sharp_ones_do_not() {
        let [left, right] = normals_along_hinge(&hinge(20.0));
        assert_eq!(left, right);
        let [left, right] = normals_along_hinge(&hinge(90.0));
        assert_eq!((left[2], right[0]), (i16::MAX, i16::MAX));
    }

    #[test]
    fn crack_faces_do_not_blend_into_the_skin() {
        let mut frame = hinge(20.0);
        let surface = Arc::make_mut(&mut frame.bodies[0].surface);
        surface.triangle_is_crack = vec![false, true];
        let [left, right] = normals_along_hinge(&frame);
        assert_ne!(left[..3], right[..3]);
        // The edge between them is opposite to corner 2 of the skin's triangle.
        assert_eq!((left[3], right[3]), (1 << 2, i16::MAX));
    }

    #[test]
    fn changed_topology_is_noticed() {
        let mut builder = GeometryBuilder::default();
        let mut frame = hinge(10.0);
        builder.build(&frame, None, coloring(ColorBy::Material));
        let mut surface = SurfaceTopology::clone(&frame.bodies[0].surface);
        surface.triangles.pop();
        frame.bodies[0].surface = Arc::new(surface);
        let geometry = builder.build(&frame, None, coloring(ColorBy::Material));
        assert_eq!(geometry.vertices.len(), 3);
    }

    #[test]
    fn values_become_map_positions_but_not_on_fixed_bodies() {
        let mut frame = hinge(10.0);
        frame.bodies[0].fields.speed_m_s = vec![1.0, 4.0, f32::NAN];
        let mut builder = GeometryBuilder::default();
        let geometry = builder.build(&frame, None, coloring(ColorBy::Speed));
        let positions: Vec<f32> = geometry.vertices.iter().map(|v| v.map_position).collect();
        // Vertex 3 has no value: the base colour.
        assert_eq!(positions, [0.5, 1.0, 0.0, 0.5, -1.0, 1.0]);
        frame.bodies[0].role = BodyRole::Fixed;
        let geometry = builder.build(&frame, None, coloring(ColorBy::Speed));
        assert!(geometry.vertices.iter().all(|v| v.map_position < 0.0));
    }

    #[test]
    fn casters_are_the_triangles_that_are_seen() {
        let mut frame = hinge(20.0);
        frame.bodies.push(frame.bodies[0].clone());
        let mut builder = GeometryBuilder::default();
        let geometry = builder.build(&frame, None, coloring(ColorBy::Material));
        let corners = geometry.caster_triangles.iter().flatten();
        let cast: Vec<[f32; 3]> = corners.map(|corner| geometry.casters_m[*corner as usize]).collect();
        let seen: Vec<[f32; 3]> = geometry.vertices.iter().map(|vertex| vertex.position_m).collect();
        assert_eq!((cast.len(), cast), (12, seen));
    }

    #[test]
    fn body_with_missing_vertices_is_left_out() {
        let mut frame = hinge(10.0);
        frame.bodies[0].positions_m.pop();
        let mut builder = GeometryBuilder::default();
        let geometry = builder.build(&frame, None, coloring(ColorBy::Material));
        assert!(geometry.vertices.is_empty() && geometry.bounds_m.is_none());
    }
}
