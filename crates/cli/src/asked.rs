//! What is asked for beside a robot's files, as a person types it.

use piaffe_codegen::{Changes, Load};

/// Options of all commands about gaits.
#[derive(clap::Args, Clone, Debug, Default)]
#[command(next_help_heading = "The robot, for this run")]
pub struct Asked {
    /// Another number in the specification: links.thigh.mass=1.2, limits.friction=0.8; may be given several times.
    #[arg(long, global = true, value_name = "NAME=NUMBER", allow_hyphen_values = true, value_parser = setting)]
    set: Vec<(String, f64)>,
    /// Greatest tangential over vertical force.
    #[arg(long, global = true, value_name = "RATIO", value_parser = positive)]
    friction: Option<f64>,
    /// Height of the parabola above which swing feet stay, m.
    #[arg(long, global = true, value_name = "HEIGHT", value_parser = natural)]
    clearance: Option<f64>,
    /// Least vertical force on a stance leg, N.
    #[arg(long, global = true, value_name = "FORCE", value_parser = natural)]
    min_force: Option<f64>,
    /// Least height of the platform's mass centre above the ground, m.
    #[arg(long, global = true, value_name = "HEIGHT", value_parser = natural)]
    platform_height: Option<f64>,
    /// Shortest and longest phase on a foot, s.
    #[arg(long, global = true, value_name = "SHORTEST,LONGEST", value_parser = duration)]
    duration: Option<[f64; 2]>,
    /// Greatest torques of all motors times this.
    #[arg(long, global = true, value_name = "FACTOR", value_parser = positive)]
    torque_scale: Option<f64>,
    /// A load on the platform: its mass, kg, at a point in the frame of the legs' mounts (forward, up, right), m; may be given
    /// several times.
    #[arg(long, global = true, value_name = "MASS@X,Y,Z", value_parser = load)]
    payload: Vec<Load>,
}

impl Asked {
    pub fn changes(&self) -> Changes {
        Changes {
            numbers: self.set.clone(),
            friction: self.friction,
            swing_clearance: self.clearance,
            min_vertical_force: self.min_force,
            min_platform_height: self.platform_height,
            duration: self.duration,
            torque_scale: self.torque_scale,
            loads: self.payload.clone(),
        }
    }
}

fn setting(text: &str) -> Result<(String, f64), String> {
    let (name, number) = text.split_once('=').ok_or("write NAME=NUMBER, for example links.thigh.mass=1.2")?;
    let value = finite(number).map_err(|why| format!("{why}; write for example links.thigh.mass=1.2"))?;
    Ok((name.trim().into(), value))
}

fn finite(text: &str) -> Result<f64, String> {
    let number = text.trim().parse::<f64>().ok().filter(|x| x.is_finite());
    number.ok_or_else(|| format!("`{text}` is not a number"))
}

fn positive(text: &str) -> Result<f64, String> {
    finite(text).and_then(|x| if x > 0.0 { Ok(x) } else { Err("must be more than 0".into()) })
}

fn natural(text: &str) -> Result<f64, String> {
    finite(text).and_then(|x| if x >= 0.0 { Ok(x) } else { Err("must not be negative".into()) })
}

fn list<const N: usize>(text: &str, example: &str) -> Result<[f64; N], String> {
    let numbers: Vec<f64> = text.split(',').map(finite).collect::<Result<_, _>>()?;
    numbers.try_into().map_err(|_| format!("is not {N} numbers; write for example {example}"))
}

fn duration(text: &str) -> Result<[f64; 2], String> {
    const EXAMPLE: &str = "0.1,0.5";
    let [shortest, longest] = list(text, EXAMPLE)?;
    let in_order = 0.0 < shortest && shortest < longest;
    if in_order { Ok([shortest, longest]) } else { Err(format!("write the shorter one first, as in {EXAMPLE}")) }
}

fn load(text: &str) -> Result<Load, String> {
    const EXAMPLE: &str = "2.5@0.1,0.05,0";
    let (mass, at) = text.split_once('@').ok_or_else(|| format!("write MASS@X,Y,Z, for example {EXAMPLE}"))?;
    Ok(Load { mass: positive(mass)?, at: list(at, EXAMPLE)? })
}
