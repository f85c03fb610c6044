//! Property tests of cutting: whatever is cut, the body stays sound and loses nothing.

mod cuts;
mod growth;
mod specimen;
