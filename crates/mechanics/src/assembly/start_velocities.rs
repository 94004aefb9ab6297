//! Velocities at t = 0: everything turns at the speed that the driven sprocket asks for.

use std::f64::consts::TAU;

use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::Moment;

use crate::bodies::{Shaft, TurnedBy};
use crate::drive::{Layout, SpanStart, Stop};
use crate::system::Member;
use crate::{Motion, System};

/// Velocities at the start: those that the layouts of the chains ask for, and along routes those of the sprockets at the speeds of the shafts.
pub(super) fn set_off(
    system: &System,
    layouts: &[&Layout],
    speeds: &[Option<f64>],
    q: &[f64],
) -> Vec<f64> {
    let mut v = vec![0.0; q.len()];
    for (shaft, speed) in system.bodies.shafts.iter().zip(speeds) {
        if let (Some(dof), Some(speed)) = (shaft.led(), speed) {
            v[dof] = *speed;
        }
    }
    for (member, layout) in system.chains.iter().zip(layouts) {
        let places = roller_places(member, q);
        let velocities = match layout {
            Layout::Route { start, .. } => along_route(system, (member, *start), &places, q, &v),
            Layout::Points { velocities, .. } => velocities.clone(),
        };
        let own = &mut v[member.entries.clone()];
        member.chain.set_off(&places, &velocities, own);
    }
    v
}

/// Angular speeds of the shafts \[rad/s\], where something prescribes them: their own motion, that of a shaft they are joined with,
/// or that of a chain that runs over their sprockets.
///
/// ```text
/// ω z p = the same for all sprockets of a route
/// ```
///
/// `rate` reads the speed off a motion.
pub(super) fn speeds(
    system: &System,
    layouts: &[&Layout],
    rate: impl Fn(&Motion) -> f64,
) -> Vec<Option<f64>> {
    let given = |shaft: &Shaft| match &shaft.turn.by {
        TurnedBy::Motion(motion) => Some(shaft.turn.ratio * rate(motion)),
        // That of a coordinate would be read off the state.
        TurnedBy::Coordinate(_) | TurnedBy::Driven { .. } => None,
    };
    let mut speeds: Vec<Option<f64>> = system.bodies.shafts.iter().map(given).collect();
    spread(system, layouts, &mut speeds);
    speeds
}

/// Passes the speeds that are known on to all shafts that gears, couplings and chains join with theirs.
pub(super) fn spread(system: &System, layouts: &[&Layout], speeds: &mut [Option<f64>]) {
    let mut waiting: Vec<usize> = (0..layouts.len()).collect();
    while share_shafts(system, speeds) | share_chains(system, layouts, &mut waiting, speeds) {}
}

/// Passes speeds on through gears and couplings; whether there was one to pass.
fn share_shafts(system: &System, speeds: &mut [Option<f64>]) -> bool {
    let shafts = &system.bodies.shafts;
    let mut news = false;
    for from in 0..shafts.len() {
        let (Some(speed), Some((dof, ratio))) = (speeds[from], shafts[from].turn.turned_by())
        else {
            continue;
        };
        for (shaft, other) in shafts.iter().zip(speeds.iter_mut()) {
            if let (None, Some((own, other_ratio))) = (*other, shaft.turn.turned_by())
                && own == dof
            {
                *other = Some(speed * other_ratio / ratio);
                news = true;
            }
        }
    }
    for coupling in &system.bodies.couplings {
        for [from, to] in [[0, 1], [1, 0]].map(|ends| ends.map(|end| coupling.shafts[end])) {
            if speeds[to].is_none() && speeds[from].is_some() {
                speeds[to] = speeds[from];
                news = true;
            }
        }
    }
    news
}

/// Passes speeds on along the routes of chains that wait for one; whether there was one to pass.
fn share_chains(
    system: &System,
    layouts: &[&Layout],
    waiting: &mut Vec<usize>,
    speeds: &mut [Option<f64>],
) -> bool {
    let before = waiting.len();
    waiting.retain(|&chain| {
        let Layout::Route { stops, .. } = layouts[chain] else {
            return false;
        };
        let member = &system.chains[chain];
        let pitch = member.chain.pitch();
        let known = stops.iter().find_map(|stop| match stop {
            Stop::Sprocket(index) => {
                let wheel = &system.bodies.wheels[*index];
                // Chain speed along the path: v = s ω z p / 2π
                speeds[wheel.shaft].map(|speed| wheel.sense * speed / pitch_angle(pitch, wheel))
            }
            Stop::Guide(_) => None,
        });
        let Some(speed) = known else { return true };
        for &index in &member.route {
            let wheel = &system.bodies.wheels[index];
            let own = wheel.sense * speed * pitch_angle(pitch, wheel);
            speeds[wheel.shaft].get_or_insert(own);
        }
        false
    });
    waiting.len() < before
}

fn roller_places(member: &Member, q: &[f64]) -> Vec<Point> {
    let own = &q[member.entries.clone()];
    (0..member.chain.rollers())
        .map(|roller| member.chain.roller_moving(own, roller).place)
        .collect()
}

/// Velocities of the rollers where sprockets carry them, and between.
///
/// ```text
/// v = v_c + ω × d on a sprocket;   quiet between:   v_i = ṅ ½ (p_{i+1} − p_{i−1}),   ṅ = s ω z/2π links a second
/// ```
///
/// A quiet span runs along itself: what the polygons do across it at the first instant averages to nothing over a tooth, and a
/// span that began with it would swing for long. With the polygon's kick velocities are linear between the sprockets. Either is
/// consistent to O((π/z)²), like every steady state of a polygon drive.
fn along_route(
    system: &System,
    (member, start): (&Member, SpanStart),
    places: &[Point],
    q: &[f64],
    v: &[f64],
) -> Vec<Vector> {
    let at = Moment::stateless(system.begin, q, v);
    let bodies = &system.bodies;
    let mut seats: Vec<Option<usize>> = vec![None; places.len()];
    for on in &member.contacts.teeth {
        let wheel = &bodies.wheels[on.wheel];
        let centre = bodies.wheel_centre(on.wheel, at);
        let circle = member.riding_radius(wheel);
        let seat = circle.hypot(0.5 * wheel.pitch);
        for (place, seated) in places.iter().zip(&mut seats) {
            if (place - centre).norm() < 0.5 * (circle + seat) {
                *seated = Some(on.wheel);
            }
        }
    }
    let rigid: Vec<Option<Vector>> = seats
        .iter()
        .zip(places)
        .map(|(seat, place)| {
            seat.map(|index| {
                let wheel = &bodies.wheels[index];
                let (centre, velocity, _) = wheel.centre_kinematics(at.t, q, v, &bodies.slides);
                let d = place - centre;
                // v = v_c + ω ẑ × d
                velocity + Vector::new(-d.y, d.x) * wheel.kinematics(at.t, q, v).rate
            })
        })
        .collect();
    if rigid.iter().all(Option::is_none) {
        return vec![Vector::zeros(); places.len()];
    }
    let links_a_second = member.route.first().map_or(0.0, |&index| {
        let wheel = &bodies.wheels[index];
        wheel.sense * wheel.kinematics(at.t, q, v).rate * f64::from(wheel.teeth) / TAU
    });
    let n = places.len();
    let free = |i: usize| match start {
        SpanStart::Polygon => between(&rigid, i),
        SpanStart::Quiet => {
            let along = places[(i + 1) % n] - places[(i + n - 1) % n];
            along * (0.5 * links_a_second)
        }
    };
    let velocities = rigid.iter().enumerate();
    velocities
        .map(|(i, seated)| seated.unwrap_or_else(|| free(i)))
        .collect()
}

/// Angle that one pitch of chain turns a wheel, per metre of chain.
fn pitch_angle(pitch: f64, wheel: &crate::bodies::Wheel) -> f64 {
    // 2π / (z p)
    TAU / (f64::from(wheel.teeth) * pitch)
}

/// Linear interpolation between the nearest seated rollers on both sides.
fn between(rigid: &[Option<Vector>], i: usize) -> Vector {
    let n = rigid.len();
    let look = |step: usize| (1..n).find_map(|k| rigid[(i + k * step) % n].map(|v| (k, v)));
    match (look(n - 1), look(1)) {
        (Some((before, a)), Some((after, b))) => {
            let share = before as f64 / (before + after) as f64;
            a * (1.0 - share) + b * share
        }
        _ => Vector::zeros(),
    }
}
