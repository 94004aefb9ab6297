//! A step and a reading from outside allocate nothing.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::hint::black_box;

use allocation_counter::measure;
use chaindrive::scene::presets;
use chaindrive::{Channel, Scene, Stepping};

use crate::live::{loose, preset, start};

/// Steps in which every list grows to its length, and steps after them.
const STEPS: [u32; 2] = [1500, 500];

/// Number of later steps with an allocation, each read into a view of all channels.
fn allocating_steps(scene: &Scene) -> usize {
    let mut simulation = start(scene, Stepping::Auto);
    let channels = Channel::ALL.iter().copied();
    let channels: Vec<Channel> = channels
        .filter(|it| it.is_of(simulation.system()))
        .collect();
    let mut view = simulation.view(&channels).unwrap();
    let mut allocates = || {
        let counted = measure(|| {
            simulation.step(1).unwrap();
            simulation.read_into(&mut view);
        });
        counted.count_total > 0
    };
    let [_, then] = STEPS.map(|steps| (0..steps).filter(|_| allocates()).count());
    then
}

#[test]
fn a_step_and_a_reading_allocate_nothing() {
    let counted = measure(|| drop(black_box(vec![0.0; 3])));
    assert_eq!(counted.count_total, 1, "allocations are counted");
    let names = presets().iter().map(|(name, _)| *name);
    let scenes = names.map(|name| (name, preset(name)));
    for (name, scene) in scenes.chain([("free rollers", loose())]) {
        let most = match name {
            // Large wheels turn slowly: the contacts of one may yet grow by a block of eight rollers, in two memories.
            "marine_engine" | "marine_engine_oil" | "bicycle" => 8,
            _ => 0,
        };
        let found = allocating_steps(&scene);
        assert!(found <= most, "{name}: {found} of {} steps", STEPS[1]);
    }
}
