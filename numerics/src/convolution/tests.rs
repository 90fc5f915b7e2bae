use super::*;

/// Reproducible values in (−1, 1) without a pattern.
fn noise(len: usize, seed: u64) -> Vec<f64> {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    (0..len).map(|_| next()).collect()
}

/// A kernel without any symmetry.
fn kernel(seed: i32) -> impl Fn(i32, i32) -> f64 {
    move |i, j| f64::from((i * 7 + j * 13 + seed).rem_euclid(11)) - 4.0 + 0.1 * f64::from(i - j)
}

fn direct(nx: usize, ny: usize, kernel: impl Fn(i32, i32) -> f64, input: &[f64]) -> Vec<f64> {
    let difference = |target: usize, source: usize| target as i32 - source as i32;
    let at = |index: usize| {
        let effect = |(source, value): (usize, &f64)| {
            let di = difference(index % nx, source % nx);
            kernel(di, difference(index / nx, source / nx)) * value
        };
        input.iter().enumerate().map(effect).sum()
    };
    (0..nx * ny).map(at).collect()
}

/// Tolerance: rounding of transforms of a few hundred values, relative to the largest value.
#[track_caller]
fn assert_same(field: &[f64], expected: &[f64]) {
    let scale = expected.iter().fold(0.0_f64, |max, value| max.max(value.abs()));
    for (value, expected) in field.iter().zip(expected) {
        assert!((value - expected).abs() <= 2e-14 * scale, "{value} is not {expected}");
    }
}

const SHAPES: [(usize, usize); 7] = [(1, 1), (1, 6), (5, 1), (2, 3), (11, 9), (17, 20), (23, 8)];

#[test]
fn equals_the_direct_sum() {
    for (nx, ny) in SHAPES {
        let mut convolution = Convolution::new(nx, ny);
        let spectrum = convolution.spectrum(kernel(3));
        // Twice, to detect effects of values left in the working memory.
        for seed in [1, 2] {
            let input = noise(nx * ny, seed);
            let mut output = vec![f64::NAN; nx * ny];
            convolution.apply(&spectrum, &input, &mut output);
            assert_same(&output, &direct(nx, ny, kernel(3), &input));
        }
    }
}

/// A sum in Fourier space equals the sum of the fields.
#[test]
fn a_sum_is_transformed_back_once() {
    for (nx, ny) in SHAPES {
        let mut convolution = Convolution::new(nx, ny);
        let mut sum = convolution.empty_sum();
        let (mut part, mut expected) = (vec![0.0; nx * ny], vec![0.0; nx * ny]);
        for seed in [1, 2, 5] {
            let spectrum = convolution.spectrum(kernel(seed));
            let input = noise(nx * ny, seed as u64);
            convolution.add(&spectrum, &input, &mut sum);
            convolution.apply(&spectrum, &input, &mut part);
            expected.iter_mut().zip(&part).for_each(|(sum, part)| *sum += part);
        }
        let mut output = vec![f64::NAN; nx * ny];
        convolution.finish(&sum, &mut output);
        assert_same(&output, &expected);
    }
}

#[test]
fn tensor_equals_four_sums() {
    for (nx, ny) in SHAPES {
        let mut convolution = Convolution::new(nx, ny);
        let spectra = [1, 2, 5, 8].map(|seed| convolution.spectrum(kernel(seed)));
        let [xx, xy, yx, yy] = &spectra;
        let (input_x, input_y) = (noise(nx * ny, 4), noise(nx * ny, 9));
        let (mut output_x, mut output_y) = (vec![f64::NAN; nx * ny], vec![f64::NAN; nx * ny]);
        convolution.apply_tensor(
            &[[xx, xy], [yx, yy]],
            [&input_x, &input_y],
            [&mut output_x, &mut output_y],
        );
        for (output, row) in [(output_x, [1, 2]), (output_y, [5, 8])] {
            let by_x = direct(nx, ny, kernel(row[0]), &input_x);
            let by_y = direct(nx, ny, kernel(row[1]), &input_y);
            let sum: Vec<f64> = by_x.iter().zip(by_y).map(|(one, other)| one + other).collect();
            assert_same(&output, &sum);
        }
    }
}

/// Spectra combine wave by wave; the spectrum of second differences lies between 0 and 8.
#[test]
fn spectra_combine() {
    let mut convolution = Convolution::new(12, 9);
    let laplacian = |i: i32, j: i32| match i.abs() + j.abs() {
        0 => 4.0,
        1 => -1.0,
        _ => 0.0,
    };
    let spectrum = convolution.spectrum(laplacian);
    let halved = spectrum.map(|value| 0.5 * value);
    let same = Spectrum::combine([&halved, &spectrum], |[one, other]| 4.0 * one - other);
    let input = noise(108, 5);
    let mut outputs = [vec![0.0; 108], vec![0.0; 108]];
    convolution.apply(&spectrum, &input, &mut outputs[0]);
    convolution.apply(&same, &input, &mut outputs[1]);
    assert_same(&outputs[1], &outputs[0]);
    let inside = |value: f64| (-1e-12..=8.0 + 1e-12).contains(&value);
    assert!(spectrum.values().all(|value| inside(value.re)), "rounding of the transform");
}

#[test]
#[should_panic(expected = "not of the grid of 4 x 3 elements")]
fn refuses_fields_of_another_grid() {
    let mut convolution = Convolution::new(4, 3);
    let spectrum = convolution.spectrum(kernel(0));
    convolution.apply(&spectrum, &[0.0; 11], &mut [0.0; 12]);
}

#[test]
fn padded_sizes_are_smooth_and_sufficient() {
    let sizes = [1, 7, 11, 13, 31, 125, 161, 641].map(smooth_size);
    assert_eq!(sizes, [1, 8, 12, 15, 32, 125, 162, 648]);
}

/// The distribution of rows and columns over threads does not change any bit.
#[test]
fn threads_change_no_bit() {
    let (nx, ny) = (331, 247);
    let mut one = Convolution::<f64>::new(nx, ny);
    let kernel = one.spectrum(|i, j| 1.0 / (1.0 + f64::from(i * i + 2 * j * j)).sqrt());
    let field: Vec<f64> = (0..nx * ny).map(|at| ((at * 37) % 101) as f64 - 50.0).collect();
    let product = |threads| {
        crate::team::limit(threads);
        let mut convolution = Convolution::<f64>::new(nx, ny);
        let (mut x, mut y) = (vec![0.0; nx * ny], vec![0.0; nx * ny]);
        let kernels = [[&kernel; 2]; 2];
        convolution.apply_tensor(&kernels, [&field, &field], [&mut x, &mut y]);
        (x, y)
    };
    let alone = product(1);
    for threads in [2, 3] {
        assert!(product(threads) == alone, "{threads}");
    }
    crate::team::limit(1);
}
