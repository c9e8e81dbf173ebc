//! Verification: simulated calibrations held against what was predicted for them.
