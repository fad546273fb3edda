//! What `make dist` has packed, in a bare Debian root without Rust, where the lines of `dist/Containerfile` are followed one
//! by one. Where `SUMO_MFC_DIST` is set, as `.ci/run` does after `make dist`, nothing that this needs may be missing;
//! elsewhere the tests say that they are skipped. The size of the program that users install is checked everywhere.

mod recipe;
mod root;
#[path = "../live/support.rs"]
#[allow(dead_code)]
mod support;

use std::{
    fs,
    io::Write,
    path::{Path, PathBuf},
    process::Command,
};

use recipe::{Recipe, Step};
use root::Root;
use support::{Ended, repository};

/// Set where a missing archive or debootstrap is a failure.
const REQUIRED: &str = "SUMO_MFC_DIST";
/// What users download is smaller.
const PACKED_BYTES: u64 = 12_000_000;
/// What `cargo install` builds in minutes is smaller; with debug information it had 78 MB.
const INSTALLED_BYTES: u64 = 15_000_000;

fn skipped<T>(why: &str) -> Option<T> {
    assert!(std::env::var_os(REQUIRED).is_none(), "{why}");
    // Not through eprintln!, which is captured.
    std::io::stderr().write_all(format!("skipped: {why}\n").as_bytes()).unwrap();
    None
}

/// What `make dist` has packed.
fn archive() -> Option<PathBuf> {
    let packed = fs::read_dir(repository("target/dist")).into_iter().flatten().flatten();
    let archive = packed.map(|entry| entry.path()).find(|path| path.to_string_lossy().ends_with("-linux.tar.gz"));
    archive.or_else(|| skipped("nothing is packed below target/dist: type make dist"))
}

/// Unpacks the archive and returns the folder that is in it.
fn unpacked(archive: &Path, into: &Path) -> PathBuf {
    let tar = Command::new("tar").arg("-xzf").arg(archive).arg("-C").arg(into).status().unwrap();
    assert!(tar.success());
    let names: Vec<PathBuf> = fs::read_dir(into).unwrap().flatten().map(|entry| entry.path()).collect();
    assert_eq!(names.len(), 1, "one folder in the archive: {names:?}");
    names[0].clone()
}

#[test]
fn the_program_that_cargo_installs_is_small() {
    let program = Path::new(env!("CARGO_BIN_EXE_sumo-mfc"));
    let optimised = program.parent().unwrap().ends_with("release");
    let bytes = program.metadata().unwrap().len();
    assert!(!optimised || bytes < INSTALLED_BYTES, "{bytes} bytes");
}

#[test]
fn the_archive_holds_a_small_static_program_and_what_belongs_to_it() {
    let Some(archive) = archive() else { return };
    let folder = tempfile::tempdir().unwrap();
    let packed = unpacked(&archive, folder.path());
    let program = packed.join("sumo-mfc");
    let bytes = program.metadata().unwrap().len();
    assert!(bytes < PACKED_BYTES, "{bytes} bytes");
    // Static: no interpreter, and no library to look for.
    let headers = Command::new("readelf").arg("-ld").arg(&program).output().expect("binutils");
    let headers = String::from_utf8_lossy(&headers.stdout).into_owned();
    assert!(headers.contains("LOAD") && !headers.contains("INTERP") && !headers.contains("NEEDED"), "{headers}");
    for name in ["LICENSE-APACHE", "LICENSE-MIT", "README.md", "scenarios/straight.toml", "man/sumo-mfc.1"] {
        assert!(packed.join(name).is_file(), "no {name}");
    }
    assert_eq!(fs::read_dir(packed.join("completions")).unwrap().count(), 5);
    let sbom: serde_json::Value = support::json(&packed.join("sbom.cdx.json"));
    assert_eq!(sbom["bomFormat"], "CycloneDX");
    let crates: Vec<&str> = sbom["components"].as_array().unwrap().iter().filter_map(|c| c["name"].as_str()).collect();
    assert!(crates.contains(&"tokio") && crates.contains(&"clap") && !crates.contains(&"divan"), "{crates:?}");
    // Whoever downloads it can check it.
    let sums = PathBuf::from(format!("{}.sha256", archive.display()));
    let check = Command::new("sha256sum").arg("-c").arg(sums).current_dir(archive.parent().unwrap()).output().unwrap();
    assert!(check.status.success());
}

/// The program runs where there is no system at all.
#[test]
fn the_program_needs_nothing_of_a_system() {
    let Some(archive) = archive() else { return };
    let Some(root) = Root::empty() else { return };
    let folder = tempfile::tempdir().unwrap();
    fs::copy(unpacked(&archive, folder.path()).join("sumo-mfc"), root.path("sumo-mfc")).unwrap();
    let ended = root.run(&["/sumo-mfc", "--version"], &[]);
    assert_eq!((ended.code, ended.stdout.as_str()), (Some(0), concat!("sumo-mfc ", env!("CARGO_PKG_VERSION"), "\n")));
}

/// What the container will do, without a container: every line of the recipe, then real runs.
#[test]
fn the_recipe_of_the_container_gives_a_program_that_runs_sumo() {
    let Some(archive) = archive() else { return };
    let recipe = Recipe::read(&repository("dist/Containerfile"));
    let Some(root) = Root::debian(&recipe.suite) else { return };
    let rust = root.run(&["sh", "-c", "command -v cargo rustc gcc"], &[]);
    assert_eq!((rust.code.is_some_and(|code| code > 0), rust.stdout.as_str()), (true, ""), "a root without Rust");
    let mut environment = Vec::new();
    for step in &recipe.steps {
        match step {
            Step::Run(line) => well(root.run(&["sh", "-c", line], &environment)),
            Step::Env(name, value) => environment.push((name.clone(), value.clone())),
            Step::Add(pattern, folder) => {
                assert!(recipe::matches(pattern, &archive), "{pattern} names {}", archive.display());
                let unpack = Command::new("tar").arg("-xzf").arg(&archive).arg("-C").arg(root.path(folder)).status();
                assert!(unpack.unwrap().success());
            }
            Step::WorkDir(folder) => fs::create_dir_all(root.path(folder)).unwrap(),
        }
    }
    let call = |arguments: &[&str]| {
        let entry: Vec<&str> = recipe.entry.iter().map(String::as_str).chain(arguments.iter().copied()).collect();
        root.run(&entry, &environment)
    };
    well(call(&["doctor"]));
    let unpacked = fs::read_dir(root.path("opt")).unwrap().flatten().map(|entry| entry.file_name());
    let unpacked = unpacked.map(|name| name.into_string().unwrap()).find(|name| name.starts_with("sumo-mfc-")).unwrap();
    let scenario = format!("/opt/{unpacked}/scenarios/straight.toml");
    well(call(&["run", &scenario, "-o", "/data/result"]));
    let rows = support::table(&root.path("data/result/vehicles.csv"));
    assert_eq!((rows.len(), rows[0]["reason"].as_str()), (1, "arrived"));
    assert!(root.path("data/result/report.html").is_file());
    // The static program computes the bytes that the one with glibc does.
    let here = support::run(support::NEW, &repository("scenarios/straight.toml"), &["--no-report"]);
    for name in ["vehicles.csv", "quality.csv", "sample.csv"] {
        assert!(fs::read(root.path("data/result").join(name)).unwrap() == here.bytes(name), "{name} differs");
    }
    // A study starts the program itself, by its own path.
    well(call(&["compare", &scenario, "--controllers", "ideal,pid", "--seeds", "1", "-q", "-o", "/data/study"]));
    assert_eq!(support::table(&root.path("data/study/cases.csv")).len(), 2);
}

#[track_caller]
fn well(ended: Ended) {
    assert_eq!(ended.code, Some(0), "{}\n{}", ended.stdout, ended.stderr);
}
