//! Four drives at once, on all cores: `cargo run --release --example sweep`.

use std::io::Write;

use chaindrive::Scene;
use chaindrive::sweep::{Go, Outcome, ResultQuantity, Setting, Statistic, Sweep};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::preset("marine_two_sprockets")?
        .replace("run.until", "5 ms")?
        .replace("run.run_in", "0 s")?
        .replace("run.method", "\"auto\"")?;
    let values = |texts: [&str; 2]| texts.map(|text| Setting::Text(text.into())).to_vec();
    let vary = [
        ("route.pretension".to_owned(), values(["10 kN", "20 kN"])),
        (
            "sprockets.crank.motion.speed".to_owned(),
            values(["-60 rpm", "-100 rpm"]),
        ),
    ];
    let sweep = Sweep::new(&scene, &vary, &[])?;
    let outcomes = sweep.run(None, |_| Go::On)?;
    for (variant, outcome) in outcomes.iter().enumerate() {
        let told = match outcome {
            Outcome::Done(account) => {
                let wanted = ResultQuantity::Statistic(Statistic::SpanTensionMax);
                let entry = account.entries.iter().find(|it| it.quantity == wanted);
                let spans = entry.map_or(&[][..], |entry| &entry.values);
                format!("{spans:.0?} N")
            }
            Outcome::Failed(reason) => reason.clone(),
            Outcome::Open => "not carried out".to_owned(),
        };
        writeln!(std::io::stdout(), "{}: {told}", sweep.label(variant))?;
    }
    Ok(())
}
