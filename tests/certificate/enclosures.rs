//! β and everything that follows from it are where the certificate says they are.

use crate::double::Double;
use crate::motions::{gaits, stepping};
use piaffe::certificate::enclosure::{Model, enclose, instants};
use piaffe::certificate::taylor::Taylor;
use piaffe::model::Description;
use piaffe::motion::Course;
use piaffe::number::Scalar;
use piaffe::verify::instants::{Instants, State};
use piaffe::verify::integrate::integrate;
use piaffe::verify::margins::{Units, clearance};
use piaffe::verify::numbers::Numbers;
use piaffe::verify::swing::swings;

/// The method's own coefficients have 16 digits.
const REFERENCE: f64 = 1e-15;

fn inside<const N: usize>(what: &str, model: &Taylor<N>, tau: f64, exact: Double) {
    let polynomial =
        model.coefficients().iter().rev().fold(Double::from(0.0), |s, c| s * tau.into() + Double::from(*c));
    let apart = (polynomial - exact).magnitude().high;
    let slack = REFERENCE * exact.high.abs().max(1.0);
    assert!(apart <= model.rest() + slack, "{what}: {apart:e} apart, at most {:e} was claimed", model.rest());
}

/// From one share of the phase to another, in twice the precision.
fn integrated(d: &Description, h: &Course, leg: usize, [from, to]: [f64; 2], y: [Double; 2]) -> [Double; 2] {
    let mut instants = Instants::<Double>::new(d, Numbers::new(d), &h.cast(), leg);
    let mut state = State::new(d);
    let duration = Double::from(h.duration);
    let rate = |s: f64, y: &[Double; 2]| {
        let acceleration = instants.accelerate(duration * s.into(), *y, &mut state)?;
        Some([y[1] * duration, acceleration * duration])
    };
    integrate(rate, from, to, y, 1e-17).unwrap().end()
}

#[test]
fn beta_is_enclosed() {
    for gait in gaits() {
        let d = gait.description();
        let phases = stepping(d).phases;
        for (leg, h) in phases.iter().enumerate() {
            let pieces = enclose(d, &phases, leg).unwrap();
            let mut y = [h.beta_initial, h.betad_initial].map(Double::from);
            let mut from = 0.0;
            for piece in &pieces {
                // Half way and at the end; the pieces follow each other without a gap.
                let [middle, to] = [0.0, 1.0].map(|tau| piece.share.at(tau).value());
                assert_eq!(piece.share.at(-1.0).value(), from);
                for (tau, ends) in [(0.0, [from, middle]), (1.0, [middle, to])] {
                    y = integrated(d, h, leg, ends, y);
                    inside("β", &piece.beta[0], tau, y[0]);
                    inside("β̇", &piece.beta[1], tau, y[1]);
                }
                from = to;
            }
            assert_eq!(from, 1.0);
            let widest = pieces.iter().flat_map(|p| p.beta).map(|b| b.rest()).fold(0.0, f64::max);
            assert!(widest < 1e-8, "{}: {widest:e}", d.gait);
        }
    }
}

fn everything<T: Scalar>(d: &Description, phases: &[Course], k: usize, share: T, beta: [T; 2]) -> Vec<(String, T)> {
    let mut instants = instants::<T>(d, phases, k);
    let (h, cast): (_, Vec<Course<T>>) = (&phases[k], phases.iter().map(Course::cast).collect());
    let mut state = State::new(d);
    let acceleration = instants.at(share * h.duration.into(), beta, &mut state).unwrap();
    let mut all = vec![("β̈".into(), acceleration)];
    for swing in swings(d, &cast, k) {
        let above = clearance(instants.numbers(), &state, &swing, share * h.duration.into());
        all.push((swing.constraint.name(d), above));
    }
    let contact = instants.contact();
    Units::new(d).margins(instants.numbers(), &contact, &state, |constraint, margin| {
        all.push((constraint.name(d), margin));
    });
    all
}

#[test]
fn what_follows_from_beta_is_enclosed() {
    for gait in gaits() {
        let d = gait.description();
        let phases = stepping(d).phases;
        for k in 0..phases.len() {
            for piece in enclose(d, &phases, k).unwrap() {
                let models = everything::<Model>(d, &phases, k, piece.share, piece.beta);
                for tau in [-1.0, -0.75, -0.125, 0.5, 0.875] {
                    let at = |m: &Model| {
                        m.coefficients().iter().rev().fold(Double::from(0.0), |s, c| s * tau.into() + Double::from(*c))
                    };
                    for shift in [-1.0, 0.0, 1.0] {
                        // Any β and β̇ of the enclosure.
                        let beta = piece.beta.map(|b| at(&b) + Double::from(shift * b.rest()));
                        let exact = everything(d, &phases, k, at(&piece.share), beta);
                        for ((name, model), (_, exact)) in models.iter().zip(exact) {
                            inside(name, model, tau, exact);
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn what_cannot_be_followed_is_said_to_be_lost() {
    let d = gaits()[2].description();
    let mut h = stepping(d).phases[0].clone();
    h.betad_initial = 1e5;
    assert!(enclose(d, &[h.clone()], 0).is_err());
    h.betad_initial = f64::NAN;
    assert!(enclose(d, &[h], 0).is_err());
}
