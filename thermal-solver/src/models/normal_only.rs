//! Error of models that conduct heat normal to the surface only and neglect conduction along it.

use super::frame::Frame;
use heat::Material;
use proto::accuracy::Simplification;

/// Returns the simplification that all models with conduction normal to the surface share. The rise
/// behind a uniform band is √(2πx)·(1 + 1/(8x)) − 1 with x = 2Pe, against √(2πx) in one dimension
/// (Jaeger's integral of e^x K₀(x)). The error is thus 0.28/√Pe at a sharp edge. Where the flux is
/// smooth, the heat from ahead and behind nearly cancels, and an error of about 1/Pe remains.
pub(super) fn along_the_surface() -> Simplification {
    let source = "model `moving-source` at Pe = 10 000 (docs/theory/moving-source.md)";
    Simplification::always("no conduction along the surface", AT_HIGH_SPEED, source)
}

/// Source of the error as a function of speed.
const BY_SPEED: &str = "model `moving-source`: 0.86/Pe, 1 % at Pe = 87 and 10 % at 8.5 \
                        (docs/theory/moving-source.md)";

/// Relative error at the speeds of railways \[-\].
const AT_HIGH_SPEED: f64 = 2e-4;

/// Returns the additional error of a slow case. The total is 1/Pe, with half the length of the grid
/// for a.
pub(super) fn along_the_surface_at(frame: &Frame) -> Option<Simplification> {
    let half = 0.5 * frame.grid.dx() * frame.grid.ni as f64;
    let bodies = frame.scene.materials.iter().zip(frame.scene.speeds);
    let inverse = |(body, speed): (&Material, f64)| 2.0 * body.diffusivity() / (half * speed);
    let inverse = bodies.map(inverse).fold(0.0, f64::max);
    let more = inverse - AT_HIGH_SPEED;
    (more > 0.0).then(|| {
        let what = format!("no conduction along the surface, at Pe = {:.3}", 1.0 / inverse);
        Simplification::always(&what, more, BY_SPEED)
    })
}
