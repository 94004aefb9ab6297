//! Drives in which nothing joins some parts with others: each group is assembled as if it were alone.
//!
//! Solved together, the groups would stop the iterations of the statics at other places than alone.

use super::{Assembled, Statics};
use crate::groups::{Group, in_order};
use crate::system::System;
use crate::{AssemblyError, Drive};

impl Drive {
    /// Assembles the groups one by one and puts them beside each other.
    pub(super) fn assemble_apart(&self, groups: &[Group]) -> Result<Assembled, AssemblyError> {
        let mut alone = Vec::new();
        for group in groups {
            let drive = Self {
                parts: group.parts(self.parts()),
                begin: self.begin,
            };
            let names = || drive.chains.iter().map(|placed| placed.name.as_ref());
            let assembled = drive.assemble_joined();
            alone.push(assembled.map_err(|error| error.of_chains(names()))?);
        }
        let statics = stages(groups, &alone);
        let mut parts = self.parts().clone();
        for (group, assembled) in groups.iter().zip(&alone) {
            group.place(&assembled.parts, &mut parts);
        }
        let fittings = alone.iter().map(|assembled| assembled.fittings.clone());
        let fittings = in_order(groups.iter().map(|group| &group.chains).zip(fittings));
        let systems = alone.into_iter().map(|it| (it.system, [it.q, it.v]));
        let (system, [q, v]) = System::beside(groups, systems.collect());
        let z = system.settled_states(&q);
        Ok(Assembled {
            drive: self.clone(),
            system,
            time: self.begin,
            zero: 0.0,
            q,
            v,
            z,
            statics,
            fittings,
            warnings: Vec::new(),
            parts,
        })
    }
}

/// The static states of all groups, stage by stage.
fn stages(groups: &[Group], alone: &[Assembled]) -> Vec<Statics> {
    let names = ["pretension", "gravity", "load"];
    let reached = |assembled: &Assembled, stage: usize| {
        // A group without this stage is where its last one left it, or still without any force.
        let mut done = assembled.statics.iter().rev();
        done.find(|statics| names[..=stage].contains(&statics.stage))
            .cloned()
            .unwrap_or_else(|| Statics {
                stage: names[stage],
                iterations: 0,
                residual: 0.0,
                tensions: vec![0.0; assembled.system.links()],
                contacts: vec![0; assembled.system.bodies.wheels.len()],
            })
    };
    let present = |stage: &usize| {
        let all = alone.iter().flat_map(|assembled| &assembled.statics);
        all.into_iter()
            .any(|statics| statics.stage == names[*stage])
    };
    let merged = |stage: usize| {
        let states: Vec<Statics> = alone.iter().map(|it| reached(it, stage)).collect();
        let tensions = states.iter().zip(alone).map(|(statics, assembled)| {
            let mut rest = statics.tensions.as_slice();
            let chains = assembled.system.chains.iter().map(|member| {
                let (own, behind) = rest.split_at(member.chain.links());
                rest = behind;
                own.to_vec()
            });
            chains.collect::<Vec<_>>()
        });
        let tensions: Vec<Vec<Vec<f64>>> = tensions.collect();
        let contacts = states.iter().map(|statics| statics.contacts.clone());
        Statics {
            stage: names[stage],
            iterations: states.iter().map(|it| it.iterations).max().unwrap_or(0),
            residual: states.iter().map(|it| it.residual).fold(0.0, f64::max),
            tensions: in_order(groups.iter().map(|it| &it.chains).zip(tensions)).concat(),
            contacts: in_order(groups.iter().map(|it| &it.sprockets).zip(contacts)),
        }
    };
    (0..names.len()).filter(present).map(merged).collect()
}
