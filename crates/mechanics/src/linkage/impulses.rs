//! (M + c C) x = M b in the space of the contacts: one unknown a row of J instead of three a body.
//!
//! ```text
//! y = c d J x,   x = b − M⁻¹ Jᵀ y     ⇒     (1/(c d) + J M⁻¹ Jᵀ) y = J b
//! ```
//!
//! Every joint has a row for its normal, and one for its tangent where pins rub; joints share a link with their
//! neighbours only. Whatever else touches a link, or the free rollers on it, is eliminated first: it couples the two joints of
//! that link, and the wheels. What is left is a narrow band with a border of wheels, tensioners, and the last joint of a
//! closed chain. Wheels have a negative diagonal. Quasi-definite: no pivoting is needed.
//!
//! # Source
//! Quasi-definite systems: R. J. Vanderbei, *SIAM J. Optim.* **5**, 1995, 100–113.

mod band;
mod local;

use super::{Bearing, Joining, Linkage, Play};
use crate::System;
use crate::linkage::element::turned;
use band::{Band, Place};
use local::Local;

/// One row of J of a joint.
///
/// u over the velocity of the link behind the joint and −u over that of the link before it, with the levers of their rotations.
#[derive(Clone, Copy, Debug, Default)]
struct JointRow {
    direction: [f64; 2],
    turn_before: f64,
    turn_after: f64,
    /// c d; zero where there is no contact.
    weight: f64,
}

/// The rows of one step and their factors.
#[derive(Clone, Debug, Default)]
pub(crate) struct Impulses {
    rows: Vec<JointRow>,
    band: Band,
    local: Local,
}

/// Unknowns of wheels and tensioners that this elimination has room for.
pub(super) const MOST_WHEELS: usize = 19;

impl Linkage {
    /// x ← (M + c C)⁻¹ M x; false if a pivot vanishes.
    pub(crate) fn damp(&self, system: &System, c: f64, play: &mut Play, x: &mut [f64]) -> bool {
        let Joining::Clearance(bearing) = &self.joining else {
            return false;
        };
        let mut work = std::mem::take(&mut play.impulses);
        // A link's rows have so many columns around them: two joints, the wheels, the right-hand side.
        let wheels = x.len() - self.dofs();
        let solved = match (bearing.rubs(), wheels) {
            (false, ..=1) => work.solve::<1, 4>(self, bearing, system, c, play, x),
            (false, 2..=5) => work.solve::<1, 8>(self, bearing, system, c, play, x),
            (true, ..=3) => work.solve::<2, 8>(self, bearing, system, c, play, x),
            (_, ..=MOST_WHEELS) => work.solve::<2, 24>(self, bearing, system, c, play, x),
            _ => false,
        };
        play.impulses = work;
        solved
    }
}

impl Impulses {
    /// With R rows a joint, and room for C columns around a link.
    fn solve<const R: usize, const C: usize>(
        &mut self,
        linkage: &Linkage,
        bearing: &Bearing,
        system: &System,
        c: f64,
        play: &Play,
        x: &mut [f64],
    ) -> bool {
        self.rows::<R>(linkage, bearing, c, play);
        let wheels = x.len() - linkage.dofs();
        self.band.clear::<R>(linkage, wheels);
        self.fill::<R>(linkage, x);
        self.fill_wheels(linkage, system, c, x);
        self.local.gather(linkage, c, play);
        let condensed = self
            .local
            .condense::<R, C>(linkage, &self.rows, &mut self.band, x);
        if !condensed || !self.band.factor::<R>() {
            return false;
        }
        self.band.substitute::<R>();
        self.apply::<R>(linkage, x);
        self.local.apply::<R, C>(linkage, &self.band, x);
        let first = self.band.border - wheels;
        x[linkage.dofs()..].copy_from_slice(&self.band.edge[first..]);
        true
    }

    fn rows<const R: usize>(&mut self, linkage: &Linkage, bearing: &Bearing, c: f64, play: &Play) {
        let joints = linkage.joints.len();
        let (pins, memory) = (&play.pins, &play.memory.joints);
        self.rows.resize(R * joints, JointRow::default());
        for (joint, rows) in self.rows.chunks_exact_mut(R).enumerate() {
            rows[0] = JointRow {
                direction: [pins.normal_x[joint], pins.normal_y[joint]],
                turn_before: pins.turn_before[joint],
                turn_after: pins.turn_after[joint],
                weight: c * pins.damping[joint],
            };
            if R == 2 {
                let levers =
                    bearing.side_levers(linkage.pairs.pin_after[joint], -memory.gap[joint]);
                let tangent = turned(pins.normal(joint));
                let (before, after) = (&play.posture.before, &play.posture.after);
                rows[1] = JointRow {
                    direction: [tangent.x, tangent.y],
                    turn_before: before.arm_x[joint] * tangent.y - before.arm_y[joint] * tangent.x
                        + levers[0],
                    turn_after: after.arm_x[joint] * tangent.y - after.arm_y[joint] * tangent.x
                        + levers[1],
                    weight: c * pins.rubs.get(joint).map_or(0.0, |rub| rub.secant),
                };
            }
        }
    }

    /// The rows of the joints among themselves, and J b.
    fn fill<const R: usize>(&mut self, linkage: &Linkage, b: &[f64]) {
        let joints = linkage.joints.len();
        let shapes = &linkage.shapes;
        let mut known = [0.0; 3];
        if linkage.closed {
            known.copy_from_slice(&b[3 * linkage.links - 3..3 * linkage.links]);
        }
        // Inverse mass and inertia, and b, of the link before.
        let mut before = if linkage.closed {
            let last = linkage.links - 1;
            ([shapes.inverse_mass[last], shapes.inverse_inertia[last]], known)
        } else {
            ([0.0; 2], [0.0; 3])
        };
        for joint in 0..joints {
            let after = if joint < linkage.links {
                (
                    [shapes.inverse_mass[joint], shapes.inverse_inertia[joint]],
                    [b[3 * joint], b[3 * joint + 1], b[3 * joint + 2]],
                )
            } else {
                ([0.0; 2], [0.0; 3])
            };
            let rows = &self.rows[R * joint..R * (joint + 1)];
            for (p, row) in rows.iter().enumerate() {
                let place = self.band.place::<R>(joint, p);
                if row.weight <= 0.0 {
                    self.band.add(place, place, 1.0);
                    continue;
                }
                let [x, y] = row.direction;
                let (mobility, turning) = (before.0[0] + after.0[0], [before.0[1], after.0[1]]);
                for (o, other) in rows[..=p].iter().enumerate() {
                    if other.weight <= 0.0 {
                        continue;
                    }
                    let mut value = mobility * (x * other.direction[0] + y * other.direction[1])
                        + turning[0] * row.turn_before * other.turn_before
                        + turning[1] * row.turn_after * other.turn_after;
                    if o == p {
                        value += 1.0 / row.weight;
                    }
                    self.band.add(place, self.band.place::<R>(joint, o), value);
                }
                let right = x * (after.1[0] - before.1[0]) + y * (after.1[1] - before.1[1])
                    + row.turn_after * after.1[2]
                    - row.turn_before * before.1[2];
                self.band.add_right(place, right);
                // Through the link before, to the joint at its beginning.
                let neighbour = match joint {
                    0 if linkage.closed => joints - 1,
                    0 => continue,
                    _ => joint - 1,
                };
                for (o, other) in self.rows[R * neighbour..R * (neighbour + 1)].iter().enumerate() {
                    if other.weight > 0.0 {
                        let value = before.0[0]
                            * (x * other.direction[0] + y * other.direction[1])
                            + before.0[1] * row.turn_before * other.turn_after;
                        let there = self.band.place::<R>(neighbour, o);
                        self.band.add(place, there, -value);
                    }
                }
            }
            before = after;
        }
    }

    fn fill_wheels(&mut self, linkage: &Linkage, system: &System, c: f64, b: &[f64]) {
        let first = self.band.border - (b.len() - linkage.dofs());
        for (j, &inertia) in system.border_inertias.iter().enumerate() {
            let place = Place::Border(first + j);
            self.band.add(place, place, -inertia);
            self.band.add_right(place, -inertia * b[linkage.dofs() + j]);
        }
        system.each_support(|dof, _, damping| {
            let place = Place::Border(first + dof - linkage.dofs());
            self.band.add(place, place, -c * damping);
        });
    }

    /// x ← b − M⁻¹ Jᵀ y of the joints.
    fn apply<const R: usize>(&self, linkage: &Linkage, x: &mut [f64]) {
        let shapes = &linkage.shapes;
        let joints = linkage.joints.len();
        for link in 0..linkage.links {
            let next = if link + 1 < joints { link + 1 } else { 0 };
            let mut impulse = [0.0; 3];
            for p in 0..R {
                let (row, y) = (self.rows[R * link + p], self.band.found::<R>(link, p));
                let (other, z) = (self.rows[R * next + p], self.band.found::<R>(next, p));
                impulse[0] += row.direction[0] * y - other.direction[0] * z;
                impulse[1] += row.direction[1] * y - other.direction[1] * z;
                impulse[2] += row.turn_after * y - other.turn_before * z;
            }
            x[3 * link] -= shapes.inverse_mass[link] * impulse[0];
            x[3 * link + 1] -= shapes.inverse_mass[link] * impulse[1];
            x[3 * link + 2] -= shapes.inverse_inertia[link] * impulse[2];
        }
    }
}

#[cfg(test)]
mod tests {
    use chaindrive_integrate::Weights;

    use crate::linkage::held::Asked;
    use crate::linkage::tests::started;

    /// The bodies' own equations, block by block, give the same answer: two independent eliminations.
    #[test]
    fn agrees_with_the_equations_of_the_bodies() {
        for free_rollers in [false, true] {
            let (system, mut record, b) = started(free_rollers);
            let linkage = system.linkage.as_ref().unwrap();
            let c = 2e-6;
            let mut impulses = b.clone();
            assert!(linkage.damp(&system, c, &mut record.play, &mut impulses));
            let mut blocks = b.clone();
            let weights = Weights {
                damping: c,
                stiffness: 0.0,
            };
            assert!(linkage.eliminate(
                &system,
                weights,
                &mut record.play,
                &mut blocks,
                Asked::Kept
            ));
            let size = b.iter().fold(0.0_f64, |m, b| m.max(b.abs()));
            for (i, (found, exact)) in impulses.iter().zip(&blocks).enumerate() {
                let error = (found - exact).abs() / size;
                assert!(error < 1e-12, "{free_rollers}, {i}: {found} {exact}");
            }
            // And it is not the undamped answer.
            assert!(
                impulses
                    .iter()
                    .zip(&b)
                    .any(|(x, b)| (x - b).abs() > 1e-3 * size)
            );
        }
    }
}
