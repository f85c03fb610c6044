//! Breaking: what fails after an elastic step is cut, and the body's arrays follow (METHOD 6 and 7).
//!
//! One body keeps all its fragments: elements and nodes are only ever added (see `follow`).
//!
//! Failure is looked for at the end of steps, as often as the fastest crack needs to cross half the smallest altitude of the
//! mesh as given: between two looks no crack could have gone on. Slow cracks are looked for as often as those of half the shear
//! wave speed: where they begin, stresses come and go with the waves. A look costs nothing where no chunk of elements is strained as
//! much as the weakest material must be to fail (the force loop knows), else the stresses of those chunks.

use super::body::Body;
use super::elastic::StepContext;
use super::release::Releases;
use super::{
    BodyMotion, BodySetup, FractureParameters, Kinematics, NEVER_FAILED_S, SimError, bars_to_breaking,
};
use crate::fem::{ElasticConstants, ElementBatches, StepBound};
use crate::fracture::{
    Changes, CrackPace, Criterion, CriterionError, Failure, FractureLimits, Growth, LimitsReached, NodeState,
    PrincipalStress, Propagation, Solid, StressMeasures,
};
use crate::math::symmetric_eigenvalues_estimate;
use crate::mesh::Renumbering;
use glam::{DMat3, DQuat, DVec3};

/// Crack speed over that of the slowest shear wave in what breaks, when the scene does not say.
const CRACK_SPEED_SHARE: f64 = 0.5;
/// Time between looks for failure in crossings of the smallest altitude by the fastest crack.
const LOOK_SHARE: f64 = 0.5;
/// Failure index of the estimated principal stresses below which an element does not fail for certain.
const SURELY_WHOLE: f64 = 0.99;
/// Allowance of the strain filter for what moved since the strain was measured.
const STRAIN_MARGIN: f64 = 0.9;

/// The part of a body that knows how it breaks.
#[derive(Clone)]
pub(super) struct Breaking {
    pub solid: Solid,
    /// By material of the body.
    criteria: Vec<Option<Criterion>>,
    /// By element of the mesh as given.
    origin_material: Vec<u32>,
    propagation: Propagation,
    pace: CrackPace,
    /// Fragments at the start.
    first_fragments: usize,
    /// `sqrt(E : E)` below which nothing can fail.
    safe_strain: f64,
    look_every_s: f64,
    next_look_s: f64,
    /// Area of crack faces in the reference shape, one side counted, m2.
    pub crack_area_m2: f64,
    /// By element: when it first took part in a crack, s; [`super::NEVER_FAILED_S`] before.
    pub failure_times_s: Vec<f64>,
    pub limits: LimitsReached,
    /// By node: the fragment that it belongs to.
    fragment_of_node: Vec<u32>,
    pub crack_speed_m_s: f64,
    /// The stable step of the body as cut, once it has been,
    pub step_bound: Option<StepBound>,
    /// and the shortest that cuts can make it, s.
    pub step_floor_s: f64,
    /// Cracks that are opening.
    pub releases: Releases,
}

impl Breaking {
    /// What `setup` breaks by, if any of its materials does.
    ///
    /// # Errors
    /// [`SimError::Setup`] where fracture does not go together with something else.
    pub fn new(setup: &BodySetup, parameters: &FractureParameters) -> Result<Option<Self>, SimError> {
        let BodyMotion::Deformable(kinematics) = setup.motion else { return Ok(None) };
        if !setup.can_break() {
            return Ok(None);
        }
        let fail = |text: String| SimError::Setup(format!("body `{}`: {text}", setup.name));
        if let Some(why) =
            bars_to_breaking(kinematics, setup.mass_scaling_max_share).into_iter().flatten().next()
        {
            return Err(fail(format!("a body that can break {why}")));
        }
        let constants = super::body::elastic_constants(setup)?;
        let of_element = |e: usize| constants[setup.element_material[e] as usize];
        let density: Vec<f64> = (0..setup.mesh.tets.len()).map(|e| of_element(e).density_kg_m3).collect();
        let altitude_share = parameters.smallest_altitude_share;
        let solid =
            Solid::new(&setup.mesh, &density, altitude_share).map_err(|error| fail(error.to_string()))?;
        let criteria: Vec<_> = setup.materials.iter().map(|m| m.fracture.clone()).collect();
        let breakable = constants.iter().zip(&criteria).filter(|(_, criterion)| criterion.is_some());
        let shear_m_s = breakable.map(|(c, _)| (c.mu_pa / c.density_kg_m3).sqrt());
        let natural_speed_m_s = CRACK_SPEED_SHARE * shear_m_s.fold(f64::INFINITY, f64::min);
        let crack_speed_m_s = parameters.crack_speed_m_s.unwrap_or(natural_speed_m_s);
        let safe_strains = criteria.iter().zip(&constants).filter_map(|(criterion, constants)| {
            Some(safe_strain(criterion.as_ref()?.safe_norm_pa(), constants, kinematics))
        });
        let safe_strain = safe_strains.fold(f64::INFINITY, f64::min);
        let step_floors_s = constants.iter().map(|c| c.stable_step_floor_s(solid.altitude_floor_m()));
        Ok(Some(Self {
            propagation: propagation(&solid, parameters),
            pace: CrackPace::new(crack_speed_m_s, parameters.crack_spacing_elements, solid.tets().len()),
            first_fragments: solid.fragments().list().len(),
            safe_strain,
            look_every_s: LOOK_SHARE * solid.altitude_floor_m()
                / altitude_share
                / crack_speed_m_s.max(natural_speed_m_s),
            next_look_s: 0.0,
            crack_area_m2: 0.0,
            failure_times_s: vec![NEVER_FAILED_S; solid.tets().len()],
            limits: LimitsReached::default(),
            fragment_of_node: (0..solid.node_count() as u32).map(|n| fragment_of_node(&solid, n)).collect(),
            crack_speed_m_s,
            step_bound: None,
            step_floor_s: step_floors_s.fold(f64::INFINITY, f64::min),
            releases: Releases::default(),
            origin_material: setup.element_material.clone(),
            criteria,
            solid,
        }))
    }

    /// Whether the body has come apart.
    pub fn is_broken(&self) -> bool {
        self.solid.fragments().list().len() > self.first_fragments
    }

    /// The fragment that each node belongs to; not below their number for a node without elements.
    pub fn fragment_of_node(&self) -> &[u32] {
        &self.fragment_of_node
    }

    /// Material of an element, an index into the body's materials.
    pub fn material(&self, element: u32) -> u32 {
        self.origin_material[self.solid.origins()[element as usize] as usize]
    }

    /// Failure index of a state of stress in an element: 0 unstressed, 1 fails.
    pub fn failure_index(&self, element: u32, cauchy_pa: &DMat3) -> f64 {
        let Some(criterion) = &self.criteria[self.material(element) as usize] else { return 0.0 };
        criterion.assess(&PrincipalStress::of(cauchy_pa).measures()).map_or(0.0, |found| found.index)
    }

    /// The failure of an element, if it does fail.
    fn failure(
        &self,
        element: u32,
        cauchy_pa: &DMat3,
        positions_m: &[DVec3],
    ) -> Result<Option<Failure>, CriterionError> {
        let Some(criterion) = &self.criteria[self.material(element) as usize] else { return Ok(None) };
        let norm2: f64 = cauchy_pa.to_cols_array().iter().map(|s| s * s).sum();
        if norm2 < criterion.safe_norm_pa().powi(2) {
            return Ok(None);
        }
        let estimate = StressMeasures::of(symmetric_eigenvalues_estimate(cauchy_pa));
        if estimate.is_finite() && criterion.assess(&estimate)?.index < SURELY_WHOLE {
            return Ok(None);
        }
        let stress = PrincipalStress::of(cauchy_pa);
        let found = criterion.assess(&stress.measures())?;
        if !found.fails() {
            return Ok(None);
        }
        let crack_normal = self.solid.crack_normal_near(element, positions_m);
        let normal = criterion.normal(found.rule, &stress, crack_normal);
        Ok(Some(Failure { element, normal, index: found.index }))
    }

    fn take_note(&mut self, changes: &Changes, time_s: f64) {
        self.pace.record(&self.solid, changes, time_s);
        self.note_failure_times(changes, time_s);
        let reference_m = self.solid.reference_m();
        for face in &changes.crack_faces {
            let [a, b, c] = face.nodes.map(|n| reference_m[n as usize]);
            // Both sides are listed, a quarter of the cross product each.
            self.crack_area_m2 += 0.25 * (b - a).cross(c - a).length();
        }
        self.sort_nodes(changes);
    }

    /// An element takes part in a crack when one of its faces opens, or one of a part cut from it.
    fn note_failure_times(&mut self, changes: &Changes, time_s: f64) {
        let times_s = &mut self.failure_times_s;
        for new in &changes.new_elements {
            times_s.push(times_s[new.cut_from as usize]);
        }
        let has_failed = |failure_time_s: f64| failure_time_s != NEVER_FAILED_S;
        let fail = |failure_time_s: &mut f64| {
            if !has_failed(*failure_time_s) {
                *failure_time_s = time_s;
            }
        };
        changes.crack_faces.iter().for_each(|face| fail(&mut times_s[face.element as usize]));
        // From parts to wholes, and back to all parts.
        for new in changes.new_elements.iter().rev() {
            if has_failed(times_s[new.element as usize]) {
                fail(&mut times_s[new.cut_from as usize]);
            }
        }
        for new in &changes.new_elements {
            if has_failed(times_s[new.cut_from as usize]) {
                fail(&mut times_s[new.element as usize]);
            }
        }
    }

    fn sort_nodes(&mut self, changes: &Changes) {
        let tets = self.solid.tets();
        let of_fragments = changes.new_fragments.iter().flat_map(|new| &new.elements);
        let moved = of_fragments.flat_map(|element| tets[*element as usize]);
        self.fragment_of_node.resize(self.solid.node_count(), NO_FRAGMENT);
        for node in changes.touched_nodes.iter().copied().chain(moved) {
            self.fragment_of_node[node as usize] = fragment_of_node(&self.solid, node);
        }
    }
}

/// Stands for the fragment of a node without elements.
const NO_FRAGMENT: u32 = u32::MAX;

fn fragment_of_node(solid: &Solid, node: u32) -> u32 {
    let of_element = solid.fragments().of_element();
    solid.elements_at(node).first().map_or(NO_FRAGMENT, |element| of_element[*element as usize])
}

fn propagation(solid: &Solid, parameters: &FractureParameters) -> Propagation {
    let suited = FractureLimits::for_body(solid);
    let elements = solid.tets().len().max(1);
    let mean_kg = solid.masses_kg().iter().sum::<f64>() / elements as f64;
    let limits = FractureLimits {
        max_elements: parameters.max_elements.map_or(suited.max_elements, |most| most as usize),
        smallest_fragment_kg: parameters.smallest_fragment_elements * mean_kg,
        ..suited
    };
    Propagation { rule: parameters.rule, limits, ..Propagation::default() }
}

/// Largest strain `e = sqrt(E : E)` at which the Cauchy stress cannot have the given norm.
fn safe_strain(norm_pa: f64, constants: &ElasticConstants, kinematics: Kinematics) -> f64 {
    let of_elements = kinematics.of_elements(DQuat::IDENTITY);
    let bound_pa = |e: f64| ElementBatches::most_stress_pa(constants, of_elements, e);
    let (mut safe, mut unsafe_) = (0.0, 0.5);
    for _ in 0..60 {
        let middle = 0.5 * (safe + unsafe_);
        if bound_pa(middle) < norm_pa { safe = middle } else { unsafe_ = middle }
    }
    STRAIN_MARGIN * safe
}

impl Body {
    /// Lets cracks grow at the end of a step where the body fails; tells what they did and what became of the numbers
    /// of the surface.
    ///
    /// # Errors
    /// A typed criterion that cannot be evaluated for a stress that occurs.
    pub fn let_cracks_grow(
        &mut self,
        context: &StepContext,
    ) -> Result<Option<(Changes, Renumbering)>, SimError> {
        let time_s = context.time_s;
        let Some(breaking) = &mut self.breaking else { return Ok(None) };
        if time_s < breaking.next_look_s {
            return Ok(None);
        }
        breaking.next_look_s = time_s + breaking.look_every_s;
        let failures = self.failures(time_s)?;
        let Some(breaking) = self.breaking.as_mut().filter(|_| !failures.is_empty()) else { return Ok(None) };
        let nodes = NodeState { positions_m: &mut self.position_m, velocities_m_s: &mut self.velocity_m_s };
        let pace = &breaking.pace;
        let may_crack = |element: u32, growth: Growth| pace.may_crack(element, growth, time_s);
        let changes = breaking.solid.propagate(nodes, &failures, &breaking.propagation, may_crack);
        breaking.limits += changes.limits;
        if changes.is_empty() {
            return Ok(None);
        }
        breaking.take_note(&changes, time_s);
        let numbers = self.follow(context, &changes)?;
        Ok(Some((changes, numbers)))
    }

    fn failures(&self, time_s: f64) -> Result<Vec<Failure>, SimError> {
        let (Some(breaking), Some(elasticity)) = (&self.breaking, &self.elasticity) else {
            return Ok(Vec::new());
        };
        let judge = |element: u32, cauchy_pa: &DMat3| {
            let failure = breaking
                .failure(element, cauchy_pa, &self.position_m)
                .map_err(|error| SimError::Criterion { body: self.name.clone(), element, time_s, error });
            failure.transpose().map(|failure| (element, failure))
        };
        let mut judged = elasticity.elements.judge_strained(
            &elasticity.scratch,
            &self.position_m,
            self.element_kinematics(),
            breaking.safe_strain,
            judge,
        );
        judged.sort_by_key(|(element, _)| *element);
        judged.into_iter().map(|(_, failure)| failure).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fracture::Strength;
    use crate::mesh::shapes::block;
    use crate::sim::Material;

    #[test]
    fn cracks_are_as_fast_as_the_slowest_material_that_breaks_lets_them() {
        let mesh = block([2, 1, 1]);
        let brittle = |youngs_modulus_pa: f64| {
            let criterion = Criterion::single(Strength::Tensile { tensile_strength_pa: 1e6 }).unwrap();
            let elastic = Material::elastic("brittle", 1000.0, youngs_modulus_pa, 0.25);
            Material { fracture: Some(criterion), ..elastic }
        };
        let speed_m_s = |second: Material| {
            let mut setup = BodySetup::at_rest("two", mesh.clone(), brittle(1e9));
            setup.element_material = (0..mesh.tets.len()).map(|e| u32::from(e >= 6)).collect();
            setup.materials.push(second);
            Breaking::new(&setup, &FractureParameters::default()).unwrap().unwrap().crack_speed_m_s
        };
        // Half of sqrt(mu / rho), mu = 0.4 E.
        let expected_m_s = |youngs_modulus_pa: f64| 0.5 * (0.4 * youngs_modulus_pa / 1000.0).sqrt();
        let of_rubber = speed_m_s(Material::elastic("rubber", 1000.0, 1e6, 0.25));
        assert!((of_rubber / expected_m_s(1e9) - 1.0).abs() < 1e-12, "{of_rubber} m/s");
        let of_two = speed_m_s(brittle(1e8));
        assert!((of_two / expected_m_s(1e8) - 1.0).abs() < 1e-12, "{of_two} m/s");
    }
}
