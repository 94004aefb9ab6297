//! Tensioners.

use chaindrive_mechanics::carriers::{Arm, Plunger, Slider};
use chaindrive_mechanics::pushes::{Hydraulic, OilColumn, Spring};
use chaindrive_mechanics::{Carrier, Push, Tensioner};

use super::{Findings, point};
use crate::scene::schema::{self, GuideSupport, Oil, SceneText, Support};

pub(super) fn resolve_all(
    scene: &SceneText,
    findings: &mut Findings<'_>,
) -> Option<Vec<Tensioner>> {
    let mut tensioners = Vec::new();
    for (i, text) in scene.tensioners.iter().enumerate() {
        let path = format!("tensioners[{i}]");
        let sprockets = scene
            .sprockets
            .iter()
            .any(|s| matches!(&s.support, Some(Support::Tensioner { name }) if *name == text.name));
        let guides = scene.guides.iter().any(
            |g| matches!(&g.support, Some(GuideSupport::Tensioner { name }) if *name == text.name),
        );
        if !(sprockets || guides) {
            let hint = "let a sprocket or guide say `support = { kind = \"tensioner\", name = … }`";
            findings.refuse_with(&path, format!("`{}` carries nothing", text.name), hint);
        }
        tensioners.push(resolve(text, &path, findings));
    }
    tensioners.into_iter().collect()
}

fn resolve(text: &schema::Tensioner, path: &str, findings: &mut Findings<'_>) -> Option<Tensioner> {
    let (carrier, inertia, key) = match &text.carrier {
        schema::Carrier::Slider { direction, mass } => {
            let direction = findings.direction(&format!("{path}.carrier.direction"), *direction);
            let carrier = direction.map(|direction| Carrier::Slider(Slider { direction }));
            (carrier, mass.map(|mass| mass.0), "mass")
        }
        schema::Carrier::Arm {
            pivot,
            inertia,
            plunger,
        } => {
            let plunger = match plunger {
                None => Some(None),
                Some(plunger) => findings
                    .direction(
                        &format!("{path}.carrier.plunger.direction"),
                        plunger.direction,
                    )
                    .map(|direction| {
                        Some(Plunger {
                            at: point(plunger.at),
                            direction,
                        })
                    }),
            };
            let pivot = point(*pivot);
            let carrier = plunger.map(|plunger| Carrier::Arm(Arm { pivot, plunger }));
            (carrier, inertia.map(|inertia| inertia.0), "inertia")
        }
    };
    if inertia.is_none() && text.push != schema::Push::Locked {
        let hint = format!("give the {key} of a tensioner that is not locked");
        findings.refuse_with(&format!("{path}.carrier.{key}"), "missing", hint);
    }
    let bare_arm = matches!(&text.carrier, schema::Carrier::Arm { plunger: None, .. });
    let push = push(&text.push, bare_arm, &format!("{path}.push"), findings);
    Some(Tensioner {
        name: text.name.clone(),
        carrier: carrier?,
        inertia: inertia.unwrap_or(0.0),
        push: push?,
    })
}

/// `bare_arm`: an arm without a plunger, on which only a torque can act.
fn push(
    text: &schema::Push,
    bare_arm: bool,
    path: &str,
    findings: &mut Findings<'_>,
) -> Option<Push> {
    let turns = matches!(text, schema::Push::TorsionSpring { .. });
    if bare_arm
        && matches!(
            text,
            schema::Push::Spring { .. } | schema::Push::Hydraulic { .. }
        )
    {
        let hint = "give the arm a `plunger`, or take a `torsion-spring`";
        findings.refuse_with(path, "a force needs a place on the arm", hint);
        return None;
    }
    if turns && !bare_arm {
        let hint = "take a `spring`, or an arm without a plunger";
        findings.refuse_with(path, "a torsion spring turns an arm and nothing else", hint);
        return None;
    }
    match text {
        schema::Push::Locked => Some(Push::Locked),
        schema::Push::Spring {
            preload,
            stiffness,
            damping,
        } => Some(Push::Spring(Spring {
            preload: preload.0,
            stiffness: stiffness.0,
            damping: damping.0,
        })),
        schema::Push::TorsionSpring {
            preload,
            stiffness,
            damping,
        } => Some(Push::Spring(Spring {
            preload: preload.0,
            stiffness: stiffness.0,
            damping: damping.0,
        })),
        schema::Push::Hydraulic {
            preload,
            stiffness,
            extending,
            relieving,
            supply,
            relief,
            leak,
            oil,
        } => {
            let direct = (supply.map(|f| f.0), relief.map(|f| f.0), leak.map(|c| c.0));
            let (supply, relief, leak) = match oil {
                Some(oil) => from_oil(oil, direct, path, findings),
                None => complete(direct, path, findings)?,
            };
            let column = match oil {
                Some(oil) => column(oil, [extending.0, relieving.0], path, findings).ok()?,
                None => None,
            };
            if relief < supply {
                let key = if oil.is_some() {
                    "oil.relief"
                } else {
                    "relief"
                };
                let message = "the relief valve opens below the supply pressure";
                findings.refuse(&format!("{path}.{key}"), message);
                return None;
            }
            Some(Push::Hydraulic(Hydraulic {
                preload: preload.0,
                stiffness: stiffness.0,
                supply,
                relief,
                leak,
                extending: extending.0,
                relieving: relieving.0,
                column,
            }))
        }
    }
}

/// Supply push \[N\], relief push \[N\] and leak damping \[N s/m\] as given.
type Direct = (Option<f64>, Option<f64>, Option<f64>);

fn complete(
    (supply, relief, leak): Direct,
    path: &str,
    findings: &mut Findings<'_>,
) -> Option<(f64, f64, f64)> {
    for (key, value) in [("supply", supply), ("relief", relief), ("leak", leak)] {
        if value.is_none() {
            let hint = "give `supply`, `relief` and `leak`, or `oil`, from which they follow";
            findings.refuse_with(&format!("{path}.{key}"), "missing", hint);
        }
    }
    Some((supply?, relief?, leak?))
}

/// Supply push, relief push and leak damping of a plunger in oil.
fn from_oil(
    oil: &Oil,
    (supply, relief, leak): Direct,
    path: &str,
    findings: &mut Findings<'_>,
) -> (f64, f64, f64) {
    for (key, value) in [("supply", supply), ("relief", relief), ("leak", leak)] {
        if value.is_some() {
            let hint = "keep one of them";
            findings.refuse_with(&format!("{path}.{key}"), "`oil` is given too", hint);
        }
    }
    let (diameter, area) = (oil.diameter.0, area(oil));
    let leak = Hydraulic::leak_damping(oil.viscosity.0, oil.length.0, diameter, oil.gap.0);
    // F = p A
    (oil.supply.0 * area, oil.relief.0 * area, leak)
}

/// Cross-section of a plunger \[m²\].
fn area(oil: &Oil) -> f64 {
    // A = π d²/4
    0.25 * std::f64::consts::PI * oil.diameter.0 * oil.diameter.0
}

/// Mistakes stand among the findings.
struct Refused;

/// Oil that can be compressed, if it can: it needs all that says how, and valves with a resistance.
fn column(
    oil: &Oil,
    [extending, relieving]: [f64; 2],
    path: &str,
    findings: &mut Findings<'_>,
) -> Result<Option<OilColumn>, Refused> {
    let given = [
        ("bulk_modulus", oil.bulk_modulus.map(|modulus| modulus.0)),
        ("volume", oil.volume.map(|volume| volume.0)),
        ("air", oil.air.map(|air| air.0)),
    ];
    if given.iter().all(|(_, value)| value.is_none()) {
        return Ok(None);
    }
    for (key, _) in given.iter().filter(|(_, value)| value.is_none()) {
        let hint = "oil that can be compressed needs `bulk_modulus`, `volume` and `air`";
        findings.refuse_with(&format!("{path}.oil.{key}"), "missing", hint);
    }
    for (key, value) in [("extending", extending), ("relieving", relieving)] {
        if value <= 0.0 {
            let hint = "give the damping by the valve, such as \"200 N s/m\"";
            let message = "oil that can be compressed needs a valve with a resistance";
            findings.refuse_with(&format!("{path}.{key}"), message, hint);
        }
    }
    let [Some(modulus), Some(volume), Some(air)] = given.map(|(_, value)| value) else {
        return Err(Refused);
    };
    if extending <= 0.0 || relieving <= 0.0 {
        return Err(Refused);
    }
    Ok(Some(OilColumn {
        area: area(oil),
        volume,
        bulk_modulus: modulus,
        air,
    }))
}
