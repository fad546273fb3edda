//! A Slurm that lives as long as a test.

use std::ffi::OsStr;
use std::fs;
use std::io::Write;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Output};

use super::STUDY;
use super::support::{Ended, NEW, Running, program, repository};
use tempfile::TempDir;

/// Set where a missing Slurm is a failure.
const REQUIRED: &str = "SUMO_MFC_SLURM";

pub struct Cluster {
    folder: TempDir,
}

impl Cluster {
    /// Starts one with this MaxArraySize; `None` if there is no Slurm and none is required.
    pub fn start(max_array_size: usize) -> Option<Self> {
        if !repository(".ci").exists() {
            return skipped("a packaged crate has no .ci/slurm");
        }
        let cluster = Self { folder: tempfile::tempdir().unwrap() };
        let id = std::process::id().to_string();
        let folder = cluster.folder().join("slurm");
        let started = script(["start".as_ref(), folder.as_os_str(), id.as_ref()], max_array_size);
        if started.status.success() {
            return Some(cluster);
        }
        let said = String::from_utf8_lossy(&started.stderr).into_owned();
        let absent = said.contains("Slurm is missing") || said.contains("needs root");
        assert!(absent && std::env::var_os(REQUIRED).is_none(), "{said}");
        skipped(said.trim())
    }

    /// For results.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    fn environment(&self, command: &mut Command) {
        command.env("SLURM_CONF", self.folder().join("slurm/slurm.conf")).current_dir(repository(""));
    }

    /// What a command of Slurm prints.
    pub fn slurm(&self, name: &str, args: &[&str]) -> String {
        let mut command = Command::new(name);
        self.environment(&mut command);
        let output = command.args(args).output().unwrap();
        assert!(output.status.success(), "{name} {args:?}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8_lossy(&output.stdout).into_owned()
    }

    /// The jobs that have not ended.
    pub fn queue(&self) -> String {
        self.slurm("squeue", &["--noheader"])
    }

    /// The program, on this cluster.
    pub fn call(&self, args: &[&str]) -> Ended {
        let mut command = program(NEW);
        self.environment(&mut command);
        command.args(args);
        Running::start(command).wait()
    }

    /// The study through this cluster.
    pub fn command(&self, dir: &Path, args: &[&str]) -> Command {
        let mut command = program(NEW);
        self.environment(&mut command);
        command.args(STUDY).args(args).args(["--executor", "slurm", "-o"]).arg(dir);
        command
    }

    /// The same, to its end.
    pub fn sweep(&self, dir: &Path, args: &[&str]) -> Ended {
        Running::start(self.command(dir, args)).wait()
    }

    /// The same with another program of a name in front of Slurm's.
    pub fn sweep_with(&self, [name, text]: [&str; 2], dir: &Path, args: &[&str]) -> Ended {
        let bin = tempfile::tempdir().unwrap();
        let file = bin.path().join(name);
        fs::write(&file, format!("#!/bin/sh\n{text}\n")).unwrap();
        fs::set_permissions(&file, fs::Permissions::from_mode(0o755)).unwrap();
        let path = std::env::var_os("PATH").unwrap();
        let path = std::env::join_paths([bin.path().to_owned()].into_iter().chain(std::env::split_paths(&path)));
        let mut command = self.command(dir, args);
        command.env("PATH", path.unwrap());
        Running::start(command).wait()
    }
}

impl Drop for Cluster {
    fn drop(&mut self) {
        let folder = self.folder().join("slurm");
        if folder.exists() {
            script(["stop".as_ref(), folder.as_os_str(), OsStr::new("")], 0);
        }
    }
}

fn skipped(why: &str) -> Option<Cluster> {
    // Not through eprintln!, which is captured.
    let line = format!("skipped, because there is no Slurm here: {why}\n");
    std::io::stderr().write_all(line.as_bytes()).unwrap();
    None
}

fn script(args: [&OsStr; 3], max_array_size: usize) -> Output {
    let mut command = Command::new(repository(".ci/slurm"));
    command.args(args).env("SLURM_MAX_ARRAY_SIZE", max_array_size.to_string()).output().unwrap()
}
