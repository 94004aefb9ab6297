//! Three numbers a link, each kind by itself: what lanes of joints and of links read.

use chaindrive_integrate::Array;
use pulp::Simd;

use super::Linkage;
use crate::lanes::{Lane, Wide};

/// Along x, along y, and of the turning; that of link i stands after place i + 1, whole lanes.
///
/// Before the first link of a closed chain stands the last and after the last one the first; beside those of an open one
/// nothing.
#[derive(Clone, Debug, Default)]
pub(crate) struct ByLink {
    pub(super) x: Array,
    pub(super) y: Array,
    pub(super) turn: Array,
}

impl ByLink {
    /// Takes the numbers of all links apart.
    ///
    /// Kept out of line, and so compiled for the oldest processor: newer ones would gather and scatter, which takes several times as
    /// long as one by one.
    #[inline(never)]
    pub(super) fn read(&mut self, linkage: &Linkage, values: impl Iterator<Item = [f64; 3]>) {
        let links = linkage.series.links;
        self.resize(linkage);
        let kinds = self.x[1..=links].iter_mut().zip(&mut self.y[1..=links]);
        let places = kinds.zip(&mut self.turn[1..=links]);
        for (value, ((x, y), turn)) in values.zip(places) {
            [*x, *y, *turn] = value;
        }
        self.close(linkage);
    }

    /// Makes room.
    #[inline(always)]
    pub(super) fn resize(&mut self, linkage: &Linkage) {
        for all in [&mut self.x, &mut self.y, &mut self.turn] {
            all.resize(linkage.shapes.lanes(), 0.0);
        }
    }

    /// Writes the numbers of the links from one on.
    #[inline(always)]
    pub(super) fn put<S: Simd>(&mut self, link: usize, [x, y, turn]: [Lane<S>; 3]) {
        x.store(&mut self.x, link + 1);
        y.store(&mut self.y, link + 1);
        turn.store(&mut self.turn, link + 1);
    }

    /// Repeats the ends of a closed chain beside each other.
    #[inline(always)]
    pub(super) fn close(&mut self, linkage: &Linkage) {
        if linkage.series.is_closed() {
            for all in [&mut self.x, &mut self.y, &mut self.turn] {
                all[0] = all[linkage.series.links];
                all[linkage.series.links + 1] = all[1];
            }
        }
    }

    /// Subtracts a multiple of others.
    pub(super) fn subtract(&mut self, other: &Self, factor: f64) {
        for (all, other) in [
            (&mut self.x, &other.x),
            (&mut self.y, &other.y),
            (&mut self.turn, &other.turn),
        ] {
            for (value, other) in all.iter_mut().zip(&**other) {
                *value -= factor * other;
            }
        }
    }

    /// The numbers of all links, one after the other.
    #[inline(always)]
    pub(super) fn each(&self, links: usize) -> impl Iterator<Item = [f64; 3]> + '_ {
        let kinds = self.x[1..=links].iter().zip(&self.y[1..=links]);
        let all = kinds.zip(&self.turn[1..=links]);
        all.map(|((x, y), turn)| [*x, *y, *turn])
    }
}

/// Numbers of a lane of links, counted as [`ByLink`] does.
#[inline(always)]
pub(super) fn load<S: Simd>(w: Wide<S>, all: &ByLink, place: usize) -> [Lane<S>; 3] {
    [
        w.load(&all.x, place),
        w.load(&all.y, place),
        w.load(&all.turn, place),
    ]
}
