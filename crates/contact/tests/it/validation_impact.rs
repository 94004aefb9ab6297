//! A mass thrown at a wall (validation cases C01, C02, C03).

use chaindrive_contact::dissipation::LankaraniNikravesh;
use chaindrive_contact::elastic::{ElasticLaw, Johnson, Power};
use chaindrive_contact::restitution::delivered;
use chaindrive_contact::{Approach, Dissipation, Elastic, Law};
use chaindrive_validation::Case;
use chaindrive_validation::Tolerance::{Absolute, Relative};

/// Depth, force, duration and speed of an impact.
#[derive(Clone, Copy, Debug)]
struct Impact {
    penetration: f64,
    force: f64,
    duration: f64,
    exit_speed: f64,
}

/// Integrates m δ'' = −F(δ, δ') from the first touch to the last with the classical Runge–Kutta method.
fn impact(law: Law, mass: f64, speed: f64) -> Impact {
    let force = |[penetration, rate]: [f64; 2]| {
        law.force(Approach {
            penetration,
            rate,
            onset_rate: speed,
        })
    };
    let slope = |y: [f64; 2]| [y[1], -force(y) / mass];
    let ahead = |y: [f64; 2], k: [f64; 2], h: f64| [y[0] + h * k[0], y[1] + h * k[1]];
    let step = |y: [f64; 2], h: f64| {
        let k1 = slope(y);
        let k2 = slope(ahead(y, k1, 0.5 * h));
        let k3 = slope(ahead(y, k2, 0.5 * h));
        let k4 = slope(ahead(y, k3, h));
        let k = [0, 1].map(|i| (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]) / 6.0);
        ahead(y, k, h)
    };
    // A two-thousandth of the quarter period at the depth the energy allows.
    let mut depth = 1e-12;
    while law.energy(depth) < 0.5 * mass * speed * speed {
        depth *= 1.01;
    }
    let h = 5e-4 * depth / speed;

    let (mut y, mut t) = ([0.0, speed], 0.0);
    let mut found = Impact {
        penetration: 0.0,
        force: 0.0,
        duration: 0.0,
        exit_speed: 0.0,
    };
    loop {
        let next = step(y, h);
        found.penetration = found.penetration.max(next[0]);
        found.force = found.force.max(force(next));
        if next[0] <= 0.0 {
            break;
        }
        (y, t) = (next, t + h);
    }
    // The last touch lies within this step.
    let (mut inside, mut outside) = (0.0, h);
    for _ in 0..50 {
        let middle = 0.5 * (inside + outside);
        if step(y, middle)[0] > 0.0 {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    found.duration = t + inside;
    found.exit_speed = -step(y, inside)[1];
    found
}

fn power(stiffness: f64, exponent: f64, dissipation: Dissipation) -> Law {
    Law {
        series: None,
        elastic: Elastic::Power(Power {
            stiffness,
            exponent,
        }),
        dissipation,
        onset_floor: 1e-6,
    }
}

fn lankarani_nikravesh(restitution: f64) -> Dissipation {
    Dissipation::LankaraniNikravesh(LankaraniNikravesh { restitution })
}

#[test]
fn c01_undamped_impact() {
    let case = Case::read("C01");
    let tolerance = Relative(case.number("tolerance.relative"));
    let inputs = case.table("inputs.rows");
    for (input, expected) in inputs.iter().zip(case.table("expected.rows")) {
        let [stiffness, exponent, mass, speed] = input[..] else {
            panic!("four inputs")
        };
        let law = power(stiffness, exponent, Dissipation::None);
        let found = impact(law, mass, speed);
        let judge = |quantity: &str, unit: &str, found, expected| {
            case.judge(quantity, unit, found, expected, tolerance);
        };
        judge("penetration", "m", found.penetration, expected[0]);
        judge("greatest force", "N", found.force, expected[1]);
        judge("duration", "s", found.duration, expected[2]);
        judge("exit speed", "m/s", found.exit_speed, speed);
    }
}

/// The factor alone decides: the closed form for every published factor.
#[test]
fn c02_closed_form() {
    let case = Case::read("C02");
    for name in case.names("expected.rows") {
        let inputs = case.table(&format!("inputs.rows.{name}"));
        let found: Vec<f64> = inputs.iter().map(|input| delivered(input[1])).collect();
        let expected = case.list(&format!("expected.rows.{name}"));
        let quantity = format!("restitution by the factor of {}", name.replace('_', " "));
        case.judge_each(&quantity, "", &found, &expected, Relative(1e-10));
    }
}

/// The same by integration, for elastic laws that have nothing in common.
#[test]
fn c02_restitution_of_lankarani_and_nikravesh() {
    let case = Case::read("C02");
    let tolerance = Absolute(case.number("tolerance.absolute"));
    let expected = case.list("expected.rows.lankarani_nikravesh");
    let elastic = [
        Elastic::Power(Power::linear(1e8)),
        Elastic::Power(Power {
            stiffness: 6.61e10,
            exponent: 1.5,
        }),
        Elastic::Johnson(Johnson::external(3.875e-3, 18.6e-3, 2.2e-3, 113.7e9)),
    ];
    let inputs = case.table("inputs.rows.lankarani_nikravesh");
    for (input, expected) in inputs.iter().zip(expected) {
        for elastic in elastic {
            let law = Law {
                series: None,
                elastic,
                dissipation: lankarani_nikravesh(input[0]),
                onset_floor: 1e-6,
            };
            let speed = 0.5;
            let found = impact(law, 5e-3, speed).exit_speed / speed;
            case.judge("restitution by integration", "", found, expected, tolerance);
        }
    }
}

#[test]
fn c03_history_of_an_impact() {
    let case = Case::read("C03");
    let input = |key: &str| case.number(&format!("inputs.{key}"));
    let law = power(input("K"), input("n"), lankarani_nikravesh(input("e")));
    let found = impact(law, input("m"), input("v0"));
    let judge = |quantity: &str, unit: &str, found, key: &str, tolerance: &str| {
        let expected = case.number(&format!("expected.{key}"));
        let tolerance = Relative(case.number(&format!("tolerance.{tolerance}")));
        case.judge(quantity, unit, found, expected, tolerance);
    };
    let depth = found.penetration;
    judge("penetration", "m", depth, "delta_max", "delta_max");
    judge("greatest force", "N", found.force, "F_max", "relative");
    judge("duration", "s", found.duration, "t_contact", "relative");
    let speed = found.exit_speed;
    judge("exit speed", "m/s", speed, "exit_speed", "exit_speed");
}

/// The upper limit on the hysteretic factor is out of reach of a free impact.
#[test]
fn limit_leaves_a_free_impact_alone() {
    let law = power(6.61e10, 1.5, lankarani_nikravesh(0.1));
    // Onset underestimated by half: the ratio starts at 2, below the limit of 4.
    let slow = Approach {
        penetration: 1e-6,
        rate: 1.0,
        onset_rate: 0.5,
    };
    let factor = law.force(slow) / law.elastic.force(1e-6);
    assert!((factor - (1.0 + 2.0 * 0.7425)).abs() < 1e-12);
}
