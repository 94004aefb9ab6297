//! A tensioner on oil that can be compressed, in a whole drive.

use chaindrive_geometry::Vector;
use chaindrive_integrate::{Method, Moment, SecondOrderSystem, State, Weights};
use chaindrive_mechanics::carriers::Slider;
use chaindrive_mechanics::pushes::{Hydraulic, OilColumn};
use chaindrive_mechanics::{
    Assembled, Carrier, Forces, Layout, Observation, Parts, Push, Support, System, Tensioner,
};

use crate::pieces;
use crate::pieces::assembled;
use crate::several_chains::{EVEN, chain, driven, pair, parts, with_play};

/// Forty links around two sprockets, the second on a slide that oil presses outwards.
fn tensioned(column: Option<OilColumn>) -> Parts {
    let [a, mut b] = pair("", [20, 20], 0.0, EVEN, driven());
    b.0.support = Support::Tensioner(0);
    let mut around = chain(40, [0, 1]);
    if let Layout::Route { fit, .. } = &mut around.layout {
        // The plunger tightens the chain.
        fit.pretension = 0.0;
    }
    let mut parts = parts(vec![around], vec![a, b]);
    parts.tensioners = vec![Tensioner {
        name: "plunger".into(),
        carrier: Carrier::Slider(Slider {
            direction: Vector::new(0.0, 1.0),
            mass: Some(0.5),
        }),
        push: Push::Hydraulic(Hydraulic {
            preload: 100.0,
            stiffness: 2e3,
            supply: 35.0,
            relief: 300.0,
            leak: 20e3,
            extending: 200.0,
            relieving: 100.0,
            column,
        }),
        forces: Forces::default(),
        forced_at: None,
    }];
    parts
}

const OIL: OilColumn = OilColumn {
    area: 1.131e-4,
    volume: 4e-6,
    bulk_modulus: 1.2e9,
    air: 0.01,
};

fn observed(system: &System, state: &State) -> Observation {
    pieces::observed(system, state, &state.quadratures)
}

/// Statics knows nothing of the oil but its supply; the state begins settled there.
#[test]
fn it_settles_where_stiff_oil_does() {
    let stiff = assembled(tensioned(None));
    let oil = assembled(tensioned(Some(OIL)));
    assert_eq!(stiff.q, oil.q);
    assert!(stiff.z.is_empty() && stiff.system.oil_column_names().is_empty());
    assert_eq!(oil.system.oil_column_names(), ["plunger"]);
    let mut state = oil.state();
    state.quadratures = vec![0.0; oil.system.quadratures()].into();
    let seen = observed(&oil.system, &state);
    let supply = 35.0 / OIL.area;
    assert!((seen.oil_pressure[0] / supply - 1.0).abs() < 1e-9);
    assert!((seen.tensioner_position[0] - oil.z[0]).abs() < 1e-15);
}

/// Trapped oil is a spring of K_eff A²/V to vibrations: the mode of the slide stiffens by it.
#[test]
fn vibrations_find_the_oil_trapped() {
    let highest = |parts| {
        let modes = assembled(parts).modes().expect("it is settled");
        let slides = modes.modes.iter();
        slides
            .map(|mode| (TWO_PI * mode.frequency).powi(2) * mode.tensioner_position[0].powi(2))
            .sum::<f64>()
    };
    // Σ ω² φ_s² = K_ss/m², since Σ φ φᵀ ω² = M⁻¹ K M⁻¹
    let inertia = 1.5_f64;
    let added = (highest(tensioned(Some(OIL))) - highest(tensioned(None))) * inertia * inertia;
    // 1/K_eff = (l + α p₀/p²)/w,   l = (1 − α)/K
    let (ambient, pressure) = (101_325.0, 101_325.0 + 35.0 / OIL.area);
    let liquid = (1.0 - OIL.air) / OIL.bulk_modulus;
    let volume = 1.0 - OIL.air - liquid * (pressure - ambient) + OIL.air * ambient / pressure;
    let modulus = volume / (liquid + OIL.air * ambient / (pressure * pressure));
    let expected = modulus * OIL.area * OIL.area / OIL.volume;
    assert!((added / expected - 1.0).abs() < 0.02, "{added} {expected}");
}

const TWO_PI: f64 = std::f64::consts::TAU;

/// Every method moves it, and the energy closes with the loss in the valves.
#[test]
fn every_method_moves_it_and_the_ledger_closes() {
    let run = |assembled: Assembled, method: Method| {
        let mut state = assembled.state();
        let mut system = assembled.system;
        // The slide is pushed in.
        let slide = state.v.len() - 2;
        state.v[slide] -= 0.05;
        let mut stepper = method.start(&mut system, &mut state).expect("starts");
        let start = observed(&system, &state).energy;
        let mut most = 0.0_f64;
        while state.t < 8e-4 {
            stepper.advance(&mut system, &mut state).expect("advances");
            most = most.max((state.z[0] - state.q[slide]).abs());
        }
        let seen = observed(&system, &state);
        let name = method.name();
        assert!(most > 1e-6, "{name}: the oil is not pressed");
        let (residual, lost) = (seen.energy.residual(&start), seen.energy.dissipated());
        println!(
            "{name}: {residual:.2e} of {lost:.2e} J lost, {:.4e} Pa",
            seen.oil_pressure[0]
        );
        assert!(lost > 1e-5, "{name} loses nothing");
        // Of the energy that the slide was given, ½ m v².
        (residual / (0.5 * 1.5 * 0.05 * 0.05), seen.oil_pressure[0])
    };
    let particles = || assembled(tensioned(Some(OIL)));
    let linked = || {
        let mut parts = tensioned(Some(OIL));
        parts.chains.iter_mut().for_each(with_play);
        assembled(parts)
    };
    for (method, bound) in Method::specimens(4e-7).into_iter().zip([1e-4, 1e-6, 1e-6]) {
        let (share, _) = run(particles(), method);
        assert!(share.abs() < bound, "{}: {share}", method.name());
    }
    let pressures = Method::implicit_specimens(4e-7).map(|method| {
        let (share, pressure) = run(linked(), method);
        assert!(share.abs() < 0.02, "{}: {share}", method.name());
        pressure
    });
    let [damped, alpha] = pressures;
    assert!((damped / alpha - 1.0).abs() < 0.02, "{damped} {alpha}");
}

/// The equations of an implicit step hold, the oil among them.
///
/// ```text
/// x − ∂a = x₀,   y − ∂ż = y₀,   ∂ along δq = k x, δv = c x, δz = c y, by finite differences
/// ```
#[test]
fn an_implicit_step_takes_the_oil_along() {
    let mut parts = tensioned(Some(OIL));
    parts.chains.iter_mut().for_each(with_play);
    let assembled = assembled(parts);
    let system = &assembled.system;
    let dofs = system.dofs();
    let along = system.quadratures();
    // So much oil that the relief valve is open.
    let z = vec![assembled.z[0] + 2e-4];
    let evaluate = |q: &[f64], v: &[f64], z: &[f64]| {
        let mut record = system.new_record();
        let mut a = vec![0.0; dofs];
        let mut rates = vec![0.0; along + 1];
        system.evaluate(Moment { t: 0.0, q, v, z }, &mut a, &mut rates, &mut record);
        a.push(rates[along]);
        (a, record)
    };
    let (_, mut record) = evaluate(&assembled.q, &assembled.v, &z);
    let mut x: Vec<f64> = (0..=dofs).map(|i| 1e-3 * (7.0 * i as f64).sin()).collect();
    // The slide and its oil alone are asked: links turn each other's forces, which an implicit step may leave out.
    let slide = system.dofs() - 2;
    let right = x.clone();
    let (c, k) = (1e-5, 4e-11);
    let weights = Weights {
        once: false,
        damping: c,
        stiffness: k,
    };
    assert!(system.solve(weights, &mut record, &mut x));
    let moved = |sign: f64| {
        let h = sign * 1e-3;
        let q: Vec<f64> = (0..dofs).map(|i| assembled.q[i] + h * k * x[i]).collect();
        let v: Vec<f64> = (0..dofs).map(|i| assembled.v[i] + h * c * x[i]).collect();
        evaluate(&q, &v, &[z[0] + h * c * x[dofs]]).0
    };
    let (ahead, behind) = (moved(1.0), moved(-1.0));
    for i in [slide, dofs] {
        let change = (ahead[i] - behind[i]) / 2e-3;
        let left = x[i] - change;
        let scale = x[i].abs().max(change.abs());
        assert!(
            (left - right[i]).abs() < 1e-3 * scale,
            "{i}: {left} {}",
            right[i]
        );
        assert!(
            (x[i] - right[i]).abs() > 1e-2 * scale,
            "{i} is not moved by the oil"
        );
    }
}
