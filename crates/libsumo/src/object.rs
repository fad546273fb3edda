//! Shared objects, loaded and never unloaded.

use std::ffi::{CStr, CString, c_void};
use std::fs::File;
use std::io::Write;
use std::os::fd::{AsRawFd, FromRawFd};
use std::path::Path;

/// A shared object in this process.
pub struct Shared(*mut c_void);

impl Shared {
    /// Loads the one at `path`, with all that it needs. Functions are bound when they are first called.
    pub fn open(path: &Path) -> Result<Self, String> {
        let text = path.as_os_str().as_encoded_bytes();
        let text = CString::new(text).map_err(|_| "its path holds a zero byte".to_owned())?;
        // SAFETY: a C string. What a library does while it is loaded is its own affair; we load SUMO's, and our own.
        let handle = unsafe { libc::dlopen(text.as_ptr(), libc::RTLD_LAZY | libc::RTLD_LOCAL) };
        if handle.is_null() { Err(loaders_error()) } else { Ok(Self(handle)) }
    }

    /// Loads one that is in memory.
    pub fn embedded(bytes: &[u8]) -> Result<Self, String> {
        let failed = |error: std::io::Error| format!("the shim: {error}");
        // SAFETY: a C string.
        let descriptor = unsafe { libc::memfd_create(c"sumo-mfc-libsumo".as_ptr(), libc::MFD_CLOEXEC) };
        if descriptor < 0 {
            return Err(failed(std::io::Error::last_os_error()));
        }
        // SAFETY: a descriptor that was just made, and that nobody else has.
        let mut file = unsafe { File::from_raw_fd(descriptor) };
        file.write_all(bytes).map_err(failed)?;
        Self::open(Path::new(&format!("/proc/self/fd/{}", file.as_raw_fd())))
    }

    /// Whether it has a symbol.
    pub fn has(&self, name: &CStr) -> bool {
        self.symbol(name).is_ok()
    }

    /// The address of a symbol.
    pub fn symbol(&self, name: &CStr) -> Result<*mut c_void, String> {
        // SAFETY: a handle of the loader that is never closed, and a C string.
        let address = unsafe { libc::dlsym(self.0, name.as_ptr()) };
        if address.is_null() { Err(loaders_error()) } else { Ok(address) }
    }
}

/// The loader's words for its last error.
fn loaders_error() -> String {
    // SAFETY: dlerror gives null or a C string that stays until the next call of the loader in this thread.
    let text = unsafe { libc::dlerror() };
    if text.is_null() {
        return "the loader does not say why".to_owned();
    }
    // SAFETY: as above.
    unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned()
}
