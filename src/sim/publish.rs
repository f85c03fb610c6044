//! Writing a frame: what a renderer needs of this moment.

use super::body::{Body, Regime};
use super::{ElementStress, World};
use crate::contact::Constraint;
use crate::frame::{
    BodyFrame, BodyRole, ContactMark, Frame, FrameStatus, Interior, InteriorTopology, PullMark, Scales,
    SurfaceTopology, VertexFields,
};
use crate::math::symmetric_eigenvalues;
use glam::{DMat3, DVec3};
use std::sync::{Arc, OnceLock};

/// What does not change of a body's frames.
#[derive(Clone)]
pub(super) struct FrameParts {
    name: Arc<str>,
    palette_srgb: Arc<[[f32; 3]]>,
    scales: Scales,
    /// By element of the mesh as given.
    element_material: Vec<u32>,
    /// Found when somebody looks.
    surface: OnceLock<Arc<SurfaceTopology>>,
    /// The same.
    interior: OnceLock<Arc<InteriorTopology>>,
}

impl FrameParts {
    pub fn new(body: &Body, setup: &super::BodySetup) -> Self {
        Self {
            name: body.name.as_str().into(),
            palette_srgb: setup.materials.iter().map(|m| m.color_srgb).collect(),
            scales: scales(body, setup),
            element_material: setup.element_material.clone(),
            surface: OnceLock::new(),
            interior: OnceLock::new(),
        }
    }

    /// After the surface has changed, or what is behind it.
    pub fn forget_surface(&mut self) {
        self.surface = OnceLock::new();
        self.interior = OnceLock::new();
    }

    fn interior(&self, body: &Body) -> Arc<InteriorTopology> {
        let found = || {
            let breaking = body.breaking.as_ref();
            let elements = 0..body.tets.len() as u32;
            Arc::new(InteriorTopology {
                tets: body.tets.clone(),
                element_material: match breaking {
                    Some(breaking) => elements.map(|t| breaking.material(t)).collect(),
                    None => self.element_material.clone(),
                },
                element_fragment: breaking
                    .map_or_else(Vec::new, |b| b.solid.fragments().of_element().to_vec()),
            })
        };
        self.interior.get_or_init(found).clone()
    }

    fn surface(&self, body: &Body) -> Arc<SurfaceTopology> {
        self.surface.get_or_init(|| Arc::new(self.topology(body))).clone()
    }

    fn topology(&self, body: &Body) -> SurfaceTopology {
        let mut vertex_of = vec![u32::MAX; body.reference_m.len()];
        for (vertex, node) in body.surface.nodes.iter().enumerate() {
            vertex_of[*node as usize] = vertex as u32;
        }
        let triangles = &body.surface.triangles;
        let behind = &body.boundary.triangle_tet;
        let breaking = body.breaking.as_ref();
        let material =
            |t: &u32| breaking.map_or_else(|| self.element_material[*t as usize], |b| b.material(*t));
        let fragment = |t: &u32| breaking.map_or(0, |b| b.solid.fragments().of_element()[*t as usize]);
        SurfaceTopology {
            triangles: triangles.iter().map(|t| t.map(|n| vertex_of[n as usize])).collect(),
            triangle_material: behind.iter().map(material).collect(),
            triangle_is_crack: body.surface.crack_sides.iter().map(Option::is_some).collect(),
            triangle_is_section: Vec::new(),
            triangle_fragment: behind.iter().map(fragment).collect(),
            triangle_element: behind.clone(),
        }
    }
}

fn scales(body: &Body, setup: &super::BodySetup) -> Scales {
    let most = |of: fn(&super::Material) -> f64| setup.materials.iter().map(of).fold(0.0, f64::max) as f32;
    Scales {
        stiffness_pa: most(|material| material.youngs_modulus_pa),
        wave_speed_m_s: most(super::Material::bar_wave_speed_m_s),
        size_m: 2.0 * body.radius_m as f32,
    }
}

fn to_f32(x: DVec3) -> [f32; 3] {
    x.as_vec3().to_array()
}

/// Marks of the pairs that press.
pub(super) fn marks<'a>(
    constraints: impl Iterator<Item = &'a Constraint>,
    duration_s: f64,
) -> Vec<ContactMark> {
    constraints
        .filter(|c| c.impulse_n_s != DVec3::ZERO && duration_s > 0.0)
        .map(|c| ContactMark { position_m: to_f32(c.place_m), force_n: to_f32(c.impulse_n_s / duration_s) })
        .collect()
}

impl World {
    /// What a renderer needs of this moment.
    #[must_use]
    pub fn publish(&self) -> Frame {
        self.frame(false)
    }

    /// As [`World::publish`], with what is inside the bodies that are not fixed.
    #[must_use]
    pub fn publish_with_interior(&self) -> Frame {
        self.frame(true)
    }

    fn frame(&self, with_interior: bool) -> Frame {
        let bodies = self.bodies.iter().zip(&self.frame_parts).enumerate();
        let bodies =
            bodies.map(|(index, (body, parts))| self.body_frame(index, (body, parts), with_interior));
        Frame {
            time_s: self.time_s,
            bodies: bodies.collect(),
            contacts: self.marks.clone(),
            crosses: Vec::new(),
            pulls: self
                .pulls_m()
                .iter()
                .map(|[from, to]| PullMark { from_m: to_f32(*from), to_m: to_f32(*to) })
                .collect(),
            is_weightless: self.setup.gravity_m_s2 == DVec3::ZERO,
            status: self.status(),
        }
    }

    fn status(&self) -> FrameStatus {
        let deformable = || self.bodies.iter().filter(|b| b.is_deformable());
        let limits = self.fracture_limits_reached();
        FrameStatus {
            stage: self.last.stage.name().to_owned(),
            step_s: self.last.step_s,
            elements: deformable().map(|b| b.tets.len()).sum(),
            nodes: deformable().map(|b| b.reference_m.len()).sum(),
            contact_pairs: self.last.contact_pairs as usize,
            fragments: self.fragments,
            edges_left_whole: limits.elements,
            nodes_left_whole: limits.fragments,
            nodes_held_up: limits.speed,
            sleeping_bodies: deformable().filter(|b| b.regime == Regime::Asleep).count(),
            steps: self.steps,
        }
    }

    fn body_frame(
        &self,
        index: usize,
        (body, parts): (&Body, &FrameParts),
        with_interior: bool,
    ) -> BodyFrame {
        if body.is_removed {
            let role = BodyRole::Fixed;
            return BodyFrame {
                name: parts.name.clone(),
                palette_srgb: parts.palette_srgb.clone(),
                role,
                ..BodyFrame::default()
            };
        }
        let positions = self.positions_m(index);
        let nodes = &body.surface.nodes;
        let role = match body.regime {
            Regime::Fixed => BodyRole::Fixed,
            Regime::Kinematic => BodyRole::Kinematic,
            _ => BodyRole::Deformable,
        };
        // Once for the skin and for what is inside.
        let stresses = if role == BodyRole::Fixed { Vec::new() } else { self.element_stresses(index) };
        let interior = (with_interior && role != BodyRole::Fixed)
            .then(|| Arc::new(self.interior(index, (body, parts), &stresses)));
        BodyFrame {
            name: parts.name.clone(),
            role,
            palette_srgb: parts.palette_srgb.clone(),
            surface: parts.surface(body),
            positions_m: nodes.iter().map(|n| to_f32(positions[*n as usize])).collect(),
            fields: self.fields_at(index, (body, nodes), &stresses),
            scales: parts.scales,
            interior,
        }
    }

    fn interior(
        &self,
        index: usize,
        (body, parts): (&Body, &FrameParts),
        stresses: &[ElementStress],
    ) -> Interior {
        let nodes: Vec<u32> = (0..body.reference_m.len() as u32).collect();
        let six = |s: &ElementStress| {
            let s = s.cauchy_pa;
            [s.x_axis.x, s.y_axis.y, s.z_axis.z, s.x_axis.y, s.y_axis.z, s.z_axis.x].map(|value| value as f32)
        };
        Interior {
            topology: parts.interior(body),
            positions_m: self.positions_m(index).iter().copied().map(to_f32).collect(),
            fields: self.fields_at(index, (body, &nodes), stresses),
            stress_pa: stresses.iter().map(six).collect(),
        }
    }

    fn fields_at(
        &self,
        index: usize,
        (body, nodes): (&Body, &[u32]),
        stresses: &[ElementStress],
    ) -> VertexFields {
        let zero = || vec![0.0_f32; nodes.len()];
        let velocities = self.velocities_m_s(index);
        let mut fields = VertexFields {
            speed_m_s: nodes.iter().map(|n| velocities[*n as usize].length() as f32).collect(),
            displacement_m: zero(),
            von_mises_pa: zero(),
            max_principal_pa: zero(),
            min_principal_pa: zero(),
            mean_stress_pa: zero(),
            failure_index: zero(),
        };
        if matches!(body.regime, Regime::Elastic | Regime::Asleep) {
            let rigid = body.rigid_part();
            let away = |n: &u32| {
                let n = *n as usize;
                (body.position_m[n] - rigid.place_m(body.arms_m[n])).length() as f32
            };
            fields.displacement_m = nodes.iter().map(away).collect();
            fill_stress_fields(&mut fields, (body, nodes), stresses);
        }
        fields
    }
}

/// Stress values at nodes: means over the elements at a node, weighted by reference volume.
fn fill_stress_fields(fields: &mut VertexFields, (body, nodes): (&Body, &[u32]), stresses: &[ElementStress]) {
    let mut sums = vec![[0.0_f64; 6]; body.reference_m.len()];
    for ((element, tet), stress) in (0_u32..).zip(&body.tets).zip(stresses) {
        let volume_m3 = crate::mesh::signed_volume_m3(&tet.map(|n| body.reference_m[n as usize]));
        let p = stress.principal_pa;
        let index = body.breaking.as_ref().map_or(0.0, |b| b.failure_index(element, &stress.cauchy_pa));
        let values = [von_mises_pa(p), p.x, p.z, p.element_sum() / 3.0, index, 1.0];
        for node in tet {
            for (sum, value) in sums[*node as usize].iter_mut().zip(values) {
                *sum += volume_m3 * value;
            }
        }
    }
    for (vertex, node) in nodes.iter().enumerate() {
        let [mises, max, min, mean, index, weight] = sums[*node as usize];
        let of = |sum: f64| (sum / weight.max(f64::MIN_POSITIVE)) as f32;
        fields.von_mises_pa[vertex] = of(mises);
        fields.max_principal_pa[vertex] = of(max);
        fields.min_principal_pa[vertex] = of(min);
        fields.mean_stress_pa[vertex] = of(mean);
        fields.failure_index[vertex] = of(index);
    }
}

/// `sqrt(3 J2)`, Pa.
fn von_mises_pa(p: DVec3) -> f64 {
    (0.5 * ((p.x - p.y).powi(2) + (p.y - p.z).powi(2) + (p.z - p.x).powi(2))).sqrt()
}

/// Cauchy stress with its principal values.
pub(super) fn element_stress(cauchy_pa: DMat3) -> ElementStress {
    ElementStress { cauchy_pa, principal_pa: symmetric_eigenvalues(&cauchy_pa) }
}
