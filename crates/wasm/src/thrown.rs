//! Errors as JavaScript throws them.

use chaindrive::scene::{Problem, SceneError};
use js_sys::{Error, JSON, Reflect};
use serde_json::{Value, json};
use wasm_bindgen::JsValue;

/// An error of JavaScript with the message of one of ours.
pub(crate) fn thrown(error: impl std::error::Error) -> JsValue {
    Error::new(&error.to_string()).into()
}

/// The same of a scene: the message as a compiler would put it, with excerpts, and the mistakes one by one in `problems`.
#[expect(clippy::needless_pass_by_value, reason = "results hand it over")]
pub(crate) fn of_scene(error: SceneError) -> JsValue {
    let thrown = Error::new(&format!("{error:#}"));
    thrown.set_name("SceneError");
    let problems: Value = error.problems.iter().map(told).collect();
    if let Ok(problems) = JSON::parse(&problems.to_string()) {
        // An error is an object like any other: this cannot be refused.
        Reflect::set(&thrown, &"problems".into(), &problems).ok();
    }
    thrown.into()
}

fn told(problem: &Problem) -> Value {
    let columns = problem.place.and_then(|place| place.columns);
    json!({
        "path": problem.path,
        "message": problem.message,
        "hint": problem.hint,
        "line": problem.place.map(|place| place.line),
        "columns": columns,
        "excerpt": problem.excerpt,
    })
}
