//! From the description of a scene to what the simulation starts from.

use super::apart::overlaps;
use super::description::{Body, BodyMaterial, GROUND, Ground, LateContact, Removal, SceneDescription};
use super::place::{Frame, Placed, place};
use super::problem::suggestion;
use super::selection::{PlacedMesh, select};
use super::shape_mesh::{ELEMENT_LIMIT, ShapeMesh, mesh_of};
use crate::mesh::TetMesh;
use crate::sim::{
    BodyMotion, BodySetup, BoundaryCondition, Change, ContactParameters, Entrance, Material, PairFriction,
    PlannedChange, Pull, WorldSetup,
};
use glam::DVec3;
use std::path::Path;

/// What is wrong with a scene whose text was sound: (path, message).
pub(super) type BuildProblem = (String, String);

/// What a scene was built into.
#[derive(Debug, Default)]
pub(super) struct Built {
    pub setup: WorldSetup,
    /// What reading the mesh files had to say: (body, note).
    pub notes: Vec<(String, String)>,
}

/// Builds a scene; mesh files are looked for from `folder`. Names may lead nowhere (which is told elsewhere): bodies
/// placed by those are left out.
///
/// # Errors
/// Every problem found, at least one.
pub(super) fn build(scene: &SceneDescription, folder: &Path) -> Result<Built, Vec<BuildProblem>> {
    let mut builder =
        Builder { scene, problems: Vec::new(), notes: Vec::new(), placed: Vec::new(), bodies: Vec::new() };
    let meshes = builder.meshes(folder);
    if !builder.check_size(&meshes) {
        // Nobody has the memory for it.
        return Err(builder.problems);
    }
    builder.ground();
    for (index, mesh) in meshes.into_iter().enumerate() {
        if let Some(mesh) = mesh {
            builder.body(index, &mesh);
        }
    }
    // Who enters later comes after all that are there, in the order of entering, as in the running world.
    builder.bodies.sort_by(|a, b| enters_s(scene, a).total_cmp(&enters_s(scene, b)));
    let there = builder.bodies.partition_point(|body| enters_s(scene, body) == FROM_THE_START);
    let overlaps = overlaps(scene, &builder.bodies[..there]);
    builder.problems.extend(overlaps);
    builder.finish()
}

/// One body of the world and the entry of the text it came from (`None`: the ground).
pub(super) struct BuiltBody {
    pub setup: BodySetup,
    pub entry: Option<usize>,
}

/// Stands before all times at which bodies enter.
const FROM_THE_START: f64 = f64::NEG_INFINITY;

fn enters_s(scene: &SceneDescription, body: &BuiltBody) -> f64 {
    let entry = body.entry.and_then(|entry| scene.bodies[entry].enters_s);
    entry.unwrap_or(FROM_THE_START)
}

struct Builder<'a> {
    scene: &'a SceneDescription,
    problems: Vec<BuildProblem>,
    notes: Vec<(String, String)>,
    placed: Vec<Placed>,
    bodies: Vec<BuiltBody>,
}

impl Builder<'_> {
    fn meshes(&mut self, folder: &Path) -> Vec<Option<ShapeMesh>> {
        let mut meshes = Vec::with_capacity(self.scene.bodies.len());
        let mut elements = 0;
        for (index, body) in self.scene.bodies.iter().enumerate() {
            // More than the limit is refused as a whole; so many meshes of that size would fill the memory before.
            if elements > ELEMENT_LIMIT {
                break;
            }
            match mesh_of(&body.shape, folder) {
                Ok(mesh) => {
                    let notes = mesh.notes.iter().map(|note| (body.name.clone(), note.clone()));
                    self.notes.extend(notes);
                    elements += mesh.mesh.tets.len();
                    meshes.push(Some(mesh));
                }
                Err(problem) => {
                    self.problem(index, &problem.key, problem.message);
                    meshes.push(None);
                }
            }
        }
        meshes
    }

    /// Copies multiply elements: the limit of one shape has to hold for all together. Returns whether it does.
    fn check_size(&mut self, meshes: &[Option<ShapeMesh>]) -> bool {
        let counts = meshes.iter().zip(&self.scene.bodies).map(|(mesh, body)| {
            let elements = mesh.as_ref().map_or(0, |mesh| mesh.mesh.tets.len());
            elements * body.copies.count as usize
        });
        let elements: usize = counts.sum();
        if elements > ELEMENT_LIMIT {
            self.problems.push((
                "bodies".to_owned(),
                format!(
                    "the scene has {elements} elements or more, and at most {ELEMENT_LIMIT} are allowed; \
                     take coarser shapes or fewer copies"
                ),
            ));
        }
        elements <= ELEMENT_LIMIT
    }

    fn problem(&mut self, entry: usize, key: &str, message: String) {
        self.problems.push((format!("bodies[{entry}].{key}"), message));
    }

    fn ground(&mut self) {
        let Some(ground) = &self.scene.ground else {
            return;
        };
        let mesh = ground_mesh(ground);
        let materials = self.materials([ground.material.as_str()], ground.color_srgb);
        self.placed.push(Placed::ground(mesh.clone()));
        self.bodies.push(BuiltBody {
            entry: None,
            setup: BodySetup {
                name: GROUND.to_owned(),
                element_material: vec![0; mesh.tets.len()],
                mesh,
                materials,
                motion: BodyMotion::Fixed,
                velocity_m_s: DVec3::ZERO,
                spin_rad_s: DVec3::ZERO,
                boundary: Vec::new(),
                mass_scaling_max_share: 0.0,
            },
        });
    }

    fn body(&mut self, entry: usize, shape: &ShapeMesh) {
        let body = &self.scene.bodies[entry];
        let element_material = element_materials(body, &shape.mesh).unwrap_or_else(|(key, message)| {
            self.problem(entry, &key, message);
            vec![0; shape.mesh.tets.len()]
        });
        if !self.has_its_neighbours(body) {
            return;
        }
        let frames = match place(body, &shape.mesh, &self.placed) {
            Ok(frames) => frames,
            Err((key, message)) => return self.problem(entry, key, message),
        };
        let materials = self.materials(body.material.names(), body.color_srgb);
        let mut placed = Placed::new(&body.name, frames[0]);
        for (name, frame) in body.names_of_copies().into_iter().zip(&frames) {
            let mesh = frame.applied_to(&shape.mesh);
            if !mesh.nodes_m.iter().all(|x| x.is_finite()) {
                let message = "the body lies beyond all numbers; check sizes and positions";
                return self.problem(entry, "position", message.to_owned());
            }
            let boundary = self.boundary(entry, &shape.mesh, &mesh);
            placed.meshes.push(mesh.clone());
            self.bodies.push(BuiltBody {
                entry: Some(entry),
                setup: BodySetup {
                    name,
                    mesh,
                    materials: materials.clone(),
                    element_material: element_material.clone(),
                    motion: body.motion.clone(),
                    velocity_m_s: body.velocity_m_s,
                    spin_rad_s: body.spin_rad_s,
                    boundary,
                    mass_scaling_max_share: body.mass_scaling_max_share,
                },
            });
        }
        self.placed.push(placed);
    }

    /// Whether the bodies that this one is placed by have been placed.
    fn has_its_neighbours(&self, body: &Body) -> bool {
        let wanted = [&body.placement.on, &body.placement.axes_of];
        wanted.into_iter().flatten().all(|name| self.placed.iter().any(|placed| placed.is_called(name)))
    }

    fn materials<'n>(
        &self,
        names: impl IntoIterator<Item = &'n str>,
        color: Option<[f32; 3]>,
    ) -> Vec<Material> {
        let found = names.into_iter().filter_map(|name| {
            let material = self.scene.materials.iter().find(|material| material.name == name)?;
            let mut material = material.clone();
            material.color_srgb = color.unwrap_or(material.color_srgb);
            Some(material)
        });
        found.collect()
    }

    fn boundary(&mut self, entry: usize, own: &TetMesh, world: &TetMesh) -> Vec<BoundaryCondition> {
        let boundary = &self.scene.bodies[entry].boundary;
        let mut conditions = Vec::with_capacity(boundary.len());
        for (index, condition) in boundary.iter().enumerate() {
            match select(PlacedMesh { own, world }, &condition.at) {
                Ok(nodes) => conditions.push(BoundaryCondition { nodes, action: condition.action.clone() }),
                Err(message) => {
                    self.problem(entry, &format!("boundary[{index}].at"), message);
                }
            }
        }
        conditions
    }

    fn finish(self) -> Result<Built, Vec<BuildProblem>> {
        if !self.problems.is_empty() {
            return Err(self.problems);
        }
        let contact = &self.scene.contact;
        let pairs = self.pair_friction();
        let is_there = |body: usize| enters_s(self.scene, &self.bodies[body]) == FROM_THE_START;
        let parameters = ContactParameters {
            method: contact.method,
            friction_coefficient: contact.friction_coefficient,
            pair_friction: pairs
                .iter()
                .copied()
                .filter(|pair| pair.bodies.into_iter().all(is_there))
                .collect(),
            self_collision: contact.self_collision,
            rest_speed_m_s: contact.rest_speed_m_s,
        };
        let names: Vec<String> = self.bodies.iter().map(|body| body.setup.name.clone()).collect();
        let late_contact = self.late_contact();
        let mut bodies = Vec::new();
        let mut changes = Vec::new();
        for (index, body) in self.bodies.into_iter().enumerate() {
            let time_s = enters_s(self.scene, &body);
            if time_s == FROM_THE_START {
                bodies.push(body.setup);
            } else {
                // By name: in the running world others may have come in before.
                let own = pairs.iter().filter(|pair| pair.bodies[1] == index);
                let friction = own.map(|pair| (names[pair.bodies[0]].clone(), pair.friction_coefficient));
                let entrance = Entrance { friction: friction.collect(), body: body.setup };
                changes.push(PlannedChange { time_s, change: Change::Enter(Box::new(entrance)) });
            }
        }
        let leave = |removal: &Removal| PlannedChange {
            time_s: removal.at_s,
            change: Change::Leave(removal.body.clone()),
        };
        changes.extend(self.scene.removals.iter().map(leave));
        changes.extend(late_contact);
        let pull = |pull: &Pull| PlannedChange {
            time_s: pull.begins_s(),
            change: Change::Pull(Box::new(pull.clone())),
        };
        changes.extend(self.scene.pulls.iter().map(pull));
        changes.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
        Ok(Built {
            setup: WorldSetup {
                gravity_m_s2: self.scene.gravity_m_s2,
                bodies,
                changes,
                contact: parameters,
                time: self.scene.time.clone(),
                fracture: self.scene.fracture.clone(),
            },
            notes: self.notes,
        })
    }

    /// Changes of contact; who names a body with copies means all of them.
    fn late_contact(&self) -> Vec<PlannedChange> {
        let names = |name: &String| -> Vec<String> {
            let bodies = self.bodies_called(name).into_iter();
            bodies.map(|body| self.bodies[body].setup.name.clone()).collect()
        };
        let planned = |late: &LateContact| {
            let mut change = late.change.clone();
            let pairs = late.change.pairs.iter().flat_map(|([a, b], friction)| {
                let seconds = names(b);
                let with =
                    move |a: String| seconds.clone().into_iter().map(move |b| ([a.clone(), b], *friction));
                names(a).into_iter().flat_map(with)
            });
            change.pairs = pairs.filter(|([a, b], _)| a != b).collect();
            PlannedChange { time_s: late.at_s, change: Change::Contact(Box::new(change)) }
        };
        self.scene.contact_changes.iter().map(planned).collect()
    }

    /// The pairs named in the text, then the ground with everybody not named together with it.
    fn pair_friction(&self) -> Vec<PairFriction> {
        let mut pairs: Vec<PairFriction> = Vec::new();
        let mut add = |a: usize, b: usize, friction_coefficient: f64| {
            let bodies = [a.min(b), a.max(b)];
            if a != b && !pairs.iter().any(|pair| pair.bodies == bodies) {
                pairs.push(PairFriction { bodies, friction_coefficient });
            }
        };
        for ([first, second], friction) in &self.scene.contact.pairs {
            for a in self.bodies_called(first) {
                for b in self.bodies_called(second) {
                    add(a, b, *friction);
                }
            }
        }
        let ground = self.scene.ground.as_ref();
        if let Some(friction) = ground.and_then(|ground| ground.friction_coefficient) {
            for b in 1..self.bodies.len() {
                add(0, b, friction);
            }
        }
        pairs
    }

    /// Bodies with this name, or copies of the entry with this name.
    fn bodies_called(&self, name: &str) -> Vec<usize> {
        let of_entry = |entry: Option<usize>| match entry {
            Some(entry) => self.scene.bodies[entry].name == name,
            None => name == GROUND,
        };
        let bodies = self.bodies.iter().enumerate();
        bodies
            .filter(|(_, body)| body.setup.name == name || of_entry(body.entry))
            .map(|(index, _)| index)
            .collect()
    }
}

/// Material of each element, an index into the body's list of materials; or (key, message).
fn element_materials(body: &Body, mesh: &TetMesh) -> Result<Vec<u32>, (String, String)> {
    let BodyMaterial::ByRegion(pairs) = &body.material else {
        return Ok(vec![0; mesh.tets.len()]);
    };
    let regions = || mesh.region_names.iter().map(String::as_str);
    for (region, _) in pairs {
        if !regions().any(|name| name == region) {
            let hint = suggestion(region, regions());
            let message = format!("the body has no region called `{region}`{hint}");
            return Err((format!("material.{region}"), message));
        }
    }
    let of_region: Vec<Option<usize>> =
        regions().map(|name| pairs.iter().position(|(region, _)| region == name)).collect();
    if let Some(missing) = of_region.iter().position(Option::is_none) {
        let message = format!(
            "region `{}` of the body has no material; name one for each of {}",
            mesh.region_names[missing],
            regions().collect::<Vec<_>>().join(", ")
        );
        return Err(("material".to_owned(), message));
    }
    let material = |region: &u32| of_region[*region as usize].unwrap_or(0) as u32;
    Ok(mesh.regions.iter().map(material).collect())
}

/// A box of six tetrahedra.
fn ground_mesh(ground: &Ground) -> TetMesh {
    let size_m = DVec3::new(ground.size_m, ground.size_m, ground.thickness_m);
    let [x, y] = ground.center_m;
    let top_m = DVec3::new(x, y, ground.height_m);
    let centre_m = top_m - DVec3::Z * (ground.thickness_m / 2.0);
    let mut mesh = super::shape_mesh::box_mesh(size_m);
    let frame = Frame::at(centre_m);
    mesh = frame.applied_to(&mesh);
    // Exactly level, whatever the rounding: bodies are placed to touch it.
    for node in &mut mesh.nodes_m {
        if node.z > centre_m.z {
            node.z = ground.height_m;
        }
    }
    mesh
}
