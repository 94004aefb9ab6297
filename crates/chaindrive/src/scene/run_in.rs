//! The run-in as a scene asks for it.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use chaindrive_quantities::read_time;

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
    /// Until the tension of every span is steady, at most [`MOST_CIRCUITS`](crate::MOST_CIRCUITS) circuits of the slowest chain.
    Auto,
    /// Default of scenes without a run-in: [`Auto`](Self::Auto) for a [motion that repeats](crate::Assembled::why_it_does_not_repeat), nothing for others and for
    /// a [`Simulation`](crate::Simulation) moved from outside.
    Usual,
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
