//! Where the stress of an element lies in the space of principal stresses, beside the failure surface: across the
//! hydrostatic axis at its mean stress, and along it at its angle.

use super::element::{CIRCLE, ENVELOPE, figure, mark_place};
use super::plots::line;
use super::widgets::measured;
use crate::fracture::envelope::{
    DrawnRange, deviatoric_place_pa, deviatoric_section, distance_along_pa, meridian, principal_place,
    principal_point_pa,
};
use crate::fracture::{Criterion, CriterionError};
use egui::{RichText, Ui};
use egui_plot::Points;
use glam::DVec3;
use std::f64::consts::TAU;

/// Points around the axis, a multiple of 12 so that the corners of the standard criteria are among them.
const AROUND: u32 = 96;
/// Points along a meridian.
const ALONG: u32 = 49;
/// How far beyond the nearest failure, or the element, surfaces are followed.
const REACH: f64 = 8.0;

/// The failure surface near a state of stress.
#[derive(Debug, PartialEq)]
pub struct NearSurface {
    /// Across the axis at the state's mean stress, right and up, Pa; pieces where it is open.
    section: Vec<Vec<[f64; 2]>>,
    /// Mean stress and distance from the axis at the state's angle, Pa.
    meridian: Vec<[f64; 2]>,
    /// Half the height of what is shown across the axis, Pa.
    shown_pa: f64,
}

impl NearSurface {
    /// Finds it.
    ///
    /// # Errors
    /// [`CriterionError`] where a formula has no value.
    pub fn of(criterion: &Criterion, principal_pa: DVec3) -> Result<Self, CriterionError> {
        let (mean_pa, distance_pa, angle_rad) = principal_place(principal_pa);
        let mut nearest_pa = f64::INFINITY;
        for index in 0..12 {
            let along = principal_point_pa(0.0, 1.0, TAU * f64::from(index) / 12.0);
            let found = distance_along_pa(criterion, DVec3::splat(mean_pa), along)?;
            nearest_pa = nearest_pa.min(found.filter(|found| *found > 0.0).unwrap_or(f64::INFINITY));
        }
        let nearest_pa = if nearest_pa.is_finite() { nearest_pa } else { 0.0 };
        let size_pa = nearest_pa.max(distance_pa).max(f64::MIN_POSITIVE);
        let found = deviatoric_section(criterion, mean_pa, AROUND, REACH * size_pa)?;
        // The meridian reaches as far as the state is from no stress, and to the apex where there is one.
        let unstressed = distance_along_pa(criterion, DVec3::ZERO, principal_point_pa(0.0, 1.0, angle_rad))?;
        let half_pa = mean_pa.abs().max(distance_pa).max(unstressed.unwrap_or(0.0)).max(f64::MIN_POSITIVE);
        let range = DrawnRange { mean_pa: [-2.0 * half_pa, 2.0 * half_pa], reach_pa: REACH * half_pa };
        Ok(Self {
            section: pieces(&found),
            meridian: meridian(criterion, angle_rad, ALONG, &range)?,
            shown_pa: 1.5 * size_pa,
        })
    }
}

/// The unbroken pieces of a section; a closed one ends where it begins.
fn pieces(distances_pa: &[Option<f64>]) -> Vec<Vec<[f64; 2]>> {
    let count = distances_pa.len();
    // Starting behind a gap no piece runs across the beginning.
    let start = distances_pa.iter().position(Option::is_none).unwrap_or(0);
    let place = |index: usize| {
        let index = (start + index) % count.max(1);
        let angle_rad = TAU * index as f64 / count as f64;
        let distance_pa = distances_pa.get(index).copied().flatten().filter(|distance| *distance > 0.0)?;
        Some(deviatoric_place_pa(principal_point_pa(0.0, distance_pa, angle_rad)).to_array())
    };
    let points: Vec<Option<[f64; 2]>> = (0..=count).map(place).collect();
    let pieces = points.split(Option::is_none).map(|piece| piece.iter().flatten().copied().collect());
    pieces.filter(|piece: &Vec<_>| piece.len() > 1).collect()
}

/// Shows both views.
pub fn show(ui: &mut Ui, surface: &Result<NearSurface, CriterionError>, principal_pa: DVec3) {
    let near = match surface {
        Ok(near) => near,
        Err(error) => {
            ui.label(RichText::new(format!("The failure surface cannot be drawn: {error}")).small());
            return;
        }
    };
    let (mean_pa, distance_pa, _) = principal_place(principal_pa);
    across(ui, near, principal_pa);
    let text =
        format!("Across the hydrostatic axis at a mean stress of {}; s1 points up.", measured(mean_pa, "Pa"));
    ui.label(RichText::new(text).small().weak());
    figure(ui, "meridian", ["mean stress", "√(2 J2)"]).show(ui, |plot| {
        plot.line(line("failure", near.meridian.clone()).color(ENVELOPE).width(1.4));
        plot.points(Points::new("element", vec![[mean_pa, distance_pa]]).radius(4.0).color(CIRCLE));
    });
    let text = "Along it, at the element's angle: mean stress, and distance from the axis √(2 J2).";
    ui.label(RichText::new(text).small().weak());
}

fn across(ui: &mut Ui, near: &NearSurface, principal_pa: DVec3) {
    let place = deviatoric_place_pa(principal_pa).to_array();
    let (name, shown_pa) = ("principal stress space", near.shown_pa);
    figure(ui, name, [""; 2]).include_y(shown_pa).include_y(-shown_pa).show(ui, |plot| {
        let weak = egui::Color32::GRAY.gamma_multiply(0.6);
        for (axis, label) in [(DVec3::X, "s1"), (DVec3::Y, "s2"), (DVec3::Z, "s3")] {
            let end = (deviatoric_place_pa(axis).normalize() * shown_pa).to_array();
            plot.line(line(label, vec![[0.0, 0.0], end]).color(weak).width(1.0));
            mark_place(plot, label, end, egui::Align2::CENTER_TOP);
        }
        for piece in &near.section {
            plot.line(line("failure", piece.clone()).color(ENVELOPE).width(1.4));
        }
        plot.points(Points::new("element", vec![place]).radius(4.0).color(CIRCLE));
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fracture::{Formula, Strength};

    const K: f64 = 2e6;

    #[test]
    fn every_criterion_has_a_surface_near_every_state() {
        let friction_angle_rad = 0.5;
        let strengths = [
            Strength::Tensile { tensile_strength_pa: K },
            Strength::Tresca { shear_strength_pa: K },
            Strength::VonMises { shear_strength_pa: K },
            Strength::MohrCoulomb { cohesion_pa: K, friction_angle_rad },
            Strength::DruckerPrager { cohesion_pa: K, friction_angle_rad },
            Strength::Formula(Formula::new("sqrt(J2) + 0.2*I1 - F", &[("F", K)]).unwrap()),
        ];
        let both = vec![strengths[0].clone().into(), strengths[3].clone().into()];
        let singles = strengths.map(|strength| Criterion::single(strength).unwrap());
        for criterion in singles.iter().chain([&Criterion::any_of(both).unwrap()]) {
            for state in [DVec3::ZERO, DVec3::new(1e6, 0.0, -3e6), DVec3::new(-1e3, -1e3, -1e3)] {
                let near = NearSurface::of(criterion, state).unwrap();
                assert!(!near.section.is_empty() && near.meridian.len() > 1, "{criterion:?} {state}");
                assert!(near.shown_pa.is_finite() && near.shown_pa > 0.0);
            }
        }
    }

    #[test]
    fn a_state_on_the_surface_lies_on_both_curves() {
        let criterion = Criterion::single(Strength::VonMises { shear_strength_pa: K }).unwrap();
        // Pure shear of k.
        let near = NearSurface::of(&criterion, DVec3::new(K, 0.0, -K)).unwrap();
        let radius = 2.0_f64.sqrt() * K;
        assert_eq!((near.section.len(), near.section[0].len()), (1, AROUND as usize + 1));
        assert!(near.section[0].iter().all(|[x, y]| (x.hypot(*y) / radius - 1.0).abs() < 1e-9));
        assert!(near.meridian.iter().all(|[_, r]| (r / radius - 1.0).abs() < 1e-9));
    }

    #[test]
    fn open_sections_fall_into_pieces() {
        assert_eq!(pieces(&[Some(1.0), None, Some(1.0), Some(2.0)]).len(), 1);
        assert!(pieces(&[None; 4]).is_empty() && pieces(&[]).is_empty());
    }
}
