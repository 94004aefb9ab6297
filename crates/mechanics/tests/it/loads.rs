//! Torques by orders and tables of the angle of any shaft.

use std::f64::consts::TAU;

use chaindrive_integrate::{Method, SecondOrderSystem, State};
use chaindrive_mechanics::{
    Action, Argument, Assembled, Drive, Flow, Observation, Order, Rotation, StartSpeed, Table,
};

use crate::pieces::{assembled, observed};
use crate::several_chains::{EVEN, chain, driven, pair, parts};

/// A table over two turns, as it is given.
const TABLE: [(f64, f64); 5] = [
    (0.0, 1.0),
    (0.2, -2.0),
    (TAU, 0.5),
    (1.5 * TAU, -1.0),
    (2.0 * TAU, 1.0),
];

/// Two orders and a table over two turns of a shaft, beside a constant torque.
fn following(of: Option<usize>) -> Rotation {
    let order = |amplitude, order, phase| Order {
        amplitude,
        order,
        phase,
    };
    let (angles, torques) = TABLE.into_iter().unzip();
    Rotation::Free {
        drive: vec![
            Action::Orders {
                of,
                terms: vec![order(0.4, 12.0, 0.3)],
            }
            .into(),
        ],
        load: vec![
            Action::Constant { value: -2.0 }.into(),
            Action::Orders {
                of,
                terms: vec![order(0.5, 1.5, 0.0), order(0.3, 8.0, -1.0)],
            }
            .into(),
            Action::Table {
                over: Argument::Angle { of, turns: 2 },
                curve: Table::new(angles, torques).expect("the angles increase"),
            }
            .into(),
        ],
        start: StartSpeed::Joined,
    }
}

/// Torques of [`following`] at an angle, written out: those that drive and those that load.
fn written_out(angle: f64) -> [f64; 2] {
    let within = angle.rem_euclid(2.0 * TAU);
    let next = TABLE.iter().position(|(at, _)| *at > within).unwrap_or(4);
    let [(a0, m0), (a1, m1)] = [TABLE[next - 1], TABLE[next]];
    let table = m0 + (m1 - m0) * (within - a0) / (a1 - a0);
    let load = -2.0 + 0.5 * (1.5 * angle).sin() + 0.3 * (8.0 * angle - 1.0).sin() + table;
    [0.4 * (12.0 * angle + 0.3).sin(), load]
}

/// P = M(θ of the shaft that is followed) ω of the shaft that the torque acts on, and every joule is accounted for.
#[test]
fn the_ledger_closes_with_orders_of_the_own_and_of_another_shaft() {
    for followed in [0, 1] {
        let [a, mut b] = pair("", [20, 20], 0.0, EVEN, driven());
        b.1 = following((followed == 0).then_some(0));
        let mut parts = parts(vec![chain(40, [0, 1])], vec![a, b]);
        // Angles of shafts with names can be seen; they count from where they were assembled, before the load turned them.
        for (index, shaft) in parts.shafts.iter_mut().enumerate() {
            shaft.name = Some(format!("shaft {index}"));
        }
        let Assembled {
            mut system, q, v, ..
        } = assembled(parts);
        let step = 1e-6;
        let mut state = State::new(0.0, q, v);
        let mut stepper = Method::Verlet { step }
            .start(&mut system, &mut state)
            .expect("the step is short enough");
        let mut flows = vec![0.0; system.quadratures()];
        let first = observed(&system, &state, &flows);
        let powers = |now: &Observation| {
            written_out(now.shaft_angle[followed]).map(|torque| torque * now.shaft_speed[1])
        };
        let (mut work, mut before) = ([0.0; 2], powers(&first));
        for _ in 0..10_000 {
            stepper
                .advance(&mut system, &mut state)
                .expect("the step is short enough");
            let now = powers(&observed(&system, &state, &flows));
            for (sum, (old, new)) in work.iter_mut().zip(before.into_iter().zip(now)) {
                *sum += 0.5 * step * (old + new);
            }
            before = now;
        }
        state.quadratures_at(state.t, &mut flows);
        let last = observed(&system, &state, &flows);
        for (flow, work) in [Flow::DriveTorque, Flow::Load].into_iter().zip(work) {
            let found = last.energy.flows[flow as usize] - first.energy.flows[flow as usize];
            assert!(
                (found - work).abs() < 1e-6 * work.abs().max(0.1),
                "{flow:?} of shaft {followed}: {found} J, not {work}"
            );
        }
        let residual = last.energy.residual(&first.energy);
        let moved = last.energy.kinetic() + last.energy.stored().abs();
        assert!(residual.abs() < 1e-5 * moved, "{residual} J of {moved} J");
    }
}

/// A torque that follows the shaft of another chain joins the two, whatever else the drive has.
#[test]
fn followed_shafts_are_found_among_parts_that_nothing_joins() {
    let run = |apart: bool| {
        let [a, b] = pair("apart ", [20, 20], 0.0, EVEN, driven());
        let [c, d] = pair("leading ", [20, 20], 2.0, EVEN, driven());
        let [e, mut f] = pair("following ", [20, 20], 4.0, EVEN, driven());
        let before = if apart { vec![a, b] } else { Vec::new() };
        let first = before.len();
        f.1 = following(Some(first + 1));
        let stops = (0..first + 4).step_by(2);
        let chains = stops.map(|i| chain(40, [i, i + 1])).collect();
        let turning = before.into_iter().chain([c, d, e, f]).collect();
        let Assembled {
            mut system, q, v, ..
        } = assembled(parts(chains, turning));
        let mut state = State::new(0.0, q, v);
        let mut stepper = Method::Verlet { step: 1e-6 }
            .start(&mut system, &mut state)
            .expect("the step is short enough");
        for _ in 0..2000 {
            stepper
                .advance(&mut system, &mut state)
                .expect("the step is short enough");
        }
        let flows = vec![0.0; system.quadratures()];
        observed(&system, &state, &flows).sprocket_speed[first..].to_vec()
    };
    let bits = |speeds: Vec<f64>| speeds.into_iter().map(f64::to_bits).collect::<Vec<_>>();
    assert_eq!(bits(run(true)), bits(run(false)));
}

#[test]
fn a_shaft_that_does_not_exist_is_not_followed() {
    let [a, mut b] = pair("", [20, 20], 0.0, EVEN, driven());
    b.1 = following(Some(7));
    let problems = Drive::new(parts(vec![chain(40, [0, 1])], vec![a, b])).expect_err("no shaft 7");
    let told = format!("{problems:?}");
    assert!(told.contains("sprockets.b") && told.contains('7'), "{told}");
}
