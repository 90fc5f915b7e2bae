use super::*;

/// Displacements without a pattern, and a field that is zero at the ends of its rows.
fn rows(nx: usize, ny: usize) -> (Vec<f64>, Vec<f64>) {
    let displacements = (0..ny).map(|j| 0.5 * (7.0 * j as f64 + 1.0).sin()).collect();
    let inside = |at: usize| (2..nx - 2).contains(&(at % nx));
    let value = |at: usize| if inside(at) { (1.0 + 3.0 * at as f64).sin() } else { 0.0 };
    (displacements, (0..nx * ny).map(value).collect())
}

fn direct(
    nx: usize,
    displacements: &[f64],
    kernel: impl Fn(f64, i32) -> f64,
    field: &[f64],
) -> Vec<f64> {
    let place = |at: usize| ((at % nx) as f64 + displacements[at / nx], (at / nx) as i32);
    let effect = |to: usize, from: usize| {
        let ((x, j), (from_x, from_j)) = (place(to), place(from));
        kernel(x - from_x, j - from_j)
    };
    let sum = |to: usize| field.iter().enumerate().map(|(from, p)| effect(to, from) * p).sum();
    (0..field.len()).map(sum).collect()
}

fn error(found: &[f64], expected: &[f64]) -> f64 {
    let largest =
        |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |m: f64, v| m.max(v.abs()));
    largest(&mut found.iter().zip(expected).map(|(a, b)| a - b))
        / largest(&mut expected.iter().copied())
}

/// The sum of a kernel that is odd in both distances and of an even one, like those of half-spaces.
fn kernel(x: f64, j: i32) -> f64 {
    let square = x * x + f64::from(j * j) + 0.1;
    x * f64::from(j) / square.powf(1.5) + square.sqrt().recip()
}

/// Exact between all rows, and nearly so between neighbours only.
#[test]
fn displaced_rows_equal_the_direct_sum() {
    let (nx, ny) = (16, 11);
    let (displacements, field) = rows(nx, ny);
    let expected = direct(nx, &displacements, kernel, &field);
    let mut errors = Vec::new();
    for reach in [0, 1, 2, ny] {
        let mut convolution = Convolution::of_rows(nx, ny).displace_rows(&displacements);
        let on_elements = |i: i32, j: i32| kernel(f64::from(i), j);
        let spectrum = convolution.spectrum_of_rows(&displacements, reach, on_elements, kernel);
        let mut image = vec![0.0; field.len()];
        convolution.apply_even(&spectrum, &field, &mut image);
        errors.push(error(&image, &expected));
    }
    assert!(
        errors[3] < 1e-13 && errors[1] < 0.1 * errors[0] && errors[2] < errors[1],
        "{errors:?}"
    );
}

/// A symmetric kernel stays symmetric, and commutes with a difference along x.
#[test]
fn a_difference_of_second_order_takes_no_work() {
    let (nx, ny) = (16, 11);
    let (displacements, field) = rows(nx, ny);
    let on_elements = |i: i32, j: i32| kernel(f64::from(i), j);
    for reach in [0, 1] {
        let mut whole = Convolution::of_rows(nx, ny).displace_rows(&displacements);
        let spectrum = whole.spectrum_of_rows(&displacements, reach, on_elements, kernel);
        let central = whole.factors_along(&[(-1, -0.5), (1, 0.5)]);
        let mut image = vec![0.0; field.len()];
        let mut work = |convolution: &mut Convolution, spectrum: &EvenSpectrum| -> f64 {
            convolution.apply_even(spectrum, &field, &mut image);
            image.iter().zip(&field).map(|(u, p)| u * p).sum()
        };
        let size = work(&mut whole, &spectrum);
        let mut difference =
            Convolution::of_rows(nx, ny).displace_rows(&displacements).with_factors(&central);
        let found = work(&mut difference, &spectrum);
        assert!(found.abs() < 1e-14 * size.abs());
    }
}
