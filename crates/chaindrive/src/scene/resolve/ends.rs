//! Shafts by their names, or by those of their sprockets.

use super::cursor::Cursor;
use crate::scene::suggest::one_of;

/// Shafts that couplings and gears can join, and torques follow, by name.
pub(super) struct Ends<'n> {
    pub(super) shafts: Vec<&'n str>,
    pub(super) sprockets: Vec<&'n str>,
    /// Number of shafts before those of the scene.
    pub(super) own: usize,
    pub(super) of_sprockets: &'n [usize],
}

impl Ends<'_> {
    /// The shafts that two names mean.
    pub(super) fn find(&self, between: &[String; 2], mut at: Cursor<'_, '_>) -> Option<[usize; 2]> {
        let mut at = at.key("between");
        let [first, second] = [0, 1].map(|i| self.one(&between[i], at.entry(i)));
        Some([first?, second?])
    }

    /// The shaft that a name means.
    pub(super) fn one(&self, name: &str, mut at: Cursor<'_, '_>) -> Option<usize> {
        let shaft = self.shafts.iter().position(|known| *known == name);
        let sprocket = || self.sprockets.iter().position(|known| *known == name);
        let found = shaft
            .map(|shaft| self.own + shaft)
            .or_else(|| sprocket().map(|sprocket| self.of_sprockets[sprocket]));
        if found.is_none() {
            let all = self.shafts.iter().chain(&self.sprockets);
            let known: Vec<&str> = all.copied().collect();
            let message = format!("no shaft or sprocket is named `{name}`");
            at.refuse(message, one_of(name, &known));
        }
        found
    }
}
