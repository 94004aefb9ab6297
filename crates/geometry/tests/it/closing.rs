//! Five complete drives close link by link, and everything else they promise.
//!
//! The reference values were computed by an independent program that shoots the chain once around
//! its wheels; the centre coordinates are those at which it closes.

#![expect(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "test code outside of test functions"
)]

use crate::drives;

use chaindrive_geometry::{
    Closing, GeometryError, Point, Route, Side, TwoWheels, Vector, Wheel, close_by_motion,
    close_by_strain, closing_strains,
};
use drives::{MARINE_CAMSHAFT, MARINE_PITCH, TIMING_PITCH, assert_close, marine, pair, timing};

/// Reference of one wheel: wrap [degrees], pitches wrapped, angle of the first seat [degrees].
type Seated = (f64, u32, f64);

/// Expected layout of a drive.
struct Expected<'a> {
    seats: &'a [Seated],
    spans: &'a [u32],
    tangents: &'a [f64],
}

#[track_caller]
fn assert_layout(
    name: &str,
    wheels: &[Wheel],
    pitch: f64,
    links: u32,
    closing: &Closing,
    expected: &Expected<'_>,
) {
    let route = Route::taut(wheels).unwrap();
    assert_eq!(closing.links, links);
    assert_close(closing.residual, 0.0, 1e-13);
    assert_eq!(closing.spans, expected.spans);
    for (i, &(wrap, pitches, first)) in expected.seats.iter().enumerate() {
        assert_close(route.wraps[i].to_degrees(), wrap, 6e-5);
        assert_eq!(closing.seats[i].pitches, pitches);
        assert_close(closing.seats[i].first_angle.to_degrees(), first, 6e-5);
    }
    for (span, &length) in route.spans.iter().zip(expected.tangents) {
        assert_close(span.length, length, 6e-7);
    }

    // Every two neighbours are one pitch apart, the last and the first included.
    let places = closing.positions(wheels, pitch).unwrap();
    assert_eq!(places.len(), links as usize);
    let worst = places
        .iter()
        .zip(places.iter().cycle().skip(1))
        .map(|(a, b)| ((b.position - a.position).norm() - pitch).abs())
        .fold(0.0, f64::max);
    println!(
        "{name}: residual {:e} m, worst link {worst:e} m",
        closing.residual
    );
    assert_close(worst, 0.0, 1e-13);
    assert_eq!(places[0].on, Some((0, 0)));
    assert_taut(
        wheels,
        pitch,
        &places
            .iter()
            .map(|place| place.position)
            .collect::<Vec<_>>(),
    );
}

/// No roller lies inside the circle of a wheel beyond the sagitta of one chord.
#[track_caller]
fn assert_taut(wheels: &[Wheel], pitch: f64, rollers: &[Point]) {
    for wheel in wheels {
        let within = wheel.radius - (wheel.radius * wheel.radius - 0.25 * pitch * pitch).sqrt();
        for roller in rollers {
            assert!((roller - wheel.centre).norm() > wheel.radius - within - 1e-12);
        }
    }
}

#[test]
fn marine_drive_closes() {
    let (place, wheels, closing) = close_by_motion(
        MARINE_PITCH,
        0.0,
        122,
        0.5,
        &mut |x| marine(1.15 + x),
        (-0.25, 0.25),
    )
    .unwrap();
    println!(
        "marine camshaft x off by {:e} m",
        1.15 + place - MARINE_CAMSHAFT
    );
    assert_close(wheels[1].centre.x, MARINE_CAMSHAFT, 1e-11);
    let expected = Expected {
        seats: &[
            (142.0447, 19, 187.9079),
            (81.9163, 11, 331.8154),
            (95.3386, 8, 52.2068),
            (40.7004, 3, 149.3061),
        ],
        spans: &[28, 14, 19, 20],
        tangents: &[2.472_506, 1.269_086, 1.683_371, 1.818_659],
    };
    assert_layout("marine", &wheels, MARINE_PITCH, 122, &closing, &expected);
    assert_close(
        Route::taut(&wheels).unwrap().pitches(MARINE_PITCH),
        122.0003,
        5e-5,
    );
}

/// Pressing the tensioner outward by 1.009 mm stretches the chain to 15 kN.
#[test]
fn marine_tensioner_travel_gives_the_pretension() {
    let wheels = marine(MARINE_CAMSHAFT);
    let spans = Route::taut(&wheels).unwrap().spans;
    let (before, behind) = (spans[1].direction, spans[2].direction);
    let outward = Vector::new(before.cos() - behind.cos(), before.sin() - behind.sin()).normalize();
    assert_close(outward.x, -0.173_536_246_310_992, 1e-12);

    let strain = 15e3 / (815e6 * MARINE_PITCH);
    let mut pressed = |travel: f64| {
        let mut wheels = wheels.clone();
        wheels[2].centre += travel * outward;
        wheels
    };
    let (travel, ..) =
        close_by_motion(MARINE_PITCH, strain, 122, 0.5, &mut pressed, (-0.01, 0.03)).unwrap();
    println!("tensioner travel {travel}");
    assert_close(travel, 1.009e-3, 5e-7);
}

/// On rigid centres the closing strain varies over one tooth, continuously and periodically.
#[test]
fn marine_closing_strain_varies_with_the_phase() {
    let wheels = marine(MARINE_CAMSHAFT);
    let strains = closing_strains(&wheels, MARINE_PITCH, 122, 48).unwrap();
    let least = strains.iter().map(|s| s.1).fold(f64::INFINITY, f64::min);
    let most = strains
        .iter()
        .map(|s| s.1)
        .fold(f64::NEG_INFINITY, f64::max);
    println!("closing strain {least:e} .. {most:e}");
    assert_close(least, -7.179_030_95e-6, 1e-12);
    assert_close(most, 1.635_335_42e-5, 1e-12);

    let at = |phase| {
        close_by_strain(&wheels, MARINE_PITCH, 122, phase)
            .unwrap()
            .0
    };
    assert_close(at(0.0), at(1.0), 1e-14);
    for phase in [0.137, 0.0, 0.62] {
        assert_close(at(phase - 1e-9), at(phase + 1e-9), 1e-12);
    }
    // A strain is a root of the excess, in all tooth phases.
    for (phase, strain) in strains {
        let closing = Closing::march(&wheels, MARINE_PITCH * (1.0 + strain), phase).unwrap();
        assert_close(closing.excess(122), 0.0, 1e-13);
    }
}

/// The excess has no jumps in the phase, so that a root of it is a chain that closes.
#[test]
fn excess_is_continuous_in_the_phase() {
    let drives = [
        (marine(MARINE_CAMSHAFT), MARINE_PITCH, 122),
        (pair(44, 18, -0.460_544_624_365_817_9, 0.0127), 0.0127, 104),
        (pair(9, 11, 0.1, 0.0127), 0.0127, 26),
        (timing(0.012_795_304_822), TIMING_PITCH, 118),
    ];
    for (wheels, pitch, links) in drives {
        let excess = |i: i32| {
            Closing::march(&wheels, pitch, f64::from(i) / 20_000.0)
                .unwrap()
                .excess(links)
        };
        let steps = (0..20_000).map(|i| (excess(i + 1) - excess(i)).abs() / pitch);
        let worst = steps.fold(0.0, f64::max);
        println!("largest step of the excess {worst:e} pitches");
        assert!(worst < 2e-5);
        assert_close(excess(0), excess(20_000), 1e-13);
    }
}

#[test]
fn bicycle_closes() {
    let pitch = 0.0127;
    let (_, wheels, closing) = close_by_motion(
        pitch,
        0.0,
        104,
        0.5,
        &mut |x| pair(44, 18, x, pitch),
        (-0.467, -0.455),
    )
    .unwrap();
    println!(
        "bicycle x off by {:e} m",
        wheels[1].centre.x + 0.460_544_624_365_817_9
    );
    assert_close(wheels[1].centre.x, -0.460_544_624_365_817_9, 1e-11);
    let expected = Expected {
        seats: &[(193.0772, 24, 260.1749), (166.9228, 8, 95.9918)],
        spans: &[36, 36],
        tangents: &[0.457_549, 0.457_549],
    };
    assert_layout("bicycle", &wheels, pitch, 104, &closing, &expected);
    let smooth = TwoWheels {
        teeth: [44, 18],
        pitch,
    };
    assert_close(
        smooth.centre_distance_catalogue(104.0),
        0.460_551_624,
        5e-10,
    );

    // Over one tooth the taut centre distance varies by 18 µm.
    let taut = |i: u32| {
        let mut moving = |x| pair(44, 18, x, pitch);
        let phase = f64::from(i) / 24.0;
        -close_by_motion(pitch, 0.0, 104, phase, &mut moving, (-0.467, -0.455))
            .unwrap()
            .0
    };
    let least = (0..24).map(taut).fold(f64::INFINITY, f64::min);
    let most = (0..24).map(taut).fold(0.0, f64::max);
    println!("bicycle centre distance {least} .. {most}");
    assert_close(least, 0.460_540_265, 1e-9);
    assert_close(most, 0.460_558_406, 1e-9);
}

#[test]
fn industrial_16b_closes() {
    let pitch = 0.0254;
    let (_, wheels, closing) = close_by_motion(
        pitch,
        0.0,
        120,
        0.5,
        &mut |x| pair(19, 57, x, pitch),
        (1.02, 1.04),
    )
    .unwrap();
    println!(
        "16B x off by {:e} m",
        wheels[1].centre.x - 1.029_929_958_167_708
    );
    assert_close(wheels[1].centre.x, 1.029_929_958_167_708, 1e-11);
    let expected = Expected {
        seats: &[(162.8708, 9, 90.9091), (197.1292, 31, 260.8278)],
        spans: &[40, 40],
        tangents: &[1.018_445, 1.018_445],
    };
    assert_layout("16B", &wheels, pitch, 120, &closing, &expected);
}

#[test]
fn timing_drive_with_guides_closes() {
    let (push, wheels, closing) =
        close_by_motion(TIMING_PITCH, 0.0, 118, 0.5, &mut timing, (0.006, 0.020)).unwrap();
    println!(
        "timing push off by {:e} m",
        push - 0.012_795_304_822_057_856
    );
    assert_close(push, 0.012_795_304_822_057_856, 1e-11);
    assert_close(wheels[4].centre.x, -0.487_015_180_001_044_7, 1e-11);
    assert_close(wheels[4].centre.y, 0.025_372_793_710_446_86, 1e-11);
    assert_close(wheels[1].teeth(TIMING_PITCH), 1_730.669_950_867, 1e-6);
    assert_close(wheels[4].teeth(TIMING_PITCH), 356.230_499_270_8, 1e-7);
    let expected = Expected {
        seats: &[
            (157.1260, 8, 186.3738),
            (2.7829, 13, 166.3926),
            (106.4091, 11, 338.8911),
            (110.8494, 11, 88.8911),
            (11.6016, 11, 20.5974),
        ],
        spans: &[12, 12, 14, 13, 13],
        tangents: &[0.096_721, 0.096_010, 0.112_000, 0.100_437, 0.103_308],
    };
    assert_layout("timing", &wheels, TIMING_PITCH, 118, &closing, &expected);
}

#[test]
fn motorcycle_closes() {
    let pitch = 0.015_875;
    let (_, wheels, closing) = close_by_motion(
        pitch,
        0.0,
        112,
        0.5,
        &mut |x| pair(15, 46, x, pitch),
        (-0.65, -0.63),
    )
    .unwrap();
    println!(
        "motorcycle x off by {:e} m",
        wheels[1].centre.x + 0.642_129_421_855_897_4
    );
    assert_close(wheels[1].centre.x, -0.642_129_421_855_897_4, 1e-11);
    let expected = Expected {
        seats: &[(166.0216, 7, 275.0108), (193.9784, 25, 81.8492)],
        spans: &[40, 40],
        tangents: &[0.637_358, 0.637_358],
    };
    assert_layout("motorcycle", &wheels, pitch, 112, &closing, &expected);
}

/// Travelling the other way round is the same drive: all wheels on the right, in reverse order.
#[test]
fn clockwise_is_the_mirror_of_counter_clockwise() {
    let mut wheels = marine(MARINE_CAMSHAFT);
    wheels[1..].reverse();
    for wheel in &mut wheels {
        wheel.side = Side::Right;
    }
    let route = Route::taut(&wheels).unwrap();
    assert_close(
        route.pitches(MARINE_PITCH),
        Route::taut(&marine(MARINE_CAMSHAFT))
            .unwrap()
            .pitches(MARINE_PITCH),
        1e-12,
    );
    let closing = Closing::march(&wheels, MARINE_PITCH, 0.5).unwrap();
    assert_eq!(closing.links, 122);
    // The loop enters wheel 0 where it used to leave it: another phase, within the ripple.
    assert!(closing.residual.abs() < 1e-3 * MARINE_PITCH * 122.0);
}

/// A curved guide as the first wheel, which has no teeth to give a phase.
#[test]
fn a_guide_may_come_first() {
    let mut wheels = timing(0.012_795_304_822_057_856);
    wheels.rotate_left(1);
    let closing = Closing::march(&wheels, TIMING_PITCH, 0.5).unwrap();
    assert_eq!(closing.links, 118);
    assert!(closing.residual.abs() < 1e-3 * TIMING_PITCH);
}

#[test]
fn a_chain_that_cannot_close_says_by_how_much() {
    let wheels = marine(MARINE_CAMSHAFT);
    let error = close_by_strain(&wheels, MARINE_PITCH, 124, 0.5).unwrap_err();
    let GeometryError::DoesNotClose {
        links,
        taut,
        slack,
        below,
        above,
        ..
    } = error
    else {
        panic!("{error}")
    };
    assert_eq!((links, below, above), (124, 122, 123));
    assert_close(slack, (124.0 - taut) * MARINE_PITCH, 1e-15);
    assert!(error.to_string().contains("too long"), "{error}");
    println!("{error}");

    let error = close_by_motion(
        MARINE_PITCH,
        0.0,
        118,
        0.5,
        &mut |x| marine(1.15 + x),
        (0.0, 0.1),
    )
    .unwrap_err();
    assert!(
        matches!(error, GeometryError::DoesNotClose { slack, .. } if slack < 0.0),
        "{error}"
    );
    let taut = |x: f64| Route::taut(&marine(x)).unwrap().pitches(MARINE_PITCH);
    let [least, most] = [taut(1.15), taut(1.25)];
    let told = format!("can be made {least:.3} to {most:.3} links long");
    assert!(error.to_string().contains(&told), "{error}");
    let [first, last] = [least.ceil(), most.floor()];
    assert!(
        error
            .to_string()
            .contains(&format!("take {first} to {last}")),
        "{error}"
    );
}

/// A bare number where millimetres were meant makes the route a thousand times too long.
#[test]
fn a_route_in_another_unit_is_told() {
    let wheels = marine(1e3 * MARINE_CAMSHAFT);
    let error = close_by_strain(&wheels, MARINE_PITCH, 122, 0.5).unwrap_err();
    assert!(
        error.to_string().contains("A bare number is in metres"),
        "{error}"
    );
}
