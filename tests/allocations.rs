//! The iterations of an optimization allocate nothing: all memory is taken before the first.

use piaffe::Robot;
use piaffe::cycle::Cycle;
use piaffe::gaits::GAITS;
use piaffe::model::Gait;
use piaffe::motion::Criterion;
use piaffe::search::local::options;
use piaffe::search::multi_start::start;
use piaffe::sqp::{Control, Options, minimize};

/// Allocations of a run that is stopped after so many iterations from a numbered start, and how many there were; `None` where
/// Clarabel was asked, which allocates.
fn allocations(gait: &dyn Gait, criterion: Criterion, number: usize, limit: usize) -> Option<(u64, usize)> {
    let theta = start(gait, criterion, 0.6, 1, number);
    let mut cycle = Cycle::new(gait, criterion, 0.6);
    let options = Options { iteration_limit: limit, ..options(&cycle) };
    let (mut iterations, mut asked) = (0, 0);
    let counted = allocation_counter::measure(|| {
        let solution = minimize(&mut cycle, &theta, &options, &mut |_| Control::Continue);
        (iterations, asked) = (solution.iterations, solution.interior_solves);
    });
    (asked == 0).then_some((counted.count_total, iterations))
}

#[test]
fn iterations_do_not_allocate() {
    let curvet = Robot::read(concat!(env!("CARGO_MANIFEST_DIR"), "/model-spec")).unwrap().gait("curvet").unwrap();
    // A gait that is evaluated as it stands has a thread's cells, taken when the thread first asks for a start.
    for gait in GAITS.iter().copied().chain([&curvet as &dyn Gait]) {
        for criterion in Criterion::ALL {
            // Not from every start is there a way: the first that goes on for a while is used.
            let goes_on = |k: usize| allocations(gait, criterion, k, 400).filter(|(_, iterations)| *iterations > 5);
            let Some((far, (all, many))) = (0..8).find_map(|k| Some((k, goes_on(k)?))) else {
                panic!("no start goes on")
            };
            let (few, none) = allocations(gait, criterion, far, 0).expect("nothing was asked");
            assert!(none == 0 && many > 5, "{many} iterations");
            assert_eq!(all, few, "{} {criterion:?}: allocations in {many} iterations", gait.description().gait);
        }
    }
}
