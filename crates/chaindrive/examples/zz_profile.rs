//! scratch
use chaindrive::Scene;
use chaindrive_integrate::{Method, SecondOrderSystem, State};
use std::time::Instant;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let steps: usize = args[2].parse().unwrap();
    let mut scene = Scene::preset(&args[1]).unwrap();
    for c in &args[3..] {
        let (a, b) = c.split_once('=').unwrap();
        scene = scene.replace(a, b).unwrap();
    }
    let drive = scene.drive().unwrap();
    let assembled = drive.assemble().unwrap();
    let mut system = assembled.system.clone();
    let links = system.links() as f64;
    let m = if system.can_solve() {
        Method::ImplicitDamping {
            step: 1.4 * system.undamped_time_scale(),
        }
    } else {
        Method::Verlet {
            step: 0.5 * system.time_scale(),
        }
    };
    let mut state = State::new(0.0, assembled.q.clone(), assembled.v.clone());
    let mut st = m.start(&mut system, &mut state).unwrap();
    let mut best = f64::MAX;
    let mut all = vec![];
    for _ in 0..9 {
        let t = Instant::now();
        for _ in 0..steps {
            st.advance(&mut system, &mut state).unwrap();
        }
        let ns = t.elapsed().as_secs_f64() * 1e9 / steps as f64 / links;
        best = best.min(ns);
        all.push(ns);
    }
    all.sort_by(f64::total_cmp);
    println!(
        "{} links {links}: min {best:.2} median {:.2} ns per link-step, candidates {}",
        args[1],
        all[4],
        system.candidates()
    );
}
