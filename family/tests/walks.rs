//! The whole way for robots that nobody has tuned anything for: random ones, each to its optimal trot.

mod draws;

use draws::{NEAR, member};
use piaffe::audit::Audit;
use piaffe::motion::Criterion;
use piaffe::result::{GaitResult, Status};
use piaffe::search::multi_start::{Settings, search};
use piaffe_family::FAMILIES;

const ROBOTS: usize = 100;
const SPEED: f64 = 0.6;
/// Robots whose results are derived anew.
const AUDITED: usize = 20;

#[test]
fn random_robots_trot_or_say_why_not() {
    let family = FAMILIES.iter().find(|f| f.description.key == "trot").unwrap();
    let settings = Settings::default();
    for criterion in Criterion::ALL {
        let mut rng = fastrand::Rng::with_seed(1);
        let (mut costs, mut infeasible, mut rest) = (Vec::new(), Vec::new(), Vec::new());
        for k in 0..ROBOTS {
            let robot = member(family, &NEAR, &mut rng);
            let found = search(&*robot, criterion, SPEED, &settings, &|_| ());
            let result = GaitResult::new(&*robot, criterion, SPEED, &found, &settings, || 0.0);
            if k < AUDITED {
                let audit = Audit::of(&result, &[&*robot]);
                assert!(result.variables.is_empty() || audit.is_confirmed(), "{k}: {:?}", audit.objection());
            }
            match result.status {
                Status::Optimal => costs.extend(result.cost),
                Status::Infeasible if !result.conflicts.is_empty() => {
                    infeasible.push(format!("{k}: {}", result.conflicts[0].constraint));
                }
                _ => rest.push(format!("{k}: {}", result.message)),
            }
        }
        costs.sort_by(f64::total_cmp);
        let quantile = |share: f64| costs[(share * (costs.len() - 1) as f64).round() as usize];
        println!(
            "{}: {} optimal ({:.2} … {:.2} … {:.2} {}), {} infeasible {infeasible:?}, {} neither {rest:?}",
            criterion.name(),
            costs.len(),
            quantile(0.0),
            quantile(0.5),
            quantile(1.0),
            criterion.unit(),
            infeasible.len(),
            rest.len(),
        );
        assert!(rest.len() * 20 <= ROBOTS, "{rest:?}");
        assert!(costs.len() >= ROBOTS / 2);
    }
}
