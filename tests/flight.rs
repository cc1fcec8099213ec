//! Gaits that fly: what is told of them beyond the optimum, on robots that are read as they are.

#[path = "flight/gaits.rs"]
mod gaits;

use piaffe::cycle::{Cycle, theta};
use piaffe::four_legs::{Lift, RealLegs, Verdict};
use piaffe::model::Mode;
use piaffe::motion::Criterion;

/// Diagonal pairs of a level robot, and pairs side by side of one that pitches, fly as the virtual legs do: nothing turns them, and
/// nothing need.
#[test]
fn in_flight_the_real_legs_lack_nothing_and_share_equally() {
    for (gait, motion) in gaits::optima() {
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
        let rounds = lift.durations.len() / motion.phases.len();
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
    }
}
