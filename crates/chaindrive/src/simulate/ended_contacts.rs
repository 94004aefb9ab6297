//! Contacts and impacts that ended, handed out once each.

use chaindrive_mechanics::ContactEvent;

use super::Simulation;

/// Tells the times of a contact from a zero of the clock on.
pub(super) fn count_from(zero: f64, event: &mut ContactEvent) {
    event.start -= zero;
    event.end -= zero;
}

impl Simulation {
    /// Takes in what ended in the last steps.
    pub(super) fn gather(&mut self) {
        self.moving.system.hand_out_events(&mut self.ended[1]);
        self.moving.system.hand_out_impacts(&mut self.struck[1]);
        self.moving.system.hand_out_readings(&mut self.readings[1]);
    }

    /// Numbers of contacts, impacts, periods and readings of spans that were taken in since the last reading.
    pub(super) fn gathered(&self) -> [usize; 4] {
        let [ended, struck] = [self.ended[1].len(), self.struck[1].len()];
        [ended, struck, self.periods[1].len(), self.readings[1].len()]
    }

    /// Hands out what ended since the last reading. A step that may be taken back keeps its own: while the drive before it is kept, nothing that
    /// ended in it has been handed out.
    pub(super) fn hand_out_ended(&mut self) {
        let [contacts, impacts, periods, readings] = match &mut self.before {
            Some(before) => std::mem::take(&mut before.gathered),
            None => self.gathered(),
        };
        let zero = self.zero();
        move_first(&mut self.ended, contacts, |it| count_from(zero, it));
        move_first(&mut self.struck, impacts, |it| it.time -= zero);
        move_first(&mut self.periods, periods, |it| it.count_from(zero));
        move_first(&mut self.readings, readings, |_| {});
        let length = self.reading_length;
        for row in self.readings[0].chunks_exact_mut(length) {
            row[0] -= zero;
        }
    }
}

fn move_first<T>([handed, since]: &mut [Vec<T>; 2], count: usize, tell: impl Fn(&mut T)) {
    handed.clear();
    handed.extend(since.drain(..count));
    handed.iter_mut().for_each(tell);
}
