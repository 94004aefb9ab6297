//! Trains of gears: shafts that turn together.

use crate::drive::{Parts, Rotation};
use crate::groups::Sets;

/// How a shaft turns with the one that leads its train; a shaft without gears leads itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct InTrain {
    /// The shaft whose angle is given in time, or else the first one.
    pub(crate) leader: usize,
    /// θ − θ(0) of the shaft over that of the leader \[–\].
    pub(crate) ratio: f64,
}

/// The place of every shaft in its train.
pub(crate) fn trains(parts: &Parts) -> Vec<InTrain> {
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
        .map(|(leader, ratio)| InTrain {
            leader,
            // Gears reach every shaft of a train from its leader.
            ratio: ratio.unwrap_or(1.0),
        })
        .collect()
}
