//! Several chains in one drive: apart, on one shaft, and joined by a shaft that twists.

use crate::pieces;
use crate::pieces::{around, assembled, body, linear, observed, seen, smooth};

use chaindrive_contact::dissipation::Viscous;
use chaindrive_contact::{Dissipation, Law};
use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::{Method, Moment, SecondOrderSystem, State, Weights};
use chaindrive_mechanics::{
    Action, Assembled, ChainModel, Clearance, Coupling, Ends, GearPair, Joint, Motion, Observation,
    Parts, PlacedChain, RigidLinks, RollerModel, Rotation, Shaft, Sprocket, StartSpeed, System,
};

const PITCH: f64 = 0.0127;
const ROLLER: f64 = 7.75e-3;

/// A sprocket, and what turns it.
type Turning = (Sprocket, Rotation);

fn sprocket(name: &str, teeth: u32, centre: [f64; 2], rotation: Rotation) -> Turning {
    let sprocket = Sprocket {
        inertia: 2e-3,
        ..pieces::sprocket(name, teeth, [PITCH, ROLLER], centre, smooth(linear(5e7)))
    };
    (sprocket, rotation)
}

/// A chain around sprockets `stops`, `links` long, with a tension of 60 N as laid.
pub(crate) fn chain(links: usize, stops: [usize; 2]) -> PlacedChain {
    let of = [PITCH, 3.81e-3, 20e6];
    let mut chain = pieces::links(
        links,
        of,
        [ROLLER, 9.6e-3],
        Ends::Closed,
        ChainModel::Particles,
    );
    chain.damping.fill(20.0);
    around(chain, &stops, 60.0)
}

fn free(load: f64) -> Rotation {
    Rotation::Free {
        drive: Vec::new(),
        load: vec![Action::Constant { value: load }.into()],
        start: StartSpeed::Joined,
    }
}

pub(crate) fn driven() -> Rotation {
    Rotation::Prescribed(Motion::Constant { rate: 30.0 })
}

/// Two sprockets as far apart as a number of links needs; the second one turns freely.
pub(crate) fn pair(
    prefix: &str,
    teeth: [u32; 2],
    x: f64,
    distance: f64,
    first: Rotation,
) -> [Turning; 2] {
    [
        sprocket(&format!("{prefix}a"), teeth[0], [x, 0.0], first),
        sprocket(&format!("{prefix}b"), teeth[1], [x, distance], free(-2.0)),
    ]
}

/// Every sprocket has a shaft of its own.
pub(crate) fn parts(chains: Vec<PlacedChain>, turning: Vec<Turning>) -> Parts {
    let (mut sprockets, mut shafts) = (Vec::new(), Vec::new());
    for (index, (sprocket, rotation)) in turning.into_iter().enumerate() {
        sprockets.push(Sprocket {
            shaft: index,
            ..sprocket
        });
        shafts.push(Shaft::of_one(rotation));
    }
    Parts {
        sprockets,
        shafts,
        settle: true,
        gravity: Vector::new(0.0, -9.81),
        ..pieces::alone(chains)
    }
}

/// Equal sprockets of 20 teeth at ten pitches: forty links.
pub(crate) const EVEN: f64 = 10.0 * PITCH;

/// Runs at a fixed step and returns what is seen at the end.
fn run(assembled: Assembled, step: f64, steps: usize) -> Observation {
    let Assembled {
        mut system, q, v, ..
    } = assembled;
    let mut state = State::new(0.0, q, v);
    let mut stepper = Method::Verlet { step }
        .start(&mut system, &mut state)
        .expect("the step is short enough");
    for _ in 0..steps {
        stepper
            .advance(&mut system, &mut state)
            .expect("the step is short enough");
    }
    observed(&system, &state, &vec![0.0; system.quadratures()])
}

/// Chains that nothing joins move, and pull, as each would in a drive of its own: to the last bit.
#[test]
fn two_chains_that_nothing_joins_are_two_drives() {
    let first = || pair("left ", [20, 20], 0.0, EVEN, driven());
    let second = || pair("right ", [20, 20], 2.0, EVEN + 0.3e-3, driven());
    let (step, steps) = (1e-6, 3000);
    let run = |chains: Vec<PlacedChain>, sprockets: Vec<Turning>| {
        run(assembled(parts(chains, sprockets)), step, steps)
    };
    let alone = [first(), second()].map(|pair| run(vec![chain(40, [0, 1])], pair.into()));
    let both = run(
        vec![chain(40, [0, 1]), chain(40, [2, 3])],
        first().into_iter().chain(second()).collect(),
    );
    let joined =
        |of: fn(&Observation) -> &Vec<f64>| [of(&alone[0]).clone(), of(&alone[1]).clone()].concat();
    let fields: [fn(&Observation) -> &Vec<f64>; 8] = [
        |o| &o.roller_x,
        |o| &o.roller_vy,
        |o| &o.link_tension,
        |o| &o.contact_force,
        |o| &o.sprocket_angle,
        |o| &o.sprocket_speed,
        |o| &o.sprocket_torque,
        |o| &o.span_tension,
    ];
    for (i, of) in fields.into_iter().enumerate() {
        let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(of(&both)), bits(&joined(of)), "field {i}");
        assert!(of(&both).iter().any(|v| v.abs() > 0.0), "field {i}");
    }
}

/// Two inertias on a shaft that twists: f = √(k (1/J₁ + 1/J₂))/2π, in the modes and in the motion.
#[test]
fn a_shaft_that_twists_has_its_closed_frequency() {
    let (stiffness, inertias) = (400.0, [2e-3, 5e-3]);
    let [mut a, mut b] = [0.0, 1.0].map(|x| sprocket("a", 20, [x, 5.0], free(0.0)));
    b.0.name = "b".into();
    (a.0.inertia, b.0.inertia) = (inertias[0], inertias[1]);
    let [c, d] = pair("", [20, 20], 0.0, EVEN, driven());
    let mut parts = parts(vec![chain(40, [0, 1])], vec![c, d, a, b]);
    parts.sprockets[0].name = "c".into();
    parts.sprockets[1].name = "d".into();
    parts.couplings = vec![Coupling {
        name: "spring".into(),
        shafts: [2, 3],
        stiffness,
        damping: 0.0,
    }];
    let exact =
        (stiffness * (1.0 / inertias[0] + 1.0 / inertias[1])).sqrt() / std::f64::consts::TAU;

    let mut assembled = assembled(parts);
    let modes = assembled.modes().unwrap();
    // The mode in which the two turn against one another, in the ratio of their inertias.
    let torsional = modes
        .modes
        .iter()
        .filter(|mode| mode.sprocket_angle[2].abs() > 1.0);
    let found: Vec<f64> = torsional
        .map(|mode| mode.frequency)
        .filter(|f| *f > 1.0)
        .collect();
    assert!(
        found.iter().any(|f| (f / exact - 1.0).abs() < 1e-9),
        "{found:?}, not {exact}"
    );

    // Kicked against one another with no net momentum, they meet again after whole periods.
    let [kick_a, kick_b] = [1.0 / inertias[0], -1.0 / inertias[1]];
    let place = |system: &System, name: &str| {
        (0..assembled.q.len())
            .find(|&dof| system.place(dof) == format!("the angle of sprocket `{name}`"))
            .unwrap()
    };
    let (i, j) = (place(&assembled.system, "a"), place(&assembled.system, "b"));
    assembled.v[i] += 1e-3 * kick_a;
    assembled.v[j] += 1e-3 * kick_b;
    let mut system = assembled.system;
    let mut state = State::new(0.0, assembled.q, assembled.v);
    let step = 2e-6;
    let mut stepper = Method::Verlet { step }
        .start(&mut system, &mut state)
        .unwrap();
    let twist = |state: &State| (state.q[j] - state.q[i]) - (0.0);
    let start = twist(&state);
    let (mut crossings, mut before) = (Vec::new(), 0.0);
    while crossings.len() < 9 {
        stepper.advance(&mut system, &mut state).unwrap();
        let now = twist(&state) - start;
        if before < 0.0 && now >= 0.0 {
            crossings.push(state.t - step * now / (now - before));
        }
        before = now;
    }
    let period = (crossings[8] - crossings[0]) / 8.0;
    assert!(
        (period * exact - 1.0).abs() < 1e-3,
        "{period}, not {}",
        1.0 / exact
    );
}

/// Sprockets of two chains on one shaft turn as one, and the shaft has the inertia of both.
#[test]
fn a_shaft_carries_sprockets_of_two_chains() {
    for ratio in [1.0, -0.5] {
        let [a, b] = pair("first ", [20, 20], 0.0, EVEN, driven());
        let [mut c, mut d] = pair("second ", [20, 20], 2.0, EVEN, free(0.0));
        d.1 = free(-1.0_f64.copysign(ratio));
        let on_one = ratio > 0.0;
        if on_one {
            c.0.centre = b.0.centre;
            d.0.centre = Point::new(0.0, 2.0 * EVEN);
        }
        let mut drive = parts(vec![chain(40, [0, 1]), chain(40, [2, 3])], vec![a, b, c, d]);
        if on_one {
            drive.shafts[1].name = Some("middle".into());
            drive.sprockets[2].shaft = 1;
            drive.sprockets[3].shaft = 2;
            drive.shafts.remove(2);
        } else {
            drive.gears.push(GearPair {
                name: "step".into(),
                shafts: [1, 2],
                ratio,
            });
        }
        let assembled = assembled(drive);
        assert!(
            assembled
                .statics
                .iter()
                .all(|statics| statics.residual < 1e-6)
        );
        // All sprockets set off together.
        let start = seen(&assembled);
        let speeds = [30.0, 30.0, 30.0 * ratio, 30.0 * ratio];
        for (found, speed) in start.sprocket_speed.iter().zip(speeds) {
            assert!((found / speed - 1.0).abs() < 1e-9, "{found}, not {speed}");
        }
        // The resisting torque of the last sprocket comes through both chains.
        let mean = |range: std::ops::Range<usize>| {
            let part = &start.link_tension[range];
            part.iter().sum::<f64>() / part.len() as f64
        };
        assert!(mean(0..40) > 30.0 && mean(40..80) > 30.0);

        let system = assembled.system.clone();
        let dofs = system.free_dofs();
        assert_eq!(
            dofs,
            2 * 80 + 2,
            "one coordinate for the shaft, one for the last sprocket"
        );
        let step = 1e-6;
        let mut flows = vec![0.0; system.quadratures()];
        let Assembled {
            mut system, q, v, ..
        } = assembled;
        let mut state = State::new(0.0, q, v);
        let mut stepper = Method::Verlet { step }
            .start(&mut system, &mut state)
            .unwrap();
        let first = observed(&system, &state, &flows).energy;
        for _ in 0..20_000 {
            stepper.advance(&mut system, &mut state).unwrap();
        }
        state.quadratures_at(state.t, &mut flows);
        let last = observed(&system, &state, &flows);
        assert!((last.sprocket_angle[2] - ratio * last.sprocket_angle[1]).abs() < 1e-12);
        let residual = last.energy.residual(&first);
        let moved = last.energy.kinetic() + last.energy.stored().abs();
        assert!(residual.abs() < 1e-5 * moved, "{residual} J of {moved} J");
    }
}

/// Pins with play in their bushes that lose energy as they close.
pub(crate) fn with_play(placed: &mut PlacedChain) {
    let law = Law {
        dissipation: Dissipation::Viscous(Viscous { damping: 500.0 }),
        ..linear(2e8)
    };
    placed.chain.model = ChainModel::Rigid(RigidLinks {
        inner: body(3.01e-3, 1.33e-7),
        outer: body(3.71e-3, 1.6e-7),
        outer_first: false,
        joint: Joint::Clearance(Clearance {
            pin_radius: 2.045e-3,
            bore_radius: 2.07e-3,
            surface: smooth(law),
        }),
        rollers: RollerModel::Lumped { mass: 0.453e-3 },
    });
}

/// The equations of an implicit step hold for chains of rigid links on common shafts.
///
/// ```text
/// x + c M⁻¹C x = b,   M⁻¹C x = −∂a/∂v x, by finite differences of the accelerations
/// ```
#[test]
fn an_implicit_step_joins_chains_of_rigid_links() {
    let [a, b] = pair("first ", [20, 20], 0.0, EVEN, driven());
    let [c, d] = pair("second ", [20, 20], 2.0, EVEN, free(0.0));
    let free_end = sprocket("flywheel", 20, [4.0, 0.0], free(0.0));
    let mut parts = parts(
        vec![chain(40, [0, 1]), chain(40, [2, 3])],
        vec![a, b, c, d, free_end],
    );
    parts.gears.push(GearPair {
        name: "step".into(),
        shafts: [1, 2],
        ratio: -2.0,
    });
    parts.chains.iter_mut().for_each(with_play);
    parts.couplings.push(Coupling {
        name: "spring".into(),
        shafts: [3, 4],
        stiffness: 400.0,
        damping: 0.05,
    });
    parts.shafts[3].rotation = free(2.0);
    for sprocket in &mut parts.sprockets {
        sprocket.surface.law.dissipation = Dissipation::Viscous(Viscous { damping: 300.0 });
    }
    let assembled = assembled(parts);
    let (system, q) = (assembled.system, assembled.q);
    let accelerations = |v: &[f64]| {
        let mut record = system.new_record();
        let mut a = vec![0.0; q.len()];
        let at = Moment {
            t: 0.0,
            q: &q,
            v,
            z: &[],
        };
        system.evaluate(
            at,
            &mut a,
            &mut vec![0.0; system.quadratures()],
            &mut record,
        );
        (a, record)
    };
    let start = &assembled.v;
    let (_, mut record) = accelerations(start);
    let b: Vec<f64> = (0..q.len()).map(|i| (7.0 * i as f64).sin()).collect();
    let damping = 2e-6;
    let weights = Weights {
        once: false,
        damping,
        stiffness: 0.0,
    };
    let mut x = b.clone();
    assert!(system.solve(weights, &mut record, &mut x));
    let moved = |sign: f64| {
        let v: Vec<f64> = start
            .iter()
            .zip(&x)
            .map(|(v, x)| v + sign * 1e-3 * x)
            .collect();
        accelerations(&v).0
    };
    let (ahead, behind) = (moved(1.0), moved(-1.0));
    let mut damped = 0.0_f64;
    for i in 0..q.len() {
        // −∂a/∂v x
        let change = -(ahead[i] - behind[i]) / 2e-3;
        let left = x[i] + damping * change;
        damped = damped.max((x[i] - b[i]).abs());
        assert!(
            (left - b[i]).abs() < 1e-6,
            "{}: {left}, not {}",
            system.place(i),
            b[i]
        );
    }
    assert!(damped > 1e-3, "nothing was damped");
}
