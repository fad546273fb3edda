//! Steps SUMO and prints the speed of every vehicle: `cargo run -- -c city.sumocfg`.
//!
//! One message per step: subscriptions of the vehicles that departed, and the step. One reply: everybody's speed.

use std::time::Duration;

use sumo_mfc::traci::{Batch, Subscribed, SumoProcess, find_sumo, simulation, vehicle};

#[tokio::main(flavor = "current_thread")]
async fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let sumo = find_sumo(None)?;
    let mut process = SumoProcess::spawn(&sumo, &args, None, &std::env::temp_dir())?;
    let mut client = process.connect(Duration::from_secs(60)).await?;
    println!("{} from {}", client.version(), sumo.origin);

    let mut batch = Batch::new();
    let events = (simulation::TIME, simulation::EXPECTED, simulation::DEPARTED);
    let begin_s = client.get(simulation::TIME, "").await?;
    batch.subscribe(events, "", begin_s)?;
    batch.step()?;
    for _ in 0..100 {
        let reply = match client.exchange(&batch).await {
            Ok(reply) => reply,
            Err(error) => return Err(process.explain(error).await.into()),
        };
        batch.clear();
        let (mut time_s, mut expected) = (0.0, 1);
        for block in reply.blocks() {
            let block = block?;
            if let Subscribed::Own((Some(now_s), Some(left), departed)) = block.read(events)? {
                (time_s, expected) = (now_s, left);
                for id in departed.unwrap_or_default() {
                    batch.subscribe(vehicle::SPEED, &id, time_s)?;
                }
            } else if let Subscribed::Own(Some(speed_mps)) = block.read(vehicle::SPEED)? {
                println!("{time_s:8.2} s  {:<16} {speed_mps:6.2} m/s", block.id);
            }
        }
        if expected == 0 {
            break;
        }
        batch.step()?;
    }
    client.close().await?;
    process.shut_down(Duration::from_secs(10)).await?;
    Ok(())
}
