//! With few vehicles SUMO and the program share a core, if that is faster. Results do not depend on it.

use crate::support::{NEW, Running, children, own, run_command};
use std::collections::BTreeSet;
use std::fs;

/// The cores that a process may run on, as the system writes them.
fn cores_of(pid: u32) -> Option<String> {
    let status = fs::read_to_string(format!("/proc/{pid}/status")).ok()?;
    Some(status.lines().find_map(|line| line.strip_prefix("Cpus_allowed_list:"))?.trim().to_owned())
}

#[test]
fn sumo_is_tried_on_one_core_and_on_all() {
    if std::thread::available_parallelism().unwrap().get() == 1 {
        return println!("there is only one core");
    }
    let all = cores_of(std::process::id()).unwrap();
    // Long enough for several trials.
    let args = ["--step-length", "0.01", "--quiet", "--force"];
    let folder = tempfile::tempdir().unwrap();
    let mut running = Running::start(run_command(NEW, &own("light"), folder.path(), &args));
    let (mut seen, mut sumo) = (BTreeSet::new(), None);
    while running.child.try_wait().unwrap().is_none() {
        let of = |pid: &u32| fs::read_to_string(format!("/proc/{pid}/comm")).is_ok_and(|name| name.trim() == "sumo");
        sumo = sumo.or_else(|| children(running.child.id()).into_iter().find(of));
        seen.extend(sumo.and_then(cores_of));
    }
    assert_eq!(running.wait().code, Some(0));
    assert!(seen.contains(&all), "{seen:?} of {all}");
    assert!(seen.iter().any(|cores| cores.parse::<u32>().is_ok()), "one core of {seen:?}");
    let placed = fs::read(folder.path().join("vehicles.csv")).unwrap();
    // Where there is only one, nothing is chosen.
    let mut one = run_command(NEW, &own("light"), folder.path(), &args);
    let (program, options) = (one.get_program().to_owned(), one.get_args().map(ToOwned::to_owned).collect::<Vec<_>>());
    let environment: Vec<_> = one.get_envs().filter_map(|(k, v)| Some((k.to_owned(), v?.to_owned()))).collect();
    one = std::process::Command::new("taskset");
    one.args(["-c", all.split(['-', ',']).next().unwrap()]).arg(program).args(options).envs(environment);
    let ended = Running::start(one).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(fs::read(folder.path().join("vehicles.csv")).unwrap() == placed, "on one core alone");
}
