//! Any drive: the chain never turns the wrong way, and never further than one tooth at a roller.

use std::f64::consts::{PI, TAU};

use chaindrive_geometry::{
    Closing, Point, Route, Side, Vector, Wheel, close_by_motion, close_by_strain,
};
use proptest::prelude::*;

/// Wheels on a ring about the origin, wide apart, every one touched from outside by the chain.
fn ring() -> impl Strategy<Value = Vec<Wheel>> {
    prop::collection::vec((5_u32..40, 0.9..1.1_f64, -0.2..0.2_f64), 2..6).prop_map(|wheels| {
        let share = TAU / wheels.len() as f64;
        let wheel = |(i, (teeth, distance, shift)): (usize, (u32, f64, f64))| {
            let (angle, distance) = (share * (i as f64 + shift), 16.3 * distance);
            let centre = Point::new(distance * angle.cos(), distance * angle.sin());
            Wheel::toothed(centre, teeth, 1.0, Side::Left)
        };
        wheels.into_iter().enumerate().map(wheel).collect()
    })
}

/// The same with guides: some of the wheels smooth, and shoes that press on spans from outside.
#[derive(Clone, Debug)]
struct Guided {
    wheels: Vec<Wheel>,
    /// Radius of the shoe after a wheel, and how far it presses on the span there.
    shoes: Vec<Option<(f64, f64)>>,
}

fn guided() -> impl Strategy<Value = Guided> {
    let shoe = prop::option::of((20.0..80.0_f64, 0.4..1.0_f64));
    let each = (prop::bool::weighted(0.3), 1.0..6.0_f64, shoe);
    (ring(), prop::collection::vec(each, 6)).prop_map(|(mut wheels, extras)| {
        // The first wheel gives the phase, so it has teeth.
        for (wheel, (smooth, radius, _)) in wheels.iter_mut().zip(&extras).skip(1) {
            if *smooth {
                *wheel = Wheel::smooth(wheel.centre, *radius, Side::Left);
            }
        }
        let shoes = extras.into_iter().map(|(.., shoe)| shoe).collect();
        Guided { wheels, shoes }
    })
}

impl Guided {
    /// The route with the wheels spread by a factor, the shoes as deep in the spans as ever.
    fn spread(&self, scale: f64) -> Vec<Wheel> {
        let away = |wheel: &Wheel| Wheel {
            centre: wheel.centre * scale,
            ..*wheel
        };
        let wheels: Vec<Wheel> = self.wheels.iter().map(away).collect();
        let Ok(taut) = Route::taut(&wheels) else {
            return Vec::new();
        };
        let mut route = Vec::new();
        for ((wheel, span), shoe) in wheels.iter().zip(&taut.spans).zip(&self.shoes) {
            route.push(*wheel);
            if let Some((radius, push)) = shoe {
                let middle = span.leaves + (span.arrives - span.leaves) * 0.5;
                let outward = Vector::new(span.direction.sin(), -span.direction.cos());
                let centre = middle + outward * (radius - push);
                route.push(Wheel::smooth(centre, *radius, Side::Right));
            }
        }
        route
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Links of a chain around sprockets and guides are one pitch long to 1e-12, rollers sit on their circles in the order of travel,
    /// and the chain turns towards the wheel that it is on, by no more than one of its pitch angles.
    #[test]
    fn a_loop_around_sprockets_and_guides_closes(guided in guided(), phase in 0.0..1.0_f64) {
        // Wheels overlap, or a shoe hides a neighbour; hardly any, or proptest gives up.
        let closing = Closing::march(&guided.spread(1.0), 1.0, phase);
        prop_assume!(closing.is_ok());
        let links = closing.unwrap().links + 1;
        let mut moving = |scale| guided.spread(scale);
        let found = close_by_motion(1.0, 0.0, links, phase, &mut moving, (1.0, 1.1));
        prop_assume!(found.is_ok());
        let (_, wheels, closed) = found.unwrap();
        // A shoe that the chain bends round by hardly more than a pitch may lie between two rollers, and touch neither.
        let wraps = Route::taut(&wheels).unwrap().wraps;
        let bends = |(wheel, wrap): (&Wheel, &f64)| wheel.side == Side::Left || *wrap > 2.0 * TAU / wheel.teeth(1.0);
        prop_assume!(wheels.iter().zip(&wraps).all(bends));
        let places = closed.positions(&wheels, closed.pitch).unwrap();
        let n = places.len();
        prop_assert_eq!(n, links as usize);
        let edge = |i: usize| places[(i + 1) % n].position - places[i % n].position;
        let mut turned = 0.0;
        for i in 0..n {
            let length = edge(i).norm();
            prop_assert!((length - 1.0).abs() < 1e-12, "link {i} is {length} long");
            let (before, behind) = (edge(i), edge(i + 1));
            let turn = before.perp(&behind).atan2(before.dot(&behind));
            let (least, most) = match places[(i + 1) % n].on {
                None => (0.0, 0.0),
                Some((on, _)) => {
                    let wheel = &wheels[on];
                    let off = (places[(i + 1) % n].position - wheel.centre).norm() - wheel.radius;
                    prop_assert!(off.abs() < 1e-12, "{off} off the circle");
                    let angle = wheel.sense() * TAU / wheel.teeth(1.0);
                    (angle.min(0.0), angle.max(0.0))
                }
            };
            prop_assert!((least - 1e-9..=most + 1e-9).contains(&turn), "{least} < {turn} < {most}");
            turned += turn;
        }
        prop_assert!((turned - 2.0 * PI).abs() < 1e-9);
        // Once around, in the order of the route.
        let order: Vec<usize> = places.iter().filter_map(|place| place.on).map(|(on, _)| on).collect();
        prop_assert!(order.is_sorted(), "{order:?}");
    }

    #[test]
    fn a_loop_around_wheels_is_convex(wheels in ring(), phase in 0.0..1.0_f64) {
        let Ok(closing) = Closing::march(&wheels, 1.0, phase) else {
            // Overlapping or untouched wheels.
            prop_assert!(Route::taut(&wheels).is_err());
            return Ok(());
        };
        // Spreading the wheels closes a chain of any length without strain.
        let mut spread = |scale: f64| {
            let away = |wheel: &Wheel| Wheel { centre: wheel.centre * scale, ..*wheel };
            wheels.iter().map(away).collect::<Vec<_>>()
        };
        let links = closing.links + 1;
        let (_, wheels, closed) =
            close_by_motion(1.0, 0.0, links, phase, &mut spread, (1.0, 1.1)).unwrap();
        prop_assert!(closed.residual.abs() < 1e-12);
        let places = closed.positions(&wheels, closed.pitch).unwrap();
        prop_assert_eq!(places.len(), links as usize);
        let n = places.len();
        let edge = |i: usize| places[(i + 1) % n].position - places[i % n].position;
        let mut turned = 0.0;
        for i in 0..n {
            let (before, behind) = (edge(i), edge(i + 1));
            let turn = before.perp(&behind).atan2(before.dot(&behind));
            let most = places[(i + 1) % n].on.map_or(0.0, |(wheel, _)| TAU / wheels[wheel].teeth(1.0));
            prop_assert!((-1e-9..=most + 1e-9).contains(&turn), "turn {turn} of at most {most}");
            turned += turn;
        }
        prop_assert!((turned - 2.0 * PI).abs() < 1e-9);
    }

    #[test]
    fn strain_leaves_no_more_than_the_misfit_of_one_seat(wheels in ring(), phase in 0.0..1.0_f64) {
        let Ok(closing) = Closing::march(&wheels, 1.0, phase) else { return Ok(()) };
        let (strain, closed) = close_by_strain(&wheels, 1.0, closing.links, phase).unwrap();
        prop_assert_eq!(closed.links, closing.links);
        prop_assert!(closed.excess(closing.links).abs() <= strain.abs() + 1e-12);
    }
}
