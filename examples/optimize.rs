//! The cheapest trot at a speed, and what stands behind it: `cargo run --release --example optimize`.

use piaffe::Task;
use piaffe::gaits::trot::Trot;

fn main() -> Result<(), piaffe::Unaskable> {
    let result = Task::new(&Trot).speed(0.6).optimize()?;
    match (result.cost, &result.receipt) {
        (Some(cost), Some(receipt)) => {
            println!("{cost:.4} {}; active: {}", result.criterion.unit(), receipt.active.join(", "))
        }
        _ => println!("{}", result.message),
    }
    Ok(())
}
