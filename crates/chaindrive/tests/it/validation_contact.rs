//! Contact laws in motion (validation cases C05, C09, and the restitution of every dissipation).
#![allow(clippy::print_stdout, reason = "measured errors are worth a look")]

use crate::dynamics;

use chaindrive::ContactEvent;
use chaindrive_contact::elastic::{ElasticLaw, Johnson, Power};
use chaindrive_contact::restitution::delivered;
use chaindrive_contact::{Dissipation, Elasticity};
use chaindrive_integrate::{Method, Moment, SecondOrderSystem, State};
use chaindrive_validation::Case;
use chaindrive_validation::Tolerance::{Absolute, Relative};

#[test]
fn c05_johnson_at_the_listed_loads() {
    let case = Case::read("C05");
    let body = Elasticity {
        modulus: case.number("inputs.E"),
        poisson: case.number("inputs.nu"),
    };
    for row in case.table("expected.rows") {
        let [outer, inner, clearance, load, depth] = row[..] else {
            panic!("five columns")
        };
        // Inside one another the clearance is the difference of the radii, beside one another their sum.
        let law = if clearance < outer {
            Johnson::internal(outer, inner, 1.0, body.composite(body))
        } else {
            Johnson::external(outer, inner, 1.0, body.composite(body))
        };
        // The formula turns back at a greatest indentation; every row is short of it.
        assert!(depth < 0.9 * law.greatest_penetration());
        let tolerance = Relative(case.number("tolerance.relative"));
        let quantity = "load at the listed indentation";
        case.judge(quantity, "N/m", law.force(depth), load, tolerance);
    }
}

/// Masses in a row that touch: m a_i = g(δ_{i−1}) − g(δ_i).
struct Row {
    masses: usize,
    law: Power,
}

impl SecondOrderSystem for Row {
    type Record = ();

    fn new_record(&self) {}

    fn dofs(&self) -> usize {
        self.masses
    }

    fn evaluate(&self, at: Moment<'_>, a: &mut [f64], _: &mut [f64], (): &mut ()) {
        a.fill(0.0);
        for i in 0..self.masses - 1 {
            let force = self.law.force(at.q[i] - at.q[i + 1]);
            a[i] -= force;
            a[i + 1] += force;
        }
    }
}

#[test]
fn c09_row_of_equal_masses() {
    let case = Case::read("C09");
    for row in case.table("expected.rows") {
        let (masses, exponent) = (row.len() - 2, row[1]);
        let mut system = Row {
            masses,
            law: Power {
                stiffness: 1e4,
                exponent,
            },
        };
        let mut v = vec![0.0; masses];
        v[0] = 1.0;
        let mut state = State::new(0.0, vec![0.0; masses], v);
        let mut stepper = Method::Rk4 { step: 1e-4 }
            .start(&mut system, &mut state)
            .unwrap();
        while state.t < 2.0 {
            stepper.advance(&mut system, &mut state).unwrap();
        }
        let tolerance = Absolute(case.number("tolerance.absolute"));
        let quantity = "speeds after the impact, masses in a row";
        case.judge_each(quantity, "v₀", &state.v, &row[2..], tolerance);
    }
}

/// A pin that flies to and fro in its bush, without weight: its impacts.
fn bounces(dissipation: &str, restitution: f64) -> Vec<ContactEvent> {
    let scene = format!(
        r#"
        gravity = [0, 0]
        settle = false
        [chain]
        model = "clearance-joints"
        rollers = "none"
        outer_first = true
        links = 1
        pitch = 0.022
        roller_diameter = 0.03
        joint = {{ pin_diameter = 0.01, clearance = 1e-3, length = 0.01 }}
        inner = {{ mass = 0.01, inertia = 1e-6 }}
        outer = {{ mass = 0.01, inertia = 1e-6, centre = [-0.01, 0] }}
        ends = ["fixed", "free"]
        start = {{ kind = "points", positions = [[0, 0], [0, 0.0218]], velocities = [[0, -0.5], [0, -0.5]] }}
        [contact.joints]
        law = {{ kind = "power", stiffness = 1e10, exponent = 1.5 }}
        dissipation = "{dissipation}"
        restitution = {restitution}
        onset_floor = 1e-6
        [run]
        until = 0.013
        every = 1e-3
        events = ["joints"]
        method = "rk4"
        step = 1e-7
        onset_depth = 2e-10
        "#
    );
    let mut events: Vec<ContactEvent> = Vec::new();
    let mut simulation = dynamics::start(&scene);
    while let Ok(Some(_)) = simulation.next_sample() {
        events.extend(simulation.events());
    }
    events.extend(simulation.outstanding_events());
    events
}

/// In the dynamics as in theory: the drop delivers the restitution of the factor, for every dissipation.
#[test]
fn a_drop_delivers_the_restitution_of_its_law() {
    let all = [
        "exact",
        "hunt-crossley",
        "lankarani-nikravesh",
        "lee-wang",
        "herbert-mcwhannell",
        "gonthier",
        "zhiying-qishao",
        "flores",
        "hu-guo",
    ];
    let members = Dissipation::hysteretic(0.7);
    assert_eq!(members.len(), all.len(), "every member is dropped");
    let mut worst = 0.0_f64;
    for name in all {
        let events = bounces(name, 0.7);
        assert!(events.len() >= 2, "{name}: {} impacts", events.len());
        // Free flight keeps the speed from one wall to the other.
        let found = events[1].onset_speed / events[0].onset_speed;
        let member = members
            .iter()
            .find(|member| serde_json::to_value(member).unwrap()["kind"] == *name);
        let factor = member
            .and_then(Dissipation::factor)
            .expect("a hysteretic member");
        let expected = delivered(factor);
        println!("{name}: {found:.6} against {expected:.6}");
        worst = worst.max((found - expected).abs());
    }
    println!("worst {worst:.1e}");
    assert!(worst < 1e-4, "{worst}");
}
