//! sumo-gui in a window that nobody sees: Debian's Xvfb is its display. Where there is none, this is skipped, unless
//! SUMO_MFC_DISPLAY=required.

use crate::support::{CAR, NEW, Running, run_command, straight_road};
use std::collections::BTreeSet;
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::time::Duration;
use sumo_mfc::traci::{Client, Color, vehicle};

/// A display, as long as this value lives.
struct Display {
    server: Child,
    name: String,
}

impl Display {
    fn open() -> Option<Self> {
        // It chooses a free number, and writes it to the file descriptor 1.
        let server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "800x600x24", "-nolisten", "tcp"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let Ok(mut server) = server else {
            assert!(std::env::var_os("SUMO_MFC_DISPLAY").is_none(), "Xvfb is needed (Debian: xvfb)");
            eprintln!("skipped: no Xvfb");
            return None;
        };
        let mut number = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut number).unwrap();
        Some(Self { server, name: format!(":{}", number.trim()) })
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

#[tokio::test]
async fn sumo_gui_shows_egos_by_their_error_and_others_as_they_are() {
    let Some(display) = Display::open() else { return };
    let folder = tempfile::tempdir().unwrap();
    let vehicle = |id: &str| {
        format!(r#"<vehicle id="{id}" type="car" depart="0" color="1,0,0"><route edges="ab bc"/></vehicle>"#)
    };
    let demand = format!("{CAR}{}{}", vehicle("ego"), vehicle("other").replace("depart=\"0\"", "depart=\"5\""));
    let config = straight_road(folder.path(), &demand);
    let port = crate::clients::free_port().to_string();
    let args = ["--gui", "--num-clients", "2", "--port", &port, "--egos", "id:ego", "--set", "noise.power_db=-6"];
    let mut command = run_command(NEW, &config, &folder.path().join("result"), &args);
    command.env("DISPLAY", &display.name);
    let ours = Running::start(command);
    let mut other = Client::connect(format!("127.0.0.1:{port}"), Duration::from_secs(60)).await.unwrap();
    other.set_order(2).await.unwrap();
    let mut shown = [BTreeSet::new(), BTreeSet::new()];
    for _ in 0..200 {
        other.step().await.unwrap();
        for id in other.get(vehicle::IDS, "").await.unwrap() {
            let Color { red, green, blue, .. } = other.get(vehicle::COLOR, &id).await.unwrap();
            shown[usize::from(id == "other")].insert([red, green, blue]);
        }
    }
    other.close().await.unwrap();
    let ended = ours.wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stderr.contains("coloured by |true speed − reference|"), "{}", ended.stderr);
    let [ego, other] = shown;
    assert!(ego.contains(&[65, 68, 135]) && ego.len() > 3, "from blue on, by the size of the error: {ego:?}");
    assert_eq!(other, BTreeSet::from([[255, 0, 0]]), "not ours to colour");
}
