//! Shipped cases that need no other file, embedded by `build.rs`.

mod built_in {
    include!(concat!(env!("OUT_DIR"), "/scenes.rs"));
}

/// Default scene.
pub use built_in::FIRST;
/// Names and texts of all scenes.
pub use built_in::SCENES;

/// Returns the text of a scene.
pub fn text(name: &str) -> Option<&'static str> {
    SCENES.iter().find(|(scene, _)| *scene == name).map(|(_, text)| *text)
}
