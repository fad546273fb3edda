//! Compiles `src/shim.cpp` against the headers of the SUMO that is there, into a shared object that `src/lib.rs` embeds.

use std::env;
use std::path::{Path, PathBuf};
use std::process::{Command, exit};

fn main() {
    println!("cargo::rerun-if-changed=src/shim.cpp");
    println!("cargo::rerun-if-env-changed=SUMO_HOME");
    println!("cargo::rerun-if-env-changed=CXX");
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap()).join("libshim.so");
    let Some(home) = home() else {
        fail(
            "SUMO's headers (include/libsumo/libsumo.h) were not found: export SUMO_HOME=/path/to/sumo, or type make setup",
        );
    };
    println!("cargo::rerun-if-changed={}", home.join("include/libsumo/libsumo.h").display());
    println!("cargo::rustc-env=LIBSUMO_VERSION={}", version(&home));
    let compiler = env::var_os("CXX").unwrap_or_else(|| "g++".into());
    let mut command = Command::new(&compiler);
    command.args(["-std=c++17", "-O2", "-fPIC", "-shared", "-Wall", "-Wextra", "-fvisibility=hidden", "src/shim.cpp"]);
    // SUMO's headers are not ours to be warned of. Lazy: which version was loaded can be asked before all else is bound.
    command.arg("-isystem").arg(home.join("include")).arg("-o").arg(&out).arg("-Wl,-z,lazy,--no-undefined");
    command.arg("-L").arg(home.join("lib64")).args(["-lsumocpp", "-Wl,--allow-shlib-undefined"]);
    match command.status() {
        Ok(status) if status.success() => {}
        Ok(status) => fail(&format!("{} has ended with {status}: see above", compiler.display())),
        Err(error) => fail(&format!(
            "the C++ compiler {} cannot be started ({error}): install g++ (apt-get install g++), or set CXX",
            compiler.display()
        )),
    }
}

/// The SUMO with headers: that of `SUMO_HOME`, or the newest that `make setup` has put below `.sumo/`.
fn home() -> Option<PathBuf> {
    let checkout = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut found: Vec<PathBuf> = folders(&checkout.join(".sumo"))
        .flat_map(|version| folders(&version.join("lib")).collect::<Vec<_>>())
        .map(|python| python.join("site-packages/sumo"))
        .filter(|home| has_headers(home))
        .collect();
    found.sort_by_key(|home| number(&version(home)));
    env::var_os("SUMO_HOME").map(PathBuf::from).filter(|home| has_headers(home)).or_else(|| found.pop())
}

fn has_headers(home: &Path) -> bool {
    home.join("include/libsumo/libsumo.h").is_file() && home.join("lib64/libsumocpp.so").is_file()
}

fn folders(parent: &Path) -> impl Iterator<Item = PathBuf> {
    std::fs::read_dir(parent).into_iter().flatten().flatten().map(|entry| entry.path())
}

/// The version of the SUMO at `home`, as libsumo tells it: "SUMO 1.28.0".
fn version(home: &Path) -> String {
    let output = Command::new(home.join("bin/sumo")).arg("--version").output();
    let text = output.map(|output| String::from_utf8_lossy(&output.stdout).into_owned()).unwrap_or_default();
    let words = text.lines().next().and_then(|line| line.split_once("sumo ")).map_or("", |(_, version)| version.trim());
    if words.is_empty() {
        fail(&format!("{} does not tell its version", home.join("bin/sumo").display()));
    }
    format!("SUMO {words}")
}

fn number(version: &str) -> Vec<u32> {
    version.split(|c: char| !c.is_ascii_digit()).filter_map(|part| part.parse().ok()).collect()
}

fn fail(why: &str) -> ! {
    println!("cargo::error=sumo-mfc-libsumo: {why}");
    exit(1)
}
