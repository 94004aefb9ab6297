//! Bodies in each other's way, chains through guides, and profiles in their places.

use chaindrive_contact::Law;
use chaindrive_geometry::{Arc, ArcSpline, Piece, Point, Segment, Vector, bar};
use chaindrive_mechanics::carriers::{Arm, Slider};
use chaindrive_mechanics::{
    AssemblyError, Carrier, Clash, Drive, DriveError, Forces, Guide, GuideSupport, Layout, Parts,
    Push, Support, Tensioner, Touches,
};

use crate::marine;
use crate::pieces::{linear, smooth};

const TIP: f64 = 0.75;

fn law() -> Law {
    linear(1e8)
}

fn guide(name: &str, face: ArcSpline) -> Guide {
    Guide {
        name: name.into(),
        face,
        support: GuideSupport::Fixed,
        touches: Touches::Rollers,
        surface: smooth(law()),
    }
}

/// A straight face; what it carries passes on the right of travel.
fn line(from: [f64; 2], to: [f64; 2]) -> ArcSpline {
    let [from, to] = [from, to].map(|[x, y]| Point::new(x, y));
    ArcSpline::open(&[Segment::new(from, to).into()]).expect("a line")
}

/// The marine drive, laid only, with guides in its plane.
fn with_guides(guides: Vec<Guide>) -> Parts {
    let mut parts = marine::parts(law());
    parts.settle = false;
    parts.chains[0].guides = (0..guides.len()).collect();
    parts.guides = guides;
    parts
}

fn assembly(parts: Parts) -> Result<Vec<Clash>, AssemblyError> {
    let drive = Drive::new(parts).unwrap_or_else(|problems| panic!("{problems:?}"));
    drive.assemble().map(|assembled| assembled.warnings)
}

fn clashes(parts: Parts) -> (Vec<Clash>, String) {
    match assembly(parts) {
        Err(error @ AssemblyError::Clash { .. }) => {
            let message = error.to_string();
            let AssemblyError::Clash { clashes } = error else {
                unreachable!()
            };
            (clashes, message)
        }
        other => panic!("{other:?}"),
    }
}

fn crank_tip() -> f64 {
    marine::parts(law()).sprockets[0].gap.tip_radius
}

/// Closed form: a straight face at height h above the centre of a sprocket lies r_a − h inside the tips, h above the foot of
/// the perpendicular; clear of them nothing is said.
#[test]
fn a_face_within_the_tips_cuts_into_the_teeth() {
    let tip = crank_tip();
    assert!((tip - TIP).abs() < 0.1, "{tip}");
    let below = |gap: f64| {
        let y = -(tip + gap);
        with_guides(vec![guide("rail", line([-0.2, y], [0.2, y]))])
    };
    // The chain runs outside the teeth there: keep it away from the rail.
    let (found, message) = clashes(beside(below(-1.3e-3), Touches::Rollers));
    let [Clash::Teeth { depth, at, .. }] = &found[..] else {
        panic!("{found:?}")
    };
    assert!((depth - 1.3e-3).abs() < 1e-9, "{depth}");
    assert!(
        (at - Point::new(0.0, -(tip - 1.3e-3))).norm() < 1e-9,
        "{at}"
    );
    let expected = format!(
        "guide `rail` cuts into the teeth of `crank` by 1.3 mm at (0.0, {:.1}) mm; move it back, shorten its face, or give its ends a smaller radius",
        at.y * 1e3
    );
    assert_eq!(message, expected);
    assert_eq!(assembly(beside(below(1e-4), Touches::Rollers)), Ok(vec![]));
}

/// A fixed rail that cuts into teeth does so wherever the chain settles: it is told at once, and not what the chain does at the rail.
#[test]
fn a_rail_in_the_teeth_is_told_before_anything_settles() {
    let y = -(crank_tip() - 1.3e-3);
    let mut parts = with_guides(vec![guide("rail", line([-0.2, y], [0.2, y]))]);
    parts.settle = true;
    // The rail lies within the wrap, so the chain is laid through it as well.
    let (found, _) = clashes(parts);
    let [Clash::Teeth { .. }] = &found[..] else {
        panic!("{found:?}")
    };
}

/// A guide that carries plates may lie beside the teeth, so it is a warning.
#[test]
fn a_guide_for_plates_may_pass_beside_the_teeth() {
    let y = -(crank_tip() - 1.3e-3);
    let parts = with_guides(vec![guide("rail", line([-0.2, y], [0.2, y]))]);
    let warnings = assembly(beside(parts, Touches::Plates)).expect("a warning at most");
    let [Clash::Teeth { beside: true, .. }] = &warnings[..] else {
        panic!("{warnings:?}")
    };
    assert!(warnings[0].to_string().contains("it must pass beside them"));
}

/// The same plane, but a guide that the chain does not reach: only the bodies are looked at.
fn beside(mut parts: Parts, touches: Touches) -> Parts {
    parts.guides[0].touches = touches;
    parts.chains[0].guides.clear();
    parts
}

/// In planes of their own neither sprockets nor guides meet.
#[test]
fn planes_keep_bodies_apart() {
    let y = -(crank_tip() - 1.3e-3);
    let rail = guide("rail", line([-0.2, y], [0.2, y]));
    let mut parts = with_guides(vec![rail]);
    parts.chains[0].guides.clear();
    // A second chain, far away, takes the guide into its plane.
    let mut away = marine::parts(law());
    for sprocket in &mut away.sprockets {
        sprocket.centre += Vector::new(20.0, 0.0);
        sprocket.name += "-2";
        sprocket.shaft += parts.shafts.len();
    }
    parts.shafts.append(&mut away.shafts);
    let first = parts.sprockets.len();
    let mut chain = away.chains.remove(0);
    if let Layout::Route { stops, .. } = &mut chain.layout {
        *stops = (first..first + 4)
            .map(chaindrive_mechanics::Stop::Sprocket)
            .collect();
    }
    chain.sprockets = (first..first + 4).collect();
    chain.guides = vec![0];
    parts.sprockets.extend(away.sprockets);
    parts.chains.push(chain);
    assert_eq!(assembly(parts.clone()), Ok(vec![]));
    parts.chains[0].guides = vec![0];
    let (found, _) = clashes(parts);
    assert!(matches!(&found[0], Clash::Teeth { .. }), "{found:?}");
}

/// The tips sweep a circle in a turn: it decides, before anything is laid, and again where a sprocket was moved to close the chain.
#[test]
fn the_circle_of_tips_decides_between_sprockets() {
    let mut parts = marine::parts(law());
    let tips = parts.sprockets[1].gap.tip_radius + parts.sprockets[2].gap.tip_radius;
    let along = (parts.sprockets[2].centre - parts.sprockets[1].centre).normalize();
    parts.sprockets[2].centre = parts.sprockets[1].centre + along * (tips - 2e-3);
    let problems = Drive::new(parts.clone()).expect_err("overlapping tips");
    let [DriveError::Overlap { overlap, .. }] = &problems[..] else {
        panic!("{problems:?}")
    };
    assert!((overlap - 2e-3).abs() < 1e-12);
    parts.sprockets[2].centre = parts.sprockets[1].centre + along * (tips + 1e-9);
    assert!(Drive::new(parts).is_ok());
}

/// A bar that crosses a straight strand: the rollers behind it are told with the deepest place.
#[test]
fn a_chain_laid_through_a_guide_is_refused() {
    let parts = with_guides(Vec::new());
    let drive = Drive::new(parts).expect("sound");
    let rollers = drive.layouts().expect("it closes").remove(0).positions;
    // The middle of the longest span, crank to camshaft, lies on the right: the void is on the left of the bar's travel.
    let (a, b) = (rollers[24], rollers[36]);
    let along = (b - a).normalize();
    let outward = Vector::new(along.y, -along.x);
    let middle = a + (b - a) * 0.5;
    let bar_at = |inward: f64| {
        let centre = middle - outward * inward;
        // From far to near: the material lies outside the loop.
        bar(centre + along * 0.3, centre - along * 0.3, 1.0, 0.3).expect("a bar")
    };
    let radius = 0.5 * 0.05398;
    // Touching, and pressed in by less than the radius.
    for inward in [-radius - 1e-3, -radius, -0.3 * radius] {
        let parts = with_guides(vec![guide("bar", bar_at(inward))]);
        assert_eq!(assembly(parts), Ok(vec![]), "{inward}");
    }
    let (found, message) = clashes(with_guides(vec![guide("bar", bar_at(4e-3))]));
    let [
        Clash::Chain {
            depth, at, carries, ..
        },
    ] = &found[..]
    else {
        panic!("{found:?}")
    };
    assert!((depth - radius - 4e-3).abs() < 1e-6, "{depth}");
    assert!((carries - radius).abs() < 1e-12);
    assert!(((at - middle).dot(&outward)).abs() < 1e-6);
    assert!(message.contains("the chain runs 31.0 mm at ("), "{message}");
    // Far behind a face that does not cross it the chain runs free.
    let parts = with_guides(vec![guide("bar", bar_at(-0.5))]);
    assert_eq!(assembly(parts), Ok(vec![]));
    let reversed: Vec<_> = bar_at(-0.2)
        .pieces()
        .iter()
        .rev()
        .map(Piece::reversed)
        .collect();
    let face = ArcSpline::open(&reversed).expect("a bar");
    assert_eq!(assembly(with_guides(vec![guide("bar", face)])), Ok(vec![]));
}

/// Faces that cross are one body when the same support holds them, and in each other's way when they move against each other.
#[test]
fn guides_on_different_supports_must_not_cross() {
    // Inside the loop, clear of chain and teeth.
    let (x, y) = (0.35, 1.45);
    let cross = |offset: f64| {
        vec![
            guide("flat", line([x + 0.1, y], [x - 0.1, y])),
            guide("steep", line([x, y + 0.1], [x, y - offset])),
        ]
    };
    assert_eq!(assembly(with_guides(cross(7e-3))), Ok(vec![]));
    let moving = |offset: f64| {
        let mut parts = with_guides(cross(offset));
        parts.tensioners.push(Tensioner {
            name: "slide".into(),
            carrier: Carrier::Slider(Slider {
                direction: Vector::x(),
                mass: Some(1.0),
            }),
            push: Push::Locked,
            forces: Forces::default(),
            forced_at: None,
        });
        parts.guides[1].support = GuideSupport::Tensioner(0);
        parts
    };
    assert_eq!(assembly(moving(-1e-3)), Ok(vec![]));
    let (found, message) = clashes(moving(7e-3));
    let [Clash::Guides { depth, .. }] = &found[..] else {
        panic!("{found:?}")
    };
    assert!((depth - 7e-3).abs() < 2e-6, "{depth}");
    assert!(
        message.starts_with("guides `flat` and `steep` cut into each other by 7.0 mm"),
        "{message}"
    );
}

/// Every gap of a placed sprocket that holds a roller touches it: the outline stands where the chain was laid.
#[test]
fn profiles_stand_where_the_chain_meets_them() {
    let mut parts = with_guides(vec![guide("flat", line([0.2, 1.45], [0.5, 1.45]))]);
    let radius = 0.5 * parts.chains[0].chain.roller_diameter;
    let drive = Drive::new(parts.clone()).expect("sound");
    let rollers = drive.layouts().expect("it closes").remove(0).positions;
    for sprocket in &parts.sprockets {
        let profile = drive.profile(&sprocket.name).expect("it has this name");
        assert!(profile.is_closed());
        let seated: Vec<_> = rollers
            .iter()
            .filter(|r| ((*r - sprocket.centre).norm() - sprocket.gap.pitch_radius).abs() < 1e-9)
            .collect();
        assert!(seated.len() > 3);
        for roller in seated {
            let foot = profile.nearest(*roller, 1.0).expect("near");
            assert!((foot.distance - radius).abs() < 1e-9, "{}", foot.distance);
        }
    }
    // As assembled, with nothing to settle: the same place.
    let assembled = drive.assemble().expect("sound");
    for name in ["crank", "idler", "flat"] {
        let (laid, stands) = (drive.profile(name), assembled.profile(name));
        let (laid, stands) = (laid.expect("laid"), stands.expect("stands"));
        for k in 0..100 {
            let s = f64::from(k) * 0.01 * laid.length();
            assert!(
                (laid.point_at(s) - stands.point_at(s)).norm() < 1e-12,
                "{name}"
            );
        }
    }
    let error = drive.profile("flet").expect_err("no such name").to_string();
    assert_eq!(
        error,
        "no sprocket or guide is named `flet`; there are `crank`, `camshaft`, `tensioner`, `idler`, `flat`"
    );
    // Carried by an arm that settles elsewhere, face and wheel go along.
    parts.settle = true;
    parts.tensioners.push(Tensioner {
        name: "slide".into(),
        carrier: Carrier::Slider(Slider {
            direction: Vector::new(-0.17, 0.98).normalize(),
            mass: Some(60.0),
        }),
        push: Push::Spring(chaindrive_mechanics::pushes::Spring {
            preload: 20e3,
            stiffness: 1e6,
            damping: 0.0,
        }),
        forces: Forces::default(),
        forced_at: None,
    });
    parts.sprockets[2].support = Support::Tensioner(0);
    parts.guides[0].support = GuideSupport::Tensioner(0);
    let drive = Drive::new(parts).expect("sound");
    let assembled = drive.assemble().expect("it settles");
    let by = |name: &str| {
        let ends = [drive.profile(name), assembled.profile(name)];
        let [laid, stands] = ends.map(|profile| profile.expect("it has this name").aabb());
        stands.min - laid.min
    };
    let moved = by("flat");
    assert!(moved.norm() > 1e-4, "{moved}");
    let along = Vector::new(-0.17, 0.98).normalize();
    assert!(moved.perp(&along).abs() < 1e-12, "{moved}");
}

/// A face that bulges, carried by an arm: its profile turns about the pivot.
#[test]
fn faces_on_arms_turn_about_the_pivot() {
    let arc = Arc {
        centre: Point::new(0.35, 1.2),
        radius: 0.1,
        start_angle: 1.2,
        sweep: 0.6,
    };
    let face = ArcSpline::open(&[arc.into()]).expect("an arc");
    let pivot = Point::new(0.3, 1.3);
    let mut parts = with_guides(vec![guide("shoe", face.clone())]);
    parts.settle = true;
    parts.guides[0].support = GuideSupport::Tensioner(0);
    parts.tensioners.push(Tensioner {
        name: "arm".into(),
        carrier: Carrier::Arm(Arm {
            pivot,
            inertia: Some(0.1),
            plunger: None,
        }),
        push: Push::TorsionSpring(chaindrive_mechanics::pushes::TorsionSpring {
            preload: 0.3,
            stiffness: 1.0,
            damping: 0.0,
        }),
        forces: Forces::default(),
        forced_at: None,
    });
    let assembled = Drive::new(parts)
        .expect("sound")
        .assemble()
        .expect("it settles");
    let stands = assembled.profile("shoe").expect("it has this name");
    // Nothing holds it but its spring: M = 0 where φ = preload / stiffness.
    for k in 0..=10 {
        let s = f64::from(k) * 0.1 * face.length();
        let arms = [&face, &stands].map(|face| face.point_at(s) - pivot);
        assert!((arms[0].norm() - arms[1].norm()).abs() < 1e-12);
        let turned = arms[0].perp(&arms[1]).atan2(arms[0].dot(&arms[1]));
        assert!((turned.abs() - 0.3).abs() < 1e-6, "{turned}");
    }
}
