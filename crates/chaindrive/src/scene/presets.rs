//! Scenes that come with the program.

use super::suggest::one_of;
use super::{Problem, Scene, SceneError};

/// Name, one-line description and text of every embedded scene.
const PRESETS: [(&str, &str, &str); 17] = [
    (
        "marine_engine",
        "Camshaft drive of a large two-stroke engine under its pumps and valves: four sprockets, three guide bars, tensioner",
        include_str!("../../scenes/marine_engine.toml"),
    ),
    (
        "marine_engine_bare",
        "The same drive as the paper models it: no friction in the joints, constant loads",
        include_str!("../../scenes/marine_engine_bare.toml"),
    ),
    (
        "marine_engine_oil",
        "The camshaft drive with oil in the seats of its rollers: what an impact leaves follows from the film",
        include_str!("../../scenes/marine_engine_oil.toml"),
    ),
    (
        "marine_two_sprockets",
        "The chain of the marine engine around two sprockets: the smallest large drive",
        include_str!("../../scenes/marine_two_sprockets.toml"),
    ),
    (
        "industrial_16b",
        "15 kW through a 16B-1 chain, 19 to 57 teeth",
        include_str!("../../scenes/industrial_16b.toml"),
    ),
    (
        "timing_drive",
        "Valve timing of a car: 8 mm bush chain, fixed guide, arm with a hydraulic plunger",
        include_str!("../../scenes/timing_drive.toml"),
    ),
    (
        "two_stage_timing",
        "Valve timing in two stages: two chains, an intermediate shaft, arms with hydraulic plungers",
        include_str!("../../scenes/two_stage_timing.toml"),
    ),
    (
        "bicycle",
        "Chain of a bicycle, 44 to 18 teeth, tight: rigid links with play in their joints",
        include_str!("../../scenes/bicycle.toml"),
    ),
    (
        "bicycle_slack",
        "The chain of the bicycle, slack: the rear wheel 1 mm nearer",
        include_str!("../../scenes/bicycle_slack.toml"),
    ),
    (
        "bicycle_crank",
        "A rider who pedals: torque of two legs, chain, rear hub and wheel joined by a torsional spring",
        include_str!("../../scenes/bicycle_crank.toml"),
    ),
    (
        "bicycle_derailleur",
        "A bicycle with a derailleur: two pulleys on a sprung cage, a chain out of line, and what all of it loses",
        include_str!("../../scenes/bicycle_derailleur.toml"),
    ),
    (
        "motorcycle",
        "Rear drive of a motorcycle, 520 chain with a slack lower run, 15 to 46 teeth",
        include_str!("../../scenes/motorcycle.toml"),
    ),
    (
        "pin_in_bush",
        "A pin dropped into its bush: one link with play, and how it bounces",
        include_str!("../../scenes/pin_in_bush.toml"),
    ),
    (
        "pendulum_in_bush",
        "A link that swings by its pin in a bush, with play and friction",
        include_str!("../../scenes/pendulum_in_bush.toml"),
    ),
    (
        "chain_pendulum",
        "A pendulum on a chainring over which a chain is drawn: its swing dies by the friction of the joints alone",
        include_str!("../../scenes/chain_pendulum.toml"),
    ),
    (
        "hanging_chain",
        "Twenty links between two fixed ends: a discrete catenary",
        include_str!("../../scenes/hanging_chain.toml"),
    ),
    (
        "spinning_ring",
        "A free ring of twenty elastic links, stretched by its rotation",
        include_str!("../../scenes/spinning_ring.toml"),
    ),
];

const NAMES: [(&str, &str); PRESETS.len()] = {
    let mut names = [("", ""); PRESETS.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = (PRESETS[i].0, PRESETS[i].1);
        i += 1;
    }
    names
};

/// Name and one-line description of every embedded scene.
pub fn presets() -> &'static [(&'static str, &'static str)] {
    &NAMES
}

impl Scene {
    /// The embedded scene of this name; [`presets`] lists them.
    ///
    /// # Errors
    /// No scene has this name.
    pub fn preset(name: &str) -> Result<Self, SceneError> {
        let Some((name, _, text)) = PRESETS.iter().find(|(known, ..)| *known == name) else {
            let known = NAMES.map(|(known, _)| known);
            let problem = Problem::new("", None, "there is no embedded scene of this name");
            return Err(SceneError::new(
                name,
                vec![problem.hint(one_of(name, &known))],
            ));
        };
        Self::from_toml(text, name)
    }
}
