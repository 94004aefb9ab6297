//! Parts of a drive that nothing joins: each group moves, and settles, as if it were alone.

use crate::drive::{
    Adjust, GearPair, GuideSupport, Layout, Parts, PlacedChain, Shaft, Stop, Support,
};
use crate::{Action, Coupling, Torque};

/// Sets that grow together: every entry points to one of its own set, in the end to the least.
#[derive(Clone, Debug)]
pub(crate) struct Sets(Vec<usize>);

impl Sets {
    /// As many sets as entries.
    pub(crate) fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    /// The least entry of the set that an entry belongs to.
    pub(crate) fn least(&self, entry: usize) -> usize {
        let mut at = entry;
        while self.0[at] != at {
            at = self.0[at];
        }
        at
    }

    /// Makes one set of two; false if they were one already.
    pub(crate) fn join(&mut self, first: usize, second: usize) -> bool {
        let (first, second) = (self.least(first), self.least(second));
        self.0[first.max(second)] = first.min(second);
        first != second
    }
}

/// Chains and bodies that something joins, by their indices in the drive, ascending.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Group {
    pub(crate) chains: Vec<usize>,
    pub(crate) sprockets: Vec<usize>,
    pub(crate) guides: Vec<usize>,
    pub(crate) tensioners: Vec<usize>,
    pub(crate) shafts: Vec<usize>,
    pub(crate) couplings: Vec<usize>,
    gears: Vec<usize>,
}

/// The groups of a drive, in the order of their first chains. Bodies that no chain has to do with are in the first one.
pub(crate) fn groups(parts: &Parts) -> Vec<Group> {
    // One entry a part, chains first.
    let sprockets = parts.chains.len();
    let guides = sprockets + parts.sprockets.len();
    let tensioners = guides + parts.guides.len();
    let shafts = tensioners + parts.tensioners.len();
    let mut sets = Sets::new(shafts + parts.shafts.len());
    for (index, placed) in parts.chains.iter().enumerate() {
        for &i in &placed.sprockets {
            sets.join(index, sprockets + i);
        }
        for &i in &placed.guides {
            sets.join(index, guides + i);
        }
        if let Layout::Route { fit, .. } = &placed.layout {
            match fit.adjust {
                Adjust::Nothing => {}
                Adjust::Sprocket { sprocket: i, .. } => {
                    sets.join(index, sprockets + i);
                }
                Adjust::Tensioner { tensioner: i, .. } => {
                    sets.join(index, tensioners + i);
                }
            }
        }
    }
    for (index, body) in parts.sprockets.iter().enumerate() {
        sets.join(sprockets + index, shafts + body.shaft);
        if let Support::Tensioner(i) = body.support {
            sets.join(sprockets + index, tensioners + i);
        }
    }
    for (index, body) in parts.guides.iter().enumerate() {
        if let GuideSupport::Tensioner(i) = body.support {
            sets.join(guides + index, tensioners + i);
        }
    }
    for (index, shaft) in parts.shafts.iter().enumerate() {
        for followed in shaft.torques().filter_map(Torque::follows) {
            sets.join(shafts + index, shafts + followed);
        }
    }
    let centres = parts.sprockets.iter().enumerate();
    let centres = centres.map(|(index, body)| (sprockets + index, &body.forces));
    let carriers = parts.tensioners.iter().enumerate();
    let carriers = carriers.map(|(index, body)| (tensioners + index, &body.forces));
    for (entry, forces) in centres.chain(carriers) {
        for followed in forces.all().filter_map(Action::follows) {
            sets.join(entry, shafts + followed);
        }
    }
    let couplings = parts.couplings.iter().map(|coupling| coupling.shafts);
    let gears = parts.gears.iter().map(|pair| pair.shafts);
    for [a, b] in couplings.chain(gears) {
        sets.join(shafts + a, shafts + b);
    }

    // The least entry of a set that holds a chain is a chain.
    let heads: Vec<usize> = (0..parts.chains.len())
        .filter(|&index| sets.least(index) == index)
        .collect();
    let group_of = |entry: usize| {
        let least = sets.least(entry);
        heads.iter().position(|&head| head == least).unwrap_or(0)
    };
    let mut groups = vec![Group::default(); heads.len().max(1)];
    for index in 0..parts.chains.len() {
        groups[group_of(index)].chains.push(index);
    }
    for index in 0..parts.sprockets.len() {
        groups[group_of(sprockets + index)].sprockets.push(index);
    }
    for index in 0..parts.guides.len() {
        groups[group_of(guides + index)].guides.push(index);
    }
    for index in 0..parts.tensioners.len() {
        groups[group_of(tensioners + index)].tensioners.push(index);
    }
    for index in 0..parts.shafts.len() {
        groups[group_of(shafts + index)].shafts.push(index);
    }
    for (index, coupling) in parts.couplings.iter().enumerate() {
        groups[group_of(shafts + coupling.shafts[0])]
            .couplings
            .push(index);
    }
    for (index, pair) in parts.gears.iter().enumerate() {
        groups[group_of(shafts + pair.shafts[0])].gears.push(index);
    }
    groups
}

impl Group {
    /// The group as a drive of its own.
    pub(crate) fn parts(&self, whole: &Parts) -> Parts {
        // Indices are ascending, and whatever a part of the group refers to is in the group.
        let place = |list: &[usize], index: usize| list.partition_point(|&i| i < index);
        let sprocket_at = |index: usize| place(&self.sprockets, index);
        let guide_at = |index: usize| place(&self.guides, index);
        let tensioner_at = |index: usize| place(&self.tensioners, index);
        let shaft_at = |index: usize| place(&self.shafts, index);
        let chains = self.chains.iter().map(|&index| {
            let mut placed: PlacedChain = whole.chains[index].clone();
            placed
                .sprockets
                .iter_mut()
                .for_each(|i| *i = sprocket_at(*i));
            placed.guides.iter_mut().for_each(|i| *i = guide_at(*i));
            if let Layout::Route { stops, fit, .. } = &mut placed.layout {
                for stop in stops {
                    match stop {
                        Stop::Sprocket(i) => *i = sprocket_at(*i),
                        Stop::Guide(i) => *i = guide_at(*i),
                    }
                }
                match &mut fit.adjust {
                    Adjust::Nothing => {}
                    Adjust::Sprocket { sprocket, .. } => *sprocket = sprocket_at(*sprocket),
                    Adjust::Tensioner { tensioner, .. } => *tensioner = tensioner_at(*tensioner),
                }
            }
            placed
        });
        let sprockets = self.sprockets.iter().map(|&index| {
            let mut sprocket = whole.sprockets[index].clone();
            sprocket.shaft = shaft_at(sprocket.shaft);
            if let Support::Tensioner(i) = &mut sprocket.support {
                *i = tensioner_at(*i);
            }
            let forces = sprocket.forces.all_mut();
            forces.for_each(|it| it.refer(shaft_at));
            sprocket
        });
        let guides = self.guides.iter().map(|&index| {
            let mut guide = whole.guides[index].clone();
            if let GuideSupport::Tensioner(i) = &mut guide.support {
                *i = tensioner_at(*i);
            }
            guide
        });
        let couplings = self.couplings.iter().map(|&index| {
            let coupling = whole.couplings[index].clone();
            Coupling {
                shafts: coupling.shafts.map(shaft_at),
                ..coupling
            }
        });
        let gears = self.gears.iter().map(|&index| {
            let pair = whole.gears[index].clone();
            GearPair {
                shafts: pair.shafts.map(shaft_at),
                ..pair
            }
        });
        let mut shafts = pick(&whole.shafts, &self.shafts);
        for torque in shafts.iter_mut().flat_map(Shaft::torques_mut) {
            torque.refer(shaft_at);
        }
        let mut tensioners = pick(&whole.tensioners, &self.tensioners);
        for force in tensioners.iter_mut().flat_map(|it| it.forces.all_mut()) {
            force.refer(shaft_at);
        }
        Parts {
            chains: chains.collect(),
            sprockets: sprockets.collect(),
            guides: guides.collect(),
            tensioners,
            shafts,
            couplings: couplings.collect(),
            gears: gears.collect(),
            settle: whole.settle,
            gravity: whole.gravity,
            oil: whole.oil.clone(),
            tunable: Vec::new(),
        }
    }
}

impl Group {
    /// Puts the parts of a drive where those of the group lie.
    pub(crate) fn place(&self, laid: &Parts, whole: &mut Parts) {
        for (&index, placed) in self.chains.iter().zip(&laid.chains) {
            whole.chains[index].chain.clone_from(&placed.chain);
        }
        for (&index, sprocket) in self.sprockets.iter().zip(&laid.sprockets) {
            whole.sprockets[index].centre = sprocket.centre;
        }
        for (&index, guide) in self.guides.iter().zip(&laid.guides) {
            whole.guides[index].face.clone_from(&guide.face);
        }
        for (&index, tensioner) in self.tensioners.iter().zip(&laid.tensioners) {
            whole.tensioners[index].carrier = tensioner.carrier;
            whole.tensioners[index].forced_at = tensioner.forced_at;
        }
    }
}

/// Values of the parts of groups, in the order of the drive.
pub(crate) fn in_order<'g, T>(of_groups: impl Iterator<Item = (&'g Vec<usize>, Vec<T>)>) -> Vec<T> {
    let mut all: Vec<(usize, T)> = of_groups
        .flat_map(|(indices, values)| indices.iter().copied().zip(values))
        .collect();
    all.sort_by_key(|(index, _)| *index);
    all.into_iter().map(|(_, value)| value).collect()
}

fn pick<T: Clone>(all: &[T], indices: &[usize]) -> Vec<T> {
    indices.iter().map(|&index| all[index].clone()).collect()
}
