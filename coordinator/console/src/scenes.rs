//! The shipped cases that need no other file, put in by `build.rs`.

mod built_in {
    include!(concat!(env!("OUT_DIR"), "/scenes.rs"));
}

/// The scene that is meant if none is named.
pub use built_in::FIRST;
/// Names and texts of all of them.
pub use built_in::SCENES;

/// The text of a scene.
pub fn text(name: &str) -> Option<&'static str> {
    SCENES.iter().find(|(scene, _)| *scene == name).map(|(_, text)| *text)
}
