//! Impacts since the start: how often, how fast, how deep.

use serde::{Deserialize, Serialize};

use super::Onsets;

/// Contacts of two parts since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Impacts {
    /// Contacts that began.
    pub count: u64,
    /// Those that closed slower than the floor of the law, which acts on them as a damper.
    pub gentle: u64,
    /// Greatest closing speed at touch \[m/s\].
    pub fastest: f64,
    /// Deepest indentation \[m\].
    pub deepest: f64,
}

impl Impacts {
    /// Adds the contacts of an accepted state.
    pub(crate) fn note(&mut self, begun: &Onsets, depth: f64) {
        self.deepest = self.deepest.max(depth);
        if begun.count > 0.0 {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a number of contacts"
            )]
            let [count, gentle] = [begun.count, begun.gentle].map(|number| number as u64);
            self.count += count;
            self.gentle += gentle;
            self.fastest = self.fastest.max(begun.fastest);
        }
    }
}
