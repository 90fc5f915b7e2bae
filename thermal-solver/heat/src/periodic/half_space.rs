//! The waves of one body.

use super::depth::Rule;
use crate::Material;
use numerics::convolution::Complex64;
use std::f64::consts::{FRAC_2_PI, PI};

/// κ s² Δt at which a wave has decayed in a window.
const DECAYED: f64 = 36.0;

/// A window of time in which the flux is constant.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FluxWindow {
    /// Duration [s].
    pub duration: f64,
    /// Speed of the material, towards −x [m/s].
    pub speed: f64,
    /// Waves of the flux into the body [W/m²].
    pub flux: Vec<Complex64>,
}

/// A state: the situation at the beginning of the last window, and that window.
#[derive(Clone, Debug, PartialEq)]
pub struct Instant {
    /// ϑ̂ [K m], node after node, all waves of a node together.
    pub start: Vec<Complex64>,
    /// The last window.
    pub window: FluxWindow,
}

/// Response factors of every wave for a window of one duration.
#[derive(Clone, Debug, Default)]
struct Response {
    duration: f64,
    speed: f64,
    /// Remaining fraction of a wave without variation in depth [-].
    along: Vec<Complex64>,
    /// Rise of the surface at the end of the window, over the flux [K m²/W].
    surface: Vec<Complex64>,
    /// W at the end of the window, over the flux [K m³/W].
    integral: Vec<Complex64>,
}

/// Rise that earlier windows leave at the end of the present window.
#[derive(Clone, Debug, Default)]
struct Past {
    known: bool,
    surface: Vec<Complex64>,
    integral: Vec<Complex64>,
}

/// A body of one material.
#[derive(Debug)]
pub struct PeriodicHalfSpace {
    material: Material,
    /// Wave numbers k_x and k of every wave [rad/m].
    numbers: Vec<[f64; 2]>,
    rule: Rule,
    response: Response,
    past: Past,
    /// The accepted state.
    pub accepted: Instant,
    /// The state of the last solve.
    pub trial: Instant,
}

impl PeriodicHalfSpace {
    /// Creates a cold body under waves with the numbers k_x and k [rad/m], the first of which is
    /// the mean.
    #[must_use]
    pub fn new(material: Material, numbers: Vec<[f64; 2]>) -> Self {
        let sizes = || numbers.iter().map(|[_, size]| *size).filter(|size| *size > 0.0);
        let range = [sizes().fold(f64::INFINITY, f64::min), sizes().fold(0.0, f64::max)];
        let rule = Rule::new(material.diffusivity(), range);
        let cold = Instant {
            start: vec![Complex64::default(); rule.nodes.len() * numbers.len()],
            window: FluxWindow {
                flux: vec![Complex64::default(); numbers.len()],
                ..FluxWindow::default()
            },
        };
        let empty = || vec![Complex64::default(); numbers.len()];
        let past = Past { known: false, surface: empty(), integral: empty() };
        let response =
            Response { along: empty(), surface: empty(), integral: empty(), ..Response::default() };
        Self { material, numbers, rule, response, past, accepted: cold.clone(), trial: cold }
    }

    fn capacity(&self) -> f64 {
        self.material.density * self.material.specific_heat
    }

    /// Returns the rate of decay κk² − i k_x V of a wave along the surface [1/s].
    fn rate(&self, wave: usize, speed: f64) -> Complex64 {
        let [along, size] = self.numbers[wave];
        Complex64::new(self.material.diffusivity() * size * size, -along * speed)
    }

    /// Iterates over κs² [1/s] and the weight of every node.
    fn nodes(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let rates = self.rule.nodes.iter().map(|s| self.material.diffusivity() * s * s);
        rates.zip(self.rule.weights.iter().copied())
    }

    /// Returns the weight of a node in W, over that in the rise of the surface [m].
    fn share(&self, wave: usize, node: usize) -> f64 {
        let (size, s) = (self.numbers[wave][1], self.rule.nodes[node]);
        if size > 0.0 { size / (size * size + s * s) } else { 0.0 }
    }

    /// Begins a window. Returns the work: 0 if the response and the past are already known.
    pub fn begin(&mut self, duration: f64, speed: f64) -> u64 {
        let waves = self.numbers.len();
        let mut work = self.respond(duration, speed);
        if !self.past.known {
            let mut past = std::mem::take(&mut self.past);
            past.surface.fill(Complex64::default());
            past.integral.fill(Complex64::default());
            let states = self.trial.start.chunks_exact(waves);
            for (node, ((rate, weight), state)) in self.nodes().zip(states).enumerate() {
                let factor = FRAC_2_PI * weight * (-rate * duration).exp();
                for (wave, (value, along)) in state.iter().zip(&self.response.along).enumerate() {
                    let part = factor * value * along;
                    past.surface[wave] += part;
                    past.integral[wave] += part * self.share(wave, node);
                }
            }
            self.past = Past { known: true, ..past };
            work += (waves * self.rule.nodes.len()) as u64;
        }
        (self.trial.window.duration, self.trial.window.speed) = (duration, speed);
        work
    }

    /// Computes the response to a window, unless it is known. Returns the work.
    fn respond(&mut self, duration: f64, speed: f64) -> u64 {
        if self.response.duration == duration && self.response.speed == speed {
            return 0;
        }
        self.past.known = false;
        let mut response = std::mem::take(&mut self.response);
        (response.duration, response.speed) = (duration, speed);
        let capacity = self.capacity();
        let last = self.rule.last();
        for wave in 0..self.numbers.len() {
            let rate = self.rate(wave, speed);
            let mut sums = [Complex64::default(); 2];
            for (node, (in_depth, weight)) in self.nodes().enumerate() {
                let gain = weight * duration * settled((rate + in_depth) * duration);
                sums[0] += gain;
                sums[1] += gain * self.share(wave, node);
            }
            // Beyond the rule the response is that to a flux of infinite duration.
            let square = rate / self.material.diffusivity();
            let tail = (1.0 - square / (3.0 * last * last)) / (last * self.material.diffusivity());
            response.surface[wave] = (sums[0] + tail) * FRAC_2_PI / capacity;
            response.integral[wave] = sums[1] * FRAC_2_PI / capacity;
            response.along[wave] = (-rate * duration).exp();
        }
        self.response = response;
        (self.numbers.len() * self.rule.nodes.len()) as u64
    }

    /// Returns the waves of the surface rise at the end of the present window, under its flux [K].
    pub fn surface(&self, waves: &mut [Complex64]) {
        self.sum(&self.past.surface, &self.response.surface, waves);
    }

    /// Returns the waves of W at the end of the present window, under its flux; the mean is 0 [K
    /// m].
    pub fn integral(&self, waves: &mut [Complex64]) {
        self.sum(&self.past.integral, &self.response.integral, waves);
    }

    fn sum(&self, past: &[Complex64], response: &[Complex64], waves: &mut [Complex64]) {
        let parts = past.iter().zip(response.iter().zip(&self.trial.window.flux));
        for (wave, (past, (response, flux))) in waves.iter_mut().zip(parts) {
            *wave = past + response * flux;
        }
    }

    /// Makes the last solve the accepted state.
    pub fn accept(&mut self) {
        std::mem::swap(&mut self.accepted, &mut self.trial);
        self.go_on();
    }

    /// Starts the trial at the end of the accepted state.
    pub fn go_on(&mut self) {
        let (waves, capacity) = (self.numbers.len(), self.capacity());
        let (duration, speed) = (self.accepted.window.duration, self.accepted.window.speed);
        self.trial.start.copy_from_slice(&self.accepted.start);
        if duration == 0.0 {
            self.past.known = false;
            return;
        }
        self.respond(duration, speed);
        self.past.known = false;
        let mut start = std::mem::take(&mut self.trial.start);
        for (state, (in_depth, _)) in start.chunks_exact_mut(waves).zip(self.nodes()) {
            let decay = (-in_depth * duration).exp();
            for (wave, value) in state.iter_mut().enumerate() {
                let rate = self.rate(wave, speed) + in_depth;
                let gain = duration * settled(rate * duration);
                *value = *value * decay * self.response.along[wave]
                    + gain * self.accepted.window.flux[wave] / capacity;
            }
        }
        self.trial.start = start;
    }

    /// Returns the waves of the rise at a depth in a state, at the end of its window [K].
    #[must_use]
    pub fn below(&self, state: &Instant, depth: f64) -> Vec<Complex64> {
        let FluxWindow { duration, speed, flux } = &state.window;
        let waves = self.numbers.len();
        if *duration == 0.0 {
            return vec![Complex64::default(); waves];
        }
        let diffusivity = self.material.diffusivity();
        let decayed = (DECAYED / (diffusivity * duration)).sqrt();
        let weights = self.rule.with_cosine(depth, decayed);
        let rates: Vec<Complex64> = (0..waves).map(|wave| self.rate(wave, *speed)).collect();
        let capacity = self.capacity();
        let mut sums = vec![Complex64::default(); waves];
        let states = state.start.chunks_exact(waves);
        for ((weight, (in_depth, _)), state) in weights.iter().zip(self.nodes()).zip(states) {
            let factor = FRAC_2_PI * weight * (-in_depth * duration).exp();
            if factor == 0.0 {
                continue;
            }
            for (wave, sum) in sums.iter_mut().enumerate() {
                let always = match wave {
                    0 => Complex64::default(),
                    _ => flux[wave] / (capacity * (rates[wave] + in_depth)),
                };
                *sum += factor * (state[wave] - always);
            }
        }
        for (wave, sum) in sums.iter_mut().enumerate() {
            *sum *= (-rates[wave] * duration).exp();
            let own = match wave {
                0 => {
                    Complex64::new(uniform(depth / (diffusivity * duration).sqrt()), 0.0)
                        * (diffusivity * duration).sqrt()
                }
                _ => {
                    let m = (rates[wave] / diffusivity).sqrt();
                    (-m * depth).exp() / m
                }
            };
            *sum += flux[wave] * own / self.material.conductivity;
        }
        sums
    }
}

/// Returns (1 − e^{−z})/z.
fn settled(z: Complex64) -> Complex64 {
    if z.norm_sqr() < 1e-6 {
        // The next term is z⁴/120.
        return 1.0 - z * (0.5 - z * (1.0 / 6.0 - z / 24.0));
    }
    (1.0 - (-z).exp()) / z
}

/// Returns the rise at the depth u √(κt) under a uniform flux of duration t, over q √(κt)/λ: 2
/// ierfc(u/2).
fn uniform(u: f64) -> f64 {
    2.0 * (-0.25 * u * u).exp() / PI.sqrt() - u * libm::erfc(0.5 * u)
}

#[cfg(test)]
mod tests {
    use super::*;
    use numerics::quadrature::integrate;

    const STEEL: Material = Material { density: 7850.0, specific_heat: 419.5, conductivity: 50.0 };

    /// Runs windows of these lengths under a flux of 1 W/m² in every wave.
    fn heated(numbers: Vec<[f64; 2]>, speed: f64, windows: &[f64]) -> PeriodicHalfSpace {
        let mut body = PeriodicHalfSpace::new(STEEL, numbers);
        for duration in windows {
            body.begin(*duration, speed);
            body.trial.window.flux.fill(Complex64::new(1.0, 0.0));
            body.accept();
        }
        body
    }

    /// A wave heated for a time t: (1/ρc) ∫ e^{−(κk² − ikV)τ − z²/4κτ}/√(πκτ) dτ by Gauss's rule,
    /// with τ = r². The lengths and the order of windows do not matter. Tolerances: those of the
    /// module.
    #[test]
    fn waves_heated_for_a_time() {
        let (total, kappa) = (0.02_f64, STEEL.diffusivity());
        let cases = [(0.0, 0.0), (800.0, 0.0), (5e4, 0.0), (800.0, 0.5), (800.0, 20.0), (5e4, 0.1)];
        for (k, speed) in cases {
            let exact = |z: f64| {
                let panels = 400;
                let part = |panel: usize, cosine: bool| {
                    let end = |panel: usize| total.sqrt() * panel as f64 / f64::from(panels);
                    integrate(end(panel), end(panel + 1), |r| {
                        let age = r * r;
                        let size = (-kappa * k * k * age - z * z / (4.0 * kappa * age)).exp();
                        let angle = k * speed * age;
                        2.0 * size * if cosine { angle.cos() } else { angle.sin() }
                            / (PI * kappa).sqrt()
                    })
                };
                let sum = |cosine: bool| (0..panels as usize).map(|p| part(p, cosine)).sum::<f64>();
                Complex64::new(sum(true), sum(false)) / (STEEL.density * STEEL.specific_heat)
            };
            for windows in [vec![total], vec![0.25 * total; 4], vec![1e-9, 0.019, 1e-3 - 1e-9]] {
                // The mean is the first wave in any case.
                let body = heated(vec![[0.0, 0.0], [k, k]], speed, &windows);
                let wave = usize::from(k > 0.0);
                let scale = exact(0.0).norm();
                let mut surface = vec![Complex64::default(); 2];
                let mut last = PeriodicHalfSpace::new(STEEL, vec![[0.0, 0.0], [k, k]]);
                for duration in &windows {
                    last.begin(*duration, speed);
                    last.trial.window.flux.fill(Complex64::new(1.0, 0.0));
                    last.surface(&mut surface);
                    last.accept();
                }
                let error = (surface[wave] - exact(0.0)).norm() / scale;
                assert!(error < 1e-7, "{k} {speed} {windows:?}: {error:e}");
                let reach = if k > 0.0 {
                    (1.0 / k).min((kappa * total).sqrt())
                } else {
                    (kappa * total).sqrt()
                };
                for over in [0.2, 1.0, 2.5] {
                    let depth = over * reach;
                    let found = body.below(&body.accepted, depth)[wave];
                    let error = (found - exact(depth)).norm() / scale;
                    assert!(error < 1e-4, "{k} {speed} {windows:?} at {over}: {error:e}");
                }
            }
        }
    }

    /// W of a wave at rest is (1/ρc) ∫ erfc(k√(κτ)) dτ.
    #[test]
    fn waves_raise_the_surface() {
        let (total, kappa, k) = (0.02_f64, STEEL.diffusivity(), 800.0_f64);
        let mut body = heated(vec![[0.0, 0.0], [k, k]], 0.0, &[0.5 * total]);
        body.begin(0.5 * total, 0.0);
        body.trial.window.flux.fill(Complex64::new(1.0, 0.0));
        let mut integral = vec![Complex64::default(); 2];
        body.integral(&mut integral);
        let heard: f64 = (0..100)
            .map(|panel| {
                let end = |panel: i32| total.sqrt() * f64::from(panel) / 100.0;
                integrate(end(panel), end(panel + 1), |r| {
                    2.0 * r * libm::erfc(k * r * kappa.sqrt())
                })
            })
            .sum();
        let capacity = STEEL.density * STEEL.specific_heat;
        assert!((integral[1].re * capacity / heard - 1.0).abs() < 1e-8, "{}", integral[1]);
        assert_eq!(integral[0], Complex64::default());
    }
}
