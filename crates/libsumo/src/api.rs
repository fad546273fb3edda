//! The functions of the shim, found by their names. Their types are those in `shim.cpp`.

use crate::object::Shared;
use std::ffi::{c_char, c_int, c_void};

/// The shim, which `build.rs` has compiled.
pub static SHIM: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/libshim.so"));

/// How a function ends: as it should,
pub const DONE: c_int = 0;
/// declined by SUMO,
pub const REFUSED: c_int = 1;
/// or with a variable that the shim does not know; everything else is an error of SUMO.
pub const UNKNOWN: c_int = 3;

/// Kinds of answers.
pub const DOUBLE: c_int = 1;
pub const INTEGER: c_int = 2;
pub const POSITION: c_int = 4;
pub const COLOUR: c_int = 5;
pub const LEADER: c_int = 6;

/// A value as the shim gives it.
#[repr(C)]
pub struct Answer {
    pub kind: c_int,
    pub integer: c_int,
    pub numbers: [f64; 2],
    pub text: *const c_char,
    pub length: usize,
    pub colour: [u8; 4],
}

impl Answer {
    /// A place for one.
    pub const NONE: Self =
        Self { kind: 0, integer: 0, numbers: [0.0; 2], text: std::ptr::null(), length: 0, colour: [0; 4] };
}

/// Is called for each id of a list.
pub type Push = extern "C" fn(into: *mut c_void, text: *const c_char, length: usize);

macro_rules! functions {
    ($($name:ident = $symbol:literal: fn($($argument:ty),*) $(-> $result:ty)?;)*) => {
        /// The functions.
        #[derive(Clone, Copy)]
        pub struct Api {
            $(pub $name: unsafe extern "C" fn($($argument),*) $(-> $result)?,)*
        }

        impl Api {
            /// Those of a shim that is loaded; it is never unloaded.
            pub fn of(shim: &Shared) -> Result<Self, String> {
                Ok(Self {
                    $($name: {
                        let symbol: *mut c_void = shim.symbol($symbol)?;
                        // SAFETY: the shim defines a function of this name with these types.
                        unsafe { std::mem::transmute::<*mut c_void, unsafe extern "C" fn($($argument),*) $(-> $result)?>(symbol) }
                    },)*
                })
            }
        }
    };
}

functions! {
    version_of = c"shim_version": fn(*mut c_int, *mut *const c_char, *mut usize);
    error_of = c"shim_error": fn(*mut *const c_char, *mut usize);
    prepare = c"shim_prepare": fn(*const c_char, *const c_char) -> c_int;
    load = c"shim_load": fn(*const *const c_char, usize) -> c_int;
    step = c"shim_step": fn() -> c_int;
    close = c"shim_close": fn() -> c_int;
    end = c"shim_end": fn(*mut f64) -> c_int;
    option = c"shim_option": fn(*const c_char, usize, *mut Answer) -> c_int;
    clock = c"shim_clock": fn(*mut f64, *mut f64, *mut c_int) -> c_int;
    ids = c"shim_ids": fn(c_int, Push, *mut c_void) -> c_int;
    get = c"shim_get": fn(c_int, c_int, *const c_char, usize, *const c_char, usize, f64, *mut Answer) -> c_int;
    previous_speed = c"shim_previous_speed": fn(*const c_char, usize, f64, f64) -> c_int;
    set = c"shim_set": fn(c_int, *const c_char, usize, f64) -> c_int;
    set_parameter = c"shim_set_parameter":
        fn(*const c_char, usize, *const c_char, usize, *const c_char, usize) -> c_int;
    set_colour = c"shim_set_colour": fn(*const c_char, usize, *const u8) -> c_int;
}

impl Api {
    /// TraCI's API number and the version's text.
    pub fn version(&self) -> (i32, String) {
        let (mut api, mut text, mut length) = (0, std::ptr::null(), 0);
        // SAFETY: places of the right types; the text stays until the next call of this function.
        let bytes = unsafe {
            (self.version_of)(&mut api, &mut text, &mut length);
            bytes(text, length)
        };
        (api, String::from_utf8_lossy(bytes).into_owned())
    }

    /// What the last function that failed says.
    pub fn error(&self) -> String {
        let (mut text, mut length) = (std::ptr::null(), 0);
        // SAFETY: places of the right types; the text stays until another function fails.
        let bytes = unsafe {
            (self.error_of)(&mut text, &mut length);
            bytes(text, length)
        };
        String::from_utf8_lossy(bytes).into_owned()
    }
}

/// A text of C++.
///
/// # Safety
/// Pointer and length are of one text, which outlives the result; or the length is 0.
pub unsafe fn bytes<'a>(text: *const c_char, length: usize) -> &'a [u8] {
    if length == 0 {
        return &[];
    }
    // SAFETY: as the caller promises.
    unsafe { std::slice::from_raw_parts(text.cast(), length) }
}
