//! A root of its own for a test, in a folder: empty, or a bare Debian.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
    time::Duration,
};

use tempfile::TempDir;

use super::{
    skipped,
    support::{Ended, Running, repository},
};

/// Packages are downloaded here, so it can take its time.
const LIMIT: Duration = Duration::from_secs(900);
/// Where the root has the certificates that this machine trusts, apart from those that its packages bring.
const CERTIFICATES: &str = "etc/machine-certificates.crt";

pub struct Root {
    folder: TempDir,
}

impl Root {
    /// One without any file; `None` where this user cannot change root and nothing requires it.
    pub fn empty() -> Option<Self> {
        let root = Self { folder: tempfile::tempdir().unwrap() };
        fs::create_dir(root.path("proc")).unwrap();
        // Mounts are made in a namespace of their own, which ends with the command.
        let probe = Command::new("unshare").args(["--mount", "--pid", "--fork", "true"]).output();
        if probe.is_ok_and(|output| output.status.success()) { Some(root) } else { skipped("no right to change root") }
    }

    /// What debootstrap makes of a release of Debian. It is kept below target/, and every test gets a copy.
    pub fn debian(suite: &str) -> Option<Self> {
        let root = Self::empty()?;
        if Command::new("debootstrap").arg("--version").output().is_err() {
            return skipped("debootstrap is missing");
        }
        let kept = repository("target/bare").join(suite);
        if !kept.is_dir() {
            let part = repository("target/bare").join(format!("{suite}.part"));
            fs::create_dir_all(&part).unwrap();
            let mut command = Command::new("debootstrap");
            command.args(["--variant=minbase", suite]).arg(&part).args(mirror(suite));
            let ended = Running::start_for(command, LIMIT).wait();
            assert_eq!(ended.code, Some(0), "debootstrap: {}\n{}", ended.stdout, ended.stderr);
            fs::rename(&part, &kept).unwrap();
        }
        let copied = Command::new("cp").arg("-a").arg(kept.join(".")).arg(root.folder.path()).status().unwrap();
        assert!(copied.success());
        // How this machine reaches its package registries.
        for name in ["etc/pip.conf", "etc/resolv.conf", "etc/hosts"] {
            let _ = fs::copy(Path::new("/").join(name), root.path(name));
        }
        if let Some(certificates) = certificates() {
            fs::copy(certificates, root.path(CERTIFICATES)).unwrap();
        }
        Some(root)
    }

    /// A path below the root.
    pub fn path(&self, inside: &str) -> PathBuf {
        self.folder.path().join(inside.trim_start_matches('/'))
    }

    /// Runs a command in the root, with processes and mounts of its own that end with it.
    pub fn run(&self, words: &[&str], environment: &[(String, String)]) -> Ended {
        let mut command = Command::new("unshare");
        command.args(["--mount", "--pid", "--fork", "--kill-child", "sh", "-c"]);
        command.arg("mount -t proc proc \"$0/proc\" && exec chroot \"$0\" \"$@\"").arg(self.folder.path()).args(words);
        command.env_clear().env("PATH", "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin");
        command.env("HOME", "/root").env("LC_ALL", "C.UTF-8").env("DEBIAN_FRONTEND", "noninteractive");
        command.envs(std::env::vars().filter(|(name, _)| name.starts_with("PIP_") || name.ends_with("_proxy")));
        if self.path(CERTIFICATES).exists() {
            command.env("PIP_CERT", format!("/{CERTIFICATES}"));
        }
        command.envs(environment.iter().cloned());
        Running::start_for(command, LIMIT).wait()
    }
}

/// Where this machine's apt gets that release from; nothing if it does not use it.
fn mirror(suite: &str) -> Option<String> {
    let format = ["indextargets", "--format", "$(CODENAME) $(REPO_URI)", "Identifier: Packages"];
    let listed = Command::new("apt-get").args(format).output().ok()?;
    let listed = String::from_utf8_lossy(&listed.stdout).into_owned();
    listed.lines().find_map(|line| line.strip_prefix(suite)?.strip_prefix(' ').map(str::to_owned))
}

/// The certificates that this machine trusts.
fn certificates() -> Option<PathBuf> {
    let named = ["PIP_CERT", "SSL_CERT_FILE"].iter().filter_map(std::env::var_os).map(PathBuf::from);
    named.chain([PathBuf::from("/etc/ssl/certs/ca-certificates.crt")]).find(|path| path.is_file())
}
