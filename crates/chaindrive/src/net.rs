//! The net under the program: a panic is a mistake of ours, and whoever meets it is told what to report.

use std::any::Any;
use std::cell::RefCell;
use std::fmt;
use std::panic::{self, AssertUnwindSafe, Location, PanicHookInfo, catch_unwind, resume_unwind};
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::Origin;

/// A mistake of the program itself: where it stopped, and what it said.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProgramError {
    /// File and line of the source, where they are known.
    pub place: Option<String>,
    /// Message of the panic.
    pub message: String,
}

/// The line that a user reports.
impl fmt::Display for ProgramError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Origin {
            build,
            instruction_set,
        } = Origin::here();
        let place = self.place.as_deref().unwrap_or("at an unknown place");
        write!(
            f,
            "chaindrive made a mistake of its own; please report this line and what led to it: {build} {instruction_set}, \
             {place}: {}",
            self.message
        )
    }
}

impl std::error::Error for ProgramError {}

/// Nets of a thread.
#[derive(Debug)]
struct Nets {
    /// Nets that are spread.
    depth: usize,
    /// Where the last panic below them was.
    place: Option<String>,
}

thread_local! {
    static NETS: RefCell<Nets> = const { RefCell::new(Nets { depth: 0, place: None }) };
}

/// Whether somebody else catches every panic of this library.
static EVERYWHERE: AtomicBool = AtomicBool::new(false);

/// Does something; a panic in it becomes an error, and nothing is printed unless `RUST_BACKTRACE` is set.
///
/// # Errors
/// [`ProgramError`] where it panicked.
///
/// # Example
///
/// ```
/// let fault = chaindrive::caught(|| vec![1, 2][chaindrive::MOST_CIRCUITS as usize]).unwrap_err();
/// assert!(fault.to_string().contains("please report this"));
/// ```
pub fn caught<T>(work: impl FnOnce() -> T) -> Result<T, ProgramError> {
    listen();
    NETS.with_borrow_mut(|nets| nets.depth += 1);
    let done = catch_unwind(AssertUnwindSafe(work));
    NETS.with_borrow_mut(|nets| nets.depth -= 1);
    done.map_err(|said| ProgramError::last(&message_of(said.as_ref())))
}

/// Has the place of every panic of this library kept and nothing printed, for a front end that catches all of them by itself; it
/// makes the error by [`ProgramError::last`].
pub fn catch_everywhere() {
    EVERYWHERE.store(true, Ordering::Relaxed);
    listen();
}

impl ProgramError {
    /// The error of the panic on this thread that was caught last, and said this.
    pub fn last(message: &str) -> Self {
        Self {
            place: NETS.with_borrow_mut(|nets| nets.place.take()),
            message: message.to_owned(),
        }
    }

    /// Carries a panic of another thread on in this one, for the net that is spread here.
    pub(crate) fn resume(self) -> ! {
        NETS.with_borrow_mut(|nets| nets.place = self.place);
        resume_unwind(Box::new(self.message))
    }
}

/// What a panic said.
fn message_of(said: &(dyn Any + Send)) -> String {
    let text = said.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| said.downcast_ref::<&str>().copied());
    text.unwrap_or("without a message").to_owned()
}

/// Keeps places of panics from now on. Those that fall into no net are printed as before.
fn listen() {
    static ONCE: Once = Once::new();
    // The hook cannot be changed while a thread unwinds.
    if std::thread::panicking() {
        return;
    }
    ONCE.call_once(|| {
        let print = panic::take_hook();
        panic::set_hook(Box::new(move |panic: &PanicHookInfo<'_>| {
            let netted = EVERYWHERE.load(Ordering::Relaxed);
            // The thread may be at its end.
            let netted = NETS.try_with(|nets| {
                nets.try_borrow_mut().is_ok_and(|mut nets| {
                    nets.place = panic.location().map(place_of);
                    netted || nets.depth > 0
                })
            });
            let asked = std::env::var_os("RUST_BACKTRACE").is_some_and(|it| it != "0");
            if asked || !netted.unwrap_or(false) {
                print(panic);
            }
        }));
    });
}

/// File and line, without folders of the machine that the program was built on.
fn place_of(location: &Location<'_>) -> String {
    let file = location.file().replace('\\', "/");
    let file = match file.split_once("/registry/src/") {
        Some((_, file)) => file.split_once('/').map_or(file, |(_, file)| file),
        None => file.find("/library/").map_or(&*file, |at| &file[at + 1..]),
    };
    format!("{file}:{}", location.line())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Inner nets, threads and panics that say nothing included.
    #[test]
    fn a_panic_becomes_what_is_to_be_reported() {
        let line = line!() + 1;
        let fault = caught(|| panic!("seven {}", 7)).unwrap_err();
        let place = format!("crates/chaindrive/src/net.rs:{line}");
        assert_eq!(fault.place, Some(place.clone()));
        let (build, said) = (Origin::here().build, fault.to_string());
        for part in [&build, &place, "seven 7", "please report this"] {
            assert!(said.contains(part), "{said}");
        }
        assert!(!said.contains('\n'));
        let inner = fault.clone();
        let outer = caught(|| inner.resume()).unwrap_err();
        assert_eq!(outer, fault);
        let silent = caught(|| panic::panic_any(7)).unwrap_err();
        assert_eq!(silent.message, "without a message");
        assert_eq!(caught(|| 7), Ok(7));
    }

    #[test]
    fn a_panic_of_a_thread_keeps_its_place() {
        let failing = || -> u8 { panic!("elsewhere") };
        let fault = caught(|| crate::patiently(failing, &|| false)).unwrap_err();
        assert_eq!(fault.message, "elsewhere");
        assert!(
            fault
                .place
                .unwrap()
                .starts_with("crates/chaindrive/src/net.rs")
        );
    }
}
