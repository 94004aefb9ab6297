//! The run-in: motion before t = 0, so that the record begins where it is steady.

use std::f64::consts::TAU;
use std::fmt;
use std::str::FromStr;

use chaindrive_mechanics::{Assembled, Drive, EventKinds};
use serde::{Deserialize, Serialize};

use super::execute::Onlooker;
use super::patience::LOOK;
use super::set_off::assemble;
use super::{Run, steady};
use crate::figure::Measure;
use crate::scene::read_time;
use crate::{Simulation, SimulationError};

/// Motion that is simulated before t = 0.
///
/// In a scene, for the command and in Python: a time (`"0.5 s"`), turns of a sprocket (`"5 turns"` of the first one, or
/// `"5 turns of camshaft"`), or `"auto"`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum RunIn {
    /// Nothing: the record begins with the start.
    #[default]
    None,
    /// A time \[s\], positive.
    Time(f64),
    /// So many turns of a sprocket at its mean speed; of the first one without a name.
    Turns {
        /// Turns, positive.
        turns: f64,
        /// The sprocket.
        sprocket: Option<String>,
    },
    /// Until the tension of every span is steady, at most [`MOST_CIRCUITS`] circuits of the slowest chain.
    Auto,
    /// Default of scenes without a run-in: [`Auto`](Self::Auto) for a [motion that repeats](Assembled::why_it_does_not_repeat), nothing for others and for
    /// a [`Simulation`] moved from outside.
    Usual,
}

/// Circuits of the chain \[–\] after which a run-in that ends by itself gives up. *Assumed*: what swings longer than that is no
/// start that dies out.
pub const MOST_CIRCUITS: u32 = 32;

/// How a run was run in.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RanIn {
    /// Simulated before t = 0 \[s\].
    pub time: f64,
    /// Whether the tensions were found steady by then; nobody looked where the time was given.
    pub is_steady: Option<bool>,
    /// Run-in by default, not by request.
    pub by_default: bool,
    /// Reason for no run-in by default.
    pub left_out: Option<String>,
}

impl RanIn {
    /// A run-in longer than nothing: the record begins behind the assembly.
    pub(super) fn has_moved(&self) -> bool {
        self.time > 0.0
    }

    fn lasted(time: f64, is_steady: Option<bool>) -> Self {
        Self {
            time,
            is_steady,
            by_default: false,
            left_out: None,
        }
    }
}

impl fmt::Display for RanIn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(why) = &self.left_out {
            return write!(
                f,
                "The record begins at the start, without a run-in: {why}."
            );
        }
        let time = Measure::Time.told(self.time);
        write!(f, "The drive was run in for {time} before t = 0")?;
        match self.is_steady {
            None => write!(f, ", as asked.")?,
            Some(true) => write!(f, ", until the tension of every span was steady.")?,
            Some(false) => write!(f, ", the longest that is tried; not every span was steady.")?,
        }
        if self.by_default {
            write!(f, " --run-in 0 leaves it out.")?;
        }
        Ok(())
    }
}

impl fmt::Display for RunIn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => write!(f, "0 s"),
            Self::Time(time) => write!(f, "{time} s"),
            Self::Turns {
                turns,
                sprocket: None,
            } => write!(f, "{turns} turns"),
            Self::Turns {
                turns,
                sprocket: Some(name),
            } => write!(f, "{turns} turns of {name}"),
            Self::Auto => write!(f, "auto"),
            Self::Usual => write!(f, "as usual"),
        }
    }
}

impl FromStr for RunIn {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        if text == "auto" {
            return Ok(Self::Auto);
        }
        let (amount, sprocket) = match text.split_once(" of ") {
            Some((amount, name)) => (amount.trim_end(), Some(name.trim().to_owned())),
            None => (text, None),
        };
        let turns = amount
            .strip_suffix("turns")
            .or_else(|| amount.strip_suffix("turn"));
        if let Some(turns) = turns {
            let turns: f64 = turns
                .trim_end()
                .parse()
                .map_err(|_| format!("`{}` is no number of turns", turns.trim_end()))?;
            return Ok(Self::Turns { turns, sprocket });
        }
        if sprocket.is_some() {
            return Err(format!("`{amount}` is no number of turns"));
        }
        let time = read_time(text)?;
        Ok(if time == 0.0 {
            Self::None
        } else {
            Self::Time(time)
        })
    }
}

impl RunIn {
    /// Names what is out of range.
    pub(super) fn check(&self) -> Result<(), SimulationError> {
        let (value, allowed) = match self {
            Self::None | Self::Auto | Self::Usual => return Ok(()),
            Self::Time(time) => (*time, "a time that is not negative"),
            Self::Turns { turns, .. } => (*turns, "a positive number of turns"),
        };
        if value > 0.0 && value.is_finite() {
            return Ok(());
        }
        Err(SimulationError::Setting {
            name: "run_in",
            value,
            allowed,
        })
    }
}

/// Runs an assembled drive in, if the run says so: as it stands at t = 0 of the record then.
///
/// The drive is assembled again, so long before, and moved with the method, step and tolerance of the run. What this leaves is
/// a start like any other: the error of the run counts from there. A run-in that ends by itself begins where the clock of the drive does, and leaves it at a
/// time that is the [zero](Assembled::zero) of the record.
///
/// # Errors
/// As [`Simulation::start`]; a sprocket that does not turn, or is not there; [`SimulationError::Interrupted`] when the onlooker
/// says so.
pub fn run_in(
    start: Assembled,
    run: &Run,
    onlooker: &dyn Onlooker,
) -> Result<(Assembled, Option<RanIn>), SimulationError> {
    if run.run_in == RunIn::Usual {
        return Ok((start, None));
    }
    let beginning = begin(start, run, onlooker)?;
    Ok((beginning.start, beginning.ran_in))
}

/// A drive where its record begins.
pub(super) struct Beginning {
    pub(super) start: Assembled,
    pub(super) ran_in: Option<RanIn>,
    /// The simulation from there, where the run-in has gone on with it.
    pub(super) simulation: Option<Simulation>,
}

impl Beginning {
    /// A run-in longer than nothing.
    pub(super) fn has_moved(&self) -> bool {
        self.ran_in.as_ref().is_some_and(RanIn::has_moved)
    }
}

/// Runs an assembled drive in, if the run says so.
pub(super) fn begin(
    start: Assembled,
    run: &Run,
    onlooker: &dyn Onlooker,
) -> Result<Beginning, SimulationError> {
    let stop = &|| onlooker.stop();
    run.check()?;
    let beginning = |start, ran_in| Beginning {
        start,
        ran_in,
        simulation: None,
    };
    let time = match &run.run_in {
        RunIn::None => return Ok(beginning(start, None)),
        RunIn::Time(time) => *time,
        RunIn::Turns { turns, sprocket } => turns_last(&start, *turns, sprocket.as_deref())?,
        RunIn::Usual => {
            if let Some(why) = start.why_it_does_not_repeat() {
                let ran_in = RanIn {
                    by_default: true,
                    left_out: Some(why.to_owned()),
                    ..RanIn::lasted(0.0, None)
                };
                return Ok(beginning(start, Some(ran_in)));
            }
            let asked = Run {
                run_in: RunIn::Auto,
                ..run.clone()
            };
            let mut found = begin(start, &asked, onlooker)?;
            if let Some(ran_in) = &mut found.ran_in {
                ran_in.by_default = true;
            }
            return Ok(found);
        }
        RunIn::Auto => {
            let settled = steady::settle(&start, run, onlooker)?;
            let ran_in = RanIn::lasted(settled.start.zero, Some(settled.is_steady));
            return Ok(Beginning {
                simulation: Some(settled.simulation),
                ..beginning(settled.start, Some(ran_in))
            });
        }
    };
    let ran_in = Some(RanIn::lasted(time, None));
    let mut moving = before(&start.drive, time, run, stop)?;
    onlooker.see_run_in(0.0);
    while !moving.advance(LOOK)? {
        onlooker.see_run_in(1.0 + moving.time() / time);
        if stop() {
            return Err(SimulationError::Interrupted);
        }
    }
    Ok(beginning(moving.as_start(), ran_in))
}

/// The drive in motion from so long before t = 0 \[s\]; nothing is logged on the way.
fn before(
    drive: &Drive,
    time: f64,
    run: &Run,
    stop: &dyn Fn() -> bool,
) -> Result<Simulation, SimulationError> {
    let start = assemble(&drive.beginning(-time)?, stop)?;
    let silent = Run {
        run_in: RunIn::None,
        events: EventKinds::default(),
        ..run.clone()
    };
    Simulation::from_assembled(start, &silent)
}

/// Time \[s\] that is simulated before t = 0 at most, that in which a run-in by itself looks for its end included.
///
/// # Errors
/// As [`run_in`].
pub(crate) fn longest(start: &Assembled, run: &Run) -> Result<f64, SimulationError> {
    match &run.run_in {
        RunIn::None => Ok(0.0),
        RunIn::Usual if start.why_it_does_not_repeat().is_some() => Ok(0.0),
        RunIn::Time(time) => Ok(*time),
        RunIn::Turns { turns, sprocket } => turns_last(start, *turns, sprocket.as_deref()),
        // How long a run-up lasts nobody knows before.
        RunIn::Auto if steady::stands(start) => Ok(f64::NAN),
        RunIn::Auto | RunIn::Usual => Ok(f64::from(MOST_CIRCUITS) * steady::circuit(start)?),
    }
}

/// Time \[s\] that a sprocket takes for some turns at its mean speed.
fn turns_last(
    start: &Assembled,
    turns: f64,
    sprocket: Option<&str>,
) -> Result<f64, SimulationError> {
    let names = start.system.sprocket_names();
    let refuse = |reason: String| SimulationError::RunIn { reason };
    let index = match sprocket {
        Some(name) => names.iter().position(|known| known == name),
        None => (!names.is_empty()).then_some(0),
    };
    let Some(index) = index else {
        let wanted = sprocket.unwrap_or("a sprocket");
        let known = match names.len() {
            0 => "the drive has none: give a time".to_owned(),
            _ => format!("there are {}", names.join(", ")),
        };
        return Err(refuse(format!("turns of {wanted}: {known}")));
    };
    let speed = start.mean_speeds()[index].abs();
    // t = n 2π/ω
    let time = turns * TAU / speed;
    if time.is_finite() {
        Ok(time)
    } else {
        let name = &names[index];
        Err(refuse(format!(
            "`{name}` turns at {speed} rad/s in the mean: give a time, or turns of a sprocket that turns"
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_read_and_written() {
        let turns = |turns, name: Option<&str>| RunIn::Turns {
            turns,
            sprocket: name.map(str::to_owned),
        };
        for (text, meant) in [
            ("auto", RunIn::Auto),
            ("0.5 s", RunIn::Time(0.5)),
            ("500 ms", RunIn::Time(0.5)),
            ("0 s", RunIn::None),
            ("5 turns", turns(5.0, None)),
            ("1 turn of camshaft", turns(1.0, Some("camshaft"))),
            ("2.5 turns of the hub", turns(2.5, Some("the hub"))),
        ] {
            let read: RunIn = text.parse().unwrap();
            assert_eq!(read, meant, "{text}");
            assert_eq!(read.to_string().parse::<RunIn>().unwrap(), meant);
        }
        for text in ["automatic", "five turns", "5 mm", "5 s of crank", ""] {
            assert!(text.parse::<RunIn>().is_err(), "{text}");
        }
    }
}
