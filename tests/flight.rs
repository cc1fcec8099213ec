//! Gaits that fly: what is told of them beyond the optimum, on robots that are read as they are.

use piaffe::Robot;
use piaffe::cycle::{Cycle, theta};
use piaffe::four_legs::{Lift, RealLegs, Verdict};
use piaffe::interpreter::Interpreted;
use piaffe::model::{Gait, Mode};
use piaffe::motion::{Criterion, Motion};
use piaffe::search::multi_start::{Settings, search};
use piaffe::sensitivity::{Unknown as NoSlopes, sensitivities};
use piaffe::stability::{Unknown as NoMap, stability};
use piaffe_codegen::{RobotFiles, SpecFile};
use std::path::Path;

const LIMITS: &str = "
    [limits]
    friction = 0.9
    min_vertical_force = 12.0
    swing_clearance = 0.006
";

const RUNNING_TROT: &str = r#"
    virtual_legs = [["fore_left", "hind_right"], ["fore_right", "hind_left"]]
    platform = { moves = ["x", "y"], rotates = "none" }
    unactuated = "leg1.haunch"
    phases = [{ stance = ["leg1"], duration = [0.05, 2.0] }, { stance = [], duration = [0.03, 0.5] }]
    [cycle]
    then = "mirrored"
"#;

const BOUND: &str = r#"
    virtual_legs = [["hind_left", "hind_right"], ["fore_left", "fore_right"]]
    platform = { moves = ["x", "y"], rotates = "pitch" }
    unactuated = "platform"
    phases = [
        { stance = ["leg1"], duration = [0.05, 0.5] },
        { stance = ["leg2"], duration = [0.05, 0.5] },
        { stance = [], duration = [0.03, 0.5] },
    ]
    [cycle]
    then = "repeat"
"#;

fn gait(text: &str) -> Interpreted {
    let model = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/model-spec"));
    let files = RobotFiles::read(model).unwrap();
    let own = SpecFile { path: "gaits/flying.toml".into(), text: format!("{text}{LIMITS}") };
    Robot::new(RobotFiles { module: String::new(), gaits: vec![own], ..files }).unwrap().gait("flying").unwrap()
}

fn optimum(gait: &dyn Gait, criterion: Criterion) -> Motion {
    let settings = Settings { starts: Some(2), ..Settings::default() };
    search(gait, criterion, 1.0, &settings, &|_| {}).optima[0].local.motion.clone()
}

/// Diagonal pairs of a level robot, and pairs side by side of one that pitches, fly as the virtual legs do: nothing turns them, and
/// nothing need.
#[test]
fn in_flight_the_real_legs_lack_nothing_and_share_equally() {
    for text in [RUNNING_TROT, BOUND] {
        let gait = gait(text);
        let motion = optimum(&gait, Criterion::Torque);
        let lift = Lift::even(&gait, &motion, 40).unwrap();
        let mut flying = 0;
        for i in &lift.instants {
            assert!(i.lack.share < 1e-11 && i.equal_lack.share < 1e-11, "{:?} {:?}", i.lack, i.equal_lack);
            assert!(i.margin > -1e-6, "{} at {} s", i.margin, i.time);
            if i.stance.is_empty() {
                flying += 1;
                assert!(i.reactions.iter().all(|force| *force == [0.0; 3]));
            }
        }
        let flights = lift.legs.description.phases.iter().filter(|phase| phase.mode == Mode::Flight).count();
        let rounds = lift.durations.len() / motion.half_steps.len();
        assert_eq!(flying, 41 * flights * rounds);

        let legs = RealLegs::of(&Lift::even(&gait, &motion, 200).unwrap());
        assert_eq!(legs.verdict(), Verdict::EqualShares, "{legs:?}");
        assert!((legs.largest_load - 0.5).abs() < 1e-9);
        // What the joints do in flight counts, and in all phases of the step.
        let mut cycle = Cycle::resolving(&gait, Criterion::Torque, 1.0, &theta(&motion)).unwrap();
        while let Some(finer) = cycle.twice_as_fine() {
            cycle = finer;
            cycle.simulate(&theta(&motion)).unwrap();
        }
        for criterion in Criterion::ALL {
            let expected = cycle.costs().of(criterion);
            for costs in [legs.costs.virtual_legs, legs.costs.within_limits] {
                let found = costs.of(criterion);
                assert!((found / expected - 1.0).abs() < 1e-6, "{criterion:?}: {found} {expected}");
            }
        }

        // Nothing is told that is not derived.
        assert_eq!(stability(&gait, &motion), Err(NoMap::Flight));
        assert_eq!(sensitivities(&gait, Criterion::Torque, 1.0, &motion), Err(NoSlopes::Flight));
    }
}
