//! What a gait is derived from.

use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// The files of a gait: who has them can derive it again, anywhere.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Specification {
    /// The text of `robot.toml`.
    pub robot: Cow<'static, str>,
    /// The text of the gait's own file.
    pub gait: Cow<'static, str>,
}
