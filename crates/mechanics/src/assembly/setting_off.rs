//! Velocities at t = 0: everything turns at the speed that the driven sprocket asks for.

use chaindrive_geometry::{Point, Vector};
use chaindrive_integrate::Moment;

use crate::System;
use crate::drive::Stop;
use crate::system::{WheelRotation, WheelSupport};

/// Sets free sprockets and rollers going at the chain speed of the first driven sprocket.
///
/// ```text
/// ω z p = the same for all,    v = v_c + ω × d on a sprocket, linear in between
/// ```
///
/// Consistent to O((π/z)²), like every steady state of a polygon drive.
pub(super) fn along_route(system: &System, stops: &[Stop], q: &[f64], v: &mut [f64]) {
    let still = vec![0.0; v.len()];
    let at = Moment {
        t: 0.0,
        q,
        v: &still,
    };
    let speed = stops
        .iter()
        .filter_map(|stop| match stop {
            Stop::Sprocket(index) => Some(&system.wheels[*index]),
            Stop::Guide(_) => None,
        })
        .find_map(|wheel| match &wheel.rotation {
            // Chain speed along the path: v = s ω z p / 2π
            WheelRotation::Prescribed(motion) => {
                Some(wheel.sense * motion.at(0.0).rate / pitch_angle(system, wheel))
            }
            WheelRotation::Free { .. } => None,
        });
    let speed = speed.unwrap_or(0.0);

    let mut seats: Vec<Option<usize>> = vec![None; system.rollers];
    for (index, wheel) in system.wheels.iter().enumerate() {
        if let WheelRotation::Free { dof, .. } = wheel.rotation
            && system.route.contains(&index)
        {
            v[dof] = wheel.sense * speed * pitch_angle(system, wheel);
        }
        if let WheelSupport::Springs { dof, .. } = wheel.support {
            v[dof] = 0.0;
            v[dof + 1] = 0.0;
        }
        let (frame, _, _) = system.wheel_frame(wheel, at);
        let circle = system.riding_radius(wheel);
        let seat = circle.hypot(0.5 * wheel.pitch);
        for (i, place) in seats.iter_mut().enumerate() {
            if (Point::new(q[i], q[system.stride + i]) - frame.origin).norm()
                < 0.5 * (circle + seat)
            {
                *place = Some(index);
            }
        }
    }
    let n = system.stride;
    let rigid: Vec<Option<Vector>> = seats
        .iter()
        .enumerate()
        .map(|(i, seat)| {
            seat.map(|index| {
                let moving = Moment { t: 0.0, q, v };
                let (frame, _, _) = system.wheel_frame(&system.wheels[index], moving);
                let d = Point::new(q[i], q[n + i]) - frame.origin;
                // v = v_c + ω ẑ × d
                frame.velocity + Vector::new(-d.y, d.x) * frame.spin
            })
        })
        .collect();
    if rigid.iter().all(Option::is_none) {
        return;
    }
    for i in 0..system.rollers {
        let velocity = rigid[i].unwrap_or_else(|| between(&rigid, i));
        v[i] = velocity.x;
        v[n + i] = velocity.y;
    }
}

/// Angle that one pitch of chain turns a wheel, per metre of chain.
fn pitch_angle(system: &System, wheel: &crate::system::Wheel) -> f64 {
    // 2π / (z p)
    std::f64::consts::TAU / (f64::from(wheel.teeth) * system.pitch)
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

/// Gives the copies behind the last roller of a closed chain the velocities of their originals.
pub(super) fn ghosts(system: &System, v: &mut [f64]) {
    if system.links.closed {
        let n = system.stride;
        for ghost in system.rollers..n {
            v[ghost] = v[ghost % system.rollers];
            v[n + ghost] = v[n + ghost % system.rollers];
        }
    }
}
