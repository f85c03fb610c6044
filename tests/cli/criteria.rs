//! `hammerfall criteria`: failure surfaces as tables and pictures.

use crate::{Place, stderr};

/// Rows of `criteria`'s table of one criterion and section: angle in degrees, and the three stresses in Pa.
fn points(table: &str, criterion: &str, section: &str) -> Vec<[f64; 4]> {
    let row = |line: &str| -> Option<[f64; 4]> {
        let (name, numbers) = line.strip_prefix('"')?.split_once("\",")?;
        let numbers = numbers.strip_prefix(section)?.strip_prefix(',')?;
        let numbers: Vec<f64> = numbers.split(',').map(|number| number.parse().unwrap()).collect();
        name.starts_with(criterion).then(|| [numbers[1], numbers[2], numbers[3], numbers[4]])
    };
    table.lines().filter_map(row).collect()
}

#[test]
fn failure_surfaces_pass_through_the_strengths() {
    let place = Place::new();
    place.succeed("criteria -o five.csv --mean-stress -5MPa");
    let table = place.read("five.csv");
    assert!(table.starts_with("criterion,section,mean_stress_pa,angle_deg,s1_pa,s2_pa,s3_pa\n"));
    let plane = |criterion: &str, angle_deg: f64| {
        let points = points(&table, criterion, "plane-stress");
        points.into_iter().find(|point| point[0] == angle_deg).map(|[_, s1, s2, _]| [s1 / 1e6, s2 / 1e6])
    };
    // Uniaxial tension, then compression. Drucker-Prager in tension: 6 c cos(phi)/(3 + sin(phi)).
    let strengths = [
        ("tensile", 10.0, None),
        ("Tresca", 10.0, Some(-10.0)),
        ("von Mises", 10.0, Some(-10.0)),
        ("Mohr-Coulomb", 10.0, Some(-30.0)),
        ("Drucker-Prager", 90.0 / 7.0, Some(-30.0)),
    ];
    for (criterion, tension, compression) in strengths {
        let [s1, s2] = plane(criterion, 0.0).unwrap();
        assert!((s1 - tension).abs() < 1e-6 && s2.abs() < 1e-6, "{criterion}: {s1}");
        let found = plane(criterion, 180.0).map(|[s1, _]| s1);
        assert_eq!(found.is_some(), compression.is_some(), "{criterion}");
        assert!((found.unwrap_or(0.0) - compression.unwrap_or(0.0)).abs() < 1e-6, "{criterion}: {found:?}");
    }
    // Pure shear: s1 = -s2 = k for Tresca and von Mises.
    for (criterion, shear) in [("Tresca", 5.0), ("von Mises", 10.0 / 3.0_f64.sqrt())] {
        let [s1, s2] = plane(criterion, 315.0).unwrap();
        assert!((s1 - shear).abs() < 1e-6 && (s2 + shear).abs() < 1e-6, "{criterion}: {s1} {s2}");
    }
    let circle = points(&table, "von Mises", "deviatoric");
    assert_eq!(circle.len(), 1440);
    for [_, s1, s2, s3] in circle {
        assert!((s1 + s2 + s3 + 15e6).abs() < 1.0);
        let j2 = ((s1 - s2).powi(2) + (s2 - s3).powi(2) + (s3 - s1).powi(2)) / 6.0;
        assert!((j2.sqrt() / 1e6 - 10.0 / 3.0_f64.sqrt()).abs() < 1e-6);
    }
}

#[test]
fn values_may_come_beside_the_criterion_and_units_are_told() {
    let place = Place::new();
    let told = place.succeed("criteria -o one.csv --criterion tensile --set tensile_strength=1e6");
    assert!(told.contains("tensile, Ft = 1 MPa"), "{told}");
    assert_eq!(told, place.succeed("criteria -o one.csv --criterion tensile:1MPa"));
    let told = place.fail("criteria -o one.csv --formula s1-Ft", 2);
    assert!(told.contains("--parameter Ft=3e6"), "{told}");
    assert!(place.fail("criteria -o one.csv --set a=1", 2).contains("no scene"));
}

#[test]
fn formulas_and_scenes_are_drawn() {
    let place = Place::new();
    place.succeed("criteria --formula s1-Ft --parameter Ft=3e6 -o formula.csv");
    let typed = points(&place.read("formula.csv"), "s1-Ft", "plane-stress");
    let [_, s1, ..] = typed[0];
    assert!((s1 - 3e6).abs() < 1.0);
    place.succeed("criteria cube-wall -o scene.png --set materials.plaster.fracture.tensile_strength=2e5");
    let picture = image::open(place.path().join("scene.png")).unwrap().to_rgb8();
    assert!(picture.width() > 1000);
    let blue = picture.pixels().filter(|pixel| pixel.0 == [0, 114, 178]).count();
    assert!(blue > 1000, "{blue} pixels of the curve's colour");
}

#[test]
fn criteria_that_make_no_sense_are_refused_with_the_place() {
    let place = Place::new();
    let message = |arguments: &[&str]| {
        let mut command = place.command("criteria -o x.csv");
        let output = command.args(arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", stderr(&output));
        stderr(&output)
    };
    assert!(message(&["--formula", "s1 - "]).contains("column 6"));
    assert!(message(&["--formula", "s1/0 - 1"]).contains("divides by zero"));
    assert!(message(&["--criterion", "tresca shear_strength=0"]).contains("shear_strength"));
    let bad_angle = "{ criterion = \"mohr-coulomb\", cohesion = 1, friction_angle = 90 }";
    let refused = message(&["--criterion", bad_angle]);
    assert!(refused.contains("friction_angle") && refused.contains("column 62"), "{refused}");
    assert!(message(&["--criterion", "tresko"]).contains("tresca"));
    assert!(message(&["--mean-stress", "1 psi"]).contains("-5MPa"));
    assert!(message(&["cubes.toml"]).contains("fracture"));
    assert!(message(&["--set", "a=1"]).contains("--set a=1"));
    assert!(!place.has("x.csv"));
    assert!(place.fail("criteria -o x.gif", 2).contains("png"));
}
