//! Messages to importers.

use std::ffi::{CString, c_char, c_int, c_void};
use std::sync::atomic::{AtomicBool, Ordering};

use chaindrive_couple::plain;

/// Logger of FMI 2.0: environment, name of the instance, status, category, format, values.
pub(crate) type Logger2 =
    unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char, ...);

/// Logger of FMI 3.0: environment, status, category, message.
pub(crate) type Logger3 = unsafe extern "C" fn(*mut c_void, c_int, *const c_char, *const c_char);

/// The function that takes messages.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Listener {
    Two(Option<Logger2>),
    Three(Option<Logger3>),
}

/// Messages of one instance.
#[derive(Debug)]
pub(crate) struct Logger {
    listener: Listener,
    environment: *mut c_void,
    name: CString,
    /// Whether calls are told beside refusals.
    follows: AtomicBool,
}

// SAFETY: the environment is handed back to the importer and never looked into; the standard lets an instance be called from any thread.
unsafe impl Send for Logger {}
// SAFETY: as above; everything else is atomic or does not change.
unsafe impl Sync for Logger {}

impl Logger {
    pub(crate) fn new(
        listener: Listener,
        environment: *mut c_void,
        name: CString,
        follows: bool,
    ) -> Self {
        Self {
            listener,
            environment,
            name,
            follows: AtomicBool::new(follows),
        }
    }

    pub(crate) fn follows(&self) -> bool {
        self.follows.load(Ordering::Relaxed)
    }

    pub(crate) fn follow(&self, follows: bool) {
        self.follows.store(follows, Ordering::Relaxed);
    }

    /// Tells a message, to the standard error output where nobody listens to a refusal.
    pub(crate) fn tell(&self, status: c_int, category: &str, message: &str) {
        let [category, message] =
            [category, message].map(|text| CString::new(&*plain(text)).unwrap_or_default());
        match self.listener {
            Listener::Two(Some(listen)) => {
                // SAFETY: the function of the importer, with texts that live until it returns; the format takes one text.
                unsafe {
                    listen(
                        self.environment,
                        self.name.as_ptr(),
                        status,
                        category.as_ptr(),
                        c"%s".as_ptr(),
                        message.as_ptr(),
                    );
                }
            }
            Listener::Three(Some(listen)) => {
                // SAFETY: the function of the importer, with texts that live until it returns.
                unsafe {
                    listen(
                        self.environment,
                        status,
                        category.as_ptr(),
                        message.as_ptr(),
                    );
                }
            }
            Listener::Two(None) | Listener::Three(None) => {
                eprintln!(
                    "{}: {}",
                    self.name.to_string_lossy(),
                    message.to_string_lossy()
                );
            }
        }
    }
}
