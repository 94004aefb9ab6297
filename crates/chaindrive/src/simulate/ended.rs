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
    }

    /// Numbers of contacts and impacts that were taken in since the last reading.
    pub(super) fn gathered(&self) -> [usize; 2] {
        [self.ended[1].len(), self.struck[1].len()]
    }

    /// Hands out what ended until a reading. A step that may be taken back keeps its own.
    pub(super) fn hand_over_until(&mut self, time: f64) {
        let within = time < self.time();
        let first = match &mut self.before {
            Some(before) if within => std::mem::take(&mut before.gathered),
            _ => self.gathered(),
        };
        self.hand_over(first);
    }

    /// Hands out the first contacts and impacts of those since the last reading.
    pub(super) fn hand_over(&mut self, [contacts, impacts]: [usize; 2]) {
        let zero = self.zero();
        move_first(&mut self.ended, contacts, |it| count_from(zero, it));
        move_first(&mut self.struck, impacts, |it| it.time -= zero);
    }
}

fn move_first<T>([handed, since]: &mut [Vec<T>; 2], count: usize, tell: impl Fn(&mut T)) {
    handed.clear();
    handed.extend(since.drain(..count));
    handed.iter_mut().for_each(tell);
}
