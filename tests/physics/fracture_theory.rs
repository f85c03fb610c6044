//! Where and when cracks start, against beam theory (METHOD 8, F1): too slow for the quick cases.

use hammerfall::verify::{Effort, find};

#[test]
fn a_notched_beam_cracks_at_the_load_and_place_of_beam_theory() {
    let case = find("beam-notch").expect("it is in the list");
    let outcome = case.run(&Effort::QUICK).unwrap();
    assert!(outcome.passes(), "{:?}", outcome.quantities);
}
