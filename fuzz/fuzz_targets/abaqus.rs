#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| localshape::internals::untrusted::read("abaqus", bytes));
