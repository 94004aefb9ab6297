//! Duties of every friction law, and the values of each.

use chaindrive_contact::Friction;
use chaindrive_contact::friction::{
    Ambrosio, BengisuAkay, BrownMcphee, Coulomb, Lugre, SpringSlider, Stribeck, Threlfall,
};

const NORMAL: f64 = 1e3;

/// Slips \[m/s\] on both sides of rest, none of them at a kink of a specimen.
fn slips() -> impl Iterator<Item = f64> {
    (-60..=60).map(|i| 1.37e-3 * f64::from(i))
}

#[test]
fn specimens_pass_their_own_check() {
    for friction in Friction::specimens() {
        friction.check().unwrap();
    }
}

#[test]
fn opposes_slip_and_is_bounded() {
    for friction in Friction::specimens() {
        for slip in slips() {
            let force = friction.force(NORMAL, slip);
            assert!(force * slip <= 0.0, "{friction:?} opposes");
            assert!(force.abs() <= 120.0, "{friction:?} is bounded by μ_s N");
            let mirrored = friction.force(NORMAL, -slip);
            assert!((force + mirrored).abs() < 1e-12, "{friction:?} is odd");
            // Oil needs no load.
            let oil = match friction {
                Friction::Stribeck(law) => law.oil() * slip.abs(),
                _ => 0.0,
            };
            assert!(friction.force(0.0, slip).abs() <= oil + f64::MIN_POSITIVE);
        }
        assert!(friction.force(NORMAL, 0.0).abs() < f64::MIN_POSITIVE);
    }
}

/// Laws with a static peak fall beyond it; the others never do.
#[test]
fn only_a_static_peak_falls() {
    for friction in Friction::specimens() {
        let peaked = matches!(
            friction,
            Friction::BengisuAkay(_)
                | Friction::BrownMcphee(_)
                | Friction::Lugre(_)
                | Friction::Stribeck(_)
        );
        let forces: Vec<f64> = slips().map(|slip| friction.force(NORMAL, slip)).collect();
        let monotone = forces.windows(2).all(|pair| pair[1] <= pair[0] + 1e-12);
        assert_eq!(monotone, !peaked, "{friction:?}");
    }
}

#[test]
fn damping_is_the_slope_where_it_resists() {
    for friction in Friction::specimens() {
        for slip in slips() {
            if slip.abs() < 1e-6 && friction.has_state() {
                continue; // the steady state jumps
            }
            if slip.abs() < 1e-6 && matches!(friction, Friction::Ambrosio(_)) {
                assert!(friction.damping(NORMAL, slip).abs() < f64::MIN_POSITIVE);
                continue;
            }
            let h = 1e-9;
            let slope =
                (friction.force(NORMAL, slip + h) - friction.force(NORMAL, slip - h)) / (2.0 * h);
            let damping = friction.damping(NORMAL, slip);
            let error = ((-slope).max(0.0) - damping).abs();
            assert!(
                error < 1e-2 + 1e-5 * damping,
                "{friction:?} at {slip}: {slope} {damping}"
            );
            assert!(damping >= 0.0);
        }
    }
}

/// |f|/N after Ambrósio, Threlfall, Bengisu–Akay and Brown–McPhee for μ = 0.1, μ_s = 0.15 and 1 mm/s,
/// from the printed formulas in another language.
#[test]
fn values_of_the_printed_formulas() {
    const TABLE: [[f64; 5]; 9] = [
        [1e-05, 0.0, 0.002_955_446_645, 0.002_985, 0.004_886_697_664],
        [0.0001, 0.0, 0.025_918_177_932, 0.028_5, 0.046_824_820_84],
        [
            0.0005,
            0.044_444_444_444,
            0.077_686_983_985,
            0.112_5,
            0.134_272_580_493,
        ],
        [
            0.00099,
            0.098_888_888_889,
            0.094_869_668_967,
            0.149_985,
            0.149_923_570_938,
        ],
        [0.001, 0.1, 0.095_021_293_163, 0.15, 0.149_932_929_974],
        [0.002, 0.1, 0.095, 0.130_326_532_986, 0.132_653_038_717],
        [0.005, 0.1, 0.095, 0.106_766_764_162, 0.105_102_040_816],
        [0.01, 0.1, 0.095, 0.100_555_449_827, 0.100_754_076_727],
        [0.1, 0.1, 0.095, 0.1, 0.100_000_799_52],
    ];
    let laws = [
        Friction::Ambrosio(Ambrosio {
            coefficient: 0.1,
            lower_speed: 1e-4,
            upper_speed: 1e-3,
        }),
        Friction::Threlfall(Threlfall {
            coefficient: 0.1,
            slip_speed: 1e-3,
        }),
        Friction::BengisuAkay(BengisuAkay {
            static_coefficient: 0.15,
            coefficient: 0.1,
            slip_speed: 1e-3,
            decay: 500.0,
        }),
        Friction::BrownMcphee(BrownMcphee::dry(0.15, 0.1, 1e-3)),
    ];
    for [slip, expected @ ..] in TABLE {
        for (law, expected) in laws.iter().zip(expected) {
            let force = law.force(2.0, slip);
            assert!(
                (force + 2.0 * expected).abs() < 3e-12,
                "{law:?} at {slip}: {force}"
            );
        }
    }
}

/// The peak of Brown and McPhee's curve: 0.9995 μ_s at 1.007 v_t; and its viscous part is μ_v v under load.
#[test]
fn peak_and_viscous_part_of_brown_and_mcphee() {
    let dry = BrownMcphee::dry(0.15, 0.1, 1e-3);
    let (slip, peak) = (1..5000)
        .map(|i| 1e-6 * f64::from(i))
        .map(|slip| (slip, -dry.force(1.0, slip)))
        .fold(
            (0.0, 0.0),
            |best, here| if here.1 > best.1 { here } else { best },
        );
    assert!((peak / 0.15 - 0.9995).abs() < 1e-4, "{peak}");
    assert!((slip / 1e-3 - 1.007).abs() < 2e-3, "{slip}");
    let wet = BrownMcphee {
        viscosity: 20.0,
        transition_force: 10.0,
        ..dry
    };
    let viscous = dry.force(1e3, 0.5) - wet.force(1e3, 0.5);
    assert!((viscous - 10.0).abs() < 1e-9, "{viscous}");
}

/// All laws with one coefficient agree far from rest.
#[test]
fn coulombs_limit() {
    for friction in Friction::specimens() {
        let force = -friction.force(NORMAL, 10.0);
        let expected = match friction {
            Friction::None => 0.0,
            Friction::Coulomb(Coulomb { coefficient, .. }) => coefficient * NORMAL,
            Friction::Threlfall(_) => 95.0,
            // Oil bears nearly all.
            Friction::Stribeck(law) => {
                10.0 * law.oil() + 100.0 / (1.0 + (10.0 * law.fading() / NORMAL).powi(2))
            }
            _ => 100.0,
        };
        assert!((force - expected).abs() < 1e-3, "{friction:?}: {force}");
    }
}

/// A spring up to μ N, then Coulomb's law at any speed; back again it unloads as a spring, and a load that falls lets it go.
#[test]
fn a_spring_and_a_slider_hold_and_slide() {
    let law = Friction::SpringSlider(SpringSlider {
        coefficient: 0.1,
        stiffness: 1e8,
    });
    let (dt, yields) = (1e-5, 0.1 * NORMAL / 1e8);
    let speed = 0.25 * yields / dt;
    let mut state = 0.0;
    for k in 1..=8 {
        let rub = law.rub(NORMAL, speed, state, dt);
        let expected = 1e8 * yields * (0.25 * f64::from(k)).min(1.0);
        assert!((rub.force + expected).abs() < 1e-9, "{k}: {}", rub.force);
        assert_eq!(rub.damping > 0.0, k < 4, "{k}");
        state = rub.state;
    }
    let back = law.rub(NORMAL, -speed, state, dt);
    assert!((back.force + 0.075 * NORMAL).abs() < 1e-9, "{}", back.force);
    let eased = law.rub(0.5 * NORMAL, 0.0, state, dt);
    assert!(
        (eased.force + 0.05 * NORMAL).abs() < 1e-9,
        "{}",
        eased.force
    );
}

const BRISTLES: Lugre = Lugre {
    static_coefficient: 0.15,
    coefficient: 0.1,
    slip_speed: 1e-3,
    stiffness: 1e5,
    damping: 30.0,
    viscosity: 0.4,
};

/// After a long step the force is that of the Stribeck curve, whatever the deflection was.
#[test]
fn bristles_come_to_their_steady_state() {
    let friction = Friction::Lugre(BRISTLES);
    for slip in [-0.1, -2e-3, 1e-5, 2e-3, 0.3] {
        let rub = friction.rub(NORMAL, slip, -1e-6, 10.0);
        let steady = friction.force(NORMAL, slip);
        assert!(
            (rub.force / steady - 1.0).abs() < 1e-12,
            "{slip}: {}",
            rub.force
        );
        assert!(rub.state * slip > 0.0);
    }
}

/// One long step is many short ones, and many short ones are the differential equation.
#[test]
fn bristles_follow_their_equation() {
    let friction = Friction::Lugre(BRISTLES);
    let (slip, span, steps) = (2e-3, 4e-4, 20_000);
    let h = span / f64::from(steps);
    let level = 0.1 + 0.05 * (-4.0_f64).exp();
    let (mut kept, mut euler) = (3e-7, 3e-7);
    for _ in 0..steps {
        kept = friction.rub(NORMAL, slip, kept, h).state;
        euler += h * (slip - 1e5 * slip * euler / level);
    }
    let once = friction.rub(NORMAL, slip, 3e-7, span).state;
    assert!((kept / once - 1.0).abs() < 1e-11, "{kept} {once}");
    assert!((euler / once - 1.0).abs() < 1e-3, "{euler} {once}");
}

/// Below the limit the contact is a spring: no creep under a constant displacement.
#[test]
fn bristles_stick() {
    let friction = Friction::Lugre(BRISTLES);
    let moved = friction.rub(NORMAL, 1e-6, 0.0, 0.1);
    let expected = 1e5 * 1e-7 * NORMAL;
    let held = friction.rub(NORMAL, 0.0, moved.state, 1e3);
    assert!((held.force / -expected - 1.0).abs() < 0.1, "{}", held.force);
    assert!((held.state / moved.state - 1.0).abs() < 1e-15);
}

/// The damping of a step is the derivative of its force, where it resists.
#[test]
fn damping_of_a_step_is_the_slope_of_its_force() {
    let friction = Friction::Lugre(BRISTLES);
    for slip in [-3e-3_f64, -4e-4, -1e-5, 2e-5, 7e-4, 2e-3, 0.05] {
        for state in [-1e-6, 0.0, 8e-7] {
            for dt in [0.0, 1e-6, 1e-4, 1e-2] {
                let at = |slip: f64| friction.rub(NORMAL, slip, state, dt).force;
                let h = 1e-4 * slip.abs();
                let slope = (8.0 * (at(slip + h) - at(slip - h))
                    - (at(slip + 2.0 * h) - at(slip - 2.0 * h)))
                    / (12.0 * h);
                let damping = friction.rub(NORMAL, slip, state, dt).damping;
                let error = ((-slope).max(0.0) - damping).abs();
                assert!(
                    error <= 1e-6 * damping + 1e-3,
                    "{slip}, {state}, {dt}: {slope} {damping}"
                );
            }
        }
    }
    // At rest the mean of both sides.
    let rest = friction.rub(NORMAL, 0.0, 5e-7, 1e-6).damping;
    let sides = [-1e-12, 1e-12].map(|slip| friction.rub(NORMAL, slip, 5e-7, 1e-6).damping);
    assert!((rest / (0.5 * (sides[0] + sides[1])) - 1.0).abs() < 1e-6);
}

/// Boundary: Coulomb's coefficient. Hydrodynamic: Petroff's torque, M = 2 π η ω r³ L/c, at any load. Mixed: the friction is least where
/// dμ/dS = 0, that is 2 x/(1 + x²)² = π S_t/(ψ μ) beyond its own greatest value, x = S/S_t.
#[test]
fn a_lubricated_journal_has_three_branches() {
    let law = Stribeck {
        coefficient: 0.12,
        transition: 2e-6,
        viscosity: 0.08,
        length: 0.025,
        relative_clearance: 0.004,
        stiffness: 1e8,
    };
    let (radius, load) = (0.007, 3e3);
    let friction = Friction::Stribeck(law);
    // Slip at a Hersey number η ω/P with P = N/(2 r L).
    let slip = |hersey: f64, load: f64| {
        hersey * load / (2.0 * radius * law.length) / law.viscosity * radius
    };
    let coefficient = |hersey: f64| -friction.force(load, slip(hersey, load)) / load;
    assert!((coefficient(1e-12) / 0.12 - 1.0).abs() < 1e-5);

    for load in [1.0, load, 2e4] {
        // There 1e-8 of the friction of metal is left: it fades with the square.
        let hersey = 1e4 * law.transition;
        let speed = slip(hersey, load) / radius;
        let clearance = law.relative_clearance * radius;
        let petroff =
            2.0 * std::f64::consts::PI * law.viscosity * speed * radius.powi(3) * law.length
                / clearance;
        let torque = -radius * friction.force(load, radius * speed);
        assert!((torque / petroff - 1.0).abs() < 1e-9, "{torque} {petroff}");
    }

    let steepness = std::f64::consts::PI * law.transition / (law.relative_clearance * 0.12);
    let (mut low, mut high) = (1.0_f64, 1e3);
    for _ in 0..60 {
        let x = 0.5 * (low + high);
        if 2.0 * x / (1.0 + x * x).powi(2) > steepness {
            low = x;
        } else {
            high = x;
        }
    }
    let least = low * law.transition;
    let at = coefficient(least);
    assert!(at < coefficient(0.99 * least) && at < coefficient(1.01 * least));
    let metal = 0.12 / (1.0 + low * low);
    let expected = metal + std::f64::consts::PI * least / law.relative_clearance;
    assert!((at / expected - 1.0).abs() < 1e-12);
    assert!(friction.damping(load, slip(0.9 * least, load)) <= 0.0);
    assert!(friction.damping(load, slip(1.1 * least, load)) > 0.0);
}

/// It holds as a spring and slides as its curve says.
#[test]
fn a_lubricated_journal_holds_and_slides() {
    let Some(friction) = Friction::specimens()
        .into_iter()
        .find(|law| matches!(law, Friction::Stribeck(_)))
    else {
        panic!("no specimen");
    };
    let held = friction.rub(NORMAL, 1e-4, 0.0, 1e-4);
    let (spring, oil) = (
        1e8 * 1e-8,
        2.0 * std::f64::consts::PI * 0.05 * 0.02 / 0.01 * 1e-4,
    );
    assert!((-held.force / (spring + oil) - 1.0).abs() < 1e-12);
    for slip in [-0.3, 1e-3, 0.7] {
        let sliding = friction.rub(NORMAL, slip, 0.0, 1.0);
        let steady = friction.force(NORMAL, slip);
        assert!((sliding.force / steady - 1.0).abs() < 1e-12);
    }
    let loose = friction.rub(0.0, 1.0, 1e-7, 1e-6);
    assert!(loose.state.abs() <= 0.0 && loose.force < 0.0);
}

/// f(κ N, v), of every law with and without a state.
#[test]
fn pressures_that_sum_to_more_than_the_force_rub_more() {
    for friction in Friction::specimens() {
        for factor in [1.0, 4.0 / std::f64::consts::PI, std::f64::consts::FRAC_PI_2] {
            let pressed = friction.pressed(factor).unwrap();
            for slip in [-0.2, -1e-3, 3e-4, 0.05] {
                for state in [0.0, 3e-7] {
                    let all = friction.rub(factor * NORMAL, slip, state, 1e-4);
                    let found = pressed.rub(NORMAL, slip, state, 1e-4);
                    for (found, expected) in [
                        (found.force, all.force),
                        (found.damping, all.damping),
                        (found.state, all.state),
                    ] {
                        assert!(
                            (found - expected).abs() <= 1e-12 * expected.abs(),
                            "{friction:?} {factor} {slip}: {found} {expected}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn laws_without_memory_ignore_it() {
    for friction in Friction::specimens() {
        if friction.has_state() {
            continue;
        }
        let rub = friction.rub(NORMAL, 0.02, 1e-3, 1.0);
        let [force, damping] = [friction.force(NORMAL, 0.02), friction.damping(NORMAL, 0.02)];
        assert_eq!((rub.force, rub.damping, rub.state), (force, damping, 0.0));
    }
}

#[test]
fn parameters_out_of_range_are_named() {
    let refused = |text: &str| {
        let friction: Friction = serde_json::from_str(text).unwrap();
        friction.check().unwrap_err().to_string()
    };
    for (text, message) in [
        (
            r#"{"kind": "ambrosio", "coefficient": 0.1, "lower_speed": 2.0, "upper_speed": 1.0}"#,
            "upper_speed = 1, must be above lower_speed [m/s]",
        ),
        (
            r#"{"kind": "brown-mcphee", "static_coefficient": 0.1, "coefficient": 0.2, "slip_speed": 1.0,
                "viscosity": 0.0, "transition_force": 1.0}"#,
            "static_coefficient = 0.1, must be at least the coefficient of sliding",
        ),
        (
            r#"{"kind": "threlfall", "coefficient": -0.1, "slip_speed": 1.0}"#,
            "coefficient = -0.1, must be not negative",
        ),
    ] {
        assert_eq!(refused(text), message);
    }
    let unknown = r#"{"kind": "threlfall", "coefficient": 0.1, "slip_speed": 1.0, "decay": 3.0}"#;
    assert!(serde_json::from_str::<Friction>(unknown).is_err());
    for friction in Friction::specimens() {
        let text = serde_json::to_string(&friction).unwrap();
        assert_eq!(serde_json::from_str::<Friction>(&text).unwrap(), friction);
    }
}
