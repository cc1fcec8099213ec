//! The share of two feet with the most room: what is found exactly against a cone program's solution.

use piaffe::four_legs::{Affine, Limit, Room, best, cone};

fn affine(at: f64, slope: f64) -> Affine {
    Affine { at, slope: [slope][..].into() }
}

fn line(joint: usize, at: f64, slope: f64) -> Room {
    Room { limit: Limit::Torque(joint), height: affine(at, slope), tangential: Default::default() }
}

fn cone(leg: usize, height: [f64; 2], tangential: [[f64; 2]; 3]) -> Room {
    let tangential = tangential.map(|[at, slope]| affine(at, slope)).into_iter().collect();
    Room { limit: Limit::Friction(leg), height: affine(height[0], height[1]), tangential }
}

fn least(rooms: &[Room], s: f64) -> f64 {
    rooms.iter().map(|room| room.margin(&[s])).fold(f64::INFINITY, f64::min)
}

/// The same margin as Clarabel's to 1e-9, from the same share where only one has it, proven by its weights.
fn agrees(rooms: &[Room], what: &str) {
    let found = best(rooms, 1).unwrap_or_else(|| panic!("{what}: nothing"));
    let s = found.s[0];
    assert!((found.margin - least(rooms, s)).abs() <= 1e-13 * (1.0 + found.margin.abs()), "{what}: {found:?}");
    let size = 1.0 + found.margin.abs();
    let oracle = cone::best(rooms, 1).unwrap_or_else(|| panic!("{what}: no oracle"));
    assert!((found.margin - oracle.margin).abs() <= 2e-9 * size, "{what}: {found:?} {oracle:?}");
    // Nearest to none of all that have this room: a step nearer has less.
    let nearer = s - 1e-3 * s.signum() * (1.0 + s.abs()).min(s.abs());
    assert!(s == 0.0 || least(rooms, nearer) < found.margin, "{what}: {s}");
    // The weighed limits alone have no more room anywhere.
    assert!((found.binding.iter().map(|(_, weight)| weight).sum::<f64>() - 1.0).abs() < 2e-3, "{what}: {found:?}");
    let bound = |s: f64| {
        let of = |limit: Limit| {
            rooms.iter().filter(|r| r.limit == limit).map(|r| r.margin(&[s])).fold(f64::INFINITY, f64::min)
        };
        found.binding.iter().map(|(limit, _)| of(*limit)).fold(f64::INFINITY, f64::min)
    };
    for step in [-100.0, -1.0, -1e-2, -1e-4, 1e-4, 1e-2, 1.0, 100.0] {
        assert!(bound(s + step) <= found.margin + 2e-9 * size, "{what}: {step} {found:?}");
    }
}

/// Limits like those of two feet and their joints: each joint both ways, as two lines or as one magnitude, and two cones.
fn drawn(rng: &mut fastrand::Rng) -> Vec<Room> {
    let mut any = |size: f64| size * (2.0 * rng.f64() - 1.0);
    let mut rooms = Vec::new();
    for joint in 0..3 {
        let (at, slope) = (any(1.2), any(0.1));
        rooms.extend([line(joint, 1.0 - at, -slope), line(joint, 1.0 + at, slope)]);
        let tangential = [affine(any(1.2), any(0.1))].into_iter().collect();
        rooms.push(Room { limit: Limit::Speed(joint), height: affine(1.0, 0.0), tangential });
    }
    for leg in 0..2 {
        let (at, slope) = (0.7 + any(0.7), any(0.05));
        rooms.push(Room { limit: Limit::Vertical(leg), ..line(0, at, slope) });
        rooms.push(cone(leg, [0.7 * at, 0.7 * slope], [(); 3].map(|()| [any(0.4), any(0.1)])));
    }
    rooms
}

#[test]
fn random_shares_agree_with_the_cone_program() {
    let mut rng = fastrand::Rng::with_seed(7);
    let mut beyond = 0;
    for k in 0..300 {
        let rooms = drawn(&mut rng);
        agrees(&rooms, &format!("problem {k}"));
        beyond += usize::from(best(&rooms, 1).unwrap().margin < 0.0);
    }
    // Where no shares keep to all limits too.
    assert!((50..250).contains(&beyond), "{beyond}");
}

#[test]
fn degenerate_shares_agree_with_the_cone_program() {
    let bounded = [line(0, 5.0, 0.1), line(0, 5.0, -0.1)];
    let with = |more: &[Room]| [&bounded[..], more].concat();
    agrees(&bounded, "symmetric");
    agrees(&with(&[line(1, 0.3, 0.0)]), "a limit that no share changes");
    agrees(&with(&[line(1, 1.0, 0.5), line(1, 1.0, 0.5), line(2, 1.0, -0.5), line(2, 1.0, -0.5)]), "ties");
    agrees(&with(&[line(1, -3.0, 0.5), line(2, 2.0, -0.25), line(3, 0.0, 0.0)]), "three lines");
    agrees(&with(&[cone(0, [0.5, 0.0], [[0.2, 0.1], [0.0, 0.0], [0.0, 0.0]])]), "a cone through its tip");
    agrees(&with(&[cone(0, [0.5, 0.02], [[0.2, 0.1], [0.3, 0.0], [0.0, 0.0]])]), "a cone");
    agrees(&with(&[cone(0, [0.5, 0.1], [[0.2, 0.1], [0.3, 0.0], [0.0, 0.0]])]), "a cone with an asymptote");
    agrees(&with(&[cone(0, [0.5, 0.3], [[0.2, 0.1], [0.3, 0.05], [0.0, 0.0]])]), "a cone that only rises");
    agrees(&with(&[cone(0, [0.5, 0.0], [[0.2, 0.0], [0.3, 0.0], [0.0, 0.0]])]), "a cone that stays");
    let two = [
        cone(0, [0.5, 0.05], [[0.3, 0.1], [0.1, 0.02], [0.0, 0.0]]),
        cone(1, [0.4, -0.05], [[-0.2, 0.1], [0.1, 0.03], [0.0, 0.0]]),
    ];
    agrees(&with(&two), "two cones");
    // A slope of nothing but rounding leads nowhere.
    let found = best(&with(&[line(1, 0.3, 1e-17)]), 1).unwrap();
    assert!(found.s[0] == 0.0 && found.binding[0].0 == Limit::Torque(1), "{found:?}");
}

#[test]
fn what_has_no_greatest_margin_has_no_share() {
    assert!(best(&[line(0, 1.0, 0.5)], 1).is_none());
    assert!(best(&[line(0, 1.0, 0.5), line(1, 1.0, 0.2)], 1).is_none());
    assert!(best(&[line(0, f64::NAN, 0.5), line(1, 1.0, -0.2)], 1).is_none());
    assert!(best(&[line(0, 1.0, f64::NAN), line(1, 1.0, -0.2)], 1).is_none());
}
