//! Stepping from outside: pieces, inputs and snapshots, to the bit.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::time::Duration;

use chaindrive::{
    Assembled, Channel, ContactEvent, Control, EventKinds, Flow, Impact, Observation, Run, Scene,
    Simulation, Snapshot, Stepping,
};

use crate::judged::bare;

pub(crate) fn start(scene: &Scene, stepping: Stepping) -> Simulation {
    moving(&assembled(scene), stepping)
}

fn assembled(scene: &Scene) -> Assembled {
    scene.drive().unwrap().assemble().unwrap()
}

fn moving(assembled: &Assembled, stepping: Stepping) -> Simulation {
    let run = Run {
        stepping,
        ..Run::default()
    };
    Simulation::from_assembled(assembled.clone(), &run).unwrap()
}

pub(crate) fn preset(name: &str) -> Scene {
    Scene::preset(name).unwrap()
}

/// Roller, bush and pin of particles as points of their own.
pub(crate) fn loose() -> Scene {
    let scene = preset("industrial_16b");
    let scene = scene.replace("chain.rollers", "free").unwrap();
    scene
        .replace("chain.roller.clearance", "\"0.05 mm\"")
        .unwrap()
}

/// Joints that rub after `LuGre`: the bristles remember.
fn rubbing() -> Scene {
    let friction = "{ kind = \"lugre\", static_coefficient = 0.15, coefficient = 0.1, slip_speed = 0.01, stiffness = 1e5 }";
    let scene = preset("bicycle");
    scene.replace("contact.joints.friction", friction).unwrap()
}

/// A plunger on oil that can be compressed: the pressure is a state of its own.
fn oiled() -> Scene {
    let push = r#"{ kind = "hydraulic", preload = "40 N", stiffness = "2 N/mm", extending = "200 N s/m", relieving = "150 N s/m",
        oil = { diameter = "12 mm", length = "25 mm", gap = "25 µm", viscosity = "10 mPa s", supply = "0.3 MPa", relief = "3 MPa",
        bulk_modulus = "1.2 GPa", volume = "4 cm^3", air = "1 %" } }"#.replace('\n', " ");
    let scene = preset("timing_drive");
    scene.replace("tensioners.arm.push", &push).unwrap()
}

/// The oil begins under the pressure of its supply, comes under more, and the energy it costs is in the ledger.
#[test]
fn oil_has_a_pressure_of_its_own() {
    for stepping in METHODS {
        let mut simulation = start(&oiled(), stepping);
        let pressure = |simulation: &Simulation| simulation.channel(Channel::OilPressure);
        simulation.advance_to(0.0).unwrap();
        let supply = pressure(&simulation);
        assert!(
            supply.len() == 1 && (supply[0] / 0.3e6 - 1.0).abs() < 1e-6,
            "{supply:?}"
        );
        let mut least = f64::INFINITY;
        let mut most = 0.0_f64;
        for k in 1..=40 {
            simulation.advance_to(1e-4 * f64::from(k)).unwrap();
            let [now] = pressure(&simulation)[..] else {
                panic!("one tensioner has oil")
            };
            least = least.min(now);
            most = most.max(now);
        }
        assert!(
            least > -101_325.0 && most > 0.35e6 && most < 6e6,
            "{least} {most}"
        );
        let [residual] = simulation.channel(Channel::EnergyResidual)[..] else {
            panic!("one residual")
        };
        let lost = simulation.channel(Channel::EnergyDissipated)[0];
        assert!(
            residual.abs() < 1e-3 * lost,
            "{stepping:?}: {residual} of {lost}"
        );
    }
    let stiff = start(&preset("timing_drive"), Stepping::Auto);
    assert!(stiff.channel(Channel::OilPressure).is_empty());
}

/// Everything that moves, bit by bit.
pub(crate) fn bits(at: &Observation) -> Vec<u64> {
    let parts = [
        &at.roller_x,
        &at.roller_vy,
        &at.link_tension,
        &at.contact_force,
        &at.sprocket_angle,
        &at.sprocket_speed,
        &at.joint_force,
        &at.oil_pressure,
    ];
    let all = parts.into_iter().flatten().chain(&at.energy.flows);
    all.map(|value| value.to_bits()).collect()
}

pub(crate) const METHODS: [Stepping; 3] = [Stepping::Auto, Stepping::Rk4, Stepping::DormandPrince];

#[test]
fn a_run_in_a_hundred_pieces_is_the_run_in_one() {
    let scenes: [fn() -> Scene; 5] = [
        || preset("marine_engine"),
        || preset("bicycle"),
        rubbing,
        loose,
        oiled,
    ];
    for scene in scenes {
        let assembled = assembled(&scene());
        for stepping in METHODS {
            let mut whole = moving(&assembled, stepping);
            let mut pieces = whole.clone();
            let end = bits(whole.advance_to(1e-4).unwrap());
            for k in 0..100 {
                pieces.advance_to(1e-6 * f64::from(k)).unwrap();
            }
            assert_eq!(bits(pieces.advance_to(1e-4).unwrap()), end, "{stepping:?}");
            assert_eq!(pieces.statistics(), whole.statistics(), "{stepping:?}");
        }
    }
}

/// A change that is set when its time has come, and one that was planned beforehand, make the same run.
#[test]
fn equal_schedules_are_equal_runs() {
    let scene = preset("marine_engine");
    let torque = Control::Torque("camshaft".into());
    let force = Control::Force("tightener".into());
    let [centre_x, centre_y] = [Control::CentreX, Control::CentreY].map(|on| on("idler".into()));
    let schedule = [
        (0.0, &torque, 3e4),
        (3.3e-4, &centre_y, 40.0),
        (3.3e-4, &torque, -2e4),
        (7.77e-4, &force, 2e3),
        (7.77e-4, &centre_x, -15.0),
    ];
    for stepping in METHODS {
        let mut planned = start(&scene, stepping);
        for (time, control, value) in schedule {
            planned.set_at(time, control, value).unwrap();
        }
        let mut live = start(&scene, stepping);
        for (time, control, value) in schedule {
            live.advance_to(time).unwrap();
            live.set(control, value).unwrap();
        }
        let free = bits(start(&scene, stepping).advance_to(1.2e-3).unwrap());
        let [planned, live] = [planned, live].map(|mut run| bits(run.advance_to(1.2e-3).unwrap()));
        assert_eq!(planned, live, "{stepping:?}");
        assert_ne!(planned, free, "{stepping:?}");
    }
}

#[test]
fn a_snapshot_brings_back_every_bit() {
    let presets = ["marine_engine", "marine_engine_oil", "bicycle"];
    for scene in presets.map(preset).into_iter().chain([rubbing(), oiled()]) {
        let assembled = assembled(&scene);
        for stepping in METHODS {
            let fresh = moving(&assembled, stepping);
            let mut simulation = fresh.clone();
            simulation.advance_to(4.2e-4).unwrap();
            let kept = simulation.snapshot();
            let end = bits(simulation.advance_to(8e-4).unwrap());
            simulation.restore(&kept).unwrap();
            assert_eq!(bits(simulation.advance_to(8e-4).unwrap()), end);
            // Another simulation of the drive takes it as well, from memory or from bytes.
            let written = Snapshot::from_bytes(&kept.to_bytes()).unwrap();
            for kept in [&kept, &written] {
                let mut other = fresh.clone();
                other.restore(kept).unwrap();
                assert_eq!(bits(other.advance_to(8e-4).unwrap()), end);
                assert_eq!(other.statistics(), simulation.statistics());
            }
        }
    }
}

/// Rigid links, pins that rub, tensioners, guides, and a chain of each kind: in twenty pieces, each on a new
/// simulation that knows nothing but the bytes of the last.
#[test]
fn a_run_by_snapshots_is_the_run_in_one() {
    fn bicycle(model: &str) -> Scene {
        preset("bicycle").replace("chain.model", model).unwrap()
    }
    // By the defaults the joints of either rub, and their springs remember.
    let scenes: [(fn() -> Scene, bool); 5] = [
        (|| preset("marine_engine"), false),
        (rubbing, true),
        (loose, true),
        (|| bicycle("ideal-joints"), true),
        (|| bicycle("particles"), false),
    ];
    for (scene, solves) in scenes {
        let assembled = assembled(&scene());
        for stepping in [METHODS.as_slice(), &[Stepping::GeneralizedAlpha]].concat() {
            if stepping.is_implicit() && !solves {
                continue;
            }
            let fresh = moving(&assembled, stepping);
            let mut whole = fresh.clone();
            let end = bits(whole.advance_to(1e-4).unwrap());
            let mut bytes = fresh.snapshot().to_bytes();
            for k in 1..=20 {
                let mut piece = fresh.clone();
                piece
                    .restore(&Snapshot::from_bytes(&bytes).unwrap())
                    .unwrap();
                piece.advance_to(1e-4 * f64::from(k) / 20.0).unwrap();
                bytes = piece.snapshot().to_bytes();
                if k == 20 {
                    assert_eq!(
                        bits(piece.observation()),
                        end,
                        "{} {stepping:?}",
                        scene().name()
                    );
                    assert_eq!(piece.statistics(), whole.statistics());
                }
            }
        }
    }
}

/// Changes set before a snapshot, and planned ones, go on from it; those set after it are gone.
#[test]
fn a_snapshot_knows_what_is_set() {
    let scene = preset("marine_engine");
    let torque = Control::Torque("camshaft".into());
    let force = Control::Force("tightener".into());
    let [centre_x, centre_y] = [Control::CentreX, Control::CentreY].map(|on| on("idler".into()));
    let fresh = start(&scene, Stepping::Verlet);
    let mut simulation = fresh.clone();
    simulation.set(&centre_x, -15.0).unwrap();
    simulation.set(&torque, 3e4).unwrap();
    simulation.advance_to(3e-4).unwrap();
    simulation.set_at(6e-4, &force, 2e3).unwrap();
    let kept = simulation.snapshot().to_bytes();
    let end = bits(simulation.advance_to(9e-4).unwrap());
    let kept = Snapshot::from_bytes(&kept).unwrap();
    let mut other = fresh.clone();
    other.set(&centre_y, 40.0).unwrap();
    other.advance_to(1e-4).unwrap();
    other.restore(&kept).unwrap();
    assert_eq!(bits(other.advance_to(9e-4).unwrap()), end);
    // A change after the last reading, where the step before it was beyond.
    let mut first = fresh.clone();
    first.advance_to(3.3e-4).unwrap();
    let kept = Snapshot::from_bytes(&first.snapshot().to_bytes()).unwrap();
    let mut second = fresh.clone();
    second.restore(&kept).unwrap();
    let ends = [&mut first, &mut second].map(|run| {
        run.set(&torque, 5e4).unwrap();
        bits(run.advance_to(9e-4).unwrap())
    });
    assert_eq!(ends[0], ends[1]);
    assert_ne!(ends[0], end);
}

#[test]
fn a_snapshot_of_something_else_is_refused() {
    let scene = preset("marine_engine");
    let mut simulation = start(&scene, Stepping::Verlet);
    let before = bits(simulation.advance_to(1e-4).unwrap());
    let heavier = scene.replace("sprockets.camshaft.inertia", "2001 kg m^2");
    for other in [
        start(&heavier.unwrap(), Stepping::Verlet),
        start(&scene, Stepping::Rk4),
        start(&preset("bicycle"), Stepping::Auto),
    ] {
        let refused = simulation.restore(&other.snapshot()).unwrap_err();
        assert!(refused.to_string().contains("another drive"), "{refused}");
        assert_eq!(bits(simulation.advance_to(1e-4).unwrap()), before);
    }
}

/// A torque M on a free shaft with inertia J that touches nothing: ω = M t/J, and its work is in the ledger.
#[test]
fn a_torque_does_its_work() {
    let scene = preset("marine_two_sprockets");
    let scene = scene.replace("sprockets.camshaft.load", "[]").unwrap();
    let control = Control::Torque("camshaft".into());
    let mut with = start(&scene, Stepping::Verlet);
    let mut without = with.clone();
    let (torque, time) = (1e4, 5e-4);
    with.set(&control, torque).unwrap();
    let speed = |run: &mut Simulation| run.advance_to(time).unwrap().sprocket_speed[1];
    let gained = speed(&mut with) - speed(&mut without);
    // The chain answers before long: of the free shaft's M t/J a good part.
    let free = torque * time / 200.0;
    assert!(gained > 0.3 * free && gained < free, "{gained} of {free}");
    let work = with.observation().energy.flow(Flow::DriveTorque);
    let turned = with.observation().sprocket_angle[1];
    let scale = (torque * turned).abs();
    assert!((work - torque * turned).abs() < 1e-4 * scale, "{work} J");
    let residual = with.energy_residual().abs();
    assert!(residual < 1e-3 * scale, "{residual} of {scale}");
}

/// Steps land on the kinks of a torque table: RK4 keeps its order across them. In the bare drive no contact shortens a
/// step before them.
#[test]
fn steps_land_on_the_knots_of_a_table() {
    let load = "[{ kind = \"time-table\", times = [0, 1.23e-3, 1.5e-3], torques = [0, 0, 3e4] }]";
    let table = bare("marine_two_sprockets").replace("sprockets.camshaft.load", load);
    let mut simulation = start(&table.unwrap(), Stepping::Rk4);
    let step = simulation.method();
    simulation.advance_to(1.229e-3).unwrap();
    let before = simulation.statistics().smallest_step;
    simulation.advance_to(1.6e-3).unwrap();
    let after = simulation.statistics().smallest_step;
    assert!(after < before, "{step:?}: {after} s, {before} s");
}

/// A drive whose contacts are logged.
fn logged() -> Simulation {
    let run = Run {
        events: EventKinds {
            teeth: true,
            ..EventKinds::default()
        },
        every: 2e-3,
        until: 0.2,
        ..Run::default()
    };
    let assembled = assembled(&preset("marine_two_sprockets"));
    Simulation::from_assembled(assembled, &run).unwrap()
}

/// Times \[s\] and torques \[N m\].
fn changes() -> impl Iterator<Item = (f64, f64)> {
    (1..40).map(|k| (5e-3 * f64::from(k) + 1.7e-7, 100.0 * f64::from(k % 3)))
}

/// Contacts and impacts are handed out once, whenever one reads, whatever is set there and taken back.
#[test]
fn what_ended_is_handed_out_once() {
    let torque = Control::Torque("camshaft".into());
    let told = |of: &Simulation| format!("{:?} {:?}", of.events(), of.impacts());
    let mut planned = logged();
    for (time, value) in changes() {
        planned.set_at(time, &torque, value).unwrap();
    }
    let mut by_step = planned.clone();
    let [mut of_samples, mut of_readings, mut of_steps] = [(); 3].map(|()| Log::default());
    while planned.next_sample().unwrap().is_some() {
        of_samples.take(&planned);
    }
    let mut set = logged();
    for (time, value) in changes() {
        set.advance_to(time).unwrap();
        of_readings.take(&set);
        let copy = set.snapshot();
        set.set(&torque, value).unwrap();
        set.advance_to(time + 1e-6).unwrap();
        let first = told(&set);
        // Again, from the reading on.
        set.restore(&copy).unwrap();
        set.set(&torque, value).unwrap();
        set.advance_to(time + 1e-6).unwrap();
        assert_eq!(told(&set), first);
        of_readings.take(&set);
    }
    while by_step.time() < 0.2 {
        by_step.step(1).unwrap();
        of_steps.take(&by_step);
    }
    of_readings.begins_as(&of_samples);
    of_steps.begins_as(&of_samples);
}

/// The same at the end of a step, taken back after the drive has gone on.
#[test]
fn what_ended_is_handed_out_once_at_the_end_of_a_step() {
    let torque = Control::Torque("camshaft".into());
    let mut planned = logged();
    for (time, value) in changes() {
        planned.set_at(time, &torque, 1.0).unwrap();
        planned.set_at(time, &torque, value).unwrap();
    }
    let [mut of_samples, mut of_readings] = [(); 2].map(|()| Log::default());
    while planned.next_sample().unwrap().is_some() {
        of_samples.take(&planned);
    }
    let mut set = logged();
    for (time, value) in changes() {
        set.set_at(time, &torque, 1.0).unwrap();
        set.advance_to(time).unwrap();
        of_readings.take(&set);
        while set.time() <= time {
            let budget = Duration::from_micros(1);
            assert!(!set.advance_towards(time + 4e-3, budget).unwrap());
        }
        set.set(&torque, value).unwrap();
    }
    of_readings.begins_as(&of_samples);

    // Samples within a step, after a reading at its end.
    let mut mixed = logged();
    let mut log = Log::default();
    let mut next = 0.0;
    for (time, value) in changes() {
        while next < time - 1e-6 {
            mixed.next_sample().unwrap();
            log.take(&mixed);
            next = mixed.observation().time + 2e-3;
        }
        mixed.set_at(time, &torque, 1.0).unwrap();
        mixed.set_at(time, &torque, value).unwrap();
        mixed.advance_to(time).unwrap();
        log.take(&mixed);
    }
    log.begins_as(&of_samples);
}

/// Contacts and impacts handed out by a simulation.
#[derive(Default)]
struct Log {
    events: Vec<ContactEvent>,
    impacts: Vec<Impact>,
}

impl Log {
    fn take(&mut self, from: &Simulation) {
        self.events.extend_from_slice(from.events());
        self.impacts.extend_from_slice(from.impacts());
    }

    /// Agreement with another log, as far as both go.
    fn begins_as(&self, whole: &Self) {
        let events = self.events.len().min(whole.events.len());
        let impacts = self.impacts.len().min(whole.impacts.len());
        assert!(impacts > 4 && 2 * impacts > whole.impacts.len() && events > 10);
        assert_eq!(self.events[..events], whole.events[..events]);
        assert_eq!(self.impacts[..impacts], whole.impacts[..impacts]);
    }
}
