//! Load of a chain in a run, for its rating.

use chaindrive_mechanics::{Extremes, Strength};

use super::WearLimit;

/// Share of the power of a chain that a sprocket takes part with, at least; idlers do not.
const TAKES_PART: f64 = 0.1;

/// Duty of one chain, beside its strength.
#[derive(Clone, Debug, PartialEq)]
pub struct Load {
    /// Name of the chain; empty where there is one only.
    pub chain: String,
    /// Its strength, as far as that is known.
    pub strength: Strength,
    /// Extremes of the tension of its links over all steps \[N\].
    pub tension: Extremes,
    /// Share of links and readings in which a link was pressed by more than `Summary::PRESSED` of the greatest span tension
    /// at that time \[–\]; 0 without spans.
    pub pressed: f64,
    /// Mean power that it has carried to or from a sprocket \[W\].
    pub power: f64,
    /// Nominal pitch \[m\].
    pub pitch: f64,
    /// Greatest mean tension of a span \[N\]; none without spans that rollers hold.
    pub steady: Option<f64>,
    /// Load times sliding of a joint a second, in the mean over the joints: r Σ T ω/X over the ends of X links' spans, with the mean
    /// tension T of the span, the speed ω of the sprocket at its end and the radius r of the pin \[W\]; none where one of them is not known.
    pub sliding: Option<f64>,
    /// Elongation at which it is worn out; none where it passes no sprocket.
    pub wear_limit: Option<WearLimit>,
    /// Every sprocket that it passes.
    pub sprockets: Vec<SprocketDuty>,
}

/// Duty of a sprocket: means over the run.
#[derive(Clone, Debug, PartialEq)]
pub struct SprocketDuty {
    /// Its name.
    pub name: String,
    /// Its teeth.
    pub teeth: u32,
    /// Speed \[rad/s\].
    pub speed: f64,
    /// Power of the chain on it \[W\]; negative where it drives the chain.
    pub power: f64,
    /// Force of the chain on it, x and y \[N\].
    pub force: [f64; 2],
}

impl Load {
    /// The smallest sprocket that takes part in the power of the chain; idlers do not.
    pub fn smallest(&self) -> Option<&SprocketDuty> {
        let takes_part = |it: &&SprocketDuty| it.power.abs() > TAKES_PART * self.power;
        let own = self.sprockets.iter().filter(takes_part);
        own.min_by_key(|it| it.teeth)
    }
}
