//! Drives a scenario step by step, watches the egos, and ends the run early once one is a minute old:
//! `cargo run --example session -- scenarios/straight.toml out/session`.

use sumo_mfc::run::{Session, SessionOptions};
use sumo_mfc::scenario::{Catalog, Request, Scenario};

#[tokio::main(flavor = "current_thread")]
async fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let (Some(file), Some(out_dir)) = (args.next(), args.next()) else { return Err("wanted: SCENARIO FOLDER".into()) };
    let scenario = Scenario::load(&Request::file(file), &Catalog::installed())?;
    let options = SessionOptions { out_dir: out_dir.into(), force: true, ..SessionOptions::default() };
    let mut session = Session::open(&scenario, &options).await?;
    let begin_s = session.time_s();
    while !session.is_over() && session.time_s() < begin_s + 60.0 {
        session.step().await?;
        for ego in session.egos() {
            let error = ego.speed - ego.reference;
            println!("{:8.1} s  {:<12} {:6.2} m/s, error {error:+.3} m/s", ego.time, ego.id, ego.speed);
        }
    }
    let result = session.finish().await?;
    if let Some(error) = result.summary.fleet.get("error_rms") {
        println!("error RMS: median {:.3} m/s; all files in {}", error.p50, result.dir.display());
    }
    Ok(())
}
