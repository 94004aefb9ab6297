//! The energy ledger: every joule is accounted for.

use std::error::Error;
use std::f64::consts::PI;

use chaindrive::{Flow, Run, Scene, Simulation, Stepping, Summary, Verdict};

use crate::dynamics::{pairs, run};

/// Whether the verdict on a run that is over distrusts it.
fn is_distrusted(summary: &Summary, simulation: &Simulation) -> bool {
    Verdict::of(summary, simulation, None, None, None).is_distrusted()
}

/// Largest residual and energy supplied \[J\] of a run of the marine drive.
fn ledger(run: &Run) -> Result<(f64, f64), Box<dyn Error>> {
    let drive = Scene::preset("marine_engine_bare")?.drive()?;
    let mut simulation = Simulation::start(&drive, run)?;
    let mut summary = Summary::new(&simulation);
    while let Some(sample) = simulation.next_sample()? {
        summary.push(sample);
    }
    Ok((summary.residual.abs(), summary.energy_supplied()))
}

/// Theory: the ledger of an exact motion closes; what is left is the error of the time stepping.
/// At the reference setting it is below 1e-5 of the energy supplied over one second.
#[test]
fn the_reference_run_accounts_for_its_energy() -> Result<(), Box<dyn Error>> {
    let (residual, supplied) = ledger(&Run::reference(1.0, 1e-2))?;
    let share = residual / supplied;
    println!("residual {residual:.3e} J of {supplied:.4e} J: {share:.2e}");
    // 5 kN m at 13.3 rad/s for a second
    assert!(supplied > 6e4, "{supplied}");
    assert!(share < 1e-5, "{residual} of {supplied}");
    Ok(())
}

/// Theory: Verlet and its trapezoidal ledger are of second order, so a quarter of the step leaves a
/// sixteenth of the residual.
#[test]
fn the_residual_of_verlet_falls_with_the_square_of_the_step() -> Result<(), Box<dyn Error>> {
    let at = |step: f64| {
        let run = Run {
            until: 0.05,
            every: 1e-3,
            step: Some(step),
            ..Run::default()
        };
        ledger(&run).map(|(residual, _)| residual)
    };
    let (coarse, fine) = (at(4e-6)?, at(1e-6)?);
    let order = (coarse / fine).log2() / 2.0;
    println!("residual {coarse:.3e} J at 4 µs, {fine:.3e} J at 1 µs: order {order:.2}");
    assert!((order - 2.0).abs() < 0.3, "{order}");
    Ok(())
}

/// A free chain is given nothing: what it may lose is judged by what it moves about, and a run that makes energy
/// from nothing says so.
#[test]
fn a_run_without_a_driver_is_judged_too() -> Result<(), Box<dyn Error>> {
    let drive = Scene::preset("hanging_chain")?.drive()?;
    let run = Run {
        until: 0.05,
        every: 1e-3,
        ..Run::default()
    };
    let mut simulation = Simulation::start(&drive, &run)?;
    let mut summary = Summary::new(&simulation);
    let mut last = None;
    while let Some(sample) = simulation.next_sample()? {
        summary.push(sample);
        last = Some(sample.clone());
    }
    assert!(summary.energy_supplied().abs() < 1e-9);
    assert!(!is_distrusted(&summary, &simulation));

    // The same chain, twice as much energy of motion as it can have.
    let mut sample = last.ok_or("a run has samples")?;
    sample.energy.stores[0] += 2.0 * summary.energy_moved().max(1.0);
    summary.push(&sample);
    let verdict = Verdict::of(&summary, &simulation, None, None, None);
    assert_eq!(verdict.reasons[0].name(), "energy-missing", "{verdict}");
    Ok(())
}

/// A driver that takes back what it gave has moved energy, though it has supplied none.
#[test]
fn a_driver_that_reverses_has_moved_energy() -> Result<(), Box<dyn Error>> {
    let scene = Scene::preset("marine_two_sprockets")?.replace(
        "sprockets.crank.motion",
        r#"{ kind = "ramp", from = "-100 rpm", to = "100 rpm", start = "5 ms", duration = "10 ms" }"#,
    )?;
    // Reversed within 10 ms it would break.
    let scene = scene.replace("chain.breaking_load", "\"10 MN\"")?;
    let run = Run {
        until: 0.05,
        every: 1e-3,
        ..Run::default()
    };
    let mut simulation = Simulation::start(&scene.drive()?, &run)?;
    let mut summary = Summary::new(&simulation);
    while let Some(sample) = simulation.next_sample()? {
        summary.push(sample);
    }
    let (supplied, moved) = (summary.energy_supplied(), summary.energy_moved());
    assert!(moved > 2.0 * supplied, "{moved} of {supplied}");
    assert!(!is_distrusted(&summary, &simulation));
    Ok(())
}

/// Guides whose oil damps ten times as hard as that of the preset shorten no step: what they take is taken at the end of the step,
/// the ledger closes, and the tensions are those of a method that follows the damping.
#[test]
fn the_damping_of_guides_bounds_no_step() -> Result<(), Box<dyn Error>> {
    let scene = Scene::preset("timing_drive")?;
    let scene = scene.replace("contact.guides.onset_floor", r#""5 mm/s""#)?;
    let drive = scene
        .replace("contact.guides.restitution", "0.1")?
        .drive()?;
    let tensions = |stepping: Stepping, step: f64| -> Result<_, Box<dyn Error>> {
        let run = Run {
            until: 2e-3,
            every: 1e-5,
            stepping,
            step: Some(step),
            ..Run::default()
        };
        let mut simulation = Simulation::start(&drive, &run)?;
        let mut summary = Summary::new(&simulation);
        let mut tensions = Vec::new();
        while let Some(sample) = simulation.next_sample()? {
            summary.push(sample);
            tensions.extend_from_slice(&sample.span_tension);
        }
        let missing = summary.residual.abs() / summary.energy_dissipated();
        Ok((tensions, missing, *simulation.statistics()))
    };
    let (found, missing, counts) = tensions(Stepping::Verlet, 3e-6)?;
    let (exact, _, _) = tensions(Stepping::Rk4, 1e-7)?;
    let n = exact.len() as f64;
    let mean = exact.iter().sum::<f64>() / n;
    let squares = found.iter().zip(&exact).map(|(a, b)| (a - b).powi(2));
    let apart = (squares.sum::<f64>() / n).sqrt() / mean;
    println!("{apart:.2e} apart, {missing:.1e} of the losses missing, {counts:?}");
    assert_eq!(counts.reductions, 0);
    assert!(apart < 0.01, "{apart}");
    assert!(missing < 0.01, "{missing}");
    Ok(())
}

/// A chain without friction slides off a fixed pulley of half a turn and more, and its energy adds up: rollers and plates find the
/// face all the way round, and the edges at its ends.
#[test]
fn a_chain_slides_over_half_a_turn_and_its_energy_adds_up() {
    let (pitch, half, around) = (0.0127, 0.004, 12);
    let circle = 0.5 * pitch / (0.5 * PI / f64::from(around)).sin();
    let mut places = Vec::new();
    places.extend((1..=9).rev().map(|k| [circle, -pitch * f64::from(k)]));
    places.extend((0..=around).map(|k| {
        let (y, x) = (PI * f64::from(k) / f64::from(around)).sin_cos();
        [circle * x, circle * y]
    }));
    places.extend((1..=3).map(|k| [-circle, -pitch * f64::from(k)]));
    // Between their pins the plates are nearer to the middle.
    let across = circle * (0.5 * PI / f64::from(around)).cos();
    for (touches, nearest) in [("rollers", circle), ("plates", across)] {
        for beyond in [0.0, 0.3, 30.0, 85.0_f64] {
            let face = nearest - half;
            let text = format!(
                r#"
                settle = false
                [chain]
                pitch = {pitch}
                links = {links}
                mass = 0.004
                stiffness = 1e6
                roller_diameter = {height}
                plate_height = {height}
                ends = [{{ kind = "free" }}, {{ kind = "free" }}]
                [chain.start]
                kind = "points"
                positions = {positions}
                [contact.guides]
                law = {{ kind = "linear", stiffness = 1e6 }}
                damping = 0
                friction = "none"
                [contact.joints]
                friction = "none"
                [[guides]]
                name = "pulley"
                touches = "{touches}"
                face = {{ kind = "arc", centre = [0, 0], radius = {face}, from = "{from} deg", to = "{to} deg" }}
                [run]
                until = 0.2
                step = 4e-6
                every = 1e-3
                "#,
                links = places.len() - 1,
                height = 2.0 * half,
                positions = pairs(places.iter().copied()),
                from = -beyond,
                to = 180.0 + beyond,
            );
            let (mut start, mut moving) = (None, 0.0_f64);
            let (mut missing, mut deepest) = (0.0_f64, f64::MAX);
            run(&text, |sample| {
                let start = start.get_or_insert(sample.energy);
                missing = missing.max(sample.energy.residual(start).abs());
                moving = moving.max(sample.energy.kinetic());
                let places = sample.roller_x.iter().zip(&sample.roller_y);
                let above = places.filter(|(_, y)| **y > 0.0);
                deepest = above.map(|(x, y)| x.hypot(*y)).fold(deepest, f64::min);
            });
            println!("{touches}, {beyond}° beyond: {missing:.1e} of {moving:.3} J, {deepest} m");
            assert!(moving > 0.01, "{moving} J");
            assert!(missing < 1e-5 * moving, "{missing} of {moving} J");
            assert!(deepest > face + 0.9 * half, "{deepest} m from the middle");
        }
    }
}

/// Theory: an end that moves against a pull F supplies F s, whichever end it is, and however the links are joined.
#[test]
fn a_driven_end_supplies_what_it_pulls() {
    let (links, pitch, pull, until) = (3.0, 0.02, 50.0, 0.04);
    let steady = (r#"{ kind = "constant", speed = SIGN0.1 }"#, 0.1 * until);
    let swinging = (
        r#"{ kind = "harmonics", terms = [{ amplitude = SIGN0.02, frequency = 5 }] }"#,
        0.02 * (2.0 * PI * 5.0 * until).sin(),
    );
    let rigid = "rollers = \"none\"
        outer_first = true
        inner = { mass = 1e-3, inertia = 1e-7 }
        outer = { mass = 1e-3, inertia = 1e-7 }";
    for (model, body) in [
        ("particles", "mass = 1e-3".to_owned()),
        (
            "ideal-joints",
            format!("{rigid}\njoint = {{ pin_diameter = 0.004 }}"),
        ),
        (
            "clearance-joints",
            format!("{rigid}\njoint = {{ pin_diameter = 0.004, clearance = 5e-6, length = 0.01 }}"),
        ),
    ] {
        for (motion, way) in [steady, swinging] {
            for last in [false, true] {
                let sign = if last { "" } else { "-" };
                let driven = format!(
                    "{{ kind = \"driven\", x = {} }}",
                    motion.replace("SIGN", sign)
                );
                let pulled = format!(
                    "{{ kind = \"pulled\", force = [{}, 0] }}",
                    if last { -pull } else { pull }
                );
                let ends = if last {
                    [pulled, driven]
                } else {
                    [driven, pulled]
                };
                let scene = format!(
                    r#"
                    gravity = [0, 0]
                    [chain]
                    model = "{model}"
                    pitch = {pitch}
                    links = {links}
                    stiffness = 1e7
                    roller_diameter = 0.01
                    {body}
                    ends = [{}]
                    start = {{ kind = "line", from = [0, 0], to = [{}, 0] }}
                    [run]
                    until = {until}
                    every = 2e-3
                    "#,
                    ends.join(", "),
                    links * pitch,
                );
                let mut supplied = 0.0;
                run(&scene, |sample| {
                    supplied = sample.energy.flow(Flow::Motions);
                });
                // The swinging end sets three grams going, at up to 0.63 m/s.
                let kinetic = 0.5 * 3e-3 * (0.02_f64 * 2.0 * PI * 5.0).powi(2);
                let allowed = 1e-3 * pull * way + if motion == steady.0 { 2e-5 } else { kinetic };
                assert!(
                    (supplied - pull * way).abs() < allowed,
                    "{model}, last end: {last}, {motion}: {supplied} J, not {} J",
                    pull * way
                );
            }
        }
    }
}

/// Theory: links of length ℓ that turn at ω about the centre of a ring are dragged by their turning alone, P = Σ b ω² ℓ³/12; what they lose is what
/// the motion has less, and a ring that nothing else touches keeps its centre.
#[test]
fn drag_on_a_closed_ring_takes_what_it_says() -> Result<(), Box<dyn Error>> {
    let scene = Scene::preset("spinning_ring")?.replace("chain.drag", "200 N s/m^2")?;
    let run = Run {
        until: 1e-3,
        every: 1e-4,
        step: Some(1e-6),
        ..Run::default()
    };
    let mut simulation = Simulation::start(&scene.drive()?, &run)?;
    let first = simulation.next_sample()?.ok_or("no sample")?.clone();
    let mut last = first.clone();
    while let Some(sample) = simulation.next_sample()? {
        last = sample.clone();
    }
    let lost = last.energy.flow(Flow::DragLoss) - first.energy.flow(Flow::DragLoss);
    // Links are stretched to 14.859 mm.
    let power = 20.0 * 200.0 * 400_f64.powi(2) * 14.859e-3_f64.powi(3) / 12.0;
    assert!((lost / (power * 1e-3) - 1.0).abs() < 0.05, "{lost} J");
    assert!(simulation.energy_residual().abs() < 1e-3 * lost);
    let centre = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    for (before, after) in [
        (&first.roller_x, &last.roller_x),
        (&first.roller_y, &last.roller_y),
    ] {
        assert!((centre(before) - centre(after)).abs() < 1e-9);
    }
    Ok(())
}
