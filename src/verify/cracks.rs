//! What the cracks of a body look like: how steep they stand, and the plane of the largest of them; on which planes elements fail.

use super::CaseError;
use super::cases::patch::outer_product;
use crate::fracture::{Criterion, CriterionError, PrincipalStress};
use crate::math::{DisjointSets, symmetric_eigen};
use crate::scene::Scene;
use crate::sim::World;
use glam::{DMat3, DVec2, DVec3};
use std::collections::BTreeMap;
use std::ops::Range;

/// One side of a cracked face, in the body's reference shape.
#[derive(Clone)]
struct CrackTriangle {
    corners_m: [DVec3; 3],
    area_m2: f64,
    normal: DVec3,
}

impl CrackTriangle {
    fn new(corners_m: [DVec3; 3]) -> Self {
        let [a, b, c] = corners_m;
        let area_normal = 0.5 * (b - a).cross(c - a);
        let area_m2 = area_normal.length();
        Self { corners_m, area_m2, normal: area_normal / area_m2 }
    }

    fn centre_m(&self) -> DVec3 {
        self.corners_m.iter().sum::<DVec3>() / 3.0
    }
}

/// All cracks of a body at one moment, in its reference shape. Both sides of a crack count, so areas are twice those of the crack.
pub(super) struct Cracks {
    triangles: Vec<CrackTriangle>,
}

/// The largest set of crack faces that hang together over their corners.
pub(super) struct Band {
    /// Its second moment of area about its middle, m4.
    moment_m4: DMat3,
    /// Its smallest and largest coordinates, m.
    pub bounds_m: [DVec3; 2],
}

impl Cracks {
    pub fn of(world: &World, body: usize) -> Self {
        let reference_m = world.reference_positions_m(body);
        let triangle = |nodes: [u32; 3]| CrackTriangle::new(nodes.map(|n| reference_m[n as usize]));
        Self { triangles: world.crack_faces(body).map(|face| triangle(face.nodes)).collect() }
    }

    /// Mean angle between the crack faces' planes and the horizontal, by area, degrees. NaN without a crack.
    pub fn mean_steepness_deg(&self) -> f64 {
        let weighted = self.triangles.iter().map(|t| t.area_m2 * steepness_deg(t.normal));
        weighted.sum::<f64>() / self.area_m2()
    }

    /// Those whose planes stand at an angle of the range to the horizontal, degrees.
    pub fn at(&self, steepness: Range<f64>) -> Self {
        let stands_so = |t: &&CrackTriangle| steepness.contains(&steepness_deg(t.normal));
        Self { triangles: self.triangles.iter().filter(stands_so).cloned().collect() }
    }

    /// Those that fall away from an upright axis.
    pub fn falling_away_from(&self, axis_m: DVec2) -> Self {
        let falls = |t: &&CrackTriangle| {
            let outward = t.centre_m().truncate() - axis_m;
            t.normal.truncate().dot(outward) * t.normal.z > 0.0
        };
        Self { triangles: self.triangles.iter().filter(falls).cloned().collect() }
    }

    /// Area, both sides counted, m2.
    pub fn area_m2(&self) -> f64 {
        self.triangles.iter().map(|t| t.area_m2).sum()
    }

    /// The largest crack; `None` without any.
    pub fn largest(&self) -> Option<Band> {
        let set = self.largest_set();
        if set.is_empty() {
            return None;
        }
        let area_m2: f64 = set.iter().map(|t| t.area_m2).sum();
        let middle_m = set.iter().map(|t| t.centre_m() * t.area_m2).sum::<DVec3>() / area_m2;
        // The second moment of a triangle: area/12 (sum of x x^T over its corners + s s^T), s their sum.
        let moment = set.iter().fold(DMat3::ZERO, |sum, t| {
            let at = t.corners_m.map(|x| x - middle_m);
            let sum_m: DVec3 = at.iter().sum();
            let of_corners = at.iter().fold(DMat3::ZERO, |m, x| m + outer_product(*x, *x));
            sum + (of_corners + outer_product(sum_m, sum_m)) * (t.area_m2 / 12.0)
        });
        let corners = || set.iter().flat_map(|t| t.corners_m);
        let low = corners().fold(DVec3::INFINITY, DVec3::min);
        let high = corners().fold(DVec3::NEG_INFINITY, DVec3::max);
        Some(Band { moment_m4: moment, bounds_m: [low, high] })
    }

    /// Both sides of a crack, and the copies of a node that it has parted, have the same reference positions to the bit.
    fn largest_set(&self) -> Vec<&CrackTriangle> {
        let mut sets = DisjointSets::new(self.triangles.len());
        let mut first_at = BTreeMap::new();
        for (i, triangle) in self.triangles.iter().enumerate() {
            for corner in triangle.corners_m {
                let first = *first_at.entry(corner.to_array().map(f64::to_bits)).or_insert(i as u32);
                sets.join(first, i as u32);
            }
        }
        let mut of_root: BTreeMap<u32, Vec<&CrackTriangle>> = BTreeMap::new();
        for (i, triangle) in self.triangles.iter().enumerate() {
            of_root.entry(sets.root(i as u32)).or_default().push(triangle);
        }
        let area = |set: &Vec<&CrackTriangle>| set.iter().map(|t| t.area_m2).sum::<f64>();
        of_root.into_values().max_by(|a, b| area(a).total_cmp(&area(b))).unwrap_or_default()
    }
}

impl Band {
    /// Unit normal of the plane with the least mean square distance from the crack's area: by second moments of the
    /// triangles, not of their centres alone.
    pub fn normal(&self) -> DVec3 {
        symmetric_eigen(&self.moment_m4).directions.z_axis
    }

    /// The same among the planes along `held`, a unit vector: in plane strain all cracks go through the slab, and a band of
    /// many of them may be thicker than the slab is deep.
    pub fn normal_across(&self, held: DVec3) -> DVec3 {
        let across = DMat3::IDENTITY - outer_product(held, held);
        let trace_m4 = self.moment_m4.diagonal().element_sum();
        let seen_m4 = across * self.moment_m4 * across + outer_product(held, held) * trace_m4;
        symmetric_eigen(&seen_m4).directions.z_axis
    }
}

/// Looks now and then on which planes the elements of a body fail.
pub(super) struct PlaneWatch {
    body: usize,
    criterion: Criterion,
    seen_deg: Result<Vec<(usize, f64)>, CriterionError>,
}

impl PlaneWatch {
    /// Of a body of one material in a scene.
    pub fn new(scene: &Scene, body: usize) -> Result<Self, CaseError> {
        let setup = &scene.setup.bodies[body];
        let none = || CaseError::Unmeasured(format!("`{}` cannot break", setup.name));
        let criterion = setup.materials[0].fracture.clone().ok_or_else(none)?;
        Ok(Self { body, criterion, seen_deg: Ok(Vec::new()) })
    }

    /// Takes note of the elements that fail now.
    pub fn look(&mut self, world: &World) {
        let Ok(seen_deg) = &mut self.seen_deg else { return };
        for (element, stress) in world.element_stresses(self.body).iter().enumerate() {
            let stress = PrincipalStress::of(&stress.cauchy_pa);
            match self.criterion.assess(&stress.measures()) {
                Ok(found) if found.fails() => {
                    seen_deg.push((element, steepness_deg(self.criterion.normal(found.rule, &stress, None))));
                }
                Ok(_) => {}
                Err(error) => {
                    self.seen_deg = Err(error);
                    return;
                }
            }
        }
    }

    /// Elements and how steep their planes stood, degrees, look by look.
    pub fn seen_deg(self) -> Result<Vec<(usize, f64)>, CaseError> {
        self.seen_deg.map_err(|error| CaseError::Unmeasured(error.to_string()))
    }
}

/// Angle between a plane and the horizontal, degrees.
pub(super) fn steepness_deg(normal: DVec3) -> f64 {
    normal.z.abs().min(1.0).acos().to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cracks(triangles: &[[DVec3; 3]]) -> Cracks {
        Cracks { triangles: triangles.iter().copied().map(CrackTriangle::new).collect() }
    }

    #[test]
    fn the_largest_crack_is_the_one_that_hangs_together_and_its_plane_is_found() {
        // A square that stands at 60 degrees, and a larger one in two parts that do not touch, lying flat.
        let up = DVec3::new(0.5, 0.0, 0.75_f64.sqrt());
        let far = DVec3::X * 9.0;
        let cracks = cracks(&[
            [DVec3::ZERO, up, DVec3::Y],
            [DVec3::Y, up, DVec3::Y + up],
            [far, far + DVec3::X, far + DVec3::Y * 1.2],
            [
                far + DVec3::splat(3.0),
                far + DVec3::splat(3.0) + DVec3::X,
                far + DVec3::splat(3.0) + DVec3::Y * 1.2,
            ],
        ]);
        let band = cracks.largest().unwrap();
        assert!((steepness_deg(band.normal()) - 60.0).abs() < 1e-9);
        assert!((band.bounds_m[1] - DVec3::new(0.5, 1.0, up.z)).length() < 1e-12);
        assert!((cracks.mean_steepness_deg() - 60.0 / 2.2).abs() < 1e-9);
        assert!(super::Cracks { triangles: vec![] }.largest().is_none());
    }

    #[test]
    fn cracks_are_told_by_how_they_lie() {
        // A tent of two faces at 45 degrees over a flat face, each an area of a half or more.
        let square = 0.5_f64.sqrt();
        let flat = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let sloping = |side: f64| [DVec3::Z, DVec3::Z + DVec3::Y, DVec3::new(side, 0.0, 0.0)];
        let all = cracks(&[flat, sloping(1.0), sloping(-1.0)]);
        assert!((all.area_m2() - 0.5 - 2.0 * square).abs() < 1e-12);
        assert!((all.at(0.0..30.0).area_m2() - 0.5).abs() < 1e-12);
        let sloping = all.at(44.0..46.0);
        assert!((sloping.area_m2() - 2.0 * square).abs() < 1e-12);
        // Both fall away from what lies between them, one of them from what lies beside.
        assert!((sloping.falling_away_from(DVec2::ZERO).area_m2() - 2.0 * square).abs() < 1e-12);
        assert!((sloping.falling_away_from(DVec2::NEG_X * 5.0).area_m2() - square).abs() < 1e-12);
    }

    #[test]
    fn a_band_that_is_thicker_than_its_slab_is_deep_still_has_its_steepness() {
        // Rungs at 50 degrees in a slab that is 0.1 deep, one beside the other over 0.5, and cracks across that join them.
        let (along, beside) = (DVec3::new(0.643, 0.0, -0.766), DVec3::new(0.766, 0.0, 0.643));
        let strip = |from: DVec3, to: DVec3| {
            let depth = DVec3::Y * 0.1;
            [[from, to, to + depth], [from, to + depth, from + depth]]
        };
        let rungs = (0..6).map(|i| beside * (0.1 * f64::from(i)));
        let mut triangles: Vec<_> = rungs.clone().flat_map(|at| strip(at, at + along)).collect();
        triangles.extend(rungs.take(5).flat_map(|at| strip(at, at + beside * 0.1)));
        let band = cracks(&triangles).largest().unwrap();
        assert!(band.normal().dot(DVec3::Y).abs() > 0.99, "{}", band.normal());
        let found_deg = steepness_deg(band.normal_across(DVec3::Y));
        assert!((found_deg - 50.0).abs() < 3.0, "{found_deg}");
    }
}
