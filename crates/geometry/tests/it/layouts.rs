//! Drives laid out without a number computed by hand: random sprockets, idlers by wrap, guides by share, whole links.

use std::f64::consts::TAU;

use chaindrive_geometry::{
    CurvedGuide, GeometryError, IdlerByWrap, LinkCounts, Plan, Point, Route, Search, Side, Station,
    TwoWheels, Vector, Wheel, close_by_motion, close_nearest,
};

use crate::drives::{TIMING_PITCH, assert_close, marine, pair, ridden, timing};

/// Numbers in [0, 1) that are the same on every machine (splitmix64).
struct Dice(u64);

impl Dice {
    #[expect(clippy::cast_precision_loss, reason = "53 bits fit")]
    fn roll(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / 9_007_199_254_740_992.0
    }

    fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.roll()
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "small counts"
    )]
    fn count(&mut self, from: u32, to: u32) -> u32 {
        from + (self.roll() * f64::from(to - from + 1)) as u32
    }
}

/// Two to eight sprockets about a ring, some of them idlers on the back of the chain, and guides that bow the spans between.
fn random_drive(dice: &mut Dice, pitch: f64) -> Plan {
    let sprockets = dice.count(2, 8);
    let idlers = if sprockets > 3 { dice.count(0, 2) } else { 0 };
    let ring = sprockets - idlers;
    let radius = pitch * dice.between(14.0, 30.0);
    let mut stops = Vec::new();
    for i in 0..ring {
        let angle = TAU * (f64::from(i) + dice.between(-0.15, 0.15)) / f64::from(ring);
        let away = radius * dice.between(0.85, 1.15);
        let centre = Point::new(away * angle.cos(), away * angle.sin());
        let teeth = dice.count(11, 30);
        stops.push(Station::Wheel(Wheel::toothed(
            centre,
            teeth,
            pitch,
            Side::Left,
        )));
        if i < idlers {
            let teeth = dice.count(9, 15);
            stops.push(Station::Idler {
                wheel: Wheel::toothed(Point::origin(), teeth, pitch, Side::Right),
                share: dice.between(0.4, 0.6),
                wrap: dice.between(10.0, 60.0).to_radians(),
            });
        } else if dice.roll() < 0.3 {
            let radius = pitch * dice.between(40.0, 200.0);
            stops.push(Station::Guide(CurvedGuide {
                shares: [0.2, 0.8],
                crest: dice.between(0.4, 0.6),
                bow: dice.between(0.1, 0.5) * pitch,
                radius,
                ride: radius + 0.3 * pitch,
                side: Side::Right,
            }));
        }
    }
    Plan { stops }
}

/// Every one of fifty drives closes with the next even number of links when one of its sprockets is moved, and neighbouring
/// rollers are one pitch apart, all the way round.
#[test]
fn fifty_random_drives_close() {
    let mut dice = Dice(12);
    let (mut closed, mut guided, mut idle, mut rolled, mut most) = (0, 0, 0, 0, 0.0_f64);
    let mut sprockets = [0; 9];
    while closed < 50 {
        rolled += 1;
        let pitch = [8e-3, 12.7e-3, 25.4e-3, 88.9e-3][dice.count(0, 3) as usize];
        let plan = random_drive(&mut dice, pitch);
        let phase = dice.roll();
        // A ring so small that wheels meet, or an idler that has no room, is no drive.
        let Ok(counts) = plan
            .lay()
            .and_then(|wheels| LinkCounts::around(&wheels, pitch, phase))
        else {
            continue;
        };
        assert!(counts.even_above.is_multiple_of(2));
        assert!(f64::from(counts.even_above) >= counts.pitches);
        assert!(f64::from(counts.even_above) < counts.pitches + 2.0);
        let bare = plan.bare().unwrap();
        let effect = |&wheel: &usize| bare.lengthening(wheel).norm();
        let largest = (1..bare.wheels.len()).max_by(|i, j| effect(i).total_cmp(&effect(j)));
        let (moved, toward) = (largest.unwrap(), bare.lengthening(largest.unwrap()));
        let mut moving = |travel: f64| {
            let mut plan = plan.clone();
            let mut wheels = plan.stops.iter_mut().filter_map(|stop| match stop {
                Station::Wheel(wheel) => Some(wheel),
                _ => None,
            });
            let wheel = wheels.nth(moved).unwrap();
            wheel.centre += toward.normalize() * travel;
            plan.lay().unwrap_or_default()
        };
        let search = Search {
            start: 0.0,
            step: 0.1 * pitch,
            within: 4.0 * pitch,
        };
        let found = close_nearest(pitch, 0.0, counts.even_above, phase, &mut moving, search);
        let (_, wheels, closing) = found.unwrap_or_else(|error| panic!("{plan:#?}\n{error}"));
        let places = closing.positions(&wheels, pitch).unwrap();
        assert_eq!(places.len(), counts.even_above as usize);
        for (i, place) in places.iter().enumerate() {
            let next = places[(i + 1) % places.len()].position;
            most = most.max(((next - place.position).norm() / pitch - 1.0).abs());
        }
        assert!(closing.excess(counts.even_above).abs() < 1e-12);
        // The chain that a designer asked for, in the place that was found.
        let taut = Route::taut(&wheels).unwrap();
        for (stop, wrap) in plan.stops.iter().zip(&taut.wraps) {
            if let Station::Idler { wrap: asked, .. } = stop {
                assert_close(*wrap, *asked, 1e-9);
            }
        }
        closed += 1;
        let has = |is: fn(&Station) -> bool| usize::from(plan.stops.iter().any(is));
        guided += has(|stop| matches!(stop, Station::Guide(_)));
        idle += has(|stop| matches!(stop, Station::Idler { .. }));
        sprockets[plan
            .stops
            .iter()
            .filter(|s| !matches!(s, Station::Guide(_)))
            .count()] += 1;
    }
    println!(
        "{rolled} rolled, {guided} with guides, {idle} with idlers, by sprockets {sprockets:?}; links off by {most:.1e}"
    );
    assert!(rolled < 75, "{rolled} rolled");
    assert!(most < 1e-12, "{most:e}");
    assert!(guided > 10 && idle > 10);
    assert!(
        sprockets[2..].iter().all(|count| *count > 0),
        "{sprockets:?}"
    );
}

/// The guides of the timing drive, by share and bow, are those that the test of the closing lays by hand.
#[test]
fn guides_by_share_are_those_laid_by_hand() {
    let by_hand = timing(0.012_795_304_822_057_856);
    let sprockets = [by_hand[0], by_hand[2], by_hand[3]];
    let spans = Route::taut(&sprockets).unwrap().spans;
    for (span, radius, bow, wheel) in [(0, 2.2, 3e-3, 1), (2, 0.45, 0.012_795_304_822_057_856, 4)] {
        let guide = CurvedGuide {
            shares: [0.25, 0.75],
            crest: 0.5,
            bow,
            radius,
            ride: ridden(radius),
            side: Side::Right,
        };
        let face = guide.on(&spans[span]).unwrap();
        assert!((face.centre - by_hand[wheel].centre).norm() < 1e-14);
        // Its ends lie beside the shares, whichever way it is passed.
        let ends = [0.0, 1.0].map(|part| {
            let angle = face.start_angle + part * face.sweep;
            let end = face.centre + radius * Vector::new(angle.cos(), angle.sin());
            (end - spans[span].leaves).dot(&spans[span].along()) / spans[span].length
        });
        assert_close(ends[0], 0.75, 1e-12);
        assert_close(ends[1], 0.25, 1e-12);
    }
}

/// The search finds what a bracket finds, and ends where sprockets meet.
#[test]
fn the_search_outward_finds_what_a_bracket_finds() {
    let (pitch, links) = (25.4e-3, 120);
    let mut moving = |x: f64| pair(19, 57, x, pitch);
    let (bracketed, ..) =
        close_by_motion(pitch, 0.0, links, 0.5, &mut moving, (1.0, 1.06)).unwrap();
    for start in [0.5, 1.029, 1.03, 1.3] {
        let search = Search {
            start,
            step: 1e-3,
            within: 1.0,
        };
        let (found, _, closing) =
            close_nearest(pitch, 0.0, links, 0.5, &mut moving, search).unwrap();
        assert_close(found, bracketed, 1e-14);
        assert!(closing.excess(links).abs() < 1e-15);
    }
    let search = Search {
        start: 1.0,
        step: 1e-3,
        within: 10.0,
    };
    let error = close_nearest(pitch, 0.0, 50, 0.5, &mut moving, search).unwrap_err();
    assert!(matches!(
        error,
        GeometryError::DoesNotClose { links: 50, .. }
    ));
}

/// A chain that does not close is told where it would: of two sprockets the centre distance, of more the place of one.
#[test]
fn a_chain_that_does_not_close_is_told_where_it_would() {
    let told = |wheels: &[Wheel], pitch, links| {
        chaindrive_geometry::close_by_strain(wheels, pitch, links, 0.5).unwrap_err()
    };
    let pitch = 12.7e-3;
    let error = told(&pair(19, 38, 0.4, pitch), pitch, 90);
    let GeometryError::DoesNotClose { remedy, .. } = &error else {
        panic!("{error}")
    };
    let remedy = remedy.as_deref().unwrap();
    let distance = remedy.centre_distance.unwrap();
    let smooth = TwoWheels {
        teeth: [19, 38],
        pitch,
    };
    // The smooth formula knows no polygon: some (π/z)² of a pitch.
    assert_close(distance, smooth.centre_distance(90.0).unwrap(), 1e-4);
    let fitting = pair(19, 38, distance, pitch);
    let counts = LinkCounts::around(&fitting, pitch, 0.5).unwrap();
    assert_eq!((counts.below, counts.above), (90, 90));
    assert_close(counts.pitches, 90.0, 1e-12);
    let text = error.to_string();
    let mentioned = format!("a centre distance of {:.4} mm", distance * 1e3);
    assert!(text.contains(&mentioned), "{text}");
    assert!(text.contains("91 need an offset link"), "{text}");

    let wheels = marine(1.3);
    let error = told(&wheels, 0.0889, 122);
    let text = error.with_names(&|wheel| ["`crank`", "`cam`", "`tight`", "`idle`"][wheel].into());
    assert!(
        text.contains("move `c") || text.contains("move `t"),
        "{text}"
    );
    let GeometryError::DoesNotClose { remedy, .. } = error else {
        panic!("{text}")
    };
    let remedy = remedy.unwrap();
    let mut moved = wheels;
    moved[remedy.wheel].centre = remedy.centre;
    assert!(chaindrive_geometry::close_by_strain(&moved, 0.0889, 122, 0.5).is_ok());
}

/// More wrap than the neighbours leave room for is refused with the angle that is reached.
#[test]
fn an_idler_that_cannot_be_wrapped_so_far_is_refused() {
    let route = Route::taut(&pair(30, 30, 0.24, TIMING_PITCH)).unwrap();
    let idler = Wheel::toothed(Point::origin(), 12, TIMING_PITCH, Side::Right);
    let asked = |wrap: f64| IdlerByWrap {
        span: 0,
        share: 0.5,
        wrap: wrap.to_radians(),
    };
    let (wheels, push) = asked(40.0).into(&route, idler).unwrap();
    // By symmetry: the spans leave by half the wrap, from the middle of the circles.
    assert!(push > 0.0 && wheels.len() == 3);
    let taut = Route::taut(&wheels).unwrap();
    assert_close(taut.wraps[1].to_degrees(), 40.0, 1e-10);
    let error = asked(179.0).into(&route, idler).unwrap_err();
    let GeometryError::Wrap { reached, .. } = error else {
        panic!("{error}")
    };
    assert!((40.0..90.0).contains(&reached), "{error}");
    assert!(asked(200.0).into(&route, idler).is_err());
    assert!(
        IdlerByWrap {
            span: 2,
            ..asked(40.0)
        }
        .into(&route, idler)
        .is_err()
    );
}
