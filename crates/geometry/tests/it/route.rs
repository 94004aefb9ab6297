//! Taut routes: what is refused, and the smooth formulas of two wheels.

use crate::drives;

use chaindrive_geometry::{
    Closing, GeometryError, Point, Route, Side, TwoWheels, Wheel, close_by_motion, close_by_strain,
};
use drives::{assert_close, pair};

#[test]
fn impossible_routes_are_refused() {
    use GeometryError as E;
    use Side::{Left, Right};

    let wheel = |x, side| Wheel::toothed(Point::new(x, 0.0), 17, 0.0127, side);
    let refused = |wheels: &[Wheel]| Route::taut(wheels).unwrap_err();

    assert!(matches!(
        refused(&[wheel(0.0, Left)]),
        E::TooFewWheels { wheels: 1 }
    ));
    assert!(matches!(refused(&[]), E::TooFewWheels { wheels: 0 }));
    let overlapping = [wheel(0.0, Left), wheel(0.2, Left), wheel(0.05, Left)];
    assert!(matches!(
        refused(&overlapping),
        E::WheelsOverlap {
            first: 0,
            second: 2,
            ..
        }
    ));
    // A chain cannot cross itself in its plane.
    assert!(matches!(
        refused(&[wheel(0.0, Left), wheel(0.3, Right)]),
        E::RouteTurns { .. }
    ));
    // An idler that hangs clear of the chain.
    let mut idler = wheel(0.15, Left);
    idler.centre.y = -0.005;
    idler.radius = 0.01;
    assert!(matches!(
        refused(&[wheel(0.0, Left), idler, wheel(0.3, Left)]),
        E::RouteTurns { wheel: 1, .. }
    ));
    // A guide circle that swallows the next wheel.
    let guide = Wheel::smooth(Point::new(0.2, 0.0), 0.5, Right);
    assert!(matches!(
        refused(&[wheel(0.0, Left), guide]),
        E::NoTangent { from: 0, to: 1, .. }
    ));

    for broken in [f64::NAN, f64::INFINITY, -0.1, 0.0] {
        let bad = Wheel {
            radius: broken,
            ..wheel(0.3, Left)
        };
        assert!(matches!(
            refused(&[wheel(0.0, Left), bad]),
            E::Wheel { wheel: 1, .. }
        ));
    }
    for broken in [f64::NAN, f64::INFINITY] {
        assert!(matches!(
            refused(&[wheel(0.0, Left), wheel(broken, Left)]),
            E::Wheel { wheel: 1, .. }
        ));
        let sound = [wheel(0.0, Left), wheel(0.3, Left)];
        assert!(Closing::march(&sound, broken, 0.5).is_err());
        assert!(Closing::march(&sound, 0.0127, broken).is_err());
        assert!(close_by_strain(&sound, broken, 64, 0.5).is_err());
        assert!(
            close_by_motion(
                0.0127,
                broken,
                64,
                0.5,
                &mut |x| pair(17, 17, x, 0.0127),
                (0.2, 0.3)
            )
            .is_err()
        );
        assert!(
            close_by_motion(
                0.0127,
                0.0,
                64,
                0.5,
                &mut |x| pair(17, 17, x, 0.0127),
                (0.2, broken)
            )
            .is_err()
        );
    }
    // A pitch in millimetres.
    assert!(Closing::march(&[wheel(0.0, Left), wheel(0.3, Left)], 12.7, 0.5).is_err());
}

/// The smooth formulas are inverses of one another, and agree with the route.
#[test]
fn smooth_two_wheel_formulas_agree_with_the_route() {
    for teeth in [[15, 45], [17, 17], [19, 57], [57, 19], [44, 18], [9, 60]] {
        let drive = TwoWheels {
            teeth,
            pitch: 0.0127,
        };
        for links in [100.0, 120.5, 300.0] {
            let centre = drive.centre_distance(links).unwrap();
            assert_close(drive.links(centre).unwrap(), links, 1e-11);
            let route = Route::taut(&pair(teeth[0], teeth[1], centre, 0.0127)).unwrap();
            assert_close(route.pitches(0.0127), links, 1e-11);
            assert!(route.length() > links * 0.0127);
        }
    }
    let drive = TwoWheels {
        teeth: [20, 63],
        pitch: 0.0127,
    };
    assert!(matches!(
        drive.centre_distance(40.0),
        Err(GeometryError::TooFewLinks { .. })
    ));
    assert!(drive.centre_distance(f64::NAN).is_err());
    assert!(drive.links(f64::INFINITY).is_err());
    assert!(drive.links(0.01).is_err());
}
