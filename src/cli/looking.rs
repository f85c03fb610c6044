//! What `render` can look at more closely: `--cut`, `--crosses`, `--color-range`.

use super::failure::Failure;
use crate::frame::{ColorBy, Frame};
use crate::render::{Camera, Cut, Range, cross_room_m, look_inside, parse_with_unit, with_unit};
use crate::scene::description::CutPlane;
use glam::Vec3;

/// A cutting plane as it was asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutChoice {
    /// What lies in this direction is left out; a unit vector.
    normal: Vec3,
    /// Place along the direction, m; `None`: the middle of the bodies, at the first picture or, where the scene says so,
    /// at its start.
    position_m: Option<f32>,
    /// Whether the scene says so, and not the command line.
    is_of_scene: bool,
    /// Whether the other side may be left out, so that the section is looked into.
    is_side_free: bool,
}

impl CutChoice {
    /// The one that a scene is recorded with; `None` for a direction beyond single precision.
    pub fn of_scene(plane: &CutPlane) -> Option<Self> {
        let position_m = plane.at_m.map(|at_m| at_m as f32);
        Some(Self { normal: plane.normal()?, position_m, is_of_scene: true, is_side_free: false })
    }

    /// The same plane, looked into by a camera where nobody has said which side is left out.
    fn facing(self, camera: &Camera) -> Self {
        if !self.is_side_free || Cut::is_looked_into(self.normal, camera) {
            return self;
        }
        Self { normal: -self.normal, position_m: self.position_m.map(|place_m| -place_m), ..self }
    }
}

/// Reads `x`, `-y`, `+y`, `1,0,2`, each perhaps with `=POSITION`. An axis without a sign leaves the side open.
///
/// # Errors
/// What is wrong and what is expected, for clap to print.
pub fn parse_cut(text: &str) -> Result<CutChoice, String> {
    let (direction, position) = match text.split_once('=') {
        Some((direction, position)) => (direction, Some(position)),
        None => (text, None),
    };
    let normal = parse_direction(direction.trim())?;
    let position_m = position.map(parse_position).transpose()?;
    let is_side_free = matches!(direction.trim(), "x" | "X" | "y" | "Y" | "z" | "Z");
    Ok(CutChoice { normal, position_m, is_of_scene: false, is_side_free })
}

fn parse_direction(text: &str) -> Result<Vec3, String> {
    let (sign, bare) = match (text.strip_prefix('-'), text.strip_prefix('+')) {
        (Some(rest), _) => (-1.0, rest),
        (None, Some(rest)) => (1.0, rest),
        (None, None) => (1.0, text),
    };
    match bare {
        "x" | "X" => return Ok(sign * Vec3::X),
        "y" | "Y" => return Ok(sign * Vec3::Y),
        "z" | "Z" => return Ok(sign * Vec3::Z),
        _ => {}
    }
    let numbers: Result<Vec<f32>, _> = text.split(',').map(|number| number.trim().parse()).collect();
    let Ok(&[x, y, z]) = numbers.as_deref() else { return Err(expected_cut()) };
    let direction = Vec3::new(x, y, z);
    direction
        .try_normalize()
        .ok_or_else(|| "three numbers that are all zero, or too large, name no direction".to_owned())
}

fn parse_position(text: &str) -> Result<f32, String> {
    let position_m = parse_with_unit(text, "m").map(|position_m| position_m as f32);
    position_m
        .filter(|position_m| position_m.is_finite())
        .ok_or_else(|| format!("`{}` is no place; write metres, for example 0.05 or 50mm", text.trim()))
}

fn expected_cut() -> String {
    "expected a direction (x, -y, +z, or three numbers such as 1,0,2), perhaps with a place: x=0.05"
        .to_owned()
}

/// Reads the ends of a colour range such as `0..2MPa` in the unit of the field.
///
/// # Errors
/// [`Failure::BadInput`] with what is wrong and what is expected.
pub fn color_range(text: &str, color_by: ColorBy) -> Result<Range, Failure> {
    let refused = |reason: String| Failure::BadInput(format!("`--color-range {text}`: {reason}"));
    if !color_by.has_values() {
        return Err(refused(format!(
            "colours by {} have no values; add --color-by with a field, for example von-mises",
            color_by.name()
        )));
    }
    let ends = text.split_once("..").and_then(|(low, high)| {
        let unit = color_by.unit();
        Some((parse_with_unit(low, unit)?, parse_with_unit(high, unit)?))
    });
    let Some((low, high)) = ends else {
        let (unit, example) = match color_by.unit() {
            "" => (String::new(), "0..1.5".to_owned()),
            "Pa" => (" in Pa, kPa, MPa or GPa".to_owned(), "0..2MPa".to_owned()),
            unit => (format!(" in {unit}"), format!("0..1.5{unit}")),
        };
        let field = color_by.name();
        return Err(refused(format!("{field} wants MIN..MAX{unit}, for example {example}")));
    };
    Range::chosen(low, high).map_err(|reason| refused(reason.to_owned()))
}

/// How the frames are looked into, from the first one on.
#[derive(Clone, Debug, Default)]
pub struct Looking {
    cut: Option<CutChoice>,
    with_crosses: bool,
    /// Room of the crosses, m: of the first picture, so that a length is the same stress in all of them.
    crosses_room_m: Option<f32>,
    /// The plane, once its place is known.
    plane: Option<Cut>,
    /// Between which places along the plane's direction moving bodies have been, m.
    reached_m: Option<[f32; 2]>,
    /// Whether the plane has gone through one of them.
    has_cut: bool,
}

impl Looking {
    /// With a cutting plane, stress crosses, both or nothing.
    pub fn new(cut: Option<CutChoice>, with_crosses: bool) -> Self {
        Self { cut, with_crosses, ..Self::default() }
    }

    /// Puts the scene's own plane where the viewer has it: through the middle of the bodies at the start. A side that nobody
    /// has chosen becomes the one that hides the section from the camera.
    pub fn begin(&mut self, start: &Frame, camera: &Camera) {
        self.cut = self.cut.map(|cut| cut.facing(camera));
        self.plane = self.cut.filter(|cut| cut.is_of_scene).and_then(|cut| place(&cut, start));
    }

    /// Whether frames must come with what is inside.
    pub fn needs_interior(&self) -> bool {
        self.cut.is_some() || self.with_crosses
    }

    /// The frame as it is drawn.
    pub fn look(&mut self, frame: Frame) -> Frame {
        if !self.needs_interior() {
            return frame;
        }
        if self.plane.is_none() {
            self.plane = self.cut.and_then(|cut| place(&cut, &frame));
        }
        if let Some(plane) = self.plane {
            self.note_cut(&frame, &plane);
        }
        if self.with_crosses && self.crosses_room_m.is_none() {
            self.crosses_room_m = Some(cross_room_m(&frame));
        }
        look_inside(&frame, self.plane.as_ref(), self.crosses_room_m)
    }

    fn note_cut(&mut self, frame: &Frame, plane: &Cut) {
        for body in frame.moving() {
            let Some([low, high]) = plane.reach_m(body) else { continue };
            self.has_cut |= low <= 0.0 && high >= 0.0;
            let [known_low, known_high] = self.reached_m.unwrap_or([low, high]);
            self.reached_m = Some([known_low.min(low), known_high.max(high)]);
        }
    }

    /// What is odd about a cut that never cut anything.
    pub fn doubt(&self) -> Option<String> {
        let ([low, high], plane) = self.reached_m.zip(self.plane).filter(|_| !self.has_cut)?;
        let place = |beyond_m: f32| with_unit(f64::from(beyond_m + plane.position_m), "m");
        let said_by = if self.cut?.is_of_scene { "recording.cut" } else { "--cut" };
        Some(format!(
            "`{said_by}` goes through no body that moves: the plane is at {}, the bodies are between {} and {} along its \
             direction",
            place(0.0),
            place(low),
            place(high)
        ))
    }
}

/// The plane, if need be through the middle of what a frame shows.
fn place(cut: &CutChoice, frame: &Frame) -> Option<Cut> {
    let middle = || Cut::middle_m(cut.normal, frame.near_bounds_m().unwrap_or_default());
    Cut::new(cut.normal, cut.position_m.unwrap_or_else(middle))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::BodyFrame;

    #[test]
    fn cuts_are_read_with_and_without_a_place() {
        let cut = |normal: Vec3, position_m| {
            Ok(CutChoice { normal, position_m, is_of_scene: false, is_side_free: false })
        };
        assert_eq!(parse_cut("x"), cut(Vec3::X, None).map(|cut| CutChoice { is_side_free: true, ..cut }));
        assert_eq!(parse_cut("+x=0.5"), cut(Vec3::X, Some(0.5)));
        assert_eq!(parse_cut("-Y=-0.25"), cut(Vec3::NEG_Y, Some(-0.25)));
        let level = cut(Vec3::Z, Some(0.05)).map(|cut| CutChoice { is_side_free: true, ..cut });
        assert_eq!(parse_cut("z = 50 mm"), level);
        assert_eq!(parse_cut("0, 0, -2=0"), cut(Vec3::NEG_Z, Some(0.0)));
        for text in
            ["", "w", "x=", "x=far", "x=nan", "1,2", "1,2,3,4", "1,2,z", "0,0,0", "nan,0,1", "x=1=2", "--x"]
        {
            assert!(parse_cut(text).is_err(), "{text}");
        }
    }

    #[test]
    fn color_ranges_are_read_in_the_unit_of_the_field() {
        let range = |text| color_range(text, ColorBy::VonMises);
        assert_eq!(range("0..2MPa").unwrap(), Range { low: 0.0, high: 2e6 });
        assert_eq!(range("-1e5 .. 300k").unwrap(), Range { low: -1e5, high: 3e5 });
        for text in ["", "2MPa", "0..", "2..1", "1..1", "0..2mm", "0..x", "0...5m..1"] {
            let refused = range(text).unwrap_err();
            assert!(matches!(refused, Failure::BadInput(words) if words.contains("--color-range")), "{text}");
        }
        let refused = color_range("0..2MPa", ColorBy::Speed).unwrap_err();
        assert!(
            matches!(refused, Failure::BadInput(words) if words.contains("speed wants MIN..MAX in m/s, for example 0..1.5m/s"))
        );
        let refused = color_range("0..1", ColorBy::Body).unwrap_err();
        assert!(matches!(refused, Failure::BadInput(words) if words.contains("--color-by")));
    }

    #[test]
    fn a_scene_is_cut_where_its_bodies_start_and_by_hand_where_they_are() {
        let ball = |x: f32| Frame {
            bodies: vec![BodyFrame {
                positions_m: vec![[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0]],
                ..Default::default()
            }],
            ..Frame::default()
        };
        let place = |cut: CutChoice| {
            let mut looking = Looking::new(Some(cut), false);
            looking.begin(&ball(0.0), &Camera::default());
            looking.look(ball(5.0));
            looking.plane.unwrap().position_m
        };
        let plane = CutPlane { across: glam::DVec3::X, at_m: None };
        assert_eq!(place(CutChoice::of_scene(&plane).unwrap()), 0.5);
        assert_eq!(place(parse_cut("+x").unwrap()), 5.5);
    }

    #[test]
    fn the_section_is_looked_into_where_no_side_is_named() {
        let frame = Frame {
            bodies: vec![BodyFrame { positions_m: vec![[0.0; 3], [2.0, 2.0, 2.0]], ..Default::default() }],
            ..Frame::default()
        };
        let plane = |text: &str, yaw_deg: f32| {
            let mut looking = Looking::new(Some(parse_cut(text).unwrap()), false);
            let camera = Camera { yaw_rad: yaw_deg.to_radians(), ..Camera::default() };
            looking.begin(&frame, &camera);
            looking.look(frame.clone());
            looking.plane.unwrap()
        };
        let cut = |normal, position_m| Cut::new(normal, position_m).unwrap();
        // Yaw 0 looks along +y: from there the half before the plane hides the section.
        assert_eq!(plane("y", 0.0), cut(Vec3::NEG_Y, -1.0));
        assert_eq!(plane("y=0.25", 30.0), cut(Vec3::NEG_Y, -0.25));
        assert_eq!(plane("y", 180.0), cut(Vec3::Y, 1.0));
        assert_eq!(plane("+y", 0.0), cut(Vec3::Y, 1.0));
        assert_eq!(plane("-y", 180.0), cut(Vec3::NEG_Y, -1.0));
        assert_eq!(plane("0,1,0", 0.0), cut(Vec3::Y, 1.0));
        assert_eq!(plane("x", 0.0), cut(Vec3::X, 1.0), "edge-on");
    }

    /// A length of their lines is the same stress in every picture, however far things fly.
    #[test]
    fn stress_crosses_have_the_room_of_the_first_picture() {
        let at = |reach_m: f32| Frame {
            bodies: vec![BodyFrame {
                surface: std::sync::Arc::new(crate::frame::SurfaceTopology {
                    triangles: vec![[0, 1, 2]],
                    triangle_element: vec![0],
                    ..Default::default()
                }),
                positions_m: vec![[0.0; 3], [reach_m, 0.0, 0.0], [0.0, reach_m, 0.0]],
                interior: Some(std::sync::Arc::new(crate::frame::Interior {
                    stress_pa: vec![[1e6, 0.0, 0.0, 0.0, 0.0, 0.0]],
                    ..Default::default()
                })),
                ..Default::default()
            }],
            ..Frame::default()
        };
        let mut looking = Looking::new(None, true);
        let rooms_m = [1.0, 3.0].map(|reach_m| looking.look(at(reach_m)).crosses[0].room_m);
        assert!(rooms_m[0] > 0.0 && rooms_m[0] == rooms_m[1], "{rooms_m:?}");
    }

    #[test]
    fn a_cut_beside_everything_is_doubted() {
        let ball = |x: f32| Frame {
            bodies: vec![BodyFrame {
                positions_m: vec![[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0]],
                ..Default::default()
            }],
            ..Frame::default()
        };
        let look = |text: &str, xs: &[f32]| {
            let mut looking = Looking::new(Some(parse_cut(text).unwrap()), false);
            xs.iter().for_each(|x| drop(looking.look(ball(*x))));
            looking.doubt()
        };
        assert_eq!(look("x", &[0.0, 5.0]), None);
        assert_eq!(look("x=5.5", &[0.0, 5.0]), None);
        let doubt = look("-x=-9", &[0.0, 5.0]).unwrap();
        assert!(doubt.contains("the plane is at −9 m, the bodies are between −6 m and 0"), "{doubt}");
        assert_eq!(Looking::default().doubt(), None);
        let plane = CutPlane { across: glam::DVec3::X, at_m: Some(9.0) };
        let mut own = Looking::new(CutChoice::of_scene(&plane), false);
        own.look(ball(0.0));
        assert!(own.doubt().unwrap().starts_with("`recording.cut` goes through no body"));
    }
}
