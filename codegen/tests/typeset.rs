//! What `piaffe model --latex` prints: complete, balanced, and equal to what is derived.

mod common;

use common::{FAMILIES, GAITS, shipped, specification};
use piaffe_codegen::typeset::latex;

#[test]
fn what_motors_overcome_is_told_where_there_is_friction() {
    let (robot, gait) = specification("trot");
    let mut rubs = shipped("trot");
    assert!(!latex(&robot, &gait, &rubs).contains(r"\Gamma^{\mathrm{motor}}"));
    (rubs.joints[0].damping, rubs.joints[0].coulomb, rubs.joints[1].coulomb) = (0.25, 0.5, 0.125);
    let text = latex(&robot, &gait, &rubs);
    let first = r"\Gamma^{\mathrm{motor}}_{1} &= \Gamma_{1} + 0.25\,\dot q_{1} + 0.5\,\operatorname{sign} \dot q_{1}";
    let second = r"\Gamma^{\mathrm{motor}}_{2} &= \Gamma_{2} + 0.125\,\operatorname{sign} \dot q_{2}";
    assert!(text.contains(first) && text.contains(second) && !text.contains("motor}}_{3}"), "{text}");
}

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
