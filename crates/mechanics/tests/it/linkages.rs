//! Eliminations and contacts of chains of rigid links, each computed in two ways.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use crate::pieces;
use crate::pieces::{around, assembled, body};

use chaindrive_contact::dissipation::LankaraniNikravesh;
use chaindrive_contact::elastic::{CylinderLaw, Cylinders, ElasticLaw, Power};
use chaindrive_contact::friction::Coulomb;
use chaindrive_contact::{Dissipation, Elastic, Friction, Law};
use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::{InstructionSet, Moment, Registers, SecondOrderSystem, Weights};
use chaindrive_mechanics::inside::{chain, teeth};
use chaindrive_mechanics::{
    Action, Assembled, ChainModel, Clearance, Coupling, End, Ends, Flank, Flow, FreeRoller, Joint,
    Layout, Motion, Observation, Parts, Record, RigidLinks, RollerModel, Rotation, Shaft, Sprocket,
    StartSpeed, Support, Surface, System,
};
use nalgebra::DVector;

/// Coordinates of the rollers of the bicycle's chain, as particles.
const ROLLERS: usize = 2 * 104;

/// Steel on steel with a little friction, so that normals and tangents take part.
fn surface(hole: f64, pin: f64, length: f64) -> Surface {
    let pair = Cylinders::pin_in_hole(hole, pin, length, 113.7e9);
    Surface {
        law: Law {
            series: None,
            elastic: CylinderLaw::Cylindrical.between(&pair).unwrap(),
            dissipation: Dissipation::LankaraniNikravesh(LankaraniNikravesh { restitution: 0.7 }),
            onset_floor: 0.05,
        },
        friction: Friction::Coulomb(Coulomb {
            coefficient: 0.1,
            slip_speed: 0.01,
        }),
        film: None,
    }
}

/// 44/18 teeth, 104 links of half an inch, centre distance computed so that they close without stress.
fn bicycle(model: ChainModel) -> Parts {
    let (pitch, roller_diameter) = (0.0127, 7.75e-3);
    let sprocket = |name: &str, teeth: u32, x: f64, shaft: usize, inertia: f64| {
        let surface = surface(3.982e-3, 3.875e-3, 3.3e-3);
        Sprocket {
            shaft,
            inertia,
            ..pieces::sprocket(name, teeth, [pitch, roller_diameter], [x, 0.0], surface)
        }
    };
    let driven = Rotation::Free {
        drive: Vec::new(),
        load: vec![Action::Constant { value: 5.0 }.into()],
        start: StartSpeed::Joined,
    };
    let driver = Rotation::Prescribed(Motion::Constant { rate: -9.42 });
    let of = [pitch, 3.81e-3, 47.7e6];
    let mut chain = pieces::links(104, of, [roller_diameter, 9.6e-3], Ends::Closed, model);
    chain.damping.fill(25.6);
    Parts {
        sprockets: vec![
            sprocket("chainring", 44, 0.0, 0, 0.0),
            sprocket("sprocket", 18, -0.460_544_624_366, 1, 0.12),
        ],
        shafts: vec![Shaft::of_one(driver), Shaft::of_one(driven)],
        settle: true,
        gravity: Vector::new(0.0, -9.81),
        ..pieces::alone(vec![around(chain, &[0, 1], 60.0)])
    }
}

fn links(joint: Joint, rollers: RollerModel) -> ChainModel {
    ChainModel::Rigid(RigidLinks {
        inner: body(3.01e-3, 1.33e-7),
        outer: body(3.71e-3, 1.6e-7),
        outer_first: false,
        joint,
        rollers,
    })
}

fn clearance() -> Joint {
    Joint::Clearance(Clearance {
        pin_radius: 2.045e-3,
        bore_radius: 2.07e-3,
        surface: surface(2.07e-3, 2.045e-3, 5e-3),
    })
}

fn free_rollers() -> RollerModel {
    RollerModel::Free(FreeRoller {
        mass: 0.453e-3,
        inertia: 5.25e-9,
        bush_radius: 2.8e-3,
        bore_radius: 2.85e-3,
        surface: surface(2.85e-3, 2.8e-3, 3.3e-3),
    })
}

/// Drives with clearance joints, and a strand.
fn kinds() -> Vec<(&'static str, Parts)> {
    let lumped = RollerModel::Lumped { mass: 0.453e-3 };
    let smooth = |mut parts: Parts| {
        if let ChainModel::Rigid(links) = &mut parts.chains[0].chain.model
            && let Joint::Clearance(joint) = &mut links.joint
        {
            joint.surface.friction = Friction::None;
        }
        for sprocket in &mut parts.sprockets {
            sprocket.surface.friction = Friction::None;
        }
        parts
    };
    let rough = bicycle(links(clearance(), lumped));
    let mut sprung = smooth(rough.clone());
    sprung.sprockets[1].support = Support::Springs {
        stiffness: [1e7; 2],
        damping: [1e3; 2],
    };
    vec![
        ("lumped rollers, smooth", smooth(rough.clone())),
        ("lumped rollers, rough", rough.clone()),
        (
            "bush chain, rough",
            bicycle(links(clearance(), RollerModel::Bush)),
        ),
        (
            "free rollers, smooth",
            smooth(bicycle(links(clearance(), free_rollers()))),
        ),
        (
            "free rollers, rough",
            bicycle(links(clearance(), free_rollers())),
        ),
        ("sprung wheel", sprung),
        ("strand, smooth", smooth(strand(rough.clone(), 30e-6))),
        ("strand, rough", strand(rough, 30e-6)),
    ]
}

/// Eleven links of a chain held at both ends, each laid longer than it is by so much.
fn strand(mut parts: Parts, longer: f64) -> Parts {
    let links = 11;
    let placed = &mut parts.chains[0];
    let chain = &mut placed.chain;
    chain.lengths.truncate(links);
    chain.stiffness.truncate(links);
    chain.damping.truncate(links);
    chain.masses = vec![chain.masses[0]; links + 1];
    chain.ends = Ends::Open([End::Fixed, End::Fixed]);
    let pitch = chain.pitch + longer;
    placed.layout = Layout::Points {
        positions: (0..=links)
            .map(|i| Point::new(pitch * i as f64, 1e-6 * (i % 3) as f64))
            .collect(),
        velocities: vec![Vector::zeros(); links + 1],
    };
    placed.sprockets.clear();
    parts.sprockets.clear();
    parts.shafts.clear();
    parts.settle = false;
    parts
}

/// A drive at its start, with the accelerations there.
struct Start {
    system: System,
    record: Record,
    q: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
}

impl Start {
    fn of(parts: Parts) -> Self {
        let Assembled { system, q, v, .. } = assembled(parts);
        let (record, a, _) = evaluated(&system, at(0.0, &q, &v));
        Self {
            system,
            record,
            q,
            v,
            a,
        }
    }
}

fn at<'a>(t: f64, q: &'a [f64], v: &'a [f64]) -> Moment<'a> {
    Moment { t, q, v, z: &[] }
}

/// The record of a moment, the accelerations there, and the flows of energy.
fn evaluated(system: &System, at: Moment<'_>) -> (Record, Vec<f64>, Vec<f64>) {
    let mut record = system.new_record();
    let mut a = vec![0.0; system.dofs()];
    let mut rates = vec![0.0; Flow::ALL.len()];
    system.evaluate(at, &mut a, &mut rates, &mut record);
    (record, a, rates)
}

/// The chain is given its pretension whatever it is made of.
#[test]
fn pretension_is_met() {
    let lumped = RollerModel::Lumped { mass: 0.453e-3 };
    for (joint, rollers) in [
        (clearance(), lumped),
        (clearance(), RollerModel::Bush),
        (clearance(), free_rollers()),
        (Joint::Ideal, lumped),
    ] {
        let mut parts = bicycle(links(joint, rollers));
        parts.gravity = Vector::zeros();
        if let Rotation::Free { load, .. } = &mut parts.shafts[1].rotation {
            load.clear();
        }
        if let Rotation::Prescribed(motion) = &mut parts.shafts[0].rotation {
            *motion = Motion::Held;
        }
        let assembled = assembled(parts);
        let (system, q) = (assembled.system, assembled.q);
        let still = vec![0.0; q.len()];
        let at = at(0.0, &q, &still);
        let mut seen = Observation::default();
        let flows = vec![0.0; Flow::ALL.len()];
        system.observe(at, &flows, &mut system.new_record(), &mut seen);
        let mean = seen.link_tension.iter().sum::<f64>() / seen.link_tension.len() as f64;
        assert!(
            (mean / 60.0 - 1.0).abs() < 2e-3,
            "{joint:?}, {rollers:?}: {mean} N"
        );
    }
}

/// The lanes and the scalar path see the same surfaces and the same law, on seats, flanks and in the passage
/// between them.
#[test]
fn lanes_and_scalar_contacts_agree() {
    let flank = Flank {
        elastic: Elastic::Power(Power::linear(4e7)),
        width: 4e-4,
    };
    let mut parts = bicycle(ChainModel::Particles);
    for sprocket in &mut parts.sprockets {
        sprocket.surface.friction = Friction::None;
        sprocket.flank = Some(flank);
    }
    let law = parts.sprockets[0].surface.law;
    let assembled = assembled(parts);
    let (system, still) = (assembled.system, vec![0.0; assembled.q.len()]);
    let mut shares = [0; 3];
    // Shaking the rollers brings them onto the flanks.
    for shake in 0..40_u32 {
        let mut q = assembled.q.clone();
        for (i, x) in q[..ROLLERS].iter_mut().enumerate() {
            *x += 2e-5 * f64::from(shake) * (f64::from(shake) + i as f64 % 104.0).sin();
        }
        let at = at(0.0, &q, &still);
        let (record, ..) = evaluated(&system, at);
        for tooth in teeth(&system, &record, at) {
            let depth = -tooth.gaps[0];
            // The wheel turns under rollers at rest: only the elastic part is compared.
            if depth <= 0.0 || tooth.closing.abs() > 0.0 && tooth.force == 0.0 {
                continue;
            }
            assert!((tooth.gaps[1] - tooth.gaps[0]).abs() < 1e-16);
            let share = tooth.share;
            let elastic =
                (1.0 - share) * law.elastic_force(depth) + share * flank.elastic.force(depth);
            let rate = tooth.closing * tooth.inverse_onset;
            let damped = (1.0 + law.dissipation.factor().unwrap_or(0.0) * rate.min(4.0)).max(0.0);
            let factor = tooth.force / elastic;
            assert!(
                (factor / damped - 1.0).abs() < 1e-12,
                "{factor} {damped} {share}"
            );
            shares[if share <= 0.0 {
                0
            } else {
                1 + usize::from(share >= 1.0)
            }] += 1;
        }
    }
    assert!(shares.iter().all(|count| *count > 10), "{shares:?}");
}

/// However many numbers go side by side, the forces are the same.
#[test]
fn lanes_of_any_width_agree() {
    let mut parts = bicycle(ChainModel::Particles);
    for sprocket in &mut parts.sprockets {
        sprocket.flank = Some(Flank {
            elastic: Elastic::Power(Power::linear(4e7)),
            width: 4e-4,
        });
    }
    let assembled = assembled(parts);
    let system = assembled.system;
    let mut narrow = system.clone();
    narrow.compute_on(Registers::of(InstructionSet::Baseline).unwrap());
    for shake in 0..40_u32 {
        let mut q = assembled.q.clone();
        let mut v = assembled.v.clone();
        for (i, x) in q[..ROLLERS].iter_mut().enumerate() {
            *x += 2e-5 * f64::from(shake) * (f64::from(shake) + i as f64 % 104.0).sin();
        }
        for (i, v) in v[..ROLLERS].iter_mut().enumerate() {
            *v += 0.1 * (f64::from(3 * shake) + i as f64 % 104.0).cos();
        }
        let [wide, narrow] = [&system, &narrow].map(|system| {
            let (_, mut a, rates) = evaluated(system, at(1e-5, &q, &v));
            a.extend(rates);
            a
        });
        let scale = wide.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        for (i, (x, y)) in wide.iter().zip(&narrow).enumerate() {
            assert!((x - y).abs() < 1e-12 * scale, "{shake}, {i}: {x} {y}");
        }
    }
}

/// Drives with ideal joints.
fn held_kinds() -> Vec<(&'static str, Parts)> {
    let ideal = |rollers: RollerModel| -> ChainModel { links(Joint::Ideal, rollers) };
    let lumped = bicycle(ideal(RollerModel::Lumped { mass: 0.453e-3 }));
    let mut sprung = lumped.clone();
    sprung.sprockets[1].support = Support::Springs {
        stiffness: [1e7; 2],
        damping: [1e3; 2],
    };
    vec![
        ("lumped rollers", lumped.clone()),
        ("free rollers", bicycle(ideal(free_rollers()))),
        ("sprung wheel", sprung),
        ("strand", strand(lumped, 0.0)),
    ]
}

/// Contacts, bodies and joints as one dense system that is solved with pivots: an elimination of its own.
#[test]
fn held_joints_agree_with_the_whole_system() {
    for (kind, parts) in held_kinds() {
        for stiffness in [0.0, 1e-9] {
            let Start {
                system,
                mut record,
                a: b,
                ..
            } = Start::of(parts.clone());
            let weights = Weights {
                once: false,
                damping: 2e-6,
                stiffness,
            };
            let (matrix, right) = chain(&system, &mut record).equations(weights, &b);
            let exact = matrix.clone().lu().solve(&right).expect("a solution");
            let x = chain(&system, &mut record)
                .held(weights, &b)
                .expect("an answer");
            let exact = &exact.as_slice()[..b.len()];
            let size = exact.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            let mut change = 0.0_f64;
            for (i, (x, exact)) in x.iter().zip(exact).enumerate() {
                let error = (x - exact).abs() / size;
                assert!(error < 1e-11, "{kind}, {i}: {x} {exact}");
                change = change.max((x - b[i]).abs() / size);
            }
            assert!(change > 1e-3 || kind == "strand", "{kind}: {change}");
            // J x = J b
            let joints = matrix.view((b.len(), 0), (matrix.nrows() - b.len(), b.len()));
            let moved = DVector::from_iterator(b.len(), x.iter().zip(&b).map(|(x, b)| x - b));
            for (joint, left) in (joints * moved).as_slice().chunks(2).enumerate() {
                let left = left[0].hypot(left[1]);
                assert!(left < 1e-12 * size, "{kind}, {joint}: {left}");
            }
        }
    }
}

/// Lanes of any width against one joint at a time, as free rollers and their bushes are looked at.
#[test]
fn joints_at_once_are_as_one_by_one() {
    for (kind, parts) in kinds() {
        let mut start = Start::of(parts);
        let at = at(0.0, &start.q, &start.v);
        let inside = chain(&start.system, &mut start.record);
        let alone = inside.joints_one_by_one(at);
        let narrow = Registers::of(InstructionSet::Baseline).unwrap();
        for registers in [narrow, Registers::in_use()] {
            let all = inside.joints_at_once(registers);
            let mut closed = 0;
            for (joint, pair) in alone.closed.iter().zip(&all.closed).enumerate() {
                assert_eq!(pair.0.is_some(), pair.1.is_some(), "{kind}, {joint}");
                let (Some(a), Some(b)) = pair else { continue };
                closed += 1;
                // Depths are differences of radii and lose four digits.
                // A slip is a small difference of large velocities.
                assert!((a.rub - b.rub).abs() <= 1e-12 * a.force, "{kind}, {joint}");
                assert!(
                    (a.secant - b.secant).abs() <= 1e-9 * a.secant,
                    "{kind}, {joint}"
                );
                let pairs = a.others.into_iter().zip(b.others);
                for (a, b) in pairs.chain([(a.force, b.force)]) {
                    assert!(
                        (a - b).abs() <= 1e-12 * a.abs() + 1e-15,
                        "{kind}, {joint}: {a} {b}"
                    );
                }
            }
            assert!(closed > 9, "{kind}: {closed}");
            for ([gap, onset], [gap_too, onset_too]) in alone.kept.iter().zip(&all.kept) {
                assert!((gap - gap_too).abs() < 1e-17);
                assert!((onset - onset_too).abs() <= 1e-12 * onset);
            }
            for (a, b) in alone.losses.into_iter().zip(all.losses) {
                assert!((a - b).abs() <= 1e-12 * a.abs().max(1e-9), "{kind}");
            }
        }
    }
}

/// The bodies' own equations, block by block, give the same answer as the impulses: two independent eliminations.
#[test]
fn impulses_agree_with_the_equations_of_the_bodies() {
    let stiffnesses = [0.0, 1e-12];
    let cases = kinds()
        .into_iter()
        .flat_map(|kind| stiffnesses.map(|k| (kind.clone(), k)));
    for ((kind, parts), stiffness) in cases {
        let Start {
            system,
            mut record,
            a: b,
            ..
        } = Start::of(parts);
        let weights = Weights {
            damping: 2e-6,
            stiffness,
            once: true,
        };
        let mut inside = chain(&system, &mut record);
        let impulses = inside.by_impulses(weights, &b).expect("an answer");
        let blocks = inside.by_blocks(weights, &b).expect("an answer");
        let size = b.iter().fold(0.0_f64, |m, b| m.max(b.abs()));
        for (i, (found, exact)) in impulses.iter().zip(&blocks).enumerate() {
            let error = (found - exact).abs() / size;
            assert!(error < 1e-12, "{kind}, {i}: {found} {exact}");
        }
        // And it is not the undamped answer.
        let change = impulses.iter().zip(&b).map(|(x, b)| (x - b).abs());
        assert!(change.fold(0.0, f64::max) > 1e-3 * size, "{kind}");
    }
}

/// However many unknowns wheels and shafts have, a step has the solution of the whole system, dense and with pivots.
#[test]
fn many_wheels_have_the_answer_of_the_whole_system() {
    let mut lumped = bicycle(links(clearance(), RollerModel::Lumped { mass: 0.453e-3 }));
    for sprocket in &mut lumped.sprockets {
        sprocket.support = Support::Springs {
            stiffness: [1e7; 2],
            damping: [1e3; 2],
        };
    }
    // Two centres and the shaft of the second one are five unknowns; the others are shafts in a row behind it.
    for unknowns in [5, 20] {
        let mut parts = lumped.clone();
        for behind in 1..unknowns - 4 {
            parts.shafts.push(Shaft {
                name: Some(format!("shaft {behind}")),
                rotation: Rotation::Free {
                    drive: Vec::new(),
                    load: Vec::new(),
                    start: StartSpeed::Joined,
                },
                inertia: 0.01,
                loss: chaindrive_mechanics::ShaftLoss::default(),
            });
            parts.couplings.push(Coupling {
                name: format!("coupling {behind}"),
                shafts: [behind, behind + 1],
                stiffness: 400.0 * behind as f64,
                damping: 0.05,
            });
        }
        let Start {
            system,
            mut record,
            a: b,
            ..
        } = Start::of(parts);
        assert_eq!(b.len() - 3 * 104, unknowns);
        let weights = Weights {
            damping: 2e-6,
            stiffness: 1e-12,
            once: true,
        };
        let inside = chain(&system, &mut record);
        // Without the conditions of ideal joints, which stand after.
        let (matrix, right) = inside.equations(weights, &b);
        let matrix = matrix.view((0, 0), (b.len(), b.len())).into_owned();
        let right = right.rows(0, b.len()).into_owned();
        let exact = matrix.lu().solve(&right).expect("a solution");
        let mut found = b.clone();
        assert!(system.solve(weights, &mut record, &mut found));
        let size = exact.amax();
        let mut change = 0.0_f64;
        for (i, (found, exact)) in found.iter().zip(&exact).enumerate() {
            let error = (found - exact).abs() / size;
            assert!(error < 1e-12, "{unknowns}, {i}: {found} {exact}");
            change = change.max((found - b[i]).abs() / size);
        }
        assert!(change > 1e-3, "{unknowns}: {change}");
    }
}
