//! Trains of gears: shafts that turn together.

use crate::drive::{Parts, Rotation};
use crate::groups::Sets;

/// Ratio of a shaft to the one that leads its train; a shaft without gears leads itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TrainMember {
    /// The shaft whose angle is given in time, or else the first one.
    pub(crate) leader: usize,
    /// θ − θ(0) of the shaft over that of the leader \[–\].
    pub(crate) ratio: f64,
}

/// The place of every shaft in its train.
pub(crate) fn trains(parts: &Parts) -> Vec<TrainMember> {
    let count = parts.shafts.len();
    let mut sets = Sets::new(count);
    for pair in &parts.gears {
        sets.join(pair.shafts[0], pair.shafts[1]);
    }
    let given = |index: &usize| matches!(parts.shafts[*index].rotation, Rotation::Prescribed(_));
    let leader = |index: usize| {
        let train = || (0..count).filter(|&other| sets.least(other) == sets.least(index));
        train().find(given).or_else(|| train().next())
    };
    let leaders: Vec<usize> = (0..count)
        .map(|index| leader(index).unwrap_or(index))
        .collect();
    let mut ratios: Vec<Option<f64>> = (0..count)
        .map(|index| (leaders[index] == index).then_some(1.0))
        .collect();
    let mut news = true;
    while news {
        news = false;
        for pair in &parts.gears {
            let [a, b] = pair.shafts;
            // θ₁ = i θ₀
            let (to, ratio) = match (ratios[a], ratios[b]) {
                (Some(ratio), None) => (b, ratio * pair.ratio),
                (None, Some(ratio)) => (a, ratio / pair.ratio),
                _ => continue,
            };
            ratios[to] = Some(ratio);
            news = true;
        }
    }
    leaders
        .into_iter()
        .zip(ratios)
        .map(|(leader, ratio)| TrainMember {
            leader,
            // Gears reach every shaft of a train from its leader.
            ratio: ratio.unwrap_or(1.0),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use chaindrive_geometry::Vector;

    use super::{TrainMember, trains};
    use crate::{GearPair, Motion, Parts, Rotation, Shaft};

    /// Four shafts in a row of three pairs, and one apart: i₀₃ = i₀₁ i₁₂ i₂₃, whichever of them leads.
    #[test]
    fn ratios_multiply_along_a_train() {
        let pair = |shafts: [usize; 2], ratio: f64| GearPair {
            name: format!("{shafts:?}"),
            shafts,
            ratio,
        };
        let free = Rotation::Free {
            drive: Vec::new(),
            load: Vec::new(),
            start: crate::StartSpeed::Joined,
        };
        let mut parts = Parts {
            chains: Vec::new(),
            sprockets: Vec::new(),
            guides: Vec::new(),
            tensioners: Vec::new(),
            shafts: vec![Shaft::of_one(free); 5],
            couplings: Vec::new(),
            gears: vec![pair([2, 3], 4.0), pair([2, 1], 0.5), pair([0, 1], -2.0)],
            settle: false,
            gravity: Vector::zeros(),
            oil: None,
            tunable: Vec::new(),
        };
        let ratios = |parts: &Parts| -> Vec<(usize, f64)> {
            let all = trains(parts).into_iter();
            all.map(|TrainMember { leader, ratio }| (leader, ratio))
                .collect()
        };
        assert_eq!(
            ratios(&parts),
            [(0, 1.0), (0, -2.0), (0, -4.0), (0, -16.0), (4, 1.0)]
        );
        parts.shafts[3].rotation = Rotation::Prescribed(Motion::Held);
        assert_eq!(
            ratios(&parts),
            [(3, -0.0625), (3, 0.125), (3, 0.25), (3, 1.0), (4, 1.0)]
        );
    }
}
