//! The same physics in dual numbers: derivatives in the robot's numbers, through the integration.

use crate::motions::{gaits, stepping};
use piaffe::model::Description;
use piaffe::motion::Course;
use piaffe::number::Dual;
use piaffe::number::Lanes;
use piaffe::number::Scalar;
use piaffe::verify::constraint::Constraint;
use piaffe::verify::instants::{Instants, State};
use piaffe::verify::margins::Units;
use piaffe::verify::numbers::Numbers;
use piaffe::verify::phase::Phase;

/// Everything about the end of a phase on leg 1: (β, β̇), then all margins.
fn outcome<T: Scalar>(d: &Description, numbers: Numbers<T>, course: &Course<T>) -> Vec<T> {
    let mut phase = Phase::with(d, numbers, course, 0, 1).unwrap();
    let mut state = State::new(d);
    phase.at(phase.duration, &mut state).unwrap();
    let mut all = phase.beta_end().to_vec();
    Units::new(d).margins(phase.numbers(), &phase.contact(), &state, |constraint, margin| {
        // Across the plane a force of exactly 0 has no direction.
        if constraint != Constraint::Friction || state.force.x.value().abs() > 1.0 {
            all.push(margin);
        }
    });
    all
}

/// A robot with its first thigh heavier by x[0], the shin's mass centre lower by x[1], and β̇ greater by x[2] at the begin.
fn altered<T: Scalar>(d: &Description, course: &Course, x: [T; 3]) -> Vec<T> {
    let mut numbers = Numbers::<T>::new(d);
    numbers.bodies[1].mass += x[0];
    numbers.bodies[2].com.y -= x[1];
    numbers.joints[1].max_torque += x[0];
    let mut course = course.cast::<T>();
    course.betad_initial += x[2];
    outcome(d, numbers, &course)
}

#[test]
fn duals_differentiate_a_whole_phase() {
    for gait in gaits() {
        let d = gait.description();
        let course = &stepping(d).phases[0];
        let exact = altered(d, course, [0, 1, 2].map(|k| Dual::<f64, 3>::variable(0.0, k)));
        for (k, h) in [1e-4, 1e-5, 1e-4].into_iter().enumerate() {
            let [less, more] = [-h, h].map(|h| {
                let mut x = [0.0; 3];
                x[k] = h;
                altered(d, course, x)
            });
            for ((dual, less), more) in exact.iter().zip(less).zip(more) {
                let found = (more - less) / (2.0 * h);
                let scale = dual.d[k].abs().max(1.0);
                assert!((found - dual.d[k]).abs() < 1e-5 * scale, "{}, {k}: {found} and {}", d.gait, dual.d[k]);
            }
        }
        // The values are those of plain numbers, to the bit.
        let values: Vec<f64> = exact.iter().map(|x| x.x).collect();
        assert_eq!(values, altered(d, course, [0.0; 3]));
    }
}

#[test]
fn instants_side_by_side_are_single_instants_to_the_bit() {
    for gait in gaits() {
        let d = gait.description();
        let course = &stepping(d).phases[0];
        let times = [0.0, 0.31, 0.77, 1.0].map(|s| s * course.duration);
        let (beta, betad) = ([0.1, -0.2, 0.05, 0.3], [1.0, -0.4, 0.2, 2.0]);
        let mut state = State::new(d);
        let mut together = Instants::<Lanes<4>>::new(d, Numbers::new(d), &course.cast(), 0);
        let acceleration = together.at(Lanes(times), [Lanes(beta), Lanes(betad)], &mut state).unwrap();
        for lane in 0..4 {
            let mut own = State::new(d);
            let mut alone = Instants::new(d, Numbers::new(d), course, 0);
            let single = alone.at(times[lane], [beta[lane], betad[lane]], &mut own).unwrap();
            assert_eq!(single, acceleration.0[lane], "{}", d.gait);
            let mut margins = Vec::new();
            Units::new(d).margins(alone.numbers(), &alone.contact(), &own, |_, margin| margins.push(margin));
            let mut k = 0;
            Units::new(d).margins(together.numbers(), &together.contact(), &state, |constraint, margin| {
                assert_eq!(margin.0[lane], margins[k], "{} {constraint:?}", d.gait);
                k += 1;
            });
            let (feet, velocities) = (state.feet.map(|foot| foot.y.0[lane]), state.feet_velocity.map(|v| v.y.0[lane]));
            assert_eq!((own.feet.map(|foot| foot.y), own.feet_velocity.map(|v| v.y)), (feet, velocities));
        }
    }
    // One lane where f1 vanishes, or that is no number, is enough for none.
    assert_eq!(Lanes([3.0, -1.0, 2.0]).least_magnitude(), 1.0);
    assert!(Lanes([3.0, f64::NAN, 0.0]).least_magnitude().is_nan());
}
