#![no_main]

#[path = "../entries.rs"]
#[expect(dead_code, reason = "the other entries have targets of their own")]
mod entries;

libfuzzer_sys::fuzz_target!(|data: &[u8]| entries::formula(data));
