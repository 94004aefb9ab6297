//! The lab: a drive that a browser computes while one looks at it, as one page without a server and without a network.
//!
//! ```text
//! module, glue ──page──► HTML with the module packed, and the programs around it ──with_scene──► the same, opened on a scene
//! ```
//!
//! The page says nothing of forces or laws: whatever it shows comes out of the module, which is the core of chaindrive. The drive is drawn by the programs
//! of a replay.

use std::io::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use chaindrive_replay::{PICTURE, STAGE, STYLE};
use flate2::Compression;
use flate2::write::DeflateEncoder;
use serde_json::json;

const PAGE: &str = include_str!("../page/page.html");
const OWN_STYLE: &str = include_str!("../page/style.css");
/// The program of the worker, which stands after the glue of the module.
const WORKER: &str = include_str!("../page/worker.js");
/// The programs of the page, each a file, in the order in which they run, after those that draw a drive.
const PROGRAMS: [&str; 17] = [
    include_str!("../page/core.js"),
    include_str!("../page/film.js"),
    include_str!("../page/facts.js"),
    include_str!("../page/history.js"),
    include_str!("../page/curves.js"),
    include_str!("../page/spectrum.js"),
    include_str!("../page/ledger.js"),
    include_str!("../page/inputs.js"),
    include_str!("../page/closing.js"),
    include_str!("../page/pull.js"),
    include_str!("../page/lab.js"),
    include_str!("../page/bench.js"),
    include_str!("../page/share.js"),
    include_str!("../page/editor.js"),
    include_str!("../page/plan.js"),
    include_str!("../page/own.js"),
    include_str!("../page/start.js"),
];

/// Place of the scene in a page without one.
const NO_SCENE: &str = r#"<script id="scene" type="application/json">null</script>"#;

/// The page: HTML that needs nothing else.
///
/// `glue` is the script that `wasm-bindgen --target no-modules` makes, `module` the module beside it.
///
/// # Panics
/// Never: memory takes all that is written.
pub fn page(glue: &str, module: &[u8]) -> String {
    let mut encoder = DeflateEncoder::new(Vec::new(), Compression::best());
    let packed = encoder.write_all(module).and_then(|()| encoder.finish());
    let packed = packed.expect("memory takes all that is written");
    let style = [STYLE, OWN_STYLE].concat();
    let program = [PICTURE.concat(), PROGRAMS.concat()].concat();
    // The largest goes in last: nothing is looked for in it.
    PAGE.replace("{{stage}}", STAGE.trim_end())
        .replace("{{style}}", &style)
        .replace("{{program}}", &program)
        .replace("{{worker}}", &within_script(WORKER))
        .replace("{{glue}}", &within_script(glue))
        .replace("{{module}}", &STANDARD.encode(&packed))
}

/// A page that opens on a scene: its text, and the name that messages call it by. None where the page has no place for one, as a page that has a
/// scene already.
///
/// # Example
///
/// ```
/// let page = chaindrive_lab::page("let wasm_bindgen;", b"\0asm");
/// let opened = chaindrive_lab::with_scene(&page, "title = '</script>'", "mine.toml").unwrap();
/// assert!(opened.contains(r"title = '\u003c/script\u003e'"));
/// assert_eq!(chaindrive_lab::with_scene(&opened, "", "again"), None);
/// ```
pub fn with_scene(page: &str, text: &str, name: &str) -> Option<String> {
    let (before, after) = page.split_once(NO_SCENE)?;
    // Within a script only `</` and `<!--` end or change it; in JSON the signs may be written by their numbers, and control characters have to be.
    let scene = json!({ "name": name, "text": text }).to_string();
    let scene = scene.replace('<', "\\u003c").replace('>', "\\u003e");
    let place = NO_SCENE.replace("null", &scene);
    Some([before, &place, after].concat())
}

/// A program as a script element may hold it: what would end or change the element is written otherwise, which texts and expressions of the
/// program read alike.
fn within_script(program: &str) -> String {
    program
        .replace("</script", "<\\/script")
        .replace("<!--", "<\\!--")
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use flate2::read::DeflateDecoder;

    use super::*;

    /// Text between two others, which come once each in this order.
    fn between<'a>(text: &'a str, begin: &str, end: &str) -> &'a str {
        let (_, after) = text.split_once(begin).unwrap();
        after.split_once(end).unwrap().0
    }

    #[test]
    fn module_comes_back_from_the_page() {
        let module: Vec<u8> = (0..=250_u8).cycle().take(100_000).collect();
        let page = page("glue", &module);
        let packed = between(&page, r#"id="module" type="text/plain">"#, "</script>");
        let packed = STANDARD.decode(packed).unwrap();
        let mut unpacked = Vec::new();
        let mut decoder = DeflateDecoder::new(packed.as_slice());
        decoder.read_to_end(&mut unpacked).unwrap();
        assert_eq!(unpacked, module);
        assert!(!page.contains("{{"), "every place is filled");
    }

    #[test]
    fn scripts_of_the_glue_do_not_end_its_element() {
        let page = page("const a = '</script>', b = '<!--';", b"");
        let glue = between(&page, r#"id="glue" type="text/plain">"#, "</script>");
        assert_eq!(glue, r"const a = '<\/script>', b = '<\!--';");
    }

    #[test]
    fn scene_of_a_page_is_harmless_and_comes_back() {
        let page = page("", b"");
        let text = "title = \"</script><!-- \u{0} \u{7f} \u{2028}\"\r\n";
        let opened = with_scene(&page, text, "<b>").unwrap();
        let scene = between(
            &opened,
            r#"id="scene" type="application/json">"#,
            "</script>",
        );
        assert!(!scene.contains(['<', '>', '\u{0}']), "{scene}");
        let scene: serde_json::Value = serde_json::from_str(scene).unwrap();
        assert_eq!(scene, json!({ "name": "<b>", "text": text }));
    }

    #[test]
    fn page_forbids_itself_a_network() {
        assert!(PAGE.contains("connect-src 'none'"));
        let page = page("", b"");
        for asking in ["src=\"", "href=\"", "import(", "fetch(", "@import"] {
            assert!(!page.contains(asking), "the page has {asking}");
        }
    }
}
