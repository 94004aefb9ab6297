//! Any text is a scene, or is refused with problems that name their place.
#![no_main]

use chaindrive::Scene;

libfuzzer_sys::fuzz_target!(|text: &str| {
    match Scene::from_text(text, "fuzz") {
        Ok(scene) => {
            // What was read is read again as the same.
            let again = Scene::from_text(scene.text(), "fuzz").expect("its own text is a scene");
            assert_eq!(again.text(), scene.text());
            let _ = scene.drive();
        }
        Err(error) => assert!(error.to_string().contains("fuzz")),
    }
});
