//! Three numbers a link, each kind by itself: what lanes of joints and of links read.

use chaindrive_integrate::Array;

use super::Linkage;

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
        let (lanes, links) = (linkage.shapes.lanes(), linkage.series.links);
        for all in [&mut self.x, &mut self.y, &mut self.turn] {
            all.resize(lanes, 0.0);
        }
        let kinds = self.x[1..=links].iter_mut().zip(&mut self.y[1..=links]);
        let places = kinds.zip(&mut self.turn[1..=links]);
        for (value, ((x, y), turn)) in values.zip(places) {
            [*x, *y, *turn] = value;
        }
        self.close(linkage);
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

    /// Subtracts the numbers of all links, which stand one link after the other there; out of line for the same reason.
    #[inline(never)]
    pub(super) fn subtract_from(&self, all: &mut [f64]) {
        let links = all.as_chunks_mut::<3>().0;
        let count = links.len();
        for (to, [x, y, turn]) in links.iter_mut().zip(self.each(count)) {
            to[0] -= x;
            to[1] -= y;
            to[2] -= turn;
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
