//! A plunger on oil that can be compressed, against closed forms.

use std::f64::consts::TAU;

use chaindrive_integrate::{Method, Moment, SecondOrderSystem, State, Weights};

use super::{Hydraulic, OilColumn, Push, Slopes};

/// A plunger that leaks alike both ways, on so much oil that what moves is small beside it: a linear push.
fn linear() -> Hydraulic {
    Hydraulic {
        preload: 40.0,
        stiffness: 2e3,
        supply: 34.0,
        relief: 1e9,
        leak: 2e4,
        extending: 2e4,
        relieving: 1.0,
        // K A²/V = 1e7 N/m
        column: Some(OilColumn {
            area: 1e-4,
            volume: 1e-2,
            bulk_modulus: 1e13,
            air: 1e-15,
        }),
    }
}

/// Something over time or a step.
type Over<T> = fn(f64) -> T;

/// Change that makes a push wrong.
type Change = fn(&mut Hydraulic, &mut OilColumn);

const STIFFNESS: f64 = 1e7;

/// The plunger of a timing chain: 12 mm, 25 µm gap, 4 cm³ of oil with a hundredth of air.
fn real() -> Hydraulic {
    Hydraulic {
        preload: 40.0,
        stiffness: 2e3,
        supply: 34.0,
        relief: 340.0,
        leak: 65e3,
        extending: 200.0,
        relieving: 150.0,
        column: Some(OilColumn {
            area: 1.131e-4,
            volume: 4e-6,
            bulk_modulus: 1.2e9,
            air: 0.01,
        }),
    }
}

/// A mass behind a push, under a force over time; without a mass it goes where it is told.
#[derive(Clone)]
struct Plunger {
    push: Push,
    mass: Option<f64>,
    force: fn(f64) -> f64,
}

impl SecondOrderSystem for Plunger {
    type Record = Slopes;
    fn new_record(&self) -> Slopes {
        Slopes::default()
    }
    fn dofs(&self) -> usize {
        1
    }
    fn quadratures(&self) -> usize {
        2
    }
    fn states(&self) -> usize {
        usize::from(self.push.settled(0.0).is_some())
    }
    fn evaluate(&self, at: Moment<'_>, a: &mut [f64], rates: &mut [f64], slopes: &mut Slopes) {
        let (x, v) = (at.q[0], at.v[0]);
        let z = at.z.first().copied().unwrap_or(0.0);
        let push = self.push.force(x, v, z);
        *slopes = self.push.slopes(x, z);
        let outside = (self.force)(at.t);
        a[0] = match self.mass {
            Some(mass) => (push.elastic + push.damping + outside) / mass,
            None => outside,
        };
        rates[0] = outside * v;
        rates[1] = push.loss - push.damping * v;
        if let Some(flow) = rates.get_mut(2) {
            *flow = push.flow;
        }
    }
    fn can_solve(&self) -> bool {
        true
    }
    fn solve(&self, weights: Weights, slopes: &mut Slopes, x: &mut [f64]) -> bool {
        let Weights {
            damping: c,
            stiffness: k,
            ..
        } = weights;
        let mass = self.mass.expect("a mass that moves");
        let own = 1.0 + c * slopes.settling;
        x[1] /= own;
        x[0] += c * slopes.by_state * x[1] / mass;
        x[0] /= 1.0 + k * (self.push.stiffness(0.0) + slopes.within(c)) / mass;
        x[1] += k * slopes.flow * x[0] / own;
        true
    }
}

/// Runs in equal steps and visits every state.
fn run(
    plunger: &Plunger,
    [x, v]: [f64; 2],
    method: Method,
    end: f64,
    mut visit: impl FnMut(&State),
) {
    let mut system = plunger.clone();
    let z = plunger.push.settled(x).into_iter().collect();
    let mut state = State::new(0.0, vec![x], vec![v]).with_states(z);
    let mut stepper = method.start(&mut system, &mut state).expect("starts");
    while state.t < end * (1.0 - 1e-9) {
        stepper.advance(&mut system, &mut state).expect("advances");
        visit(&state);
    }
}

fn oil_force(push: &Hydraulic, state: &State) -> f64 {
    let (x, v) = (state.q[0], state.v[0]);
    let z = state.z.first().copied().unwrap_or(0.0);
    let force = Push::Hydraulic(*push).force(x, v, z);
    force.elastic + force.damping - (push.preload - push.stiffness * x)
}

/// Pressed in at a constant speed, oil behind a linear leak comes under pressure as
///
///     F − p_s A = c_leak |ẋ| (1 − e^(−t/τ)),   τ = V/(K G) = c_leak V/(K A²)
#[test]
fn a_step_in_speed_is_met_exponentially() {
    let push = linear();
    let speed = 1e-3;
    let tau = push.leak / STIFFNESS;
    let plunger = Plunger {
        push: Push::Hydraulic(push),
        mass: None,
        force: |_| 0.0,
    };
    let method = Method::Rk4 { step: tau / 100.0 };
    let mut steps = 0;
    run(&plunger, [0.0, -speed], method, 5.0 * tau, |state| {
        let closed = push.leak * speed * (1.0 - (-state.t / tau).exp());
        let found = oil_force(&push, state) - push.supply;
        assert!(
            (found - closed).abs() < 2e-6 * push.leak * speed,
            "{found} {closed}"
        );
        steps += 1;
    });
    assert!(steps > 400);
}

/// Moved to and fro, x = X sin ωt, the oil is a spring and a dashpot in series:
///
///     F = −X Im[k iωτ/(1 + iωτ) e^(iωt)]
#[test]
fn it_answers_frequencies_like_a_spring_behind_a_dashpot() {
    let push = linear();
    let tau = push.leak / STIFFNESS;
    // A newton, far less than the supply.
    let amplitude = 1e-7;
    // ẍ = −ω² X sin ωt for ωτ = 0.1, 1 and 10
    let cases: [(f64, Over<f64>); 3] = [
        (50.0, |t| -0.000_25 * (50.0 * t).sin()),
        (500.0, |t| -0.025 * (500.0 * t).sin()),
        (5000.0, |t| -2.5 * (5000.0 * t).sin()),
    ];
    for (omega, acceleration) in cases {
        let wt = omega * tau;
        let plunger = Plunger {
            push: Push::Hydraulic(push),
            mass: None,
            force: acceleration,
        };
        let method = Method::Rk4 {
            step: (tau.min(1.0 / omega)) / 200.0,
        };
        let end = 12.0 * tau + TAU / omega;
        run(&plunger, [0.0, amplitude * omega], method, end, |state| {
            if state.t > 12.0 * tau {
                let (sine, cosine) = (omega * state.t).sin_cos();
                // k iωτ/(1 + iωτ) = k ωτ (ωτ + i)/(1 + ω²τ²)
                let scale = STIFFNESS * amplitude * wt / (1.0 + wt * wt);
                let closed = -scale * (wt * sine + cosine);
                let found = oil_force(&push, state) - push.supply;
                assert!(
                    (found - closed).abs() < 1e-4 * scale * wt.hypot(1.0),
                    "{wt}: {found} {closed}"
                );
            }
        });
    }
}

/// With K → ∞ the push is that of stiff oil: through the leak, the relief valve and the check valve. What is left falls as 1/K.
#[test]
fn stiff_oil_is_the_limit() {
    let stiff = Hydraulic {
        column: None,
        ..real()
    };
    // −2 … 2 cm/s in 20 ms: leak, relief at 4.7 mm/s, suction
    let acceleration = |t: f64| -4.0 * (TAU * t / 0.02).sin();
    let start = 4.0 * 0.02 / TAU;
    let departure = |bulk_modulus: f64| {
        let column = real().column.map(|column| OilColumn {
            bulk_modulus,
            air: 1e-9,
            ..column
        });
        let push = Hydraulic { column, ..real() };
        let plunger = Plunger {
            push: Push::Hydraulic(push),
            mass: None,
            force: acceleration,
        };
        // The mean: the valves are passed a little later, where forces differ by more.
        let step = 2e4 / bulk_modulus;
        let mut sum = 0.0;
        let method = Method::Rk4 { step };
        run(&plunger, [0.0, start], method, 0.02, |state| {
            sum += (oil_force(&push, state) - oil_force(&stiff, state)).abs();
        });
        sum * step / 0.02
    };
    let [soft, hard] = [1e11, 1e12].map(departure);
    assert!(hard < 0.15 * soft && hard > 0.0, "{soft} {hard}");
}

/// Energy goes into the spring and the oil, and out through leak and valves: nothing is left over.
#[test]
fn the_ledger_closes_through_every_valve() {
    let push = Push::Hydraulic(real());
    let plunger = Plunger {
        push,
        mass: Some(0.3),
        // Hits and lets go: relief and suction.
        force: |t| -75.0 - 600.0 * (TAU * t / 0.01).sin(),
    };
    let mut regimes = [false; 3];
    let mut most = 0.0_f64;
    let mut moved = 0.0_f64;
    run(
        &plunger,
        [0.0, 0.0],
        Method::Rk4 { step: 2e-7 },
        0.03,
        |state| {
            let [x, v, z] = [state.q[0], state.v[0], state.z[0]];
            let total = 0.5 * 0.3 * v * v + push.energy(x, z);
            let [work, lost] = [state.quadratures[0], state.quadratures[1]];
            most = most.max((total - work + lost).abs());
            moved = moved.max(lost);
            let oil = oil_force(&real(), state);
            regimes[0] |= oil > 345.0;
            regimes[1] |= oil > 40.0 && oil < 335.0;
            regimes[2] |= oil < 20.0;
        },
    );
    assert_eq!(regimes, [true; 3]);
    assert!(most < 1e-7 * moved, "{most} of {moved}");
}

/// A plunger torn away leaves the oil behind: its pressure falls towards nothing and never below, and it fills again.
#[test]
fn torn_off_oil_has_no_negative_pressure() {
    let push = Hydraulic {
        extending: 2e4,
        ..real()
    };
    let plunger = Plunger {
        push: Push::Hydraulic(push),
        mass: None,
        force: |_| 0.0,
    };
    let mut least = f64::INFINITY;
    run(
        &plunger,
        [0.0, 1.0],
        Method::Verlet { step: 1e-6 },
        0.05,
        |state| {
            let pressure = plunger.push.pressure(state.q[0], state.z[0]);
            least = least.min(pressure.expect("oil has a pressure") + 101_325.0);
        },
    );
    assert!(least > 0.0 && least < 1e4, "{least}");
}

#[test]
fn nothing_flows_when_it_is_settled() {
    for x in [-1e-3, 0.0, 2e-3] {
        let push = Push::Hydraulic(real());
        let force = push.force(x, 0.0, push.settled(x).expect("it has a state"));
        assert!(force.flow.abs() < 1e-12 && force.loss.abs() < 1e-12);
        let stiff = push.relaxed().force(x, 0.0, 0.0);
        assert!((force.elastic - stiff.elastic).abs() < 1e-6);
        assert!(push.relaxed().settled(x).is_none());
    }
}

/// The pressure is that of the mixture: V/V_s = w(p)/w(p_s), with w from its definition.
#[test]
fn the_pressure_obeys_the_law_of_the_mixture() {
    let column = real().column.expect("there is one");
    let ambient = 101_325.0;
    let volume = |pressure: f64| {
        (1.0 - column.air) * (1.0 - (pressure - ambient) / column.bulk_modulus)
            + column.air * ambient / pressure
    };
    let supplied = ambient + 34.0 / column.area;
    for (x, z) in [
        (0.0, 0.0),
        (-4e-4, 0.0),
        (1e-2, 1e-3),
        (0.5, 0.0),
        (1e-3, 1.2e-3),
    ] {
        let pressure = column.at(x, z, 34.0).pressure + ambient;
        let ratio = (column.volume + column.area * x) / (column.volume + column.area * z);
        let expected = volume(pressure) / volume(supplied);
        assert!((ratio / expected - 1.0).abs() < 1e-12, "{x} {z} {pressure}");
    }
}

/// Derivatives against central differences; the energy against the force and the loss.
#[test]
fn slopes_and_energy_belong_to_the_force() {
    let push = Push::Hydraulic(real());
    // Suction, rest of the leak, and relief.
    for (x, z) in [(2e-3, 0.0), (-2e-5, 1e-5), (-4e-4, 0.0)] {
        let h = 1e-9;
        let force = |dx: f64, dz: f64| push.force(x + dx, 0.0, z + dz);
        let energy = |dx: f64, dz: f64| push.energy(x + dx, z + dz);
        let slopes = push.slopes(x, z);
        let near = |found: f64, difference: f64, what: &str| {
            let error = (found - difference).abs() / found.abs().max(1e-3);
            assert!(error < 1e-4, "{what} at {x}, {z}: {found} {difference}");
        };
        let by = |f: &dyn Fn(f64) -> f64| (f(h) - f(-h)) / (2.0 * h);
        near(
            push.stiffness(x) + slopes.stiffness,
            -by(&|d| force(d, 0.0).elastic),
            "stiffness",
        );
        near(
            slopes.by_state,
            by(&|d| force(0.0, d).elastic),
            "force by state",
        );
        near(slopes.flow, by(&|d| force(d, 0.0).flow), "flow");
        near(slopes.settling, -by(&|d| force(0.0, d).flow), "settling");
        assert!(slopes.largest[0] >= slopes.stiffness && slopes.largest[1] >= slopes.settling);
        let wide = 1e-7;
        let broad = |f: &dyn Fn(f64) -> f64| (f(wide) - f(-wide)) / (2.0 * wide);
        let here = force(0.0, 0.0);
        near(
            here.elastic,
            -broad(&|d| energy(d, 0.0)),
            "force and energy",
        );
        near(
            here.loss,
            -broad(&|d| energy(0.0, d)) * here.flow,
            "loss and energy",
        );
    }
}

/// Motion, state and ledger of a mass on leaking oil, with every method.
#[test]
fn every_method_keeps_its_order_on_oil() {
    // Never without pressure: oil that tears off has a kink.
    let column = linear().column.map(|column| OilColumn {
        volume: 1e-6,
        bulk_modulus: 1e9,
        ..column
    });
    let push = Push::Hydraulic(Hydraulic {
        leak: 3e3,
        extending: 3e3,
        column,
        ..linear()
    });
    let plunger = Plunger {
        push,
        mass: Some(2.0),
        force: |t| -74.0 - 10.0 * (900.0 * t).sin(),
    };
    let end = 4e-3;
    // At eight instants: a single one may hide an error by chance.
    let seen = |method: Method| {
        let mut found = Vec::new();
        run(&plunger, [0.0, 0.003], method, end, |state| {
            let [x, v, z] = [state.q[0], state.v[0], state.z[0]];
            let total = v * v + push.energy(x, z);
            let ledger = total - state.quadratures[0] + state.quadratures[1];
            found.push([x, z, ledger]);
        });
        let every = found.len() / 8;
        (1..=8).map(|k| found[k * every - 1]).collect::<Vec<_>>()
    };
    let precise = seen(Method::Rk4 {
        step: end / 20_000.0,
    });
    let methods: [(Over<Method>, f64, f64); 5] = [
        (|step| Method::Verlet { step }, 800.0, 2.0),
        (|step| Method::Rk4 { step }, 96.0, 4.0),
        (
            |step| Method::DormandPrince {
                relative: 0.0,
                absolute: f64::INFINITY,
                absolute_rate: f64::INFINITY,
                max_step: step,
            },
            48.0,
            5.0,
        ),
        (|step| Method::ImplicitDamping { step }, 6400.0, 1.0),
        (
            |step| Method::GeneralizedAlpha {
                step,
                spectral_radius: 0.8,
            },
            800.0,
            2.0,
        ),
    ];
    for (method, steps, order) in methods {
        let error = |steps: f64| {
            let found = seen(method(end / steps));
            let pairs = found.iter().zip(&precise);
            pairs.fold([0.0_f64; 3], |worst, (found, exact)| {
                [0, 1, 2].map(|i| worst[i].max((found[i] - exact[i]).abs()))
            })
        };
        let (coarse, fine) = (error(steps), error(2.0 * steps));
        for (i, what) in ["place", "state", "ledger"].into_iter().enumerate() {
            let seen = (coarse[i] / fine[i]).log2();
            assert!(
                seen > order - 0.25,
                "{what}, {}: {seen}",
                method(1.0).name()
            );
        }
    }
}

#[test]
fn what_makes_no_oil_is_named() {
    let refused = |change: fn(&mut Hydraulic, &mut OilColumn)| {
        let mut push = real();
        let mut column = real().column.expect("there is one");
        change(&mut push, &mut column);
        push.column = Some(column);
        let refused = Push::Hydraulic(push).check().expect_err("it is wrong");
        refused.to_string()
    };
    let cases: [(Change, &str); 9] = [
        (|_, oil| oil.bulk_modulus = f64::NAN, "oil.bulk_modulus"),
        (|_, oil| oil.bulk_modulus = 0.0, "oil.bulk_modulus"),
        (|_, oil| oil.volume = f64::INFINITY, "oil.volume"),
        (|_, oil| oil.area = -1.0, "oil.area"),
        (|_, oil| oil.air = 0.0, "oil.air"),
        (|_, oil| oil.air = f64::NAN, "oil.air"),
        (|push, _| push.leak = 0.0, "leak"),
        (|push, _| push.extending = 0.0, "extending"),
        (|push, _| push.relieving = f64::NAN, "relieving"),
    ];
    for (change, place) in cases {
        let message = refused(change);
        assert!(message.starts_with(place), "{message}");
    }
}
