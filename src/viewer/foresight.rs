//! What a throw would bring in, before it is let go: the very body, built by the same words, what it weighs, and a free place in
//! sight from where it can start.

use super::pick;
use super::thrown::Throw;
use crate::frame::{BodyFrame, Frame};
use crate::math::MassProperties;
use crate::mesh::{Surface, signed_volume_m3};
use crate::render::{Camera, Ray};
use crate::sim::{BodySetup, raise_clear};
use glam::{DVec3, Vec2, Vec3};
use std::sync::Arc;

/// Most balls that stand for a body: 2 to this power.
const MOST_HALVINGS: u32 = 4;
/// A body is halved where the balls around its halves are smaller than this share of that around it.
const WORTH_HALVING: f32 = 0.8;
/// Free room around the body, as a share of its reach.
const GAP_SHARE: f32 = 0.03;
/// Least step towards the eye in search of a free place, as a share of the body's reach.
const STEP_SHARE: f32 = 0.05;
/// Nearest that the body's middle may be to the eye, as a share of its reach: nearer, it would hide everything.
const NEAREST_SHARE: f32 = 1.5;

/// Most by which it starts higher than the mouse points and still is looked for by its shape, as a share of its reach.
const MOST_LIFT: f32 = 3.0;
/// Places on the way to the eye above which a free one is looked for.
const LIFTED_FROM: u32 = 8;

/// A body that would be thrown in.
#[derive(Clone, Debug, PartialEq)]
pub struct Foreseen {
    /// Number of the question that it answers.
    pub number: u64,
    /// What was to be thrown.
    pub throw: Throw,
    /// What it weighs.
    mass: MassProperties,
    /// Its nodes about its place, m.
    nodes_m: Vec<Vec3>,
    /// Its skin.
    pub surface: Surface,
    /// Balls that together cover it: middle about its place and radius, m.
    balls: Vec<(Vec3, f32)>,
}

/// The body at the place where it would start.
#[derive(Clone, Debug)]
pub struct Ghost {
    /// The body.
    pub foreseen: Arc<Foreseen>,
    /// Its nodes there, m.
    pub nodes_m: Vec<Vec3>,
    /// Where its middle is, m.
    pub start_m: Vec3,
    /// How much higher it starts than where the mouse was pressed, where there is no free place on the way to the eye, m.
    pub lift_m: f32,
    seen_by: Sight,
}

/// What the place of the start is found from.
#[derive(Clone, Debug)]
pub struct Sight {
    /// What is seen.
    pub frame: Arc<Frame>,
    /// From where.
    pub camera: Camera,
    /// Width over height of the picture.
    pub aspect: f32,
    /// Where the mouse was pressed, a share of the picture.
    pub at: Vec2,
}

impl PartialEq for Sight {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.frame, &other.frame)
            && (self.camera, self.aspect, self.at) == (other.camera, other.aspect, other.at)
    }
}

impl Foreseen {
    /// Of a body that was built for a throw from a place.
    #[must_use]
    pub fn new(number: u64, throw: &Throw, position_m: DVec3, body: &BodySetup) -> Self {
        let mesh = &body.mesh;
        let nodes_m: Vec<Vec3> = mesh.nodes_m.iter().map(|x| (x - position_m).as_vec3()).collect();
        let mut balls = Vec::new();
        let mut tets: Vec<[Vec3; 4]> =
            mesh.tets.iter().map(|tet| tet.map(|node| nodes_m[node as usize])).collect();
        cover(&mut tets, MOST_HALVINGS, &mut balls);
        let mass = mass_of(body);
        Self { number, throw: throw.clone(), mass, nodes_m, surface: Surface::of(&mesh.tets), balls }
    }

    /// Its mass, kg.
    #[must_use]
    pub fn mass_kg(&self) -> f64 {
        self.mass.mass_kg
    }

    /// Its energy of motion, J, with this velocity, m/s, and spin, rad/s.
    #[must_use]
    pub fn kinetic_j(&self, velocity_m_s: DVec3, spin_rad_s: DVec3) -> f64 {
        let turning_j = 0.5 * spin_rad_s.dot(self.mass.inertia_kg_m2 * spin_rad_s);
        0.5 * self.mass.mass_kg * velocity_m_s.length_squared() + turning_j
    }

    /// Largest distance from its place, m.
    fn reach_m(&self) -> f32 {
        self.balls.iter().map(|(middle_m, radius_m)| middle_m.length() + radius_m).fold(0.0, f32::max)
    }

    /// A free place in sight, and how much higher it is than what is under the mouse, m: in front of what is seen there and as far
    /// away as what the camera looks at, or else as little nearer to the eye as it needs; where there is none up to the eye, as
    /// little higher as it needs. `None` where nothing is free before the eye.
    fn place_in_sight(&self, sight: &Sight) -> Option<(Vec3, f32)> {
        let ray = sight.camera.ray_in_world(sight.at, sight.aspect);
        let focus_m = (pick::in_focus(&sight.camera, &ray) - ray.origin_m).length();
        let hit = pick::pick(&sight.frame, &ray).map(|hit| (hit.point_m - ray.origin_m).length());
        let far_m = hit.map_or(focus_m, |hit_m| hit_m.min(focus_m));
        let (reach_m, gap_m) = (self.reach_m(), GAP_SHARE * self.reach_m());
        let near_m = NEAREST_SHARE * reach_m;
        let around =
            triangles_along(&sight.frame, &ray, [near_m, far_m], (1.0 + MOST_LIFT) * reach_m + gap_m);
        let to_eye = |at_m: f32| ray.origin_m + ray.direction * (far_m - at_m);
        if let Some(at_m) = self.first_free(far_m - near_m, &around, to_eye) {
            return Some((to_eye(at_m), 0.0));
        }
        let lifted = (0..LIFTED_FROM).filter_map(|index| {
            let from_m = to_eye((far_m - near_m) * index as f32 / LIFTED_FROM as f32);
            let up = |lift_m: f32| from_m + Vec3::Z * lift_m;
            let lift_m = self.first_free(MOST_LIFT * reach_m, &around, up)?;
            sight.shows(up(lift_m)).then_some((up(lift_m), lift_m))
        });
        lifted.filter(|_| far_m > near_m).min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// How far to go, m, on a way until it is free from triangles; `None` where it is not before its end.
    fn first_free(&self, end_m: f32, triangles: &[Triangle], way: impl Fn(f32) -> Vec3) -> Option<f32> {
        let reach_m = self.reach_m();
        let mut at_m = 0.0;
        while at_m <= end_m {
            let lacking_m = self.lacking_m(way(at_m), triangles, GAP_SHARE * reach_m);
            if lacking_m <= 0.0 {
                return Some(at_m);
            }
            // Distances change no faster than the place does: no free one is left out, up to the least step.
            at_m += lacking_m.max(STEP_SHARE * reach_m);
        }
        None
    }

    /// By how much its distance from triangles is less than a gap, m, if its middle is at a place.
    fn lacking_m(&self, place_m: Vec3, triangles: &[Triangle], gap_m: f32) -> f32 {
        let of_ball = |(middle_m, radius_m): &(Vec3, f32)| {
            let (middle_m, least_m) = (place_m + *middle_m, radius_m + gap_m);
            let near = triangles.iter().filter(|t| (t.middle_m - middle_m).length() < least_m + t.radius_m);
            near.map(|t| least_m - distance_m(middle_m, &t.corners_m)).fold(0.0, f32::max)
        };
        self.balls.iter().map(of_ball).fold(0.0, f32::max)
    }
}

impl Sight {
    /// Whether a point is in the picture, and nothing hides it.
    fn shows(&self, point_m: Vec3) -> bool {
        let Some(at) = self.camera.picture_position(point_m, self.aspect) else { return false };
        let ray = self.camera.ray_in_world(at, self.aspect);
        let hit = pick::pick(&self.frame, &ray).map(|hit| hit.point_m.distance(ray.origin_m));
        let is_hidden = hit.is_some_and(|hit_m| hit_m < point_m.distance(ray.origin_m));
        at.cmpge(Vec2::ZERO).all() && at.cmple(Vec2::ONE).all() && !is_hidden
    }
}

impl Ghost {
    /// Where a body would start.
    #[must_use]
    pub fn new(foreseen: Arc<Foreseen>, sight: Sight) -> Self {
        let found = foreseen.place_in_sight(&sight);
        let (asked_m, mut lift_m) = found.unwrap_or_else(|| {
            (pick::in_focus(&sight.camera, &sight.camera.ray_in_world(sight.at, sight.aspect)), 0.0)
        });
        let mut nodes_m: Vec<DVec3> = foreseen.nodes_m.iter().map(|x| (asked_m + *x).as_dvec3()).collect();
        let mut start_m = asked_m;
        if found.is_none() {
            let before_m = nodes_m.first().map_or(0.0, |x| x.z);
            raise_clear(&mut nodes_m, &boxes_m(&sight.frame));
            lift_m = nodes_m.first().map_or(0.0, |x| x.z - before_m) as f32;
            start_m.z += lift_m;
        }
        let nodes_m = nodes_m.iter().map(|x| x.as_vec3()).collect();
        Self { foreseen, nodes_m, start_m, lift_m, seen_by: sight }
    }

    /// Whether it is what this would come to.
    #[must_use]
    pub fn is_of(&self, foreseen: &Arc<Foreseen>, sight: &Sight) -> bool {
        Arc::ptr_eq(&self.foreseen, foreseen) && self.seen_by == *sight
    }

    /// Whether its middle is in the picture.
    #[must_use]
    pub fn is_in_sight(&self) -> bool {
        self.seen_by.shows(self.start_m)
    }
}

/// A quarter of each element's mass goes to each of its nodes, as in the simulation.
fn mass_of(body: &BodySetup) -> MassProperties {
    let mut masses_kg = vec![0.0; body.mesh.nodes_m.len()];
    for (index, tet) in body.mesh.tets.iter().enumerate() {
        let material =
            body.element_material.get(index).and_then(|number| body.materials.get(*number as usize));
        let density_kg_m3 = material.map_or(0.0, |material| material.density_kg_m3);
        let share_kg = 0.25 * density_kg_m3 * signed_volume_m3(&body.mesh.corners_m(index)).abs();
        tet.iter().for_each(|node| masses_kg[*node as usize] += share_kg);
    }
    MassProperties::of_points(&masses_kg, &body.mesh.nodes_m)
}

/// Covers elements with balls: one, or those of its halves where they are much smaller.
fn cover(tets: &mut [[Vec3; 4]], halvings: u32, balls: &mut Vec<(Vec3, f32)>) {
    if tets.is_empty() {
        return;
    }
    let whole = ball_around(tets);
    let (low, high) = bounds_m(tets);
    let size = high - low;
    let along = |x: &[Vec3; 4]| x.iter().sum::<Vec3>()[size.max_position()];
    tets.sort_by(|a, b| along(a).total_cmp(&along(b)));
    let (one, other) = tets.split_at_mut(tets.len() / 2);
    let is_worth = |half: &[[Vec3; 4]]| !half.is_empty() && ball_around(half).1 < WORTH_HALVING * whole.1;
    if halvings > 0 && is_worth(one) && is_worth(other) {
        cover(one, halvings - 1, balls);
        cover(other, halvings - 1, balls);
    } else {
        balls.push(whole);
    }
}

fn bounds_m(tets: &[[Vec3; 4]]) -> (Vec3, Vec3) {
    tets.iter().flatten().fold((Vec3::MAX, Vec3::MIN), |(low, high), x| (low.min(*x), high.max(*x)))
}

fn ball_around(tets: &[[Vec3; 4]]) -> (Vec3, f32) {
    let (low, high) = bounds_m(tets);
    let middle_m = 0.5 * (low + high);
    (middle_m, tets.iter().flatten().map(|x| x.distance(middle_m)).fold(0.0, f32::max))
}

/// A triangle and a ball around it, m.
struct Triangle {
    corners_m: [Vec3; 3],
    middle_m: Vec3,
    radius_m: f32,
}

/// What of a frame is nearer than `reach_m` to a part of a ray.
fn triangles_along(frame: &Frame, ray: &Ray, [from_m, to_m]: [f32; 2], reach_m: f32) -> Vec<Triangle> {
    let of_body = |body: &BodyFrame| {
        let corner = |node: u32| body.positions_m.get(node as usize).map(|x| Vec3::from(*x));
        let triangles = body.surface.triangles.iter().filter_map(|&[a, b, c]| {
            let corners_m = [corner(a)?, corner(b)?, corner(c)?];
            let middle_m = corners_m.iter().sum::<Vec3>() / 3.0;
            let radius_m = corners_m.iter().map(|x| x.distance(middle_m)).fold(0.0, f32::max);
            let along_m = (middle_m - ray.origin_m).dot(ray.direction).max(from_m).min(to_m);
            let is_near = (ray.origin_m + ray.direction * along_m).distance(middle_m) < reach_m + radius_m;
            is_near.then_some(Triangle { corners_m, middle_m, radius_m })
        });
        triangles.collect::<Vec<_>>()
    };
    frame.bodies.iter().flat_map(of_body).collect()
}

/// Distance of a point from a triangle, m.
fn distance_m(point_m: Vec3, [a, b, c]: &[Vec3; 3]) -> f32 {
    let normal = (*b - *a).cross(*c - *a);
    let is_inside = |from: &Vec3, to: &Vec3| (*to - *from).cross(point_m - *from).dot(normal) >= 0.0;
    if normal != Vec3::ZERO && is_inside(a, b) && is_inside(b, c) && is_inside(c, a) {
        return (point_m - *a).dot(normal.normalize()).abs();
    }
    let of_edge = |from: &Vec3, to: &Vec3| {
        let way = *to - *from;
        let share =
            ((point_m - *from).dot(way) / way.length_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
        point_m.distance(*from + way * share)
    };
    of_edge(a, b).min(of_edge(b, c)).min(of_edge(c, a))
}

/// The boxes around the bodies that are seen, m.
fn boxes_m(frame: &Frame) -> Vec<(DVec3, DVec3)> {
    let exact = |corner_m: [f32; 3]| Vec3::from(corner_m).as_dvec3();
    let bounds = frame.bodies.iter().filter_map(BodyFrame::bounds_m);
    bounds.map(|(low, high)| (exact(low), exact(high))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::SurfaceTopology;
    use crate::mesh::shapes::{Ball, BoxShape, Hammer, Meshing, Shape};
    use crate::mesh::{TetMesh, overlap};
    use crate::viewer::thrown::{Placing, TOOL, ThrowKind, rubber};

    fn foreseen(mesh: TetMesh) -> Arc<Foreseen> {
        let throw = Throw {
            kind: ThrowKind::Ball,
            material: TOOL.to_owned(),
            scale: 1.0,
            placing: Placing::Above { top_m: None },
        };
        Arc::new(Foreseen::new(1, &throw, DVec3::ZERO, &BodySetup::at_rest("it", mesh, rubber())))
    }

    fn seen(mesh: &TetMesh) -> BodyFrame {
        let surface =
            SurfaceTopology { triangles: Surface::of(&mesh.tets).triangles, ..SurfaceTopology::default() };
        BodyFrame {
            positions_m: mesh.nodes_m.iter().map(|x| x.as_vec3().to_array()).collect(),
            surface: Arc::new(surface),
            ..BodyFrame::default()
        }
    }

    fn shape(shape: Shape) -> TetMesh {
        shape.build(&Meshing::default()).unwrap()
    }

    fn box_at(middle_m: DVec3, size_m: DVec3) -> TetMesh {
        let mut mesh = shape(Shape::Box(BoxShape { size_m }));
        mesh.nodes_m.iter_mut().for_each(|x| *x += middle_m);
        mesh
    }

    /// The mouse is pressed on bodies that lie about: the start was lifted over the boxes around them all, out of sight.
    #[test]
    fn a_start_is_free_in_sight_and_near_what_was_pressed_on() {
        let ground = box_at(DVec3::new(0.0, 0.0, -0.5), DVec3::new(20.0, 20.0, 1.0));
        let tower = box_at(DVec3::new(0.1, 0.0, 1.5), DVec3::new(0.2, 0.2, 3.0));
        let frame = Arc::new(Frame { bodies: [&ground, &tower].map(seen).into(), ..Frame::default() });
        let camera = Camera { target_m: Vec3::new(0.0, 0.0, 0.5), distance_m: 6.0, ..Camera::default() };
        for thrown in [shape(Shape::Hammer(Hammer::default())), shape(Shape::Ball(Ball::default()))] {
            let foreseen = foreseen(thrown.clone());
            let reach_m = foreseen.reach_m();
            for at in [Vec2::new(0.5, 0.5), Vec2::new(0.3, 0.8), Vec2::new(0.52, 0.2), Vec2::new(0.45, 0.55)]
            {
                let sight = Sight { frame: frame.clone(), camera, aspect: 1.5, at };
                let ghost = Ghost::new(foreseen.clone(), sight);
                assert!(ghost.lift_m == 0.0 && ghost.is_in_sight(), "{at}: {} m higher", ghost.lift_m);
                let seen_at = camera.picture_position(ghost.start_m, 1.5).unwrap();
                assert!((seen_at - at).length() < 1e-4, "{at}: {seen_at}");
                let nodes_m = ghost.nodes_m.iter().map(|x| x.as_dvec3()).collect();
                let there = TetMesh { nodes_m, ..thrown.clone() };
                assert!([&ground, &tower].iter().all(|body| overlap(body, &there).is_none()), "{at}");
                let ray = camera.ray_in_world(at, 1.5);
                let asked_m =
                    [Some(pick::in_focus(&camera, &ray)), pick::pick(&frame, &ray).map(|hit| hit.point_m)];
                let nearer_m = asked_m.into_iter().flatten().map(|x| x.distance(ghost.start_m));
                // A flat look at the ground takes a longer way to come clear of it.
                let nearer_m = nearer_m.fold(f32::MAX, f32::min);
                assert!(nearer_m < 5.0 * reach_m, "{at}: {nearer_m}, reach {reach_m}");
            }
        }
    }

    /// With the eye near the ground, a body over the lower edge of the picture would be in the ground all the way to the eye.
    #[test]
    fn a_start_near_the_ground_is_as_little_higher_as_it_needs() {
        let ground = box_at(DVec3::new(0.0, 0.0, -0.5), DVec3::new(20.0, 20.0, 1.0));
        let frame = Arc::new(Frame { bodies: vec![seen(&ground)], ..Frame::default() });
        let camera = Camera {
            target_m: Vec3::new(0.0, 0.0, 0.3),
            distance_m: 3.0,
            pitch_rad: 0.05,
            ..Camera::default()
        };
        let thrown = shape(Shape::Ball(Ball { radius_m: 0.4 }));
        let sight = Sight { frame, camera, aspect: 1.5, at: Vec2::new(0.3, 0.97) };
        let ghost = Ghost::new(foreseen(thrown), sight);
        assert!(ghost.is_in_sight() && ghost.lift_m > 0.0 && ghost.lift_m < 0.5, "{}", ghost.lift_m);
        assert!((ghost.start_m.z - 0.412).abs() < 0.025, "{}", ghost.start_m);
    }

    #[test]
    fn without_a_free_place_before_the_eye_it_starts_above_what_is_there() {
        let wall = box_at(DVec3::ZERO, DVec3::splat(1.0));
        let frame = Arc::new(Frame { bodies: vec![seen(&wall)], ..Frame::default() });
        let camera = Camera { target_m: Vec3::ZERO, distance_m: 0.9, ..Camera::default() };
        let sight = Sight { frame, camera, aspect: 1.0, at: Vec2::splat(0.5) };
        let thrown = box_at(DVec3::ZERO, DVec3::splat(0.8));
        let ghost = Ghost::new(foreseen(thrown.clone()), sight);
        assert!(ghost.lift_m > 0.0 && !ghost.is_in_sight(), "{}", ghost.lift_m);
        let nodes_m = ghost.nodes_m.iter().map(|x| x.as_dvec3()).collect();
        assert_eq!(overlap(&wall, &TetMesh { nodes_m, ..thrown }), None);
    }

    #[test]
    fn mass_and_energy_are_those_of_the_body() {
        let foreseen = foreseen(box_at(DVec3::ZERO, DVec3::splat(0.1)));
        assert!((foreseen.mass_kg() - 1.1).abs() < 1e-9, "{}", foreseen.mass_kg());
        assert!((foreseen.kinetic_j(DVec3::X * 10.0, DVec3::ZERO) - 55.0).abs() < 1e-9);
        assert!(foreseen.kinetic_j(DVec3::ZERO, DVec3::X) > 0.0);
    }
}
