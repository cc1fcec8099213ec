//! The pinned sine and cosine of all generated code, for whatever is computed before it and for whoever evaluates a program as it
//! stands: those of a platform differ in their last bits from machine to machine.

include!("../support/math.rs");
