//! The cases of `hammerfall verify`, the quick ones: nothing that is judged falls short, nothing hangs on threads.

use hammerfall::verify::{CASES, Effort, Outcome, Turn, find};

/// What is known to fall short, by case and the beginning of its name; README says why.
const KNOWN: &[(&str, &str)] = &[];

fn shortfalls(case: &str, outcome: &Outcome) -> Vec<String> {
    let is_known = |name: &str| KNOWN.iter().any(|(id, start)| *id == case && name.starts_with(start));
    let short = outcome.quantities.iter().filter(|quantity| !quantity.passes() && !is_known(&quantity.name));
    short
        .map(|quantity| {
            format!("{case}: {}: {} is off by {}", quantity.name, quantity.value, quantity.error())
        })
        .collect()
}

#[test]
fn no_quick_case_falls_short() {
    let mut short = Vec::new();
    for case in CASES.iter().filter(|case| case.turn == Turn::Quick) {
        let outcome = case.run(&Effort::QUICK).unwrap_or_else(|error| panic!("{}: {error}", case.id));
        assert!(!outcome.quantities.is_empty(), "{} measures nothing", case.id);
        for quantity in &outcome.quantities {
            assert!(!quantity.source.is_empty(), "{}: {} has no source", case.id, quantity.name);
        }
        short.extend(shortfalls(case.id, &outcome));
    }
    assert!(short.is_empty(), "\n{}", short.join("\n"));
}

#[test]
fn a_scene_runs_through_at_any_criterion() {
    let case = find("sweep-bar-torn").expect("it is in the list");
    let outcome = case.run(&Effort::QUICK).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(outcome.quantities.iter().filter(|q| q.name.ends_with("fragments")).count(), 5);
    let short = shortfalls(case.id, &outcome);
    assert!(short.is_empty(), "\n{}", short.join("\n"));
}

#[test]
fn one_run_of_a_sweep_can_be_asked_for() {
    let told = std::sync::Mutex::new(Vec::new());
    let tell = |line: &str| told.lock().unwrap().push(line.to_owned());
    let effort = Effort { only: Some("Tresca"), tell: &tell, ..Effort::QUICK };
    let outcome = find("sweep-bar-torn").expect("it is in the list").run(&effort).expect("it runs");
    assert!(outcome.quantities.iter().all(|q| q.name.starts_with("Tresca x 1:")), "{outcome:?}");
    let told = told.into_inner().unwrap();
    // Whoever waits learns how far it has come.
    let so_far = (1..10).map(|tenth| format!("bar-torn, Tresca x 1: {} % after ", 10 * tenth));
    assert!(so_far.zip(&told).all(|(begin, line)| line.starts_with(&begin)), "{told:?}");
    assert!(told.len() == 10 && told[9].ends_with("steps; passes"), "{told:?}");
}

#[test]
fn who_wants_an_end_gets_it() {
    let stopped = Effort { stop: &|| true, ..Effort::QUICK };
    for case in CASES.iter().filter(|case| !["patch", "criteria"].contains(&case.id)) {
        assert!(case.run(&stopped).is_err_and(|error| error.to_string() == "stopped"), "{}", case.id);
    }
}
