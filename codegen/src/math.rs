//! The pinned sine and cosine of all generated code, for whoever evaluates a program as it stands.

include!("../../support/math.rs");
