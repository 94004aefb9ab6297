//! Bush chains of several strands: how they share a load, and what their bushes do to teeth.

use std::f64::consts::TAU;

use chaindrive_contact::Friction;
use chaindrive_contact::friction::Coulomb;
use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::{Method, Moment, SecondOrderSystem, State};
use chaindrive_mechanics::{
    Assembled, BushStrands, ChainModel, End, Ends, Layout, Observation, Parts, PlacedChain,
    Rotation, StartSpeed, Strand,
};

use crate::pieces::{assembled, seen};
use crate::several_chains::{EVEN, chain, driven, pair, parts};

const PITCH: f64 = 0.0127;

/// A new strand and a softer one that is worn by a third of a per cent.
const LENGTHS: [f64; 2] = [PITCH, PITCH + 40e-6];
const STIFFNESS: [f64; 2] = [20e6, 10e6];

/// Radial clearance of pins and bushes \[m\]: an inner strand has four times as much from pulling to pushing.
const CLEARANCE: f64 = 20e-6;

/// A link of an open chain between two ends, a distance apart; the first link has bushes.
fn strands(clearance: f64, outer_first: bool) -> (ChainModel, [f64; 2]) {
    let (strands, together) = BushStrands::together(&LENGTHS, &STIFFNESS);
    let model = ChainModel::Strands(BushStrands {
        strands,
        clearance,
        outer_first,
    });
    (model, together)
}

/// An open chain that touches nothing, with joints at these places along x.
fn straight(
    (model, [length, stiffness]): (ChainModel, [f64; 2]),
    places: &[f64],
    ends: [End; 2],
    settle: bool,
) -> Parts {
    let links = places.len() - 1;
    let mut placed = chain(links, [0, 1]);
    placed.chain.masses = vec![0.01; places.len()];
    placed.chain.lengths = vec![length; links];
    placed.chain.stiffness = vec![stiffness; links];
    placed.chain.damping = vec![0.0; links];
    placed.chain.ends = Ends::Open(ends);
    placed.chain.model = model;
    placed.sprockets = Vec::new();
    placed.layout = Layout::Points {
        positions: places.iter().map(|x| Point::new(*x, 0.0)).collect(),
        velocities: vec![Vector::zeros(); places.len()],
    };
    Parts {
        gravity: Vector::zeros(),
        settle,
        ..parts(vec![placed], Vec::new())
    }
}

/// Within 1e-9 of the load of the drive, a kilonewton.
fn assert_close(found: f64, exact: f64, what: &str) {
    let error = (found - exact).abs() / 1e3;
    assert!(error < 1e-9, "{what}: {found} N, not {exact} N");
}

/// Under a pull T all strands that bear have the length of the link:
///
/// ```text
/// ℓ = (T + Σ k_s p_s)/Σ k_s,   T_s = k_s (ℓ − p_s)     over the strands that bear
/// ```
#[test]
fn strands_share_a_pull_by_stiffness_and_length() {
    let [k1, k2] = STIFFNESS;
    let [p1, p2] = LENGTHS;
    // The worn strand bears from k₁ (p₂ − p₁) = 800 N on.
    for (pull, both) in [(3000.0, true), (900.0, true), (500.0, false)] {
        let force = Vector::new(pull, 0.0);
        let ends = [End::Fixed, End::Pulled { force }];
        let places = [0.0, PITCH, 2.0 * PITCH];
        let seen = seen(&assembled(straight(
            strands(CLEARANCE, false),
            &places,
            ends,
            true,
        )));
        let shared = (pull + k1 * p1 + k2 * p2) / (k1 + k2);
        let inner = if both { shared } else { p1 + pull / k1 };
        let worn = if both { k2 * (inner - p2) } else { 0.0 };
        assert_close(seen.link_tension[0], pull, "all strands");
        assert_close(
            seen.strand_tension_max[0],
            k1 * (inner - p1),
            "the new strand",
        );
        assert_close(seen.strand_tension_min[0], worn, "the worn strand");
        // Outer plates are pressed on their pins, and push where they are too long.
        assert_close(
            seen.strand_tension_max[1],
            k1 * (shared - p1),
            "new outer plates",
        );
        assert_close(
            seen.strand_tension_min[1],
            k2 * (shared - p2),
            "worn outer plates",
        );
        let length = seen.roller_x[1] - seen.roller_x[0];
        assert!((length - inner).abs() < 1e-9 * PITCH, "{length}");
    }
}

/// A strand of an inner link pulls beyond its length, hangs loose for 4 c, and pushes below: T = k (max(e, 0) + min(e + 4 c, 0)), and
/// stores ½ k e² of what is beyond.
#[test]
fn loose_strands_neither_pull_nor_push() {
    for inner in [true, false] {
        for offset in [-150e-6, -70e-6, -30e-6, 20e-6, 100e-6] {
            let length = PITCH + offset;
            let places = [0.0, length];
            let ends = [End::Fixed, End::Fixed];
            let seen = seen(&assembled(straight(
                strands(CLEARANCE, !inner),
                &places,
                ends,
                false,
            )));
            let play = if inner { 4.0 * CLEARANCE } else { 0.0 };
            let each = [0, 1].map(|s| {
                let e: f64 = length - LENGTHS[s];
                let beyond = e.max(0.0) + (e + play).min(0.0);
                (STIFFNESS[s] * beyond, 0.5 * STIFFNESS[s] * beyond * beyond)
            });
            let most = each[0].0.max(each[1].0);
            let least = each[0].0.min(each[1].0);
            assert_close(seen.strand_tension_max[0], most, "the greatest");
            assert_close(seen.strand_tension_min[0], least, "the least");
            assert_close(seen.link_tension[0], most + least, "together");
            let stored = seen.energy.stored();
            assert!((stored - each[0].1 - each[1].1).abs() < 1e-12, "{stored} J");
        }
    }
}

/// A joint between two links swings on the strands that bear: ω² = (Σ k before + Σ k after)/m along the chain.
#[test]
fn loose_strands_do_not_stiffen_a_mode() {
    let [k1, k2] = STIFFNESS;
    // Both links 20 µm beyond the new strand: the worn one hangs loose in the inner link and pushes in the outer one.
    let length = LENGTHS[0] + 20e-6;
    for (clearance, worn_inside) in [(CLEARANCE, 0.0), (0.0, k2)] {
        let (model, together) = strands(clearance, false);
        let ends = [End::Fixed, End::Fixed];
        let places = [0.0, length, 2.0 * length];
        let parts = straight((model, together), &places, ends, true);
        let modes = assembled(parts).modes().expect("it was settled");
        let stiffest = modes.frequencies().pop().unwrap_or_default();
        let exact = ((k1 + worn_inside + k1 + k2) / 0.01_f64).sqrt() / TAU;
        assert!(
            (stiffest / exact - 1.0).abs() < 1e-9,
            "{stiffest} Hz, not {exact} Hz"
        );
    }
}

/// A chain of equal strands around two sprockets, or of particles.
fn around(model: ChainModel, friction: Friction) -> Assembled {
    let mut placed = chain(40, [0, 1]);
    placed.chain.model = model;
    let mut parts = parts(vec![placed], pair("", [20, 20], 0.0, EVEN, driven()).into());
    for sprocket in &mut parts.sprockets {
        sprocket.surface.friction = friction;
    }
    assembled(parts)
}

fn equal(count: usize) -> ChainModel {
    let (strands, _) = BushStrands::together(&vec![PITCH; count], &vec![1e7; count]);
    ChainModel::Strands(BushStrands {
        strands,
        clearance: 0.0,
        outer_first: false,
    })
}

fn after(assembled: Assembled, steps: usize) -> (State, Observation) {
    let mut assembled = assembled;
    let mut state = assembled.state();
    let mut stepper = Method::Verlet { step: 1e-6 }
        .start(&mut assembled.system, &mut state)
        .expect("the step is short enough");
    for _ in 0..steps {
        let stepped = stepper.advance(&mut assembled.system, &mut state);
        stepped.expect("the step is short enough");
    }
    (assembled.q, assembled.v) = (state.q.to_vec(), state.v.to_vec());
    let seen = seen(&assembled);
    (state, seen)
}

/// Two, three strands that are alike are one that is as heavy and as stiff as all of them; and without friction on the bushes that is
/// a chain of particles.
#[test]
fn equal_strands_are_one() {
    let (one, _) = after(around(equal(1), COULOMB), 2000);
    for count in [2, 3] {
        let (several, seen) = after(around(equal(count), COULOMB), 2000);
        for (found, exact) in several.q.iter().zip(one.q.iter()) {
            assert!((found - exact).abs() < 1e-9 * PITCH, "{found}, not {exact}");
        }
        let links = seen.link_tension.iter();
        let most = seen.strand_tension_max.iter();
        for (all, own) in links.zip(most) {
            assert_close(own * count as f64, *all, "a strand");
        }
    }
    let (particles, _) = after(around(ChainModel::Particles, Friction::None), 2000);
    let (strands, _) = after(around(equal(2), Friction::None), 2000);
    for (found, exact) in strands.q.iter().zip(particles.q.iter()) {
        assert!((found - exact).abs() < 1e-9 * PITCH, "{found}, not {exact}");
    }
}

const COULOMB: Friction = Friction::Coulomb(Coulomb {
    coefficient: 0.15,
    slip_speed: 0.01,
});

/// Joints pressed into gaps of a wheel that turns freely, and sliding there; half of the chain is beyond it.
fn sliding(model: ChainModel) -> Assembled {
    let joints = 9;
    let mut placed: PlacedChain = chain(joints - 1, [0, 1]);
    placed.chain.masses = vec![3.81e-3; joints];
    placed.chain.ends = Ends::Open([End::Free, End::Free]);
    placed.chain.model = model;
    placed.sprockets = vec![0];
    let radius = 0.5 * PITCH / (0.05 * 0.5 * TAU).sin();
    let angle = |i: usize| 0.05 * TAU * (i as f64 - 4.0);
    let depth = |i: usize| 2e-6 * (1.0 + (3.0 * i as f64).sin());
    placed.layout = Layout::Points {
        positions: (0..joints)
            .map(|i| {
                let r = radius - depth(i);
                Point::new(r * angle(i).cos(), r * angle(i).sin())
            })
            .collect(),
        velocities: (0..joints)
            .map(|i| Vector::new((7.0 * i as f64).sin(), (5.0 * i as f64).cos()) * 0.3)
            .collect(),
    };
    let [mut wheel, _] = pair("", [20, 20], 0.0, EVEN, driven());
    wheel.0.surface.friction = COULOMB;
    wheel.1 = Rotation::Free {
        drive: Vec::new(),
        load: Vec::new(),
        start: StartSpeed::Given(5.0),
    };
    assembled(Parts {
        gravity: Vector::zeros(),
        settle: false,
        ..parts(vec![placed], vec![wheel])
    })
}

/// Torque that is missing between a wheel and a free chain on it \[N m\], and the largest torque of one joint.
///
/// ```text
/// Σ m d × a + I α = 0     about the centre of the wheel, on which nothing else acts
/// ```
fn missing(model: ChainModel) -> [f64; 2] {
    let Assembled {
        mut system, q, v, ..
    } = sliding(model);
    let mut a = vec![0.0; q.len()];
    let mut rates = vec![0.0; system.quadratures()];
    let mut state = State::new(0.0, q, v);
    // A step, so that contacts have a past.
    let mut stepper = Method::Verlet { step: 1e-7 }
        .start(&mut system, &mut state)
        .expect("the step is short enough");
    stepper
        .advance(&mut system, &mut state)
        .expect("the step is short enough");
    let at = Moment {
        t: state.t,
        q: &state.q,
        v: &state.v,
        z: &[],
    };
    system.evaluate(at, &mut a, &mut rates, &mut system.new_record());
    let stride = (state.q.len() - 1) / 2;
    let torque = |i: usize| 3.81e-3 * (state.q[i] * a[stride + i] - state.q[stride + i] * a[i]);
    let torques: Vec<f64> = (0..9).map(torque).collect();
    let wheel = 2e-3 * a[2 * stride];
    let largest = torques.iter().fold(0.0, |m: f64, t| m.max(t.abs()));
    [torques.iter().sum::<f64>() + wheel, largest]
}

/// Friction on a bush turns its link: nothing is lost of the angular momentum. Circles of particles do not turn, and lose the torque
/// that friction has about their centres.
#[test]
fn bushes_hand_the_torque_of_friction_to_their_links() {
    for outer_first in [false, true] {
        let (model, _) = strands(CLEARANCE, outer_first);
        let [missing, largest] = missing(model);
        assert!(
            missing.abs() < 1e-12 * largest,
            "{missing} N m of {largest} N m"
        );
    }
    let [missing, largest] = missing(ChainModel::Particles);
    assert!(
        missing.abs() > 1e-3 * largest,
        "{missing} N m of {largest} N m"
    );
}

/// Parameters out of range are named.
#[test]
fn strands_out_of_range_are_named() {
    let strand = |length: f64, stiffness: f64| Strand { length, stiffness };
    let cases = [
        (vec![], 0.0, "chain.strands"),
        (
            vec![strand(1.0, 0.0), strand(1.0, 1.0)],
            0.0,
            "chain.strands[0].stiffness",
        ),
        (vec![strand(-1.0, 1.0)], 0.0, "chain.strands[0].length"),
        (vec![strand(1.0, 0.6)], 0.0, "chain.strands.stiffness"),
        (vec![strand(1.1, 1.0)], 0.0, "chain.strands.length"),
        (vec![strand(1.0, 1.0)], -1e-6, "chain.joint.clearance"),
    ];
    for (strands, clearance, path) in cases {
        let mut placed = chain(40, [0, 1]);
        placed.chain.model = ChainModel::Strands(BushStrands {
            strands,
            clearance,
            outer_first: false,
        });
        let problems = placed.chain.problems();
        let named = problems.iter().any(|it| it.to_string().contains(path));
        assert!(named, "{path}: {problems:?}");
    }
    let mut placed = chain(41, [0, 1]);
    placed.chain.model = equal(2);
    assert!(
        !placed.chain.problems().is_empty(),
        "an odd number of links"
    );
}
