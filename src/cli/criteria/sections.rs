//! The curves: sections of the failure surfaces by planes.

use super::choice::Entry;
use crate::cli::failure::Failure;
use crate::fracture::CriterionError;
use crate::fracture::envelope::{
    deviatoric_place_pa, deviatoric_section, distance_along_pa, plane_stress_section, principal_point_pa,
};
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Points of a whole turn; a multiple of 24, so that the corners of the standard criteria are among them.
const POINTS: u32 = 1440;
/// Directions of plane stress that settle how much is shown, in eighths of a turn: all but equal pressure on both axes,
/// where some criteria bear many times what they bear elsewhere.
const SCOUTS: [u32; 7] = [0, 1, 2, 3, 4, 6, 7];
/// Free space around the curves over their size.
const MARGIN: f64 = 0.18;
/// How far beyond what is shown curves are followed, over its size.
const REACH: f64 = 6.0;

/// A plane through the space of principal stresses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// `s3 = 0`.
    PlaneStress,
    /// Across the hydrostatic axis.
    Deviatoric {
        /// Mean stress, Pa.
        mean_pa: f64,
    },
}

impl Shape {
    /// Coordinates of a point in the plane, right and up, Pa: `(s1, s2)`, or with the projection of the s1
    /// axis up and that of the s2 axis at the lower left.
    pub fn flat_pa(self, point_pa: DVec3) -> DVec2 {
        match self {
            Self::PlaneStress => point_pa.truncate(),
            Self::Deviatoric { .. } => deviatoric_place_pa(point_pa),
        }
    }
}

/// One criterion in one plane: points at equal angles around, absent where nothing fails.
pub struct Curve(Vec<Option<DVec3>>);

impl Curve {
    /// The points with their angles in degrees.
    pub fn points_with_angles(&self) -> impl Iterator<Item = (f64, DVec3)> {
        let degrees = |index: usize| 360.0 * index as f64 / f64::from(POINTS);
        self.0.iter().enumerate().filter_map(move |(index, point)| Some((degrees(index), (*point)?)))
    }

    /// The unbroken pieces; a closed curve is one piece that ends where it begins.
    pub fn pieces(&self) -> Vec<Vec<DVec3>> {
        // Starting behind a gap no piece runs across the beginning.
        let start = self.0.iter().position(Option::is_none).unwrap_or(0);
        let around = (0..=self.0.len()).map(|index| self.0[(start + index) % self.0.len()]);
        let points: Vec<_> = around.collect();
        points
            .split(Option::is_none)
            .map(|piece| piece.iter().flatten().copied().collect())
            .filter(|piece: &Vec<_>| piece.len() > 1)
            .collect()
    }

    /// Whether there is nothing to draw.
    pub fn is_empty(&self) -> bool {
        self.0.iter().all(Option::is_none)
    }
}

/// All criteria in one plane.
pub struct Section {
    pub shape: Shape,
    /// What is shown of both coordinates, Pa.
    pub shown_pa: [f64; 2],
    /// By entry.
    pub curves: Vec<Curve>,
}

/// Everything that is drawn.
pub struct Sections {
    pub list: Vec<Section>,
}

impl Sections {
    /// The plane-stress section, and one across the hydrostatic axis for each mean stress: where none is given,
    /// for none and for a pressure of about half the smallest tensile strength.
    ///
    /// # Errors
    /// [`Failure::BadInput`] for a formula that cannot be evaluated, or that fails nowhere.
    pub fn of(entries: &[Entry], means_pa: &[f64]) -> Result<Self, Failure> {
        let (flat, tensile_pa) = plane_stress(entries)?;
        let means_pa = match means_pa {
            [] => vec![0.0, -round_down(tensile_pa / 2.0)],
            given => given.to_vec(),
        };
        let mut list = vec![flat];
        let mut shown_pa: f64 = 0.0;
        for mean_pa in &means_pa {
            shown_pa = shown_pa.max(largest_radius_pa(entries, *mean_pa)?);
        }
        if shown_pa == 0.0 {
            return Err(Failure::BadInput(
                "at every --mean-stress given all criteria fail already without shear; give one farther below".to_owned(),
            ));
        }
        shown_pa *= 1.0 + MARGIN;
        for mean_pa in means_pa {
            list.push(deviatoric(entries, mean_pa, shown_pa)?);
        }
        Ok(Self { list })
    }
}

/// The section with `s3 = 0`, and the smallest tensile strength (or other strength if nothing fails in tension), Pa.
fn plane_stress(entries: &[Entry]) -> Result<(Section, f64), Failure> {
    let (mut low_pa, mut high_pa, mut tensile_pa) = (0.0_f64, 0.0_f64, f64::INFINITY);
    for entry in entries {
        let mut first_pa = f64::INFINITY;
        for eighths in SCOUTS {
            let (sin, cos) = (TAU * f64::from(eighths) / 8.0).sin_cos();
            let found = distance_along_pa(&entry.criterion, DVec3::ZERO, DVec3::new(cos, sin, 0.0));
            let Some(distance_pa) = found.map_err(|error| refused(entry, &error))? else { continue };
            if first_pa.is_infinite() {
                first_pa = distance_pa;
            }
            for coordinate_pa in [distance_pa * cos, distance_pa * sin] {
                low_pa = low_pa.min(coordinate_pa);
                high_pa = high_pa.max(coordinate_pa);
            }
        }
        if first_pa.is_infinite() {
            return Err(Failure::BadInput(format!(
                "`{}` does not fail in plane stress up to 10 TPa; there is nothing to draw",
                entry.name
            )));
        }
        tensile_pa = tensile_pa.min(first_pa);
    }
    let margin_pa = MARGIN * (high_pa - low_pa);
    let shown_pa = [low_pa - margin_pa, high_pa + margin_pa];
    let reach_pa = REACH * (high_pa - low_pa);
    let curves = entries.iter().map(|entry| {
        let points = plane_stress_section(&entry.criterion, POINTS, reach_pa);
        points.map(Curve).map_err(|error| refused(entry, &error))
    });
    let curves = curves.collect::<Result<_, _>>()?;
    Ok((Section { shape: Shape::PlaneStress, shown_pa, curves }, tensile_pa))
}

fn deviatoric(entries: &[Entry], mean_pa: f64, shown_pa: f64) -> Result<Section, Failure> {
    let point = |(index, radius_pa): (u32, Option<f64>)| {
        // A radius of zero: the axis itself fails.
        let radius_pa = radius_pa.filter(|radius_pa| *radius_pa > 0.0)?;
        Some(principal_point_pa(mean_pa, radius_pa, TAU * f64::from(index) / f64::from(POINTS)))
    };
    let curves = entries.iter().map(|entry| {
        let radii = deviatoric_section(&entry.criterion, mean_pa, POINTS, REACH * shown_pa);
        let radii_pa = radii.map_err(|error| refused(entry, &error))?;
        Ok(Curve((0..).zip(radii_pa).map(point).collect()))
    });
    let curves = curves.collect::<Result<_, Failure>>()?;
    Ok(Section { shape: Shape::Deviatoric { mean_pa }, shown_pa: [-shown_pa, shown_pa], curves })
}

/// Largest distance from the hydrostatic axis to failure, Pa, where there is any; zero if the axis itself fails.
fn largest_radius_pa(entries: &[Entry], mean_pa: f64) -> Result<f64, Failure> {
    let mut largest_pa: f64 = 0.0;
    for entry in entries {
        for index in 0..12 {
            let along = principal_point_pa(0.0, 1.0, TAU * f64::from(index) / 12.0);
            let found = distance_along_pa(&entry.criterion, DVec3::splat(mean_pa), along);
            largest_pa = largest_pa.max(found.map_err(|error| refused(entry, &error))?.unwrap_or(0.0));
        }
    }
    Ok(largest_pa)
}

fn refused(entry: &Entry, error: &CriterionError) -> Failure {
    Failure::BadInput(format!("`{}` cannot be drawn: {error}", entry.name))
}

/// The last of 1, 2, 5 times a power of ten, at or below the value.
fn round_down(value: f64) -> f64 {
    let decade = 10f64.powf(value.log10().floor());
    let lead = [5.0, 2.0].into_iter().find(|lead| lead * decade <= value * (1.0 + 1e-9));
    lead.unwrap_or(1.0) * decade
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_close_whole_curves_and_start_behind_gaps() {
        let point = |x: f64| Some(DVec3::splat(x));
        let closed = Curve(vec![point(0.0), point(1.0), point(2.0)]).pieces();
        assert_eq!(closed, [[0.0, 1.0, 2.0, 0.0].map(DVec3::splat).to_vec()]);
        let open = Curve(vec![point(0.0), None, point(2.0)]).pieces();
        assert_eq!(open, [[2.0, 0.0].map(DVec3::splat).to_vec()]);
        assert!(Curve(vec![None; 3]).is_empty());
    }

    #[test]
    fn the_s1_axis_points_up_in_the_deviatoric_plane() {
        let shape = Shape::Deviatoric { mean_pa: 3.0 };
        let up = shape.flat_pa(principal_point_pa(3.0, 2.0, 0.0));
        assert!((up - DVec2::new(0.0, 2.0)).length() < 1e-12, "{up}");
        let s2 = shape.flat_pa(DVec3::Y);
        assert!(s2.x < 0.0 && s2.y < 0.0);
    }

    #[test]
    fn rounding_down_gives_round_numbers() {
        for (value, expected) in [(5.0, 5.0), (4.9, 2.0), (1.5e6, 1e6), (0.09, 0.05)] {
            assert!((round_down(value) / expected - 1.0).abs() < 1e-12, "{value}");
        }
    }
}
