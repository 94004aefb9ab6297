//! Forces from outside on the centres of sprockets and on carriers.

use crate::DriveError;
use crate::action::Action;

/// Forces that act at a point from outside, along x and y of the frame \[N\]; several along one axis add up.
///
/// ```text
/// F = (Σ Fx, Σ Fy)       P = F·v       v: velocity of the point
/// ```
///
/// On a centre that is fixed the bearing bears them; a prescribed motion does the work against them; on springs they move the centre; on a
/// tensioner the part Q = F·∂x/∂s along its coordinate acts, and its guide or pivot bears the rest.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Forces {
    /// Forces along x \[N\].
    pub x: Vec<Action>,
    /// Forces along y \[N\].
    pub y: Vec<Action>,
}

impl Forces {
    /// Whether nothing acts.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty() && self.y.is_empty()
    }

    /// All of them, those along x before those along y.
    pub fn all(&self) -> impl Iterator<Item = &Action> {
        self.x.iter().chain(&self.y)
    }

    /// All of them, to change them.
    pub(crate) fn all_mut(&mut self) -> impl Iterator<Item = &mut Action> {
        self.x.iter_mut().chain(&mut self.y)
    }

    /// The force \[N\] where each of its parts has a value.
    pub(crate) fn sum(&self, value: impl Fn(&Action) -> f64) -> [f64; 2] {
        [&self.x, &self.y].map(|along| along.iter().map(&value).sum())
    }

    /// The force \[N\] at time `t` \[s\] where no shaft has turned yet.
    pub fn unturned(&self, t: f64) -> [f64; 2] {
        self.sum(|it| it.at(t, 0.0))
    }

    /// Names every parameter out of range; `place` is that of the body in the scene.
    pub(crate) fn problems(&self, place: &str) -> Vec<DriveError> {
        let along = [("force_x", &self.x), ("force_y", &self.y)];
        let each = along.into_iter().flat_map(|(key, list)| {
            let list = list.iter().enumerate();
            list.map(move |(i, it)| (format!("{place}.{key}[{i}]"), it))
        });
        each.filter_map(|(path, it)| it.check(&path, "force").err())
            .collect()
    }
}
