//! Any drive: the chain never turns the wrong way, and never further than one tooth at a roller.

use std::f64::consts::{PI, TAU};

use chaindrive_geometry::{Closing, Point, Side, Wheel, close_by_motion, close_by_strain};
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

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn a_loop_around_wheels_is_convex(wheels in ring(), phase in 0.0..1.0_f64) {
        let Ok(closing) = Closing::march(&wheels, 1.0, phase) else {
            // Overlapping or untouched wheels.
            prop_assert!(chaindrive_geometry::Route::taut(&wheels).is_err());
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
