//! What is said of limits that cracks have reached.

use super::console::Console;
use super::failure::Failure;
use crate::fracture::LimitsReached;

/// Says which of the limits that a user may set kept cracks from where they would have gone.
pub fn tell(reached: LimitsReached, console: &Console) -> Result<(), Failure> {
    if reached.elements > 0 {
        console.closing(format_args!(
            "limit reached: cuts along faces since a body has as many elements as it may (fracture.max_elements): {}",
            reached.elements
        ))?;
    }
    if reached.fragments > 0 {
        console.closing(format_args!(
            "limit reached: nodes not cut since a fragment would have been too small (fracture.smallest_fragment): {}",
            reached.fragments
        ))?;
    }
    if reached.speed > 0 {
        console.closing(format_args!(
            "limit reached: nodes at which a crack had to wait, since it would have been too fast (fracture.crack_speed): {}",
            reached.speed
        ))?;
    }
    Ok(())
}
