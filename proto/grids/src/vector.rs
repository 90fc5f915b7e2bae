//! Vectors in space.

pub(super) fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

pub(super) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Returns points moved by `displacement` [m]: all x, then all y, then all z.
///
/// # Errors
/// Fails if the length is not three values per point.
pub(super) fn displaced(
    points: &[[f64; 3]],
    displacement: &[f64],
) -> Result<Vec<[f64; 3]>, String> {
    let count = points.len();
    if displacement.len() != 3 * count {
        let given = displacement.len();
        return Err(format!("{given} displacements for the {count} vertices, not {}", 3 * count));
    }
    let moved = |(n, point): (usize, &[f64; 3])| -> [f64; 3] {
        std::array::from_fn(|k| point[k] + displacement[k * count + n])
    };
    Ok(points.iter().enumerate().map(moved).collect())
}

pub(super) fn length(a: [f64; 3]) -> f64 {
    a.iter().map(|v| v * v).sum::<f64>().sqrt()
}
