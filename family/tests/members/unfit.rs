//! Parameters that no robot has are refused, with the reason.

use piaffe::model::family::Family;
use piaffe_family::FAMILIES;

fn trot() -> &'static Family {
    FAMILIES.iter().find(|f| f.description.key == "trot").unwrap()
}

fn refusal(changes: &[(&str, f64)]) -> String {
    trot().with(changes).err().map(|e| e.to_string()).unwrap_or_default()
}

#[test]
fn what_cannot_be_is_named() {
    assert!(trot().with(&[("links.thigh.mass", 2.0)]).is_ok());
    assert_eq!(refusal(&[("links.thigh.mass", 0.0)]), "links.thigh.mass = 0 kg: it must be positive");
    assert_eq!(refusal(&[("links.shin.length", f64::NAN)]), "links.shin.length = NaN m: it must be finite");
    let negative = "actuators.knee_motor.rotor_inertia = -1 kg·m²: it must be zero or more";
    assert_eq!(refusal(&[("actuators.knee_motor.rotor_inertia", -1.0)]), negative);
    assert!(refusal(&[("links.thigh.inertia.swing", 1.0)]).contains("inertia of thigh1 is one that no rigid body"));
    assert!(refusal(&[("links.thigh.mas", 1.0)]).starts_with("the family has no parameter `links.thigh.mas`; it has"));
    let count = (trot().member)(&[1.0]).err().unwrap().to_string();
    assert!(count.ends_with("parameters, 1 values are given"), "{count}");
}
