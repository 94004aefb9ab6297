//! Rigid links as uniform bars: a spinning ring (T01), the slider-crank (S07), and taut spans (V01, V02).

use crate::linkages;

use std::f64::consts::{FRAC_PI_2, TAU};

use chaindrive_integrate::{Method, Moment, SecondOrderSystem};
use chaindrive_mechanics::{End, LinkBody};
use chaindrive_validation::Case;
use chaindrive_validation::Tolerance::{Absolute, Relative};
use linkages::{Bench, Strand, body, circle, clearance, harmonic, surface};
use nalgebra::DMatrix;

/// A count that the reference lists as a number.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a small whole number"
)]
fn whole(count: f64) -> usize {
    count.round() as usize
}

/// T01, uniform bars: the hinge force is along the tangent, and the bars feel its part along them.
#[test]
fn a_ring_of_bars_carries_its_centrifugal_tension() {
    let case = Case::read("T01");
    let rings = case.table("expected.rows");
    let expected = case.table("bars.expected.rows");
    let mut worst = [0.0_f64; 4];
    for (row, input) in case.table("inputs.rows").iter().enumerate() {
        let [count, pitch, mass, spin] = input[..] else {
            panic!("four inputs")
        };
        let places = circle(whole(count), pitch);
        let velocities = places.iter().map(|p| [-spin * p[1], spin * p[0]]).collect();
        let mut ring = Strand::ring(pitch, body(mass, mass * pitch * pitch / 12.0), places);
        ring.velocities = velocities;
        // A fifth of a turn. Within a Runge-Kutta step the hinges are off by (ωh)² R, and are drawn back by α².
        let step = (TAU / spin / 2000.0).min(2e-5);
        let mut bench = Bench::start(ring.assemble(), Method::Rk4 { step });
        for look in 0..=4 {
            bench.until(f64::from(look) * 0.05 * TAU / spin);
            let seen = bench.look();
            for i in 0..seen.roller_x.len() {
                let found = [
                    seen.joint_force[i] / expected[row][0],
                    seen.link_tension[i] / expected[row][1],
                    seen.roller_x[i].hypot(seen.roller_y[i]) / rings[row][0],
                    seen.roller_vx[i].hypot(seen.roller_vy[i]) / rings[row][1],
                ];
                for (worst, found) in worst.iter_mut().zip(found) {
                    *worst = worst.max((found - 1.0).abs());
                }
            }
        }
    }
    let tolerance = Absolute(case.number("tolerance"));
    for (name, worst) in ["hinge force", "link tension", "radius", "speed"]
        .into_iter()
        .zip(worst)
    {
        let quantity = format!("largest relative error of the {name}, bars");
        case.judge(&quantity, "", worst, 0.0, tolerance);
    }
}

/// The crank pin is a driven end, and the slider a body at the end of a link so long that it moves on a
/// straight line to 5e-9 m.
#[test]
fn s07_an_ideal_slider_crank() {
    let case = Case::read("S07");
    let input = |name: &str| case.number(&format!("inputs.{name}"));
    let (r, l, turns) = (input("r"), input("l"), input("rpm") / 60.0);
    let mass = input("m_slider");
    let far = 1e6;
    let mut strand = Strand::straight(2, l, body(0.21, 2.5e-4), [End::Fixed, End::Fixed]);
    strand.ends = chaindrive_mechanics::Ends::Open([
        End::Driven {
            x: harmonic(r, turns, FRAC_PI_2),
            y: harmonic(r, turns, 0.0),
        },
        End::Fixed,
    ]);
    strand.lengths = vec![l, far];
    strand.places = vec![[r, 0.0], [r + l, 0.0], [r + l, -far]];
    // Crank at its dead centre: the slider rests, and the rod turns about it.
    strand.velocities = vec![[0.0, TAU * turns * r], [0.0; 2], [0.0; 2]];
    strand.links.outer = LinkBody {
        mass,
        // Adds 1e-8 of the slider's mass.
        inertia: 1e-8 * mass * far * far,
        centre: [-0.5 * far, 0.0].into(),
    };
    let steps = 12_000_u32;
    let step = 1.0 / turns / f64::from(steps);
    let mut bench = Bench::start(strand.assemble(), Method::Rk4 { step });
    let (mut least, mut most, mut squares, mut place) = (0.0_f64, 0.0_f64, 0.0, 0.0_f64);
    for _ in 0..steps {
        let seen = bench.look();
        let acceleration = seen.joint_force_x[1] / mass;
        let angle = TAU * turns * seen.time;
        let expected = r * angle.cos() + (l * l - (r * angle.sin()).powi(2)).sqrt();
        place = place.max((seen.roller_x[1] / expected - 1.0).abs());
        least = least.min(acceleration);
        most = most.max(acceleration);
        squares += acceleration * acceleration / f64::from(steps);
        bench.advance();
    }
    let tolerance = case.number("tolerance.relative");
    for (quantity, unit, found, key) in [
        ("least acceleration", "m/s²", least, "a_min"),
        ("greatest acceleration", "m/s²", most, "a_max"),
        (
            "root mean square of the acceleration",
            "m/s²",
            squares.sqrt(),
            "rms",
        ),
        ("greatest force", "N", -least * mass, "F_x_slider_max"),
    ] {
        let expected = case.number(&format!("expected.{key}"));
        case.judge(quantity, unit, found, expected, Relative(tolerance));
    }
    let quantity = "largest relative error of the place";
    case.judge(quantity, "", place, 0.0, Absolute(tolerance));
}

/// Frequencies \[Hz\] of small motions about a state at rest, from forces on both sides of it.
fn frequencies(strand: &Strand, masses: [f64; 3]) -> Vec<f64> {
    let assembled = strand.assemble();
    let (system, q) = (assembled.system, assembled.q);
    let n = q.len();
    let still = vec![0.0; n];
    let mut record = system.new_record();
    let mut accelerations = |q: &[f64]| {
        let mut a = vec![0.0; n];
        let mut rates = vec![0.0; system.quadratures()];
        let at = Moment {
            t: 0.0,
            q,
            v: &still,
            z: &[],
        };
        system.evaluate(at, &mut a, &mut rates, &mut record);
        a
    };
    let mut matrix = DMatrix::zeros(n, n);
    for j in 0..n {
        let by = 1e-10 / if j % 3 == 2 { strand.lengths[0] } else { 1.0 };
        let [ahead, behind] = [by, -by].map(|by| {
            let mut q = q.clone();
            q[j] += by;
            accelerations(&q)
        });
        for i in 0..n {
            // −M^{-1/2} (∂f/∂q) M^{-1/2}, a = f/m
            let scale = (masses[i % 3] / masses[j % 3]).sqrt();
            matrix[(i, j)] = -(ahead[i] - behind[i]) / (2.0 * by) * scale;
        }
    }
    let symmetric = (&matrix + matrix.transpose()) * 0.5;
    let mut found: Vec<f64> = symmetric
        .symmetric_eigenvalues()
        .iter()
        .map(|squared| squared.abs().sqrt().copysign(*squared) / TAU)
        .collect();
    found.sort_by(f64::total_cmp);
    found
}

/// A span with its ends held, in which every joint is pressed by the tension of the case.
fn bars_of(case: &Case, links: usize, shorten: f64) -> Vec<f64> {
    let input = |name: &str| case.number(&format!("inputs.{name}"));
    let (pitch, tension, mass) = (input("pitch"), input("tension"), input("mass"));
    let inertia = case.number("bars.inputs.inertia");
    // Clearance and indentation are a millionth of the pitch, so that hinges they are.
    let gap = 1e-6 * pitch;
    let stiffness = tension / gap;
    let depth = tension / stiffness;
    let bar = pitch - shorten;
    let mut strand = Strand::straight(links, bar, body(mass, inertia), [End::Fixed, End::Fixed]);
    strand.links.joint = clearance(0.1 * pitch, gap, surface(stiffness, 1.0));
    strand.links.outer_first = true;
    // Pins and bushes stand apart by c + δ at every joint, and an outer link is shorter by 2c.
    let inner = (links / 2) as f64;
    let length = links as f64 * bar - inner * 2.0 * gap + (links as f64 + 1.0) * (gap + depth);
    strand.places = (0..=links)
        .map(|i| [length * i as f64 / links as f64, 0.0])
        .collect();
    strand.settle = true;
    let found = frequencies(&strand, [mass, mass, inertia]);
    // What the steps are chosen by: under tension pins swing in their bushes fast, however small their play.
    let scale = strand.assemble().system.undamped_time_scale();
    let fastest = 1.0 / (TAU * found[found.len() - 1]);
    assert!(
        scale < 1.001 * fastest && scale > 0.3 * fastest,
        "{scale:e} {fastest:e}"
    );
    found
}

#[test]
fn v01_v02_transverse_modes_of_spans_of_bars() {
    let elastic = Case::read("V02");
    let stretch = elastic.number("inputs.tension") / elastic.number("inputs.stiffness");
    for (id, links, shorten) in [("V01", 20, 0.0), ("V02", 40, -stretch)] {
        let case = Case::read(id);
        let found = bars_of(&case, links, shorten);
        let expected = case.list("bars.expected.frequency");
        let (listed, others) = found.split_at(expected.len());
        let tolerance = Relative(case.number("tolerance"));
        case.judge_each("frequencies, bars", "Hz", listed, &expected, tolerance);
        assert!(others[0] > 10.0 * expected[expected.len() - 1]);
    }
}
