//! `hammerfall verify`: the table, its forms, what it refuses.

use crate::Place;

#[test]
fn verify_tells_how_far_off_answers_are() {
    let place = Place::new();
    let table = place.succeed("verify --quick patch criteria squeeze");
    for word in ["patch: uniform strain", "criteria:", "squeeze:", "reference", "bound", "pass"] {
        assert!(table.contains(word), "{word}: {table}");
    }
    assert!(!table.contains("falls short"), "{table}");
    let json = place.succeed("verify --quick --json --report out patch criteria squeeze");
    let found: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(found["falls_short"], 0);
    let cases = found["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 3);
    for quantity in cases.iter().flat_map(|case| case["quantities"].as_array().unwrap()) {
        assert!(quantity["value"].is_f64() && quantity["source"] != "", "{quantity}");
        assert!(quantity["bound"].is_null() || quantity["reason"] != "", "{quantity}");
    }
    assert!(place.read("out/report.html").contains("</html>"));
    let rows = place.read("out/quantities.csv").lines().count();
    let quantities: usize = cases.iter().map(|case| case["quantities"].as_array().unwrap().len()).sum();
    assert_eq!(rows, quantities + 1);
    assert_eq!(json, place.succeed("verify --quick --json --threads 1 patch criteria squeeze"));
}

#[test]
fn verify_refuses_what_it_does_not_know() {
    let place = Place::new();
    let message = place.fail("verify patch wings", 2);
    assert!(message.contains("`wings`") && message.contains("cantilever"), "{message}");
    let message = place.fail("verify patch --only tensile", 2);
    assert!(message.contains("begins with `sweep-`"), "{message}");
    let message = place.fail("verify sweep-bar-torn --only glass", 2);
    assert!(message.contains("no run has `glass`") && message.contains("Tresca x 0.1"), "{message}");
    let message = place.fail("verify patch --set a=1", 2);
    assert!(message.contains("--set a=1"), "{message}");
}
