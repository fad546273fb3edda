//! SUMO in this process: a safe wrapper around `libsumocpp`, the C++ library that comes with SUMO.
//!
//! Nothing of SUMO is linked: [`Library::load`] loads the library beside the SUMO that is used, and then the shim
//! (`shim.cpp`), which this crate carries inside it. So a program with this crate starts also where there is no SUMO.
//!
//! SUMO's state is static: a process has at most one [`Simulation`], ever. SUMO's own printing goes into a file. A SUMO that
//! crashes takes the process with it.

#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
compile_error!("SUMO in this process needs Linux with glibc: libsumocpp.so is made for it");

mod api;
mod object;

use api::{Answer, Api, DONE, REFUSED};
use object::Shared;
use std::ffi::{CString, c_char, c_int, c_void};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// The version that the shim was compiled for, as SUMO tells it.
pub const VERSION: &str = env!("LIBSUMO_VERSION");

/// Why there is no SUMO in this process, or none any more.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// It is not beside SUMO.
    #[error("no libsumocpp.so beside {} (the Python package eclipse-sumo has one, Debian's package has not)", .binary.display())]
    Missing {
        /// SUMO's binary.
        binary: PathBuf,
    },
    /// It has no place in this process.
    #[error("{} cannot be loaded: {why}", .path.display())]
    Unloadable {
        /// The library.
        path: PathBuf,
        /// The loader's reason.
        why: String,
    },
    /// It is another one than the shim was compiled for.
    #[error("{} is {found}, and this program was built for {VERSION}", .path.display())]
    Version {
        /// The library.
        path: PathBuf,
        /// Its version.
        found: String,
    },
    /// This process has, or had, a simulation.
    #[error("this process has had its one simulation")]
    Taken,
    /// A text that C cannot take.
    #[error("{0:?} holds a zero byte")]
    Zero(String),
    /// Where SUMO's printing goes.
    #[error("{}: {why}", .path.display())]
    Log {
        /// The file.
        path: PathBuf,
        /// Why not.
        why: String,
    },
    /// SUMO could not load the simulation. Its log says more.
    #[error("{0}")]
    Load(String),
    /// SUMO has failed. Its log says more.
    #[error("{0}")]
    Failed(String),
    /// The shim does not ask for this.
    #[error("variable 0x{variable:02x} of domain 0x{domain:02x} is not known to SUMO in this process")]
    Variable {
        /// The domain's get command.
        domain: u8,
        /// The variable.
        variable: u8,
    },
    /// An id or another text of SUMO.
    #[error("SUMO's text is not UTF-8: {0:?}")]
    Text(String),
}

/// A value of SUMO, as it tells it: with its own numbers for "no value".
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Value<'a> {
    /// A number.
    Double(f64),
    /// A whole number.
    Integer(i32),
    /// A text.
    Text(&'a str),
    /// x and y \[m\].
    Position([f64; 2]),
    /// Red, green, blue, alpha.
    Colour([u8; 4]),
    /// The vehicle ahead, empty if there is none, and the gap to it \[m\].
    Leader(&'a str, f64),
}

/// What is said along with a variable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum With<'a> {
    /// Nothing.
    Nothing,
    /// The key of a parameter.
    Key(&'a str),
    /// A distance \[m\].
    Distance(f64),
}

/// Lists of ids.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(i32)]
pub enum Ids {
    /// Vehicles that departed in the last step.
    Departed = 0,
    /// Vehicles that arrived.
    Arrived = 1,
    /// Vehicles of which a teleport began.
    TeleportBegan = 2,
    /// Vehicles that a teleport has put down.
    TeleportEnded = 3,
    /// Vehicles in collisions.
    Colliding = 4,
    /// Vehicles on the road.
    Present = 5,
    /// Collider and victim of every collision, one after the other.
    Collisions = 6,
}

/// Where SUMO is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clock {
    /// Simulation time \[s\].
    pub time_s: f64,
    /// Length of a step \[s\].
    pub step_s: f64,
    /// Vehicles that are on the road or still to come.
    pub expected: i32,
}

/// The library, loaded, without a simulation.
pub struct Library {
    api: Api,
}

/// The library beside SUMO's binary.
///
/// # Errors
/// [`Error::Missing`].
pub fn find(binary: &Path) -> Result<PathBuf, Error> {
    let home = binary.parent().and_then(Path::parent);
    let places = ["lib64", "lib", "bin"].into_iter().filter_map(|dir| Some(home?.join(dir).join("libsumocpp.so")));
    places.into_iter().find(|path| path.is_file()).ok_or_else(|| Error::Missing { binary: binary.to_owned() })
}

impl Library {
    /// Loads the library at `path`, and the shim.
    ///
    /// # Errors
    /// [`Error::Unloadable`], [`Error::Version`].
    pub fn load(path: &Path) -> Result<Self, Error> {
        let unloadable = |why| Error::Unloadable { path: path.to_owned(), why };
        let sumo = Shared::open(path).map_err(unloadable)?;
        // Older ones are of another C++ library's binary interface: not even their version could be asked for.
        if !sumo.has(c"_ZN7libsumo7Vehicle8getSpeedERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEE") {
            let found = "of another version or compiler".to_owned();
            return Err(Error::Version { path: path.to_owned(), found });
        }
        let shim = Shared::embedded(api::SHIM).map_err(unloadable)?;
        let api = Api::of(&shim).map_err(unloadable)?;
        let found = api.version().1;
        if found == VERSION { Ok(Self { api }) } else { Err(Error::Version { path: path.to_owned(), found }) }
    }

    /// TraCI's API number and the version's text, for example "SUMO 1.28.0".
    pub fn version(&self) -> (i32, String) {
        self.api.version()
    }

    /// Loads a simulation with SUMO's arguments, without the name of the program. From now on all that C and C++ print in
    /// this process goes to the end of the file `log`. `home` becomes the environment's `SUMO_HOME`.
    ///
    /// At its end this process leaves SUMO's libraries as they are, and runs no `atexit` function registered before.
    ///
    /// # Errors
    /// [`Error::Taken`], [`Error::Log`], [`Error::Load`].
    pub fn start(self, arguments: &[String], home: Option<&Path>, log: &Path) -> Result<Simulation, Error> {
        static TAKEN: AtomicBool = AtomicBool::new(false);
        let text = |text: &str| CString::new(text).map_err(|_| Error::Zero(text.to_owned()));
        let path = |path: &Path| {
            CString::new(path.as_os_str().as_encoded_bytes()).map_err(|_| Error::Zero(path.display().to_string()))
        };
        let arguments = arguments.iter().map(|argument| text(argument)).collect::<Result<Vec<_>, _>>()?;
        let (home, file) = (home.map(path).transpose()?, path(log)?);
        if TAKEN.swap(true, Ordering::Relaxed) {
            return Err(Error::Taken);
        }
        let api = self.api;
        let home = home.as_ref().map_or(std::ptr::null(), |home| home.as_ptr());
        // SAFETY: both are C strings or null, as the function wants, and live until it returns.
        if unsafe { (api.prepare)(home, file.as_ptr()) } != DONE {
            return Err(Error::Log { path: log.to_owned(), why: api.error() });
        }
        let pointers: Vec<*const c_char> = arguments.iter().map(|argument| argument.as_ptr()).collect();
        // SAFETY: so many C strings, which live until the function returns.
        match unsafe { (api.load)(pointers.as_ptr(), pointers.len()) } {
            DONE => Ok(Simulation { api }),
            _ => Err(Error::Load(api.error())),
        }
    }
}

/// The one simulation of this process. Everything acts at once.
pub struct Simulation {
    // That all of it takes `&mut self` keeps two threads from being inside SUMO at a time; it does not matter which one is.
    api: Api,
}

impl Simulation {
    /// TraCI's API number and the version's text.
    pub fn version(&self) -> (i32, String) {
        self.api.version()
    }

    /// Makes one step.
    ///
    /// # Errors
    /// [`Error::Failed`]: then SUMO is of no use any more.
    pub fn step(&mut self) -> Result<(), Error> {
        // SAFETY: a simulation is loaded, and `&mut self` is the only way to it.
        let status = unsafe { (self.api.step)() };
        self.done(status)
    }

    /// Ends the simulation: SUMO completes its outputs.
    ///
    /// # Errors
    /// [`Error::Failed`].
    pub fn close(self) -> Result<(), Error> {
        // SAFETY: as for `step`; there is no other call after it.
        let status = unsafe { (self.api.close)() };
        self.done(status)
    }

    /// Time, length of a step, and number of vehicles expected.
    ///
    /// # Errors
    /// [`Error::Failed`].
    pub fn clock(&mut self) -> Result<Clock, Error> {
        let mut clock = Clock { time_s: 0.0, step_s: 0.0, expected: 0 };
        // SAFETY: as for `step`, and three places of the right types.
        let status = unsafe { (self.api.clock)(&mut clock.time_s, &mut clock.step_s, &mut clock.expected) };
        self.done(status).map(|()| clock)
    }

    /// The end that the configuration asks for \[s\]; negative without one.
    ///
    /// # Errors
    /// [`Error::Failed`].
    pub fn end_s(&mut self) -> Result<f64, Error> {
        let mut end_s = 0.0;
        // SAFETY: as for `step`, and a place of the right type.
        let status = unsafe { (self.api.end)(&mut end_s) };
        self.done(status).map(|()| end_s)
    }

    /// An option by its name; `None` if SUMO has none of that name.
    ///
    /// # Errors
    /// [`Error::Failed`], [`Error::Text`].
    pub fn option(&mut self, name: &str) -> Result<Option<String>, Error> {
        let mut answer = Answer::NONE;
        // SAFETY: as for `step`; pointer and length are of one text, and the answer is a place of the right type.
        let status = unsafe { (self.api.option)(name.as_ptr().cast(), name.len(), &mut answer) };
        if status == REFUSED {
            return Ok(None);
        }
        self.done(status)?;
        match self.value(&answer)? {
            Value::Text(text) => Ok(Some(text.to_owned())),
            _ => Ok(None),
        }
    }

    /// Appends ids to `ids`.
    ///
    /// # Errors
    /// [`Error::Failed`], [`Error::Text`].
    pub fn ids(&mut self, which: Ids, ids: &mut Vec<String>) -> Result<(), Error> {
        extern "C" fn push(into: *mut c_void, text: *const c_char, length: usize) {
            // SAFETY: `into` is the list below, and the text is one of C++ that outlives this call.
            let (into, bytes) =
                unsafe { (&mut *into.cast::<(&mut Vec<String>, Option<String>)>(), api::bytes(text, length)) };
            match std::str::from_utf8(bytes) {
                Ok(id) => into.0.push(id.to_owned()),
                Err(_) => into.1 = Some(String::from_utf8_lossy(bytes).into_owned()),
            }
        }
        let mut list = (ids, None::<String>);
        // SAFETY: as for `step`; `push` gets the list back that it is given here, during the call alone.
        let status = unsafe { (self.api.ids)(which as c_int, push, (&raw mut list).cast()) };
        self.done(status)?;
        list.1.map_or(Ok(()), |text| Err(Error::Text(text)))
    }

    /// A variable of an object, by TraCI's numbers. `None` if SUMO declines: it does not know the object, say.
    ///
    /// # Errors
    /// [`Error::Variable`], [`Error::Text`], [`Error::Failed`].
    #[inline]
    pub fn get(&mut self, domain: u8, variable: u8, id: &str, with: With<'_>) -> Result<Option<Value<'_>>, Error> {
        let (key, number) = match with {
            With::Nothing => ("", 0.0),
            With::Key(key) => (key, 0.0),
            With::Distance(distance_m) => ("", distance_m),
        };
        let mut answer = Answer::NONE;
        // SAFETY: as for `step`; pointers and lengths are of one text each, and the answer is a place of the right type.
        let status = unsafe {
            (self.api.get)(
                domain.into(),
                variable.into(),
                id.as_ptr().cast(),
                id.len(),
                key.as_ptr().cast(),
                key.len(),
                number,
                &mut answer,
            )
        };
        match status {
            DONE => self.value(&answer).map(Some),
            REFUSED => Ok(None),
            api::UNKNOWN => Err(Error::Variable { domain, variable }),
            _ => Err(Error::Failed(self.api.error())),
        }
    }

    /// `setPreviousSpeed` \[m/s, m/s²\]. False if SUMO declines.
    ///
    /// # Errors
    /// [`Error::Failed`].
    #[inline]
    pub fn set_previous_speed(&mut self, id: &str, speed_mps: f64, acceleration_mps2: f64) -> Result<bool, Error> {
        // SAFETY: as for `step`; pointer and length are of one text.
        let status = unsafe { (self.api.previous_speed)(id.as_ptr().cast(), id.len(), speed_mps, acceleration_mps2) };
        self.taken(status)
    }

    /// Sets a number of a vehicle, by TraCI's number of the variable. False if SUMO declines.
    ///
    /// # Errors
    /// [`Error::Variable`], [`Error::Failed`].
    pub fn set(&mut self, variable: u8, id: &str, number: f64) -> Result<bool, Error> {
        // SAFETY: as for `step`; pointer and length are of one text.
        match unsafe { (self.api.set)(variable.into(), id.as_ptr().cast(), id.len(), number) } {
            api::UNKNOWN => Err(Error::Variable { domain: 0xc4, variable }),
            status => self.taken(status),
        }
    }

    /// Sets a generic parameter of a vehicle. False if SUMO declines.
    ///
    /// # Errors
    /// [`Error::Failed`].
    pub fn set_parameter(&mut self, id: &str, key: &str, value: &str) -> Result<bool, Error> {
        // SAFETY: as for `step`; pointers and lengths are of one text each.
        let status = unsafe {
            (self.api.set_parameter)(
                id.as_ptr().cast(),
                id.len(),
                key.as_ptr().cast(),
                key.len(),
                value.as_ptr().cast(),
                value.len(),
            )
        };
        self.taken(status)
    }

    /// Sets the colour of a vehicle: red, green, blue, alpha. False if SUMO declines.
    ///
    /// # Errors
    /// [`Error::Failed`].
    pub fn set_colour(&mut self, id: &str, colour: [u8; 4]) -> Result<bool, Error> {
        // SAFETY: as for `step`; pointer and length are of one text, and the colour has four parts.
        let status = unsafe { (self.api.set_colour)(id.as_ptr().cast(), id.len(), colour.as_ptr()) };
        self.taken(status)
    }

    fn done(&self, status: c_int) -> Result<(), Error> {
        if status == DONE { Ok(()) } else { Err(Error::Failed(self.api.error())) }
    }

    fn taken(&self, status: c_int) -> Result<bool, Error> {
        if status == REFUSED { Ok(false) } else { self.done(status).map(|()| true) }
    }

    fn value(&self, answer: &Answer) -> Result<Value<'_>, Error> {
        Ok(match answer.kind {
            api::DOUBLE => Value::Double(answer.numbers[0]),
            api::INTEGER => Value::Integer(answer.integer),
            api::POSITION => Value::Position(answer.numbers),
            api::COLOUR => Value::Colour(answer.colour),
            api::LEADER => Value::Leader(self.text(answer)?, answer.numbers[0]),
            _ => Value::Text(self.text(answer)?),
        })
    }

    fn text(&self, answer: &Answer) -> Result<&str, Error> {
        // SAFETY: the shim's text, which stays until the next call, and that needs `&mut self`.
        let bytes = unsafe { api::bytes(answer.text, answer.length) };
        let broken = |_| Error::Text(String::from_utf8_lossy(bytes).into_owned());
        std::str::from_utf8(bytes).map_err(broken)
    }
}
