//! A load on the platform: a point mass, put into the file where the platform's own numbers stand.

use super::rigid::Rigid;
use super::robot::parse_robot;
use super::set::{insert, set};

/// The text of a robot's file with a point mass (kg) on its platform, at a point in the frame of the legs' mounts, m.
///
/// # Errors
/// If the file describes no robot, or none that can carry it.
pub fn load(text: &str, mass: f64, at: [f64; 3]) -> Result<String, String> {
    let known = parse_robot("robot.toml", text).map_err(|mistakes| {
        mistakes.first().map_or_else(|| "robot.toml describes no robot".to_string(), ToString::to_string)
    })?;
    let platform = &known.robot.platform;
    let body = Rigid { mass: platform.mass, com: platform.com, inertia: platform.inertia };
    let Rigid { mass: together, com, inertia } = body.with(&Rigid::point(mass, at));
    if !(together.is_finite() && com.iter().chain(inertia.iter().flatten()).all(|number| number.is_finite())) {
        return Err(format!("a load of {mass:?} kg at {at:?} m is beyond all numbers: give it nearer or lighter"));
    }
    let link = format!("links.{}", platform.name);
    let products = [inertia[1][2], inertia[2][0], inertia[0][1]].map(|moment| 0.0 - moment);
    let lists = [("com", com, ["x", "y", "z"]), ("inertia.products", products, ["yz", "zx", "xy"])];
    let moments =
        ["roll", "yaw", "pitch"].iter().enumerate().map(|(k, about)| (format!("inertia.{about}"), inertia[k][k]));
    let mut numbers: Vec<(String, f64)> = moments.chain([("mass".to_string(), together)]).collect();
    let mut changed = text.to_string();
    for (key, values, parts) in lists {
        let name = format!("{link}.{key}");
        // As one list where there was none.
        match insert_list(&changed, &name, values) {
            Some(with) => changed = with,
            None => numbers.extend(parts.iter().zip(values).map(|(part, value)| (format!("{key}.{part}"), value))),
        }
    }
    for (key, value) in numbers {
        let name = format!("{link}.{key}");
        changed = set(&changed, &name, value).ok_or_else(|| format!("robot.toml has no number `{name}`"))?;
    }
    Ok(changed)
}

/// `None` if the file has this list.
fn insert_list(text: &str, name: &str, values: [f64; 3]) -> Option<String> {
    let known = super::set::numbers(text).iter().any(|number| number.name.starts_with(&format!("{name}.")));
    if known { None } else { insert(text, name, &format!("{values:?}")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROBOT: &str = include_str!("../../../model-spec/robot.toml");
    const A1: &str = include_str!("../../../model-spec/a1/robot.toml");

    #[test]
    fn a_load_moves_mass_centre_and_inertia_as_a_point_mass_does() {
        for text in [ROBOT, A1] {
            let before = parse_robot("robot.toml", text).unwrap().robot.platform;
            let (mass, at) = (2.5, [0.1, 0.05, -0.02]);
            let after = parse_robot("robot.toml", &load(text, mass, at).unwrap()).unwrap().robot.platform;
            assert!((after.mass - before.mass - mass).abs() < 1e-12);
            // The moments about the mounts' origin add up.
            let about_origin = |mass: f64, com: [f64; 3], own: [[f64; 3]; 3], i: usize, j: usize| {
                let square: f64 = com.iter().map(|x| x * x).sum();
                own[i][j] + mass * (if i == j { square } else { 0.0 } - com[i] * com[j])
            };
            for i in 0..3 {
                let first = before.mass * before.com[i] + mass * at[i];
                assert!((after.mass * after.com[i] - first).abs() < 1e-12);
                for j in 0..3 {
                    let sum = about_origin(before.mass, before.com, before.inertia, i, j)
                        + about_origin(mass, at, [[0.0; 3]; 3], i, j);
                    let whole = about_origin(after.mass, after.com, after.inertia, i, j);
                    assert!((whole - sum).abs() < 1e-12, "{i} {j}: {whole} {sum}");
                }
            }
        }
    }
}
