//! What `piaffe model --latex` prints: complete, balanced, and equal to what is derived.

mod common;

use common::{FAMILIES, GAITS, shipped, specification};
use piaffe_codegen::typeset::latex;

#[test]
fn documents_are_balanced_and_name_the_parameters() {
    for key in GAITS {
        let (robot, gait) = specification(key);
        let text = latex(&robot, &gait, &shipped(key));
        let count = |what: &str| text.matches(what).count();
        assert_eq!(count("{"), count("}"), "{key}");
        assert_eq!(count("\\left("), count("\\right)"), "{key}");
        assert_eq!(count("\\begin{align*}"), count("\\end{align*}"), "{key}");
        // Where legs do not share their links there are numbers only.
        let mass = if FAMILIES.contains(&key) { "A_{1,1} &= M" } else { "A_{1,1} &= 13.741" };
        for name in [r"f_1 &=", r"f_2 &=", r"c &=", mass, "H_{1} &=", "d^{1}_{1} &=", r"\dot\sigma &="] {
            assert!(text.contains(name), "{key}: no {name}");
        }
    }
}
