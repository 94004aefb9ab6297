//! Films of oil against Reynolds' equation, integrated in other ways, and against closed forms.

use chaindrive_contact::Film;

/// Roller and seat of a marine chain's sprocket: 26.99 mm in 27.26 mm.
const SEAT: Film = Film {
    viscosity: 0.05,
    pressure_coefficient: 0.0,
    radius: 26.99e-3 * 27.26e-3 / 0.27e-3,
    half_width: 14e-3,
    length: 53.3e-3,
    leakage_factor: Some(1.0),
    thickness: 100e-6,
    roughness: 0.8e-6,
    refill_time: 0.0,
};

/// Force \[N\] of a film that closes at a speed: p′ = −12 v x η/H³ from the edge inwards, by the midpoint rule; twice its half.
fn force(film: &Film, thickness: f64, speed: f64) -> f64 {
    let steps = 40_000_u32;
    // Places are dense where the film is thin.
    let scale = (2.0 * film.radius * thickness).sqrt();
    let end = (film.half_width / scale).asinh();
    let at = |share: f64| scale * (end * share).sinh();
    let (mut pressure, mut sum) = (0.0, 0.0);
    for i in (0..steps).rev() {
        let share = |it: f64| (f64::from(i) + it) / f64::from(steps);
        let [inner, middle, outer] = [0.0, 0.5, 1.0].map(|it| at(share(it)));
        let height = thickness + middle * middle / (2.0 * film.radius);
        let slope = |p: f64| {
            let viscosity = film.viscosity * (film.pressure_coefficient * p).exp();
            12.0 * speed * middle * viscosity / height.powi(3)
        };
        let way = outer - inner;
        let between = pressure + 0.5 * way * slope(pressure);
        pressure += way * slope(between);
        sum += way * between;
    }
    2.0 * film.leakage_factor.unwrap_or(1.0) * film.length * sum
}

/// Constant viscosity, thin and thick films, narrow and wide seats.
#[test]
fn a_film_drains_as_reynolds_equation_says() {
    for half_width in [3e-3, 8e-3, 14e-3, 23e-3] {
        let film = Film {
            half_width,
            leakage_factor: Some(0.8),
            ..SEAT
        };
        for thickness in [1e-6, 1e-5, 1e-4, 1e-3] {
            let force = force(&film, thickness, 0.3);
            let found = film.drain(force, thickness).speed;
            assert!(
                (found / 0.3 - 1.0).abs() < 2e-5,
                "{half_width} {thickness}: {found}"
            );
        }
    }
}

/// Viscosity under pressure, up to where the pressure grows without bound: to 1 %.
#[test]
fn a_film_stiffens_as_barus_says() {
    for half_width in [8e-3, 14e-3, 23e-3] {
        let film = Film {
            half_width,
            pressure_coefficient: 20e-9,
            ..SEAT
        };
        for thickness in [1e-6_f64, 1e-5, 1e-4, 3e-4] {
            // q_max = 6 η₀ v R (1/h² − 1/H_b²) = m/α
            let edge = thickness + half_width * half_width / (2.0 * film.radius);
            let sharp = thickness.powi(-2) - edge.powi(-2);
            let bound =
                1.0 / (film.pressure_coefficient * 6.0 * film.viscosity * film.radius * sharp);
            for share in [0.05, 0.3, 0.6, 0.9, 0.97] {
                let speed = share * bound;
                let force = force(&film, thickness, speed);
                let found = film.drain(force, thickness).speed;
                assert!(
                    (found / speed - 1.0).abs() < 0.01,
                    "{half_width} {thickness} {share}: {found} {speed}"
                );
            }
            // Whatever presses on it.
            let most = film.drain(1e9, thickness).speed;
            assert!((most / bound - 1.0).abs() < 0.01, "{most} {bound}");
        }
    }
}

/// The change with the force is that of the speed.
#[test]
fn the_slope_is_that_of_the_speed() {
    let film = Film {
        pressure_coefficient: 20e-9,
        ..SEAT
    };
    for thickness in [1e-6, 3e-5, 3e-4] {
        for force in [1.0, 1e3, 3e4, 9e4, 3e5] {
            let [less, more] = [-1e-6, 1e-6].map(|it| film.drain(force * (1.0 + it), thickness));
            let slope = (more.speed - less.speed) / (2e-6 * force);
            let found = film.drain(force, thickness).by_force;
            let scale = film.drain(force, thickness).speed / force;
            assert!((found - slope).abs() < 1e-6 * scale, "{thickness} {force}");
        }
    }
}

/// Time in which a constant load thins a film: t = 4 η λ L b³/F (1/h₂² − 1/h₁²) of plates, t = 6√2 π η λ L R^(3/2)/F (1/√h₂ − 1/√h₁) of a
/// cylinder on a plane (A. Cameron, Basic Lubrication Theory).
#[test]
fn a_constant_load_takes_its_time() {
    let load = 1e4;
    let time = |film: &Film, from: f64, to: f64| {
        // ∫ dh/v by Simpson's rule in ln h.
        let steps = 200_u32;
        let width = (from / to).ln() / f64::from(steps);
        let at = |i: u32| {
            let thickness = to * (width * f64::from(i)).exp();
            thickness / film.drain(load, thickness).speed
        };
        let weight = |i: u32| match i {
            0 | 200 => 1.0,
            _ if i % 2 == 1 => 4.0,
            _ => 2.0,
        };
        let sum: f64 = (0..=steps).map(|i| weight(i) * at(i)).sum();
        sum * width / 3.0
    };
    let strip = SEAT.viscosity * SEAT.length;
    let plates = Film {
        radius: 1e6,
        ..SEAT
    };
    let exact = 4.0 * strip * plates.half_width.powi(3) / load * (1e10 - 1e8 / 4.0);
    let found = time(&plates, 2e-4, 1e-5);
    assert!((found / exact - 1.0).abs() < 1e-3, "{found} {exact}");
    let cylinder = Film {
        radius: 0.027,
        half_width: 0.02,
        ..SEAT
    };
    let root = |thickness: f64| thickness.sqrt().recip();
    let exact =
        6.0 * std::f64::consts::SQRT_2 * std::f64::consts::PI * strip * cylinder.radius.powf(1.5)
            / load
            * (root(1e-7) - root(1e-6));
    let found = time(&cylinder, 1e-6, 1e-7);
    assert!((found / exact - 1.0).abs() < 1e-3, "{found} {exact}");
}

/// The force of rectangular plates is the stiffness in torsion of a bar of that section: 3 β of S. Timoshenko and J. N. Goodier, Theory of
/// Elasticity, table of § 109.
#[test]
fn ends_leak_as_a_bar_twists() {
    for (ratio, beta) in [
        (1.0, 0.1406),
        (1.5, 0.196),
        (2.0, 0.229),
        (3.0, 0.263),
        (5.0, 0.291),
        (10.0, 0.312),
    ] {
        let leakage = |half_width, length| {
            let plates = Film {
                half_width,
                length,
                radius: 1e9,
                leakage_factor: None,
                ..SEAT
            };
            share(&plates, 1e-3)
        };
        let (found, exact) = (leakage(0.005, 0.01 * ratio), 3.0 * beta);
        assert!((found / exact - 1.0).abs() < 0.01, "{ratio}: {found}");
        // With the other side for the strip.
        let wide = leakage(0.005 * ratio, 0.01) * ratio * ratio;
        assert!((wide / exact - 1.0).abs() < 0.01, "{ratio}: {wide}");
    }
}

/// Share of the force of one dimension: that of the speeds.
fn share(film: &Film, thickness: f64) -> f64 {
    let sealed = Film {
        leakage_factor: Some(1.0),
        ..*film
    };
    sealed.drain(1.0, thickness).speed / film.drain(1.0, thickness).speed
}

/// Two-dimensional solutions by finite volumes, 120 × 80 in a quarter of the seat.
#[test]
fn a_curved_film_leaks_as_in_two_dimensions() {
    let microns = [1.0, 10.0, 30.0, 100.0, 270.0];
    for (half_width, solutions) in [
        (8e-3, [0.948, 0.877, 0.844, 0.823, 0.816]),
        (14e-3, [0.945, 0.851, 0.785, 0.723, 0.693]),
        (23e-3, [0.944, 0.836, 0.745, 0.630, 0.556]),
    ] {
        let film = Film {
            half_width,
            leakage_factor: None,
            ..SEAT
        };
        for (thickness, solution) in microns.into_iter().zip(solutions) {
            let found = share(&film, thickness * 1e-6);
            assert!(
                (found / solution - 1.0).abs() < 0.045,
                "{half_width} {thickness}: {found}"
            );
        }
    }
}

#[test]
fn parameters_out_of_range_are_named() {
    SEAT.check().unwrap();
    let wrong = [
        Film {
            viscosity: 0.0,
            ..SEAT
        },
        Film {
            pressure_coefficient: -1e-9,
            ..SEAT
        },
        Film {
            radius: f64::INFINITY,
            ..SEAT
        },
        Film {
            half_width: -1.0,
            ..SEAT
        },
        Film {
            length: f64::NAN,
            ..SEAT
        },
        Film {
            leakage_factor: Some(1.2),
            ..SEAT
        },
        Film {
            thickness: 0.0,
            ..SEAT
        },
        Film {
            roughness: 0.0,
            ..SEAT
        },
        Film {
            refill_time: -1.0,
            ..SEAT
        },
    ];
    let names = [
        "viscosity",
        "pressure_coefficient",
        "radius",
        "half_width",
        "length",
        "leakage_factor",
        "thickness",
        "roughness",
        "refill_time",
    ];
    for (film, name) in wrong.into_iter().zip(names) {
        assert_eq!(film.check().unwrap_err().parameter, name);
    }
}
