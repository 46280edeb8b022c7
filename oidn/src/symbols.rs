//! The functions of `oidn.h` that are called, and where the library is.

use core::ffi::{c_char, c_int, c_void};

use libloading::Library;

use crate::Error;

/// Names of the library, the one of version 2 first.
const NAMES: &[&str] = if cfg!(target_os = "windows") {
    &["OpenImageDenoise.dll"]
} else if cfg!(target_os = "macos") {
    &["libOpenImageDenoise.2.dylib", "libOpenImageDenoise.dylib"]
} else {
    &["libOpenImageDenoise.so.2", "libOpenImageDenoise.so"]
};

/// Declares the functions once: field, type, and their names in the library.
macro_rules! symbols {
    ($($(#[$doc:meta])* $field:ident: fn($($argument:ty),*) $(-> $result:ty)? = $name:literal;)*) => {
        /// The functions, and the library that has them: it stays loaded as long as they may be called.
        pub struct Symbols {
            $($(#[$doc])* pub $field: unsafe extern "C" fn($($argument),*) $(-> $result)?,)*
            _library: Library,
        }

        impl Symbols {
            /// Those of `library`.
            fn of(library: Library) -> Result<Self, Error> {
                Ok(Self {
                    $($field: {
                        type Function = unsafe extern "C" fn($($argument),*) $(-> $result)?;
                        // SAFETY: the library's header declares the function of this name with this signature, and has
                        // done so since version 2.0; earlier ones lack some of the names and are refused.
                        let symbol = unsafe { library.get::<Function>($name) };
                        *symbol.map_err(|error| Error(format!("it is not of version 2: {}", words(&error))))?
                    },)*
                    _library: library,
                })
            }
        }
    };
}

symbols! {
    /// A device of a type: 1 is the processor.
    new_device: fn(c_int) -> *mut c_void = b"oidnNewDevice\0";
    /// Sets a number of a device: device, name, value.
    set_device_int: fn(*mut c_void, *const c_char, c_int) = b"oidnSetDeviceInt\0";
    /// A number of a device: device, name.
    get_device_int: fn(*mut c_void, *const c_char) -> c_int = b"oidnGetDeviceInt\0";
    /// Makes a device ready.
    commit_device: fn(*mut c_void) = b"oidnCommitDevice\0";
    /// The first error since it was last asked for, 0 if there is none, and where its text is: device, text.
    get_device_error: fn(*mut c_void, *mut *const c_char) -> c_int = b"oidnGetDeviceError\0";
    /// Gives a device back.
    release_device: fn(*mut c_void) = b"oidnReleaseDevice\0";
    /// A filter of a type: device, type.
    new_filter: fn(*mut c_void, *const c_char) -> *mut c_void = b"oidnNewFilter\0";
    /// Names an image of a filter: filter, name, pixels, format, width, height, offset, bytes to the next pixel and to
    /// the next row, 0 for what follows from the format.
    set_image: fn(*mut c_void, *const c_char, *mut c_void, c_int, usize, usize, usize, usize, usize)
        = b"oidnSetSharedFilterImage\0";
    /// Sets a choice of a filter: filter, name, value.
    set_filter_bool: fn(*mut c_void, *const c_char, bool) = b"oidnSetFilterBool\0";
    /// Makes a filter ready.
    commit_filter: fn(*mut c_void) = b"oidnCommitFilter\0";
    /// Runs a filter, and returns once it is done.
    execute_filter: fn(*mut c_void) = b"oidnExecuteFilter\0";
    /// Gives a filter back.
    release_filter: fn(*mut c_void) = b"oidnReleaseFilter\0";
}

impl Symbols {
    /// Those of the first library that there is.
    pub fn load() -> Result<Self, Error> {
        let mut first = None;
        for name in NAMES {
            // SAFETY: loading runs what a library does when it is loaded. This is the installed Open Image Denoise, by
            // its own name: it sets up itself, and neither reads nor writes anything of this program, whatever other
            // threads do. Whoever can put another library in its place can put another program in the place of this
            // one, too.
            match unsafe { Library::new(*name) } {
                Ok(library) => return Self::of(library),
                Err(error) => first = first.or(Some(error)),
            }
        }
        Err(Error(first.map_or_else(String::new, |error| words(&error))))
    }
}

/// What the system says of an error, which is in its source.
fn words(error: &libloading::Error) -> String {
    core::error::Error::source(error).map_or_else(|| error.to_string(), |source| source.to_string())
}
