//! Scratch.
use chaindrive::{Run, Scene, Simulation, Stepping};
use chaindrive_contact::dissipation::*;
use chaindrive_contact::elastic::*;
use chaindrive_contact::*;
use chaindrive_mechanics::*;
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().collect();
    let text = std::fs::read_to_string(&args[1])?;
    let model = args[2].as_str();
    let method = args[3].as_str();
    let step: f64 = args[4].parse()?;
    let until: f64 = args[5].parse()?;
    let drive = Scene::from_text(&text, &args[1])?.drive()?;
    let mut parts = drive.parts().clone();
    let steel = 113.7e9;
    let law = |hole: f64, pin: f64, length: f64| Surface {
        law: Law {
            elastic: CylinderLaw::Cylindrical
                .between(&Cylinders::pin_in_hole(hole, pin, length, steel))
                .unwrap(),
            dissipation: Dissipation::LankaraniNikravesh(LankaraniNikravesh { restitution: 0.7 }),
            onset_floor: 0.05,
        },
        friction: Friction::None,
    };
    let clearance = Joint::Clearance(Clearance {
        pin_radius: 2.045e-3,
        bore_radius: 2.07e-3,
        surface: law(2.07e-3, 2.045e-3, 5.0e-3),
    });
    let lumped = RollerModel::Lumped { mass: 0.453e-3 };
    let free = RollerModel::Free(FreeRoller {
        mass: 0.453e-3,
        inertia: 5.25e-9,
        bush_radius: 2.8e-3,
        bore_radius: 2.85e-3,
        surface: law(2.85e-3, 2.8e-3, 3.3e-3),
    });
    let (joint, rollers) = match model {
        "ideal" => (Joint::Ideal, lumped),
        "clearance" => (clearance, lumped),
        "free" => (clearance, free),
        "bush" => (clearance, RollerModel::Bush),
        _ => (Joint::Ideal, lumped),
    };
    if model != "particles" {
        parts.chain.model = ChainModel::Rigid(RigidLinks {
            inner: LinkBody {
                mass: 3.01e-3 - 0.0 * 0.9e-3,
                inertia: 1.33e-7,
                centre: [0.0, 0.0].into(),
            },
            outer: LinkBody {
                mass: 3.71e-3,
                inertia: 1.6e-7,
                centre: [0.0, 0.0].into(),
            },
            outer_first: false,
            joint,
            rollers,
        });
    }
    let drive = Drive::new(parts).map_err(|e| format!("{e:?}"))?;
    let t0 = std::time::Instant::now();
    let assembled = drive.assemble()?;
    println!("assembled in {:?}", t0.elapsed());
    println!(
        "time scale {:e}",
        chaindrive_integrate::SecondOrderSystem::time_scale(&assembled.system)
    );
    let run = Run {
        until,
        every: until / 20.0,
        stepping: Stepping::from_name(method).unwrap(),
        step: (step > 0.0).then_some(step),
        ..Run::default()
    };
    let mut simulation = Simulation::from_assembled(assembled, &run)?;
    while let Some(o) = simulation.next_sample()? {
        let c = o.contact_force.iter().filter(|f| **f > 0.0).count();
        println!(
            "{:9.6} spans {:?} w {:?} contacts {} maxF {:.1} joint {:.1} depth {:.3e}",
            o.time,
            o.span_tension
                .iter()
                .map(|t| (t * 1000.0).round() / 1000.0)
                .collect::<Vec<_>>(),
            o.sprocket_speed[1],
            c,
            o.contact_force.iter().fold(0.0f64, |m, f| m.max(*f)),
            o.joint_force.iter().fold(0.0f64, |m, f| m.max(*f)),
            o.joint_depth.iter().fold(0.0f64, |m, f| m.max(*f))
        );
    }
    let e = simulation.observation().energy;
    println!(
        "supplied {:e} dissipated {:e} residual {:e}",
        e.supplied(),
        e.dissipated(),
        simulation.energy_residual()
    );
    println!(
        "method {:?} {:?}",
        simulation.method(),
        simulation.statistics()
    );
    let wall = simulation.stepping_time();
    println!(
        "wall {wall:.3} s, RTF {:.4}, {:.1} ns/link-step",
        until / wall,
        wall * 1e9 / 104.0 / simulation.statistics().steps as f64
    );
    Ok(())
}
