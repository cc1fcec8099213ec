//! Options of an import, written as on the command line.

use piaffe::import::Options;

pub fn given(options: &[(&str, &str)]) -> Options {
    let mut all = Options::default();
    for (option, value) in options {
        match *option {
            "--lock" => all.locks.push(value.parse().unwrap()),
            "--foot" => all.feet.push(value.parse().unwrap()),
            "--effort" => all.efforts.push(value.parse().unwrap()),
            "--velocity" => all.velocities.push(value.parse().unwrap()),
            "--gear" => all.gears.push(value.parse().unwrap()),
            "--rotor" => all.rotors.push(value.parse().unwrap()),
            "--range" => all.ranges.push(value.parse().unwrap()),
            "--forward" => all.forward = Some(value.parse().unwrap()),
            "--up" => all.up = Some(value.parse().unwrap()),
            "--alike" => all.alike = value.parse().unwrap(),
            "--mend" => all.mend = true,
            _ => panic!("{option}"),
        }
    }
    all
}
