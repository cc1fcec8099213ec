//! Searches: as wide as the evidence asks for, with the same result whoever counts the threads.

use piaffe::altered::Altered;
use piaffe::gaits::{GAITS, curvet::Curvet};
use piaffe::model::Gait;
use piaffe::motion::Criterion;
use piaffe::search::evidence::Effort;
use piaffe::search::local::Task;
use piaffe::search::multi_start::{Found, Settings, search, start};
use piaffe::sqp::Control;

fn named(name: &str) -> &'static dyn Gait {
    GAITS.iter().copied().find(|g| g.description().key == name).unwrap()
}

fn searched(name: &str, speed: f64, settings: &Settings) -> Found {
    search(named(name), Criterion::Torque, speed, settings, &|_| {})
}

fn costs(found: &Found) -> Vec<(u64, usize)> {
    found.optima.iter().map(|o| (o.local.costs.torque.to_bits(), o.reached)).collect()
}

#[test]
fn many_optima_ask_for_more_starts_than_one() {
    let settings = Settings::default();
    let (one, several) = (searched("trot", 0.6, &settings), searched("amble", 0.9, &settings));
    assert!(one.optima.len() == 1 && several.optima.len() > 1, "{:?} {:?}", one.effort, several.effort);
    assert!(one.effort.starts < several.effort.starts, "{:?} {:?}", one.effort, several.effort);
    for found in [&one, &several] {
        let unseen = found.effort.expected_optima().unwrap() - found.effort.optima as f64;
        assert!(found.effort.is_enough() && unseen <= 0.5, "{:?}", found.effort);
        assert_eq!(found.effort.successes, found.optima.iter().map(|o| o.reached).sum::<usize>());
    }
}

#[test]
fn a_search_where_no_start_leads_anywhere_ends_before_long() {
    let found = searched("trot", 1.6, &Settings::default());
    assert!(found.optima.is_empty() && found.effort.successes == 0);
    assert!(!found.failure.unwrap().conflicts.is_empty() && found.effort.starts <= 16, "{:?}", found.effort);
}

#[test]
fn a_given_number_of_starts_is_kept_to_and_threads_do_not_matter() {
    let settings = Settings { starts: Some(20), seed: 3, ..Settings::default() };
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let (one, many) = (alone.install(|| searched("amble", 0.9, &settings)), searched("amble", 0.9, &settings));
    assert_eq!(one.effort.starts + one.effort.informed, 20);
    assert_eq!((one.effort, costs(&one)), (many.effort, costs(&many)));
}

/// The optimum that few starts reach is among those that a search of a slow curvet ends with; more lead to 964.1.
#[test]
fn optima_that_few_starts_reach_are_found() {
    let found = searched("curvet", 0.2, &Settings::default());
    let best = &found.optima[0];
    assert!(best.local.costs.torque < 960.0, "{} {:?}", best.local.costs.torque, found.effort);
    let Effort { starts, successes, .. } = found.effort;
    assert!(4 * best.reached < successes && starts > 2 * 8, "{} {:?}", best.reached, found.effort);
}

/// The swing foot's room is a quotient that is 0/0 where the step begins: a row between nodes that is lowest there has the value of the
/// node, not one of a look at that instant.
#[test]
fn a_row_that_is_lowest_at_an_end_has_the_value_there() {
    let curvet = Altered::of_order(&Curvet, 8);
    let task = Task { gait: &curvet, criterion: Criterion::Torque, speed: 0.6 };
    for k in [0, 3] {
        let found = task.descend(&start(&curvet, task.criterion, task.speed, 1, k), &mut |_| Control::Continue);
        assert!(
            found.status.is_optimal() && found.costs.torque < 312.7,
            "start {k}: {:?} {}",
            found.status,
            found.costs.torque
        );
    }
}
