//! Systems that nothing joins, as one.

use super::{Group as Solved, System};
use crate::bodies::{RailSupport, WheelSupport};
use crate::groups::{Group, in_order};

impl System {
    /// Puts the systems of groups beside each other, as they are; and their coordinates and velocities.
    pub(crate) fn beside(
        groups: &[Group],
        alone: Vec<(Self, [Vec<f64>; 2])>,
    ) -> (Self, [Vec<f64>; 2]) {
        let first = alone.iter().map(|(system, _)| system.bodies.first).sum();
        let (mut systems, mut states) = (Vec::new(), Vec::new());
        let mut solved = Vec::new();
        let mut dofs = first;
        for (group, (mut system, state)) in groups.iter().zip(alone) {
            let count = system.dofs - system.bodies.first;
            states.push((system.bodies.first, state));
            system.bodies.move_to(dofs);
            solved.push(Solved {
                chains: group.chains.clone(),
                bodies: dofs - first..dofs - first + count,
            });
            dofs += count;
            system.refer_to(group);
            systems.push(system);
        }
        let mut whole = systems[0].clone();
        macro_rules! gather {
            ($($list:ident by $indices:ident),*) => {
                $(whole.bodies.$list = in_order(
                    groups.iter().zip(&mut systems).map(|(group, system)| {
                        (&group.$indices, std::mem::take(&mut system.bodies.$list))
                    }),
                );)*
            };
        }
        gather!(wheels by sprockets, rails by guides, slides by tensioners, shafts by shafts, couplings by couplings);
        whole.bodies.number_states();
        whole.bodies.first = first;
        let inertias = systems.iter().map(|system| &system.bodies.inertias);
        whole.bodies.inertias = inertias.flatten().copied().collect();
        let shortest = |scales: [f64; 4], system: &Self| {
            [0, 1, 2, 3].map(|kind| f64::min(scales[kind], system.time_scales[kind]))
        };
        whole.time_scales = systems.iter().fold([f64::INFINITY; 4], shortest);
        whole.groups = solved;
        whole.dofs = dofs;

        // Coordinates of chains in the order of the drive, then those of bodies, group by group.
        let members = systems.iter_mut().zip(&states).map(|(system, (_, state))| {
            let members = std::mem::take(&mut system.chains).into_iter();
            let own = members.map(|member| {
                let entries = member.entries.clone();
                let state = [0, 1].map(|kind| state[kind][entries.clone()].to_vec());
                (member, state)
            });
            own.collect::<Vec<_>>()
        });
        let members: Vec<Vec<_>> = members.collect();
        let members = in_order(groups.iter().map(|group| &group.chains).zip(members));
        let mut state = [Vec::new(), Vec::new()];
        whole.chains.clear();
        for (mut member, own) in members {
            let start = state[0].len();
            member.entries = start..start + own[0].len();
            whole.chains.push(member);
            for (all, own) in state.iter_mut().zip(own) {
                all.extend(own);
            }
        }
        for (first, own) in states {
            for (all, own) in state.iter_mut().zip(own) {
                all.extend(&own[first..]);
            }
        }
        whole.refer_to_groups();
        (whole, state)
    }

    /// Turns indices within a group into those of the drive.
    fn refer_to(&mut self, group: &Group) {
        for member in &mut self.chains {
            for on in &mut member.contacts.teeth {
                on.wheel = group.sprockets[on.wheel];
            }
            for on in &mut member.contacts.rails {
                on.rail = group.guides[on.rail];
            }
            for sprocket in &mut member.route {
                *sprocket = group.sprockets[*sprocket];
            }
        }
        for wheel in &mut self.bodies.wheels {
            wheel.shaft = group.shafts[wheel.shaft];
            if let WheelSupport::Carried(slide) = &mut wheel.support {
                *slide = group.tensioners[*slide];
            }
            let forces = wheel.forces.all_mut();
            forces.for_each(|it| it.refer(|index| group.shafts[index]));
        }
        for slide in &mut self.bodies.slides {
            let forces = slide.forces.all_mut();
            forces.for_each(|it| it.refer(|index| group.shafts[index]));
        }
        for rail in &mut self.bodies.rails {
            if let RailSupport::Carried(slide) = &mut rail.support {
                *slide = group.tensioners[*slide];
            }
        }
        for shaft in &mut self.bodies.shafts {
            for torque in shaft.drive.iter_mut().chain(&mut shaft.load) {
                torque.refer(|index| group.shafts[index]);
            }
        }
        for coupling in &mut self.bodies.couplings {
            coupling.shafts = coupling.shafts.map(|shaft| group.shafts[shaft]);
        }
    }
}
