//! Pins in their bushes: a row of masses (C09), and the restitution that every dissipation delivers in a joint.
#![allow(clippy::print_stdout, reason = "measured errors are worth a look")]

use crate::linkages;

use chaindrive_contact::Dissipation;
use chaindrive_integrate::Method;
use chaindrive_mechanics::{End, LinkBody};
use chaindrive_validation::Case;
use chaindrive_validation::Tolerance::Absolute;
use linkages::{Bench, Strand, body, clearance, surface};

/// One outer link of length `length` between its pins, the first one in a bush on the ground.
///
/// Its centre of mass lies `below` behind that pin, and at the start the pin stands `offset` from the bush's centre.
fn hung(length: f64, below: f64, gap: f64, offset: f64, bar: LinkBody, ends: [End; 2]) -> Strand {
    let mut strand = Strand::straight(1, length + 2.0 * gap, bar, ends);
    // The link lies in the middle between the two places.
    strand.places[1][0] = length + 2.0 * offset;
    strand.links.outer_first = true;
    strand.links.outer.centre = [below - 0.5 * length, 0.0].into();
    strand
}

/// The row is a taut strand: its links hang together by pins that just touch, and the first is pulled away.
#[test]
fn c09_a_mass_strikes_a_row_of_equal_masses() {
    let case = Case::read("C09");
    let tolerance = Absolute(case.number("tolerance.absolute"));
    for row in case.table("expected.rows") {
        let (count, exponent) = (row.len() - 2, row[1]);
        let (pitch, mass) = (0.1, 0.01);
        // Hard enough for all to be over before the last has crossed its bush.
        let (gap, stiffness) = (5e-3, 1e3 * 10_f64.powf(6.0 * (exponent - 0.5)));
        let mut strand = Strand::straight(count, pitch, body(mass, 1e-5), [End::Free, End::Free]);
        strand.links.joint = clearance(0.01, gap, surface(stiffness, exponent));
        let mut assembled = strand.assemble();
        assembled.v[0] = -1.0;
        let mut bench = Bench::start(assembled, Method::Rk4 { step: 2e-7 });
        bench.until(3e-3);
        // Leftwards here.
        let found: Vec<f64> = (0..count).map(|mass| -bench.body(mass)[1][0]).collect();
        let quantity = "speeds after the impact, links of a taut strand";
        case.judge_each(quantity, "v₀", &found, &row[2..], tolerance);
    }
}

/// A pin with the centre of mass of its link is thrown at its bush: the restitution is that of the table, which an
/// independent program worked out from the closed form.
#[test]
fn a_pin_thrown_at_its_bush_returns_with_the_restitution_of_its_law() {
    let table = include_str!("../../../contact/tests/data/restitution.csv");
    let (gap, speed) = (1e-4, 0.5);
    let (mut worst, mut laws) = (0.0_f64, 0);
    for line in table.lines().skip(1) {
        let row: Vec<&str> = line.split(',').collect();
        let number = |i: usize| -> f64 { row[i].parse().expect("a number") };
        let index = NAMES
            .iter()
            .position(|name| *name == row[0])
            .expect("a known law");
        let mut surface = surface(1e8, 1.0);
        surface.law.dissipation = Dissipation::hysteretic(number(1))[index];
        let mut strand = hung(
            0.1,
            0.0,
            gap,
            gap,
            body(0.01, 1e-5),
            [End::Fixed, End::Free],
        );
        strand.links.joint = clearance(0.01, gap, surface);
        let mut assembled = strand.assemble();
        assembled.q[0] -= 1e-8;
        assembled.v[0] = speed;
        let mut bench = Bench::start(assembled, Method::Rk4 { step: 2e-8 });
        let start = bench.body(0)[0][0];
        while bench.body(0)[0][0] >= start {
            bench.advance();
        }
        let error = -bench.body(0)[1][0] / speed - number(3);
        worst = worst.max(error.abs());
        laws += 1;
        assert!(error.abs() < 1e-4, "{line}: {error:e}");
    }
    println!("restitution of {laws} laws in a joint: {worst:.1e}");
}

/// In the order of `Dissipation::hysteretic`.
const NAMES: [&str; 9] = [
    "exact",
    "hunt_crossley",
    "lankarani_nikravesh",
    "lee_wang",
    "herbert_mcwhannell",
    "gonthier",
    "zhiying_qishao",
    "flores",
    "hu_guo",
];
