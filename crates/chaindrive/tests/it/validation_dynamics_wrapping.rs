//! Tight loops, whose length around both wheels varies over a tooth (validation cases K16, K19).

use crate::dynamics;

use std::f64::consts::TAU;

use crate::two_sprockets::{TwoSprockets, steady};
use chaindrive_validation::Case;
use chaindrive_validation::Tolerance::Absolute;
use dynamics::{mean, range, run};

/// Parts of a tooth, and samples of each.
const PARTS: usize = 12;
const SAMPLES: usize = 20;

/// The tension of a loop that is tight throughout follows its length: links of the stiffness k in a row,
///
/// ```text
/// ΔT = k/n ΔL
/// ```
///
/// Seats are wider than rollers, so that the tension is the same in all links. Half a pitch more in the strands (K16) makes a ripple that whole pitches (K19)
/// do not have.
#[test]
fn k16_k19_tight_loops_carry_what_their_length_asks_for() {
    for (id, links) in [("K16", 58.0), ("K19", 57.0)] {
        let case = Case::read(id);
        let input = |name: &str| case.number(&format!("inputs.{name}"));
        let (pitch, teeth) = (input("pitch"), input("z1"));
        let (stiffness, speed) = (1e7, 4.0);
        let tooth = TAU / teeth / speed;
        let text = TwoSprockets {
            before: "settle = false\ngravity = [0, 0]",
            pitch,
            links,
            mass: 2e-4,
            stiffness,
            damping_ratio: 0.2,
            roller: 0.6 * pitch,
            contact: 2e8,
            damper: 45.0,
            teeth: [teeth; 2],
            tooth: &format!("{{ kind = 'circular', seat_radius = {} }}", 0.33 * pitch),
            centre: [input("C"), 0.0],
            driver: &steady(speed),
            inertia: 2e-4,
            driven: "load = [{ kind = \"resistance\", linear = 1e-2 }]",
            after: "[route]\npretension = \"200 N\"",
            until: 2.0 * tooth,
            every: tooth / (PARTS * SAMPLES) as f64,
            run: "run_in = 0\nmethod = \"verlet\"",
            ..TwoSprockets::NOTHING
        }
        .text();
        let mut tensions = Vec::new();
        run(&text, |sample| {
            if sample.time > tooth {
                tensions.push(mean(&sample.span_tension));
            }
        });
        // What rollers do within a twelfth of a tooth is not asked for.
        let parts: Vec<f64> = tensions.chunks_exact(SAMPLES).map(mean).collect();
        assert_eq!(parts.len(), PARTS);
        let table = case.table("expected.table_f_L");
        let lengths: Vec<f64> = table.iter().map(|row| row[1]).collect();
        let of_length = stiffness / links * pitch;
        // A tenth of the ripple of K16, in the loop that has none as well.
        let tolerance = Absolute(0.1 * of_length * 8.57e-3);
        let name = "range of the tension, as a run";
        case.judge(
            name,
            "N",
            range(&parts),
            of_length * range(&lengths),
            tolerance,
        );
    }
}
