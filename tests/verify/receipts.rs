//! What a receipt says, and that it catches what is wrong.

use crate::motions::{Random, closed_trot, gaits, stepping};
use piaffe::gaits::{curvet::Curvet, trot::Trot};
use piaffe::model::{Description, Gait};
use piaffe::verify::constraint::{Constraint, Tally};
use piaffe::verify::{Finding, Receipt, VerifyError, sample, verify};

const GRID: usize = 2001;

/// Every constraint without room to spare, by name.
fn names(receipt: &Receipt) -> Vec<&str> {
    receipt.active.iter().map(|f| f.constraint.as_str()).collect()
}

fn found<'r>(receipt: &'r Receipt, name: &str) -> &'r Finding {
    receipt
        .active
        .iter()
        .find(|f| f.constraint == name)
        .unwrap_or_else(|| panic!("`{name}` is not among {:?}", names(receipt)))
}

/// Of every constraint its own margin is told, and none is forgotten that the gait was not known to have.
#[test]
fn every_constraint_has_a_margin_of_its_own() {
    for gait in gaits() {
        let d = gait.description();
        let unknown = [Constraint::Torque(d.joints()), Constraint::Height(d.points.len())];
        let all: Vec<Constraint> = Constraint::all(d).chain(unknown).collect();
        let mut tally = Tally::new(d, 1);
        let margin = |k: usize| 1.0 - 2.0 * k as f64;
        all.iter().enumerate().for_each(|(k, constraint)| tally.note(*constraint, margin(k), 0.0));
        for (k, constraint) in all.iter().enumerate() {
            assert_eq!(tally.margin(*constraint), margin(k), "{}: {constraint:?}", d.key);
        }
        assert_eq!(tally.worst(d).unwrap().margin, margin(all.len() - 1));
    }
}

#[test]
fn costs_agree_with_a_brute_force_sum() {
    for gait in gaits() {
        let d = gait.description();
        let motion = stepping(d);
        let receipt = verify(d, &motion, 0.4, GRID).unwrap();
        let points = 40_001;
        let samples = sample(d, &motion, points).unwrap();
        let (mut torque, mut energy, mut travel, mut time) = (0.0, 0.0, 0.0, 0.0);
        for phase in samples.chunks_exact(points) {
            travel += phase[points - 1].platform[0] - phase[0].platform[0];
            time += phase[points - 1].t;
            for pair in phase.windows(2) {
                for s in pair {
                    let h = 0.5 * (pair[1].t - pair[0].t);
                    torque += h * s.torques.iter().map(|x| x * x).sum::<f64>();
                    energy += h * s.torques.iter().zip(&s.qd).map(|(x, rate)| (x * rate).abs()).sum::<f64>();
                }
            }
        }
        let near = |found: f64, expected: f64, tolerance: f64| {
            assert!((found / expected - 1.0).abs() < tolerance, "{}: {found} instead of {expected}", d.gait);
        };
        near(receipt.costs.torque, torque / travel, 1e-8);
        near(receipt.costs.energy, energy / travel, 1e-6);
        near(receipt.step_length, travel, 1e-12);
        near(receipt.speed, travel / time, 1e-12);
        // A grid a hundred times as coarse changes little.
        let coarse = verify(d, &motion, 0.4, 201).unwrap();
        near(coarse.costs.torque, receipt.costs.torque, 1e-8);
        near(coarse.costs.energy, receipt.costs.energy, 1e-5);
    }
}

#[test]
fn a_cycle_closes_and_a_changed_rate_opens_it() {
    let d = Trot.description();
    let motion = closed_trot();
    let speed = verify(d, &motion, 0.3, GRID).unwrap().speed;
    let receipt = verify(d, &motion, speed, GRID).unwrap();
    assert!(receipt.cycle_error < 1e-9, "cycle error {:e}", receipt.cycle_error);
    assert!(receipt.step_length > 0.0 && receipt.costs.energy > 0.0);

    for k in 0..3 {
        let mut broken = motion.clone();
        broken.phases[0].qd_initial[k] += 1e-3;
        let error = verify(d, &broken, speed, GRID).unwrap().cycle_error;
        assert!(error > 1e-4, "rate {k}: cycle error {error:e}");
    }
    let mut broken = motion.clone();
    broken.phases[0].q_initial[1] += 1e-4;
    assert!(verify(d, &broken, speed, GRID).unwrap().cycle_error >= 0.99e-4);
    let mut broken = motion.clone();
    broken.phases[0].beta_initial += 1e-4;
    assert!(verify(d, &broken, speed, GRID).unwrap().cycle_error >= 0.99e-4);
    let mut broken = motion;
    broken.phases[0].duration += 1e-3;
    assert!(verify(d, &broken, speed, GRID).unwrap().cycle_error > 1e-5);
}

/// The description with one thing changed.
fn changed(gait: &dyn Gait, change: impl FnOnce(&mut Description)) -> Description {
    let mut d = gait.description().clone();
    change(&mut d);
    d
}

#[test]
fn limits_are_judged_at_their_place() {
    let d = Trot.description();
    let motion = closed_trot();
    let base = verify(d, &motion, 0.3, GRID).unwrap();

    // A weaker actuator: just below and just above what the motion takes.
    for (factor, broken) in [(0.99, true), (1.01, false)] {
        let weak = changed(&Trot, |d| {
            d.joints.to_mut()[1].max_torque = factor * base.peaks[1].torque;
        });
        let receipt = verify(&weak, &motion, base.speed, GRID).unwrap();
        assert_eq!(names(&receipt).contains(&"torque of knee1"), broken);
        if broken {
            let finding = found(&receipt, "torque of knee1");
            assert!((finding.margin - (1.0 - 1.0 / factor)).abs() < 1e-12);
            assert!((0.0..=motion.phases[0].duration).contains(&finding.time));
        }
    }

    let slippery = changed(&Trot, |d| d.limits.friction = 1e-3);
    let receipt = verify(&slippery, &motion, base.speed, GRID).unwrap();
    assert!(found(&receipt, "friction").margin < 0.0);
    assert!(found(&receipt, "friction of the impulse").margin < 0.0);

    let light = changed(&Trot, |d| d.limits.min_vertical_force = 10.0 * d.total_mass() * d.gravity);
    let receipt = verify(&light, &motion, base.speed, GRID).unwrap();
    assert_eq!(receipt.worst.as_ref().map(|f| f.constraint.as_str()), Some("vertical force"));
    assert_eq!(receipt.worst.as_ref().map(|f| -f.margin), Some(receipt.max_violation));

    let high = changed(&Trot, |d| d.limits.swing_clearance = 0.1);
    assert!(found(&verify(&high, &motion, base.speed, GRID).unwrap(), "swing clearance").margin < -0.1);

    let tall = changed(&Trot, |d| d.limits.min_platform_height = 0.4);
    assert!(found(&verify(&tall, &motion, base.speed, GRID).unwrap(), "platform height").margin < -0.1);

    let hasty = changed(&Trot, |d| d.phases.to_mut()[0].duration = [1.0, 2.0]);
    assert!(found(&verify(&hasty, &motion, base.speed, GRID).unwrap(), "shortest phase").margin < -0.5);

    let stiff = changed(&Trot, |d| {
        d.joints.to_mut()[3].range = [-0.5, -0.4];
    });
    assert!(found(&verify(&stiff, &motion, base.speed, GRID).unwrap(), "range of knee2 (lower stop)").margin < 0.0);

    // Relative to the speed asked.
    let slow = verify(d, &motion, 1.5 * base.speed, GRID).unwrap();
    assert!(slow.max_violation >= 1.0 / 3.0 - 1e-9, "mean speed: {:?}", slow.worst);
    assert!(!names(&slow).contains(&"mean speed"), "an equality is not an active inequality");
}

#[test]
fn a_foot_above_the_ground_at_the_end_is_found() {
    let d = Trot.description();
    let mut motion = closed_trot();
    motion.phases[0].q_final[2] -= 0.3;
    let receipt = verify(d, &motion, 0.3, GRID).unwrap();
    assert!(receipt.max_violation > 0.01 && receipt.cycle_error > 0.1);
}

#[test]
fn every_phase_has_its_findings() {
    let d = changed(&Curvet, |d| d.limits.min_vertical_force = 1e4);
    let receipt = verify(&d, &stepping(&d), 0.3, GRID).unwrap();
    let of = |phase| receipt.active.iter().filter(|f| f.constraint == "vertical force" && f.phase == phase).count();
    assert_eq!((of(1), of(2)), (1, 1));
    assert_eq!(receipt.peaks.len(), 4);
    assert!(receipt.peaks.iter().all(|p| p.torque > 0.0 && p.speed > 0.0 && p.envelope_margin < 1.0));
}

#[test]
fn receipts_are_the_same_bits_and_survive_json() {
    for gait in gaits() {
        let d = gait.description();
        let motion = stepping(d);
        let receipt = verify(d, &motion, 0.3, GRID).unwrap();
        assert_eq!(receipt, verify(d, &motion, 0.3, GRID).unwrap());
        let text = serde_json::to_string(&receipt).unwrap();
        assert_eq!(receipt, serde_json::from_str::<Receipt>(&text).unwrap());
    }
}

#[test]
fn what_cannot_be_verified_is_refused_with_a_reason() {
    let d = Trot.description();
    let good = closed_trot();
    let refused = |change: &dyn Fn(&mut piaffe::motion::Course)| {
        let mut motion = good.clone();
        change(&mut motion.phases[0]);
        verify(d, &motion, 0.3, GRID).unwrap_err()
    };
    assert!(matches!(refused(&|h| h.duration = 0.0), VerifyError::Duration { phase: 1, .. }));
    assert!(matches!(refused(&|h| h.duration = f64::NAN), VerifyError::Duration { .. }));
    assert!(matches!(refused(&|h| h.q_interior[0].truncate(1)), VerifyError::Length { expected: 3, found: 1, .. }));
    assert!(matches!(refused(&|h| h.qd_final[0] = f64::INFINITY), VerifyError::NotFinite { .. }));
    assert!(matches!(
        refused(&|h| h.betad_initial = 1e9),
        VerifyError::Blowup { .. } | VerifyError::Steps { .. } | VerifyError::Singular { .. }
    ));
    let of_speed = |speed| verify(d, &good, speed, GRID).unwrap_err().to_string();
    assert_eq!(of_speed(f64::NAN), "the speed must be finite and not zero, not NaN m/s");
    assert_eq!(of_speed(0.0), "the speed must be finite and not zero, not 0 m/s");
    assert_eq!(verify(d, &good, 0.3, 2), Err(VerifyError::Grid(2)));
    let two = piaffe::motion::Motion { phases: [&good.phases[..], &good.phases[..]].concat() };
    let message = verify(d, &two, 0.3, GRID).unwrap_err().to_string();
    assert_eq!(message, "the trot is defined by 1 phase(s), the motion has 2");
}

#[test]
fn wild_motions_end_in_a_receipt_or_a_reason() {
    let mut random = Random::new(5);
    for gait in gaits() {
        let d = gait.description();
        for size in [0.1, 1.0, 10.0, 1e3, 1e8] {
            let mut motion = stepping(d);
            for h in &mut motion.phases {
                let interior = h.q_interior.iter_mut().flatten();
                let lists = [&mut h.q_initial, &mut h.qd_initial, &mut h.q_final, &mut h.qd_final];
                for x in lists.into_iter().flatten().chain(interior) {
                    *x += size * random.next();
                }
                h.duration *= 1.0 + size * random.next().abs();
                h.betad_initial += size * random.next();
            }
            if let Ok(receipt) = verify(d, &motion, 0.3, 101) {
                assert!(receipt.cycle_error > 0.0 && receipt.max_violation > 0.0, "{receipt:?}");
            }
        }
    }
}
