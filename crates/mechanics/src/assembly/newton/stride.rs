//! How far a step of Newton's method may go.

use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::Moment;

use super::Newton;

/// Angle \[rad\] by which a step may turn a link. *Assumed*: the strain of a link that turns by φ across its line is φ²/2, which the
/// linear step does not know of.
const TURN: f64 = 0.2;

impl Newton<'_> {
    /// How far \[m\] anything has moved since the contact windows were laid.
    pub(super) fn moved(&self, q: &[f64]) -> f64 {
        let unknowns = self.unknowns;
        let both = q.iter().zip(&self.looked).zip(&unknowns.row);
        let moved = both.filter_map(|((now, then), row)| {
            row.map(|row| (now - then).abs() * unknowns.scale[row].sqrt())
        });
        moved.fold(0.0, f64::max)
    }

    /// Share of a step from `q`, at most all of it, in which neither a body nor a roller near one goes farther than `longest` \[m\].
    ///
    /// Other rollers go half of their way to the nearest body, and no link turns by more than [`TURN`]: a long span reaches its sag in
    /// a few steps.
    pub(super) fn share(&self, q: &[f64], step: &[f64], longest: f64) -> f64 {
        let (system, unknowns) = (&*self.system, self.unknowns);
        let still = vec![0.0; q.len()];
        let at = Moment::stateless(system.begin, q, &still);
        // How many times too far anything goes.
        let mut over = 1.0_f64;
        let bodies = unknowns.scale.iter().zip(step).skip(unknowns.of_chains);
        for (lever, step) in bodies {
            over = over.max(step.abs() * lever.sqrt() / longest);
        }
        for member in &system.chains {
            let chain = &member.chain;
            let own = &q[member.entries.clone()];
            let moved = |entry: usize| {
                let row = unknowns.row[member.entries.start + entry];
                row.map_or(0.0, |row| step[row])
            };
            let rollers = (0..chain.rollers()).map(|roller| chain.roller_moving(own, roller));
            let moves: Vec<(Point, Vector)> = rollers
                .map(|it| {
                    (
                        it.place,
                        it.ways()
                            .iter()
                            .map(|way| way.first * moved(way.entry))
                            .sum(),
                    )
                })
                .collect();
            // Those that go far, and how far they are from the nearest body.
            let far = moves.iter().filter(|(_, shift)| shift.norm() > longest);
            let mut far: Vec<_> = far.map(|it| (it, f64::INFINITY)).collect();
            if !far.is_empty() {
                member.contacts.each_room(&system.bodies, at, |room| {
                    for ((place, _), least) in &mut far {
                        *least = least.min(room(*place));
                    }
                });
            }
            for ((_, shift), room) in far {
                over = over.max(shift.norm() / longest.max(0.5 * room));
            }
            let turn = TURN * chain.pitch();
            for link in 0..chain.links() {
                let across = moves[(link + 1) % moves.len()].1 - moves[link].1;
                over = over.max(across.norm() / turn);
            }
        }
        1.0 / over
    }
}
