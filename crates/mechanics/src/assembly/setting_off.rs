//! Velocities at t = 0: everything turns at the speed that the driven sprocket asks for.

use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::Moment;

use crate::System;
use crate::drive::{Layout, Stop};
use crate::system::{WheelRotation, WheelSupport};

/// Gives a chain the velocities that its layout asks for, and along a route its sprockets too.
pub(super) fn set_off(system: &System, chain: usize, layout: &Layout, q: &[f64], v: &mut [f64]) {
    let places = roller_places(system, chain, q);
    let velocities = match layout {
        Layout::Route { stops, .. } => along_route(system, chain, stops, &places, q, v),
        Layout::Points { velocities, .. } => velocities.clone(),
    };
    let member = &system.chains[chain];
    let own = &mut v[member.entries.clone()];
    member.chain.set_off(&places, &velocities, own);
}

fn roller_places(system: &System, chain: usize, q: &[f64]) -> Vec<Point> {
    let member = &system.chains[chain];
    let own = &q[member.entries.clone()];
    (0..member.chain.rollers())
        .map(|roller| member.chain.roller_moving(own, roller).place)
        .collect()
}

/// Velocities of the rollers at the chain speed of the first driven sprocket; sets free sprockets going.
///
/// ```text
/// ω z p = the same for all,    v = v_c + ω × d on a sprocket, linear in between
/// ```
///
/// Consistent to O((π/z)²), like every steady state of a polygon drive.
fn along_route(
    system: &System,
    chain: usize,
    stops: &[Stop],
    places: &[Point],
    q: &[f64],
    v: &mut [f64],
) -> Vec<Vector> {
    let still = vec![0.0; v.len()];
    let at = Moment {
        t: 0.0,
        q,
        v: &still,
    };
    let bodies = &system.bodies;
    let member = &system.chains[chain];
    let pitch = member.chain.pitch();
    let speed = stops
        .iter()
        .filter_map(|stop| match stop {
            Stop::Sprocket(index) => Some(&bodies.wheels[*index]),
            Stop::Guide(_) => None,
        })
        .find_map(|wheel| match &wheel.rotation {
            // Chain speed along the path: v = s ω z p / 2π
            WheelRotation::Prescribed(motion) => {
                Some(wheel.sense * motion.at(0.0).rate / pitch_angle(pitch, wheel))
            }
            WheelRotation::Free { .. } => None,
        });
    let speed = speed.unwrap_or(0.0);

    let mut seats: Vec<Option<usize>> = vec![None; places.len()];
    for on in &member.contacts.teeth {
        let wheel = &bodies.wheels[on.wheel];
        if let WheelRotation::Free { dof, .. } = wheel.rotation
            && member.route.contains(&on.wheel)
        {
            v[dof] = wheel.sense * speed * pitch_angle(pitch, wheel);
        }
        if let WheelSupport::Springs { dof, .. } = wheel.support {
            v[dof] = 0.0;
            v[dof + 1] = 0.0;
        }
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
                let (centre, velocity, _) = wheel.centre_course(0.0, q, v, &bodies.slides);
                let d = place - centre;
                // v = v_c + ω ẑ × d
                velocity + Vector::new(-d.y, d.x) * wheel.course(0.0, q, v).rate
            })
        })
        .collect();
    if rigid.iter().all(Option::is_none) {
        return vec![Vector::zeros(); places.len()];
    }
    (0..places.len())
        .map(|i| rigid[i].unwrap_or_else(|| between(&rigid, i)))
        .collect()
}

/// Angle that one pitch of chain turns a wheel, per metre of chain.
fn pitch_angle(pitch: f64, wheel: &crate::system::Wheel) -> f64 {
    // 2π / (z p)
    std::f64::consts::TAU / (f64::from(wheel.teeth) * pitch)
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
