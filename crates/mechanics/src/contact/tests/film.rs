//! Masses that fall on oil, against a program that shares no code with the kernels.

use chaindrive_contact::{Dissipation, Elastic, Film, Friction, Law, elastic::Power};
use chaindrive_geometry::{Point, Vector};

use super::{RADIUS, Roller, flat_rail};
use crate::contact::MemoryField;
use crate::contact::film::LaneFilm;
use crate::surface::Surface;

/// A link of a marine chain that meets its seat.
const MASS: f64 = 3.01;
const SPEED: f64 = 1.06;
const HERTZ: f64 = 6e11;
const BEHIND: f64 = 4.37e9;

fn oil(thickness: f64, viscosity: f64, leakage_factor: f64) -> Film {
    Film {
        viscosity,
        pressure_coefficient: 20e-9,
        radius: 2.7,
        half_width: 14e-3,
        length: 53.3e-3,
        leakage_factor: Some(leakage_factor),
        thickness,
        roughness: 0.8e-6,
        refill_time: 0.0,
    }
}

fn law() -> Law {
    Law {
        elastic: Elastic::Power(Power {
            stiffness: HERTZ,
            exponent: 1.5,
        }),
        series: Some(BEHIND),
        dissipation: Dissipation::None,
        onset_floor: 0.01,
    }
}

fn roller(film: Option<Film>, height: f64) -> Roller {
    let surface = Surface {
        law: law(),
        friction: Friction::None,
        film,
    };
    Roller::new(flat_rail(surface), Point::new(0.0, RADIUS + height))
}

/// What an impact was.
#[derive(Clone, Copy, Debug)]
struct Impact {
    peak: f64,
    /// Speed of rebound over that of impact.
    restitution: f64,
    least_film: f64,
    /// Greatest change of all energy and what was lost, over that of the impact.
    energy_error: f64,
}

/// Lets the mass fall, by Verlet's steps.
fn fall(film: Film, step: f64) -> Impact {
    let mut at = Point::new(0.0, RADIUS + film.thickness + 0.4 * SPEED * 8e-6);
    let mut roller = roller(Some(film), at.y - RADIUS);
    let (mut velocity, mut t, mut lost) = (-SPEED, 0.0, 0.0);
    let energy = 0.5 * MASS * SPEED * SPEED;
    let mut force = roller.force(t, at, Vector::new(0.0, velocity)).y;
    let mut impact = Impact {
        peak: 0.0,
        restitution: 0.0,
        least_film: film.thickness,
        energy_error: 0.0,
    };
    while t < 5e-3 {
        let losing = roller.losing;
        velocity += 0.5 * step * force / MASS;
        at.y += step * velocity;
        t += step;
        force = roller.force(t, at, Vector::new(0.0, velocity)).y;
        velocity += 0.5 * step * force / MASS;
        lost += 0.5 * step * (losing + roller.losing);
        let squeezed = roller.contacts.memory.state.get(MemoryField::Squeezed, 0);
        impact.peak = impact.peak.max(force);
        impact.least_film = impact.least_film.min(film.thickness - squeezed);
        let all = 0.5 * MASS * velocity * velocity + roller.stored() + lost;
        impact.energy_error = impact.energy_error.max((all / energy - 1.0).abs());
    }
    impact.restitution = velocity / SPEED;
    impact
}

/// The same by Runge and Kutta's steps of 0.2 µs, with the pressure of Reynolds and Barus summed over the seat.
fn by_itself(film: Film) -> Impact {
    // ∫ −ln(1 − m (ŝ − κ)/(1 − κ))/α dx over the seat, by 64 midpoints that are dense in its middle.
    let places = 64_u32;
    let force_at = |m: f64, h: f64| {
        let scale = (2.0 * film.radius * h).sqrt();
        let end = (film.half_width / scale).asinh();
        let edge = (h / (h + film.half_width.powi(2) / (2.0 * film.radius))).powi(2);
        let sum: f64 = (0..places)
            .map(|i| {
                let u = end * (f64::from(i) + 0.5) / f64::from(places);
                let shape = (1.0 + u.sinh().powi(2)).powi(-2);
                let q = m * (shape - edge) / (1.0 - edge);
                -(1.0 - q).ln() * u.cosh()
            })
            .sum();
        let width = scale * end / f64::from(places);
        2.0 * film.leakage_factor.unwrap_or(1.0) * film.length * sum * width
            / film.pressure_coefficient
    };
    let draining = |force: f64, h: f64| {
        if force <= 0.0 {
            return 0.0;
        }
        let (mut low, mut high) = (0.0, 1.0 - 1e-9);
        for _ in 0..40 {
            let m = 0.5 * (low + high);
            if force_at(m, h) < force {
                low = m;
            } else {
                high = m;
            }
        }
        let edge = h + film.half_width.powi(2) / (2.0 * film.radius);
        let sharp = h.powi(-2) - edge.powi(-2);
        // m = α 6 η₀ v R (1/h² − 1/H_b²)
        low / (film.pressure_coefficient * 6.0 * film.viscosity * film.radius * sharp)
    };
    // (K δ^1.5 with the spring behind) by halving the share of the surfaces.
    let push = |depth: f64| {
        let (mut low, mut high) = (0.0, depth.max(0.0));
        for _ in 0..50 {
            let x = 0.5 * (low + high);
            if x + HERTZ * x.powf(1.5) / BEHIND < depth {
                low = x;
            } else {
                high = x;
            }
        }
        HERTZ * low.powf(1.5)
    };
    let rates = |[x, v, h]: [f64; 3]| {
        let force = push(h - x);
        [v, force / MASS, -draining(force, h + film.roughness)]
    };
    let step = 2e-7 * if film.thickness > 5e-5 { 5.0 } else { 10.0 };
    let mut state = [film.thickness, -SPEED, film.thickness];
    let mut impact = Impact {
        peak: 0.0,
        restitution: 0.0,
        least_film: film.thickness,
        energy_error: 0.0,
    };
    loop {
        let moved =
            |by: [f64; 3], share: f64| std::array::from_fn(|i| state[i] + share * step * by[i]);
        let k1 = rates(state);
        let k2 = rates(moved(k1, 0.5));
        let k3 = rates(moved(k2, 0.5));
        let k4 = rates(moved(k3, 1.0));
        for i in 0..3 {
            state[i] += step / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
        }
        let force = push(state[2] - state[0]);
        impact.peak = impact.peak.max(force);
        impact.least_film = impact.least_film.min(state[2]);
        if force <= 0.0 && state[1] > 0.0 {
            impact.restitution = state[1] / SPEED;
            return impact;
        }
    }
}

/// Peak within 3 % over film, viscosity and leakage; what is left of the speed and of the film too.
#[test]
fn an_impact_in_oil_is_that_of_a_program_by_itself() {
    let mut peaks = Vec::new();
    for thickness in [10e-6, 30e-6, 100e-6] {
        for viscosity in [0.02, 0.1] {
            for leakage_factor in [0.667, 1.0] {
                let film = oil(thickness, viscosity, leakage_factor);
                let (found, exact) = (fall(film, 2e-6), by_itself(film));
                let case = format!("{thickness} {viscosity} {leakage_factor}: {found:?} {exact:?}");
                assert!((found.peak / exact.peak - 1.0).abs() < 0.01, "{case}");
                assert!(
                    (found.restitution - exact.restitution).abs() < 0.005,
                    "{case}"
                );
                assert!(
                    (found.least_film / exact.least_film - 1.0).abs() < 0.01,
                    "{case}"
                );
                peaks.push(found.peak);
            }
        }
    }
    // 100 µm halve what 10 µm hardly change.
    assert!(peaks[8] < 0.5 * peaks[0], "{peaks:?}");
}

/// Without oil that matters the peak is that of ½ m v² = ∫ F dδ.
#[test]
fn a_thin_film_leaves_the_dry_impact() {
    let law = law();
    let found = fall(oil(1e-9, 0.05, 1.0), 5e-7);
    let (mut low, mut high) = (0.0, 1e-4);
    for _ in 0..60 {
        let depth = 0.5 * (low + high);
        if law.energy(depth) < 0.5 * MASS * SPEED * SPEED {
            low = depth;
        } else {
            high = depth;
        }
    }
    let exact = law.elastic_force(low);
    assert!((found.peak / exact - 1.0).abs() < 2e-3, "{found:?} {exact}");
    assert!((found.restitution - 1.0).abs() < 1e-3, "{found:?}");
}

/// Energy is that of kinetic, elastic and lost parts: to the second order in the step, as is the speed of rebound.
#[test]
fn errors_fall_with_the_square_of_the_step() {
    for (thickness, viscosity) in [(100e-6, 0.05), (30e-6, 0.05), (270e-6, 0.1)] {
        let film = oil(thickness, viscosity, 0.82);
        let [coarse, middle, fine, finest] = [8e-6, 4e-6, 2e-6, 2.5e-7].map(|it| fall(film, it));
        assert!(middle.energy_error < 2e-3, "{middle:?}");
        assert!(
            fine.energy_error < 0.4 * middle.energy_error,
            "{middle:?} {fine:?}"
        );
        let off = |it: Impact| (it.restitution - finest.restitution).abs();
        assert!(off(coarse) < 5e-3, "{coarse:?} {finest:?}");
        assert!(off(fine) < 0.3 * off(coarse) + 1e-4, "{coarse:?} {fine:?}");
    }
}

/// At the start surfaces lie on what is left between them, and a film that is looked at again is as it was.
#[test]
fn nothing_jumps_at_the_start() {
    let film = oil(30e-6, 0.05, 0.8);
    for depth in [1e-5, 0.0, -1e-5, -4e-5] {
        let at = Point::new(0.0, RADIUS - depth);
        let mut found = roller(Some(film), -depth);
        let dry = roller(None, -depth).force(0.0, at, Vector::zeros()).y;
        let force = found.force(0.0, at, Vector::zeros()).y;
        assert!(
            (force - dry).abs() <= 1e-9 * dry + 1e-9,
            "{depth}: {force} {dry}"
        );
        let squeezed = found.contacts.memory.state.get(MemoryField::Squeezed, 0);
        let expected = (film.thickness + depth).clamp(0.0, film.thickness);
        assert!((squeezed - expected).abs() < 1e-15, "{depth}: {squeezed}");
        let again = found.force(0.0, at, Vector::zeros()).y;
        assert!(
            (again - force).abs() <= 1e-9 * dry + 1e-9,
            "{depth}: {again}"
        );
    }
}

/// Oil does not pull, and comes back in its time.
#[test]
fn oil_comes_back_between_parted_surfaces() {
    for refill_time in [0.0, 1e-3, 1e3] {
        let film = Film {
            refill_time,
            ..oil(30e-6, 0.02, 0.8)
        };
        let mut roller = roller(Some(film), -1e-5);
        let place = |height: f64| Point::new(0.0, RADIUS + height);
        assert!(roller.force(0.0, place(-1e-5), Vector::zeros()).y > 0.0);
        // 20 µm apart, for 1 ms.
        let mut t = 0.0;
        for _ in 0..100 {
            t += 1e-5;
            let force = roller.force(t, place(20e-6), Vector::zeros()).y;
            assert!(force.abs() <= 0.0 && roller.closed() == 0, "{force}");
            // Looked at again, a last place higher or lower.
            let again = roller.force(t, place(20e-6 - 4e-18), Vector::zeros()).y;
            assert!(again.abs() <= 0.0 && roller.closed() == 0, "{again}");
        }
        let squeezed = roller.contacts.memory.state.get(MemoryField::Squeezed, 0);
        // From the whole film to the 10 µm that the gap leaves: e = 10 + 20 e^(−t/τ) µm
        let left = if refill_time > 0.0 {
            (-t / refill_time).exp()
        } else {
            0.0
        };
        let expected = 10e-6 + 20e-6 * left;
        assert!(
            (squeezed - expected).abs() < 1e-7,
            "{refill_time}: {squeezed}"
        );
    }
}

/// What implicit steps are told of the stiffness is how the force at the end of a step changes with the place there.
#[test]
fn the_stiffness_is_that_of_law_and_film() {
    for thickness in [10e-6, 100e-6] {
        let film = oil(thickness, 0.05, 0.8);
        for step in [1e-6, 1e-5, 1e-4] {
            let at = |height: f64| Point::new(0.0, RADIUS + height);
            let forces = [-1e-9, 0.0, 1e-9].map(|off| {
                let mut roller = roller(Some(film), thickness);
                roller.force(0.0, at(thickness), Vector::zeros());
                let force = roller
                    .force(step, at(0.7 * thickness + off), Vector::zeros())
                    .y;
                [force, roller.contacts.memory.faces.stiffness[0]]
            });
            let slope = (forces[0][0] - forces[2][0]) / 2e-9;
            let found = forces[1][1];
            assert!(
                (found / slope - 1.0).abs() < 0.1,
                "{thickness} {step}: {found} {slope}"
            );
        }
    }
}

/// Lanes drain as the law does, whatever shape the pressure has.
#[test]
fn lanes_drain_as_the_law_says() {
    for (half_width, leakage_factor) in [(8e-3, None), (23e-3, None), (14e-3, Some(0.8))] {
        let film = Film {
            half_width,
            leakage_factor,
            ..oil(1e-4, 0.05, 1.0)
        };
        let lanes = LaneFilm::new(film);
        for thickness in [1e-6, 1e-5, 3e-5, 1e-4, 3e-4] {
            for force in [1.0, 1e4, 5e4, 2e5] {
                let exact = film.drain(force, thickness);
                let [speed, by_force] = lanes.draining(force, thickness);
                let case = format!("{half_width} {thickness} {force}: {speed} {exact:?}");
                assert!((speed / exact.speed - 1.0).abs() < 3e-3, "{case}");
                let off = (by_force - exact.by_force).abs() * force / exact.speed;
                assert!(off < 5e-3, "{case}");
            }
        }
    }
}
