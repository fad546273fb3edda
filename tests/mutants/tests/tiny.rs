//! The harness, tried on a crate of its own: of each kind of change one that a test catches, and one that survives.

use std::fs;
use std::path::Path;
use std::process::Command;

/// Copies a folder.
fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap().map(|entry| entry.unwrap().path()) {
        let name = to.join(entry.file_name().unwrap());
        if entry.is_dir() { copy(&entry, &name) } else { fs::copy(&entry, &name).map(drop).unwrap() }
    }
}

/// Runs the harness on the tiny crate in `root`: its exit code, what it prints, and what became of every change.
fn tried(root: &Path, survivors: &str) -> (Option<i32>, String, String) {
    fs::write(root.join("survivors.txt"), survivors).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_sumo-mfc-mutants"));
    command.args(["--root", ".", "--survivors", "survivors.txt", "--list", "mutants.json", "src/room", "--", "--lib"]);
    // What builds this test is not to build the tiny crate.
    let ended = command.current_dir(root).env_remove("RUSTFLAGS").output().unwrap();
    let printed = String::from_utf8(ended.stdout).unwrap();
    let log = fs::read_to_string(root.join("target/mutants/tried.txt"));
    let log = log.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&ended.stderr)));
    (ended.status.code(), printed, log)
}

/// What became of the changes is known beforehand: `tiny/expected.txt` has it.
#[test]
fn the_fate_of_every_change_of_a_tiny_crate() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().canonicalize().unwrap();
    copy(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tiny"), &root);
    let expected = fs::read_to_string(root.join("expected.txt")).unwrap();

    let (code, printed, log) = tried(&root, "");
    assert_eq!(log, expected);
    let count = |word: &str| log.lines().filter(|line| line.starts_with(word)).count();
    let (caught, survived, unreached) = (count("caught"), count("survived"), count("reached by no"));
    let row = format!("| room | {} | {caught} | {survived} | {unreached} |", caught + survived + unreached);
    assert!(printed.contains(&row), "{row}\n{printed}");
    assert_eq!(code, Some(1));
    assert!(printed.contains(&format!("Survivors without a reason: {}", survived + unreached)), "{printed}");

    // With reasons for all of them, and one too many.
    let names = log.lines().filter(|line| line.starts_with("survived") || line.starts_with("reached by no"));
    let names: Vec<String> = names
        .map(|line| line.split('\t').nth(1).unwrap())
        .map(|name| format!("{}: {}\n", name.split(':').next().unwrap(), name.splitn(4, ':').nth(3).unwrap().trim()))
        .collect();
    let (code, printed, _) = tried(&root, &format!("because:\n{}src/room.rs: replace a with b\n", names.concat()));
    assert_eq!(code, Some(0), "{printed}");
    assert!(printed.contains("survived; because"), "{printed}");
    assert!(printed.contains("listed as a survivor, but is none (1): src/room.rs: replace a with b"), "{printed}");
}
