//! Calls as nobody should make them: in any order, with handles, pointers, lengths and values of all kinds.
//!
//! Without the allocator of the library, so that a checker of memory sees every block:
//! `CHAINDRIVE_INSTRUCTION_SET=avx2 valgrind --leak-check=full target/release/deps/chaindrive_fmu-… misuse`

use std::cell::Cell;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::path::Path;
use std::ptr::{null, null_mut, without_provenance_mut};
use std::sync::Arc;

use chaindrive::{Request, Scene, Settings};
use chaindrive_couple::{Export, Model, Standard, package, read_library};

use crate::units::Handle;
use crate::{calls, fmi2, fmi3};

/// Entries of every array: more than the unit has variables, so that a length that is let through is within it.
const ROOM: usize = 256;

thread_local! {
    static MESSAGES: Cell<usize> = const { Cell::new(0) };
}

unsafe extern "C" fn listen(
    _: *mut c_void,
    status: c_int,
    category: *const c_char,
    message: *const c_char,
) {
    assert!((0..=4).contains(&status));
    for text in [category, message] {
        // SAFETY: the library hands over texts.
        let text = unsafe { CStr::from_ptr(text) };
        assert!(!text.is_empty());
    }
    MESSAGES.set(MESSAGES.get() + 1);
}

/// SplitMix64 (Steele, Lea and Flood 2014).
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    fn below(&mut self, n: usize) -> usize {
        let n = u64::try_from(n).expect("a small number");
        usize::try_from(self.roll() % n).expect("below a small number")
    }

    fn of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }

    /// A number of any kind.
    fn number(&mut self) -> f64 {
        let any = f64::from_bits(self.roll());
        self.of(&[
            0.0,
            -0.0,
            1e-6,
            1e-5,
            1.0,
            -1.0,
            1e308,
            f64::NAN,
            f64::INFINITY,
            any,
        ])
    }

    /// A length that is right, zero, or beyond all bounds.
    fn length(&mut self) -> usize {
        self.of(&[0, 1, 2, 7, usize::MAX, usize::MAX / 2, 1 << 40, ROOM * 1000])
    }
}

/// Handles and arrays that calls draw from.
struct Pool {
    token: CString,
    folder: CString,
    handles: Vec<Handle>,
    live: Vec<Handle>,
    states: Vec<Handle>,
    references: [u32; ROOM],
    numbers: [f64; ROOM],
    choices: [i64; ROOM],
    texts: [*const c_char; ROOM],
    bytes: Vec<u8>,
    /// Beginning of the present step, as the caller has it.
    time: f64,
}

impl Pool {
    fn handle(&mut self, dice: &mut Dice) -> Handle {
        let strange = without_provenance_mut(usize::try_from(dice.roll() >> 1).unwrap_or(16));
        match dice.below(8) {
            0 => null_mut(),
            1 => strange,
            2 if !self.handles.is_empty() => dice.of(&self.handles),
            _ => self.live.last().copied().unwrap_or(null_mut()),
        }
    }

    fn state(&mut self, dice: &mut Dice) -> Handle {
        let strange = without_provenance_mut(usize::try_from(dice.roll() >> 1).unwrap_or(16));
        match dice.below(4) {
            0 => null_mut(),
            1 => strange,
            _ if self.states.is_empty() => null_mut(),
            _ => dice.of(&self.states),
        }
    }

    fn fill(&mut self, dice: &mut Dice) {
        for index in 0..8 {
            self.references[index] = match dice.below(6) {
                0 => u32::MAX,
                _ => u32::try_from(dice.below(90)).expect("a small number"),
            };
            self.numbers[index] = dice.number();
            self.choices[index] = i64::try_from(dice.below(7)).expect("a small number") - 1;
        }
    }

    fn make(&mut self, dice: &mut Dice) {
        let good = dice.below(4) > 0;
        let wrong = c"no such thing";
        let token = if good {
            self.token.as_ptr()
        } else {
            dice.of(&[null(), wrong.as_ptr()])
        };
        let folder = match dice.below(8) {
            0 => null(),
            1 => wrong.as_ptr(),
            _ => self.folder.as_ptr(),
        };
        let environment = null_mut();
        // SAFETY: texts or null.
        let made = unsafe {
            fmi3::fmi3InstantiateCoSimulation(
                dice.of(&[null(), c"drive".as_ptr()]),
                token,
                folder,
                0,
                u8::from(dice.below(2) == 0),
                0,
                0,
                null(),
                0,
                environment,
                Some(listen),
                null_mut(),
            )
        };
        if made.is_null() {
            assert!(
                !good || folder != self.folder.as_ptr(),
                "a good call was refused"
            );
            return;
        }
        self.handles.push(made);
        self.live.push(made);
        self.time = 0.0;
    }

    /// One call of any kind; none answers with more than the standard knows.
    #[expect(clippy::too_many_lines, reason = "a list of calls")]
    #[expect(
        clippy::multiple_unsafe_ops_per_block,
        reason = "one of them is carried out"
    )]
    fn call(&mut self, dice: &mut Dice) {
        self.fill(dice);
        let instance = self.handle(dice);
        let known = self.live.contains(&instance);
        let before = MESSAGES.get();
        let (n, m) = (dice.length(), dice.length());
        let m = if dice.below(4) > 0 { n } else { m };
        let none = dice.below(6) == 0;
        let references = if none {
            null()
        } else {
            self.references.as_ptr()
        };
        let numbers = if dice.below(6) == 0 {
            null_mut()
        } else {
            self.numbers.as_mut_ptr()
        };
        let mut state = self.state(dice);
        let kept = state;
        // SAFETY: arrays have more entries than any length that is let through; everything else is null or a number.
        let status = unsafe {
            match dice.below(20) {
                0 => fmi3::fmi3EnterInitializationMode(
                    instance,
                    0,
                    0.0,
                    dice.of(&[0.0, 0.0, f64::NAN]),
                    0,
                    0.0,
                ),
                1 => fmi3::fmi3ExitInitializationMode(instance),
                2 => fmi3::fmi3GetFloat64(instance, references, n, numbers, m),
                3 => fmi3::fmi3SetFloat64(instance, references, n, numbers, m),
                4 => fmi3::fmi3GetInt64(instance, references, n, self.choices.as_mut_ptr(), m),
                5 => fmi3::fmi3SetInt64(instance, references, n, self.choices.as_ptr(), m),
                6 => fmi3::fmi3GetString(instance, references, n, self.texts.as_mut_ptr(), m),
                7..=9 => {
                    let from = dice.of(&[self.time, self.time, self.time, f64::NAN, -1.0]);
                    let step = dice.of(&[1e-6, 2e-6, 5e-6, 0.0, -1.0, f64::NAN, 1e300]);
                    let mut reached = f64::NAN;
                    let status = fmi3::fmi3DoStep(
                        instance,
                        from,
                        step,
                        0,
                        null_mut(),
                        null_mut(),
                        null_mut(),
                        &raw mut reached,
                    );
                    if status <= calls::WARNING {
                        self.time = reached;
                    }
                    status
                }
                10 => {
                    let status = fmi3::fmi3GetFMUState(instance, &raw mut state);
                    if status == calls::OK && state != kept {
                        self.states.push(state);
                    }
                    status
                }
                11 => fmi3::fmi3SetFMUState(instance, state),
                12 => fmi3::fmi3FreeFMUState(instance, &raw mut state),
                13 => {
                    let mut size = 0;
                    let status = fmi3::fmi3SerializedFMUStateSize(instance, state, &raw mut size);
                    if status == calls::OK {
                        self.bytes = vec![0; size];
                        let size = dice.of(&[size, size - 1, 0]);
                        fmi3::fmi3SerializeFMUState(instance, state, self.bytes.as_mut_ptr(), size);
                    }
                    status
                }
                14 => {
                    let size = self.bytes.len();
                    if size > 0 && dice.below(2) == 0 {
                        let place = dice.below(size);
                        self.bytes[place] ^= 1 << dice.below(8);
                    }
                    let mut fresh = null_mut();
                    let status = fmi3::fmi3DeserializeFMUState(
                        instance,
                        self.bytes.as_ptr(),
                        size,
                        &raw mut fresh,
                    );
                    if status == calls::OK {
                        self.states.push(fresh);
                    }
                    status
                }
                15 => fmi3::fmi3Terminate(instance),
                16 => fmi3::fmi3Reset(instance),
                17 => {
                    let kinds = [null(), c"logAll".as_ptr()];
                    fmi3::fmi3SetDebugLogging(
                        instance,
                        1,
                        dice.of(&[0, 2, usize::MAX]),
                        kinds.as_ptr(),
                    )
                }
                18 => fmi2::fmi2SetRealInputDerivatives(instance, references, n, null(), numbers),
                _ => fmi3::fmi3GetFloat32(instance, references, n, null_mut(), m),
            }
        };
        assert!((0..=4).contains(&status), "{status}");
        assert_ne!(status, calls::FATAL, "a panic");
        if !known {
            assert_eq!(status, calls::ERROR);
        } else if status != calls::OK {
            assert!(MESSAGES.get() > before, "a refusal without a word");
        }
    }

    fn free(&mut self, dice: &mut Dice) {
        let handle = self.handle(dice);
        fmi3::fmi3FreeInstance(handle);
        if let Some(place) = self.live.iter().position(|it| *it == handle) {
            self.live.remove(place);
            self.states.clear();
        }
    }
}

/// Ten thousand sequences of up to sixteen calls; fewer where `CHAINDRIVE_MISUSES` says so.
#[test]
fn misuse_is_refused_with_a_status_and_a_message() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = Scene::preset("spinning_ring").expect("a preset");
    let request = Request::new(&scene, &Settings::default()).expect("a request");
    let model = Model::new(Export::new(&request, "ring")).expect("a model");
    assert!(model.variables().len() < ROOM);
    for (name, text) in model.resources() {
        std::fs::write(folder.path().join(name), text).expect("a file");
    }
    let path = folder.path().to_str().expect("a path").to_owned();
    // One stays, so that the others need not assemble the drive.
    let shared = Model::of_resources(folder.path()).expect("a model");
    let mut pool = Pool {
        token: CString::new(model.token()).expect("a token"),
        folder: CString::new(path).expect("a path"),
        handles: Vec::new(),
        live: Vec::new(),
        states: Vec::new(),
        references: [0; ROOM],
        numbers: [0.0; ROOM],
        choices: [0; ROOM],
        texts: [null(); ROOM],
        bytes: vec![7; 64],
        time: 0.0,
    };
    let mut dice = Dice(34);
    let count = std::env::var("CHAINDRIVE_MISUSES").ok();
    let count = count.and_then(|it| it.parse().ok()).unwrap_or(10_000);
    for _ in 0..count {
        pool.make(&mut dice);
        if dice.below(3) > 0 {
            // Every second sequence gets to where a drive moves.
            let instance = pool.live.last().copied().unwrap_or(null_mut());
            fmi3::fmi3EnterInitializationMode(instance, 0, 0.0, 0.0, 0, 0.0);
            fmi3::fmi3ExitInitializationMode(instance);
        }
        for _ in 0..dice.below(16) {
            pool.call(&mut dice);
        }
        while pool.live.len() > 3 || (dice.below(2) == 0 && !pool.live.is_empty()) {
            pool.free(&mut dice);
        }
        let last = pool.handles.len().saturating_sub(64);
        pool.handles.drain(..last);
    }
    for handle in pool.live.drain(..) {
        fmi3::fmi3FreeInstance(handle);
    }
    // Nothing is left but the model that this test holds.
    assert_eq!(Arc::strong_count(&shared), 1);
}

/// Every preset of the same kind has the bytes of a unit, whose library is whatever file is named.
#[test]
fn a_unit_is_an_archive_of_its_parts() {
    let scene = Scene::preset("spinning_ring").expect("a preset");
    let request = Request::new(&scene, &Settings::default()).expect("a request");
    let model = Model::new(Export::new(&request, "ring")).expect("a model");
    let library = read_library(Path::new(env!("CARGO_MANIFEST_PATH"))).expect("a file");
    for standard in [Standard::Two, Standard::Three] {
        let unit = package(&model, standard, &library).expect("an archive");
        assert_eq!(unit[..4], *b"PK\x03\x04");
        assert_eq!(
            unit,
            package(&model, standard, &library).expect("an archive")
        );
    }
    read_library(Path::new("none")).expect_err("no library is there");
}
