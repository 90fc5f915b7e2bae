//! A surrogate ready for evaluation.
//!
//! All figures are computed from one list of numbers, held in a [`Workspace`]: 1, the Chebyshev
//! polynomials of each coordinate in each scale in use, and products of earlier entries of the
//! list, two factors each. A figure is a weighted sum of entries.

use crate::file::{Coordinate, Document, Fault, FittedFigure, HeldOutError, Key, Origin, Scale};
use std::collections::HashMap;

/// A surrogate ready for evaluation.
#[derive(Clone, Debug)]
pub struct Surrogate {
    origin: Origin,
    keys: Vec<Key>,
    /// Quotients of keys, which have bounds of their own.
    quotients: Vec<Quotient>,
    axes: Vec<Axis>,
    /// Each product multiplies two earlier entries of the list; products follow the polynomials.
    products: Vec<[u32; 2]>,
    figures: Vec<Figure>,
    terms: Vec<(u32, f64)>,
    /// Length of the list of numbers.
    length: usize,
}

#[derive(Clone, Debug)]
struct Quotient {
    of: usize,
    by: usize,
    from: f64,
    to: f64,
}

/// Polynomials of one coordinate in one scale.
#[derive(Clone, Debug)]
struct Axis {
    of: usize,
    by: Option<usize>,
    scale: Scale,
    /// Scaling `s = x · slope - shift`, or the same with `ln x`.
    slope: f64,
    shift: f64,
    /// Position of the polynomial of degree 1 in the list, and the largest degree.
    first: usize,
    degree: usize,
}

/// A figure of a surrogate.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Dotted key in `summary.json`.
    pub key: String,
    /// Description in words.
    pub words: String,
    /// Error at points that were held out of the fit.
    pub held: HeldOutError,
    scale: Scale,
    sign: f64,
    /// End of the figure's terms, which begin at the end of the previous figure's terms.
    end: usize,
}

/// Buffers of an evaluation, allocated once and reused.
#[derive(Clone, Debug)]
pub struct Workspace {
    numbers: Vec<f64>,
    figures: Vec<f64>,
}

/// A point outside the region of a surrogate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{key} = {value}{unit} is outside {from} to {to}{unit}, the range of the surrogate")]
pub struct Outside {
    /// Key; for a quotient, both keys separated by a slash.
    pub key: String,
    /// Value of the key \[SI\].
    pub value: f64,
    /// Smallest value in the region.
    pub from: f64,
    /// Largest value in the region.
    pub to: f64,
    /// A space followed by the unit; empty for a plain number.
    pub unit: String,
}

/// Reason for a refused evaluation.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refused {
    /// The point lies outside the region.
    #[error(transparent)]
    Outside(#[from] Outside),
    /// The number of values is wrong.
    #[error("got {given} values, but the surrogate has {keys} keys")]
    Count {
        /// Number of values given.
        given: usize,
        /// Number of keys of the surrogate.
        keys: usize,
    },
    /// A figure has no finite value at a point inside the region, so its coefficients cannot stem
    /// from a fit.
    #[error("{figure} has no finite value here; create the surrogate again")]
    NotFinite {
        /// Key of the figure.
        figure: String,
    },
}

impl Surrogate {
    /// Reads a surrogate from the contents of its file.
    ///
    /// # Errors
    /// The contents are not a valid surrogate. See [`Document::read`].
    pub fn read(text: &[u8]) -> Result<Self, Fault> {
        Ok(Self::of(&Document::read(text)?))
    }

    /// Prepares a document for evaluation.
    ///
    /// # Errors
    /// The document is invalid. See [`Document::check`].
    pub fn new(document: &Document) -> Result<Self, Fault> {
        document.check()?;
        Ok(Self::of(document))
    }

    /// Sweep to which the surrogate is fitted.
    #[must_use]
    pub fn origin(&self) -> &Origin {
        &self.origin
    }

    /// Keys, in the order of the values of a point.
    #[must_use]
    pub fn keys(&self) -> &[Key] {
        &self.keys
    }

    /// Figures, in the order of the results.
    #[must_use]
    pub fn figures(&self) -> &[Figure] {
        &self.figures
    }

    /// Index of a figure in the results.
    #[must_use]
    pub fn position(&self, key: &str) -> Option<usize> {
        self.figures.iter().position(|one| one.key == key)
    }

    /// Allocates the buffers of an evaluation.
    #[must_use]
    pub fn room(&self) -> Workspace {
        Workspace { numbers: vec![1.0; self.length], figures: vec![0.0; self.figures.len()] }
    }

    /// Evaluates all figures at a point, given by the value of each key \[SI\]. Only the text of a
    /// refusal is allocated.
    ///
    /// # Errors
    /// The point lies outside the region of the surrogate, the number of values is wrong, or a
    /// figure has no finite value.
    ///
    /// # Panics
    /// If the room belongs to another surrogate.
    pub fn ask<'a>(&self, at: &[f64], room: &'a mut Workspace) -> Result<&'a [f64], Refused> {
        self.admit(at)?;
        let Workspace { numbers, figures } = room;
        assert_eq!(
            (numbers.len(), figures.len()),
            (self.length, self.figures.len()),
            "the room belongs to another surrogate"
        );
        for axis in &self.axes {
            axis.fill(at, numbers);
        }
        let first = self.length - self.products.len();
        for (n, [one, other]) in self.products.iter().enumerate() {
            numbers[first + n] = numbers[*one as usize] * numbers[*other as usize];
        }
        let mut begin = 0;
        for (value, figure) in figures.iter_mut().zip(&self.figures) {
            let sum: f64 = self.terms[begin..figure.end]
                .iter()
                .map(|(n, factor)| numbers[*n as usize] * factor)
                .sum();
            begin = figure.end;
            *value = match figure.scale {
                Scale::Linear => sum,
                Scale::Log => figure.sign * sum.exp(),
            };
            if !value.is_finite() {
                return Err(Refused::NotFinite { figure: figure.key.clone() });
            }
        }
        Ok(figures)
    }

    /// Checks that a point lies in the region of the surrogate.
    ///
    /// # Errors
    /// The point lies outside, or the number of values is wrong.
    pub fn admit(&self, at: &[f64]) -> Result<(), Refused> {
        if at.len() != self.keys.len() {
            return Err(Refused::Count { given: at.len(), keys: self.keys.len() });
        }
        for (key, value) in self.keys.iter().zip(at) {
            // NaN counts as outside.
            if !(key.from..=key.to).contains(value) {
                return Err(outside(key, *value).into());
            }
        }
        for one in &self.quotients {
            let value = at[one.of] / at[one.by];
            if !(one.from..=one.to).contains(&value) {
                return Err(self.outside_quotient(one, value).into());
            }
        }
        Ok(())
    }

    #[cold]
    fn outside_quotient(&self, one: &Quotient, value: f64) -> Outside {
        let key = format!("{}/{}", self.keys[one.of].key, self.keys[one.by].key);
        let alike = self.keys[one.of].unit == self.keys[one.by].unit;
        let unit = if alike { String::new() } else { " (SI)".to_owned() };
        Outside { key, value, from: one.from, to: one.to, unit }
    }

    fn of(document: &Document) -> Self {
        let place = |key: &str| document.place(key).expect("a document has been checked");
        let ends = |one: &Coordinate| (place(&one.key), one.per.as_deref().map(place));
        let quotients = document.coordinates.iter().filter_map(|one| {
            let (of, by) = ends(one);
            Some(Quotient { of, by: by?, from: one.from, to: one.to })
        });
        let mut list = List::new(document);
        let (mut figures, mut terms) = (Vec::new(), Vec::new());
        for one in &document.figures {
            let degrees = one.degrees.iter().zip(&one.coefficients);
            terms.extend(
                degrees.map(|(degrees, factor)| (list.product(degrees, &one.scales), *factor)),
            );
            figures.push(Figure::of(one, terms.len()));
        }
        let axis = |(n, scale): (usize, Scale), first: usize, degree: usize| {
            let one = &document.coordinates[n];
            let (of, by) = ends(one);
            let (from, to) = match scale {
                Scale::Linear => (one.from, one.to),
                Scale::Log => (one.from.ln(), one.to.ln()),
            };
            let (slope, shift) = (2.0 / (to - from), (to + from) / (to - from));
            Axis { of, by, scale, slope, shift, first, degree }
        };
        Self {
            origin: document.origin.clone(),
            keys: document.keys.clone(),
            quotients: quotients.collect(),
            axes: list.axes.iter().map(|(of, first, degree)| axis(*of, *first, *degree)).collect(),
            length: list.first_product + list.products.len(),
            products: list.products,
            figures,
            terms,
        }
    }
}

#[cold]
fn outside(key: &Key, value: f64) -> Outside {
    let unit = if matches!(key.unit.as_str(), "" | "1") {
        String::new()
    } else {
        format!(" {}", key.unit)
    };
    Outside { key: key.key.clone(), value, from: key.from, to: key.to, unit }
}

impl Axis {
    /// Writes the polynomials from degree 1 upwards.
    fn fill(&self, at: &[f64], numbers: &mut [f64]) {
        let x = self.by.map_or(at[self.of], |by| at[self.of] / at[by]);
        let x = if self.scale == Scale::Log { x.ln() } else { x };
        let s = x * self.slope - self.shift;
        let (mut before, mut now) = (1.0, s);
        for number in &mut numbers[self.first..self.first + self.degree] {
            *number = now;
            (before, now) = (now, 2.0 * s * now - before);
        }
    }
}

impl Figure {
    fn of(one: &FittedFigure, end: usize) -> Self {
        let sign = if one.negative { -1.0 } else { 1.0 };
        let (key, words) = (one.key.clone(), one.words.clone());
        Self { key, words, held: one.held, scale: one.scale, sign, end }
    }
}

/// Layout of the list of numbers.
struct List {
    /// A coordinate in a scale, the position of its polynomials, and their largest degree.
    axes: Vec<((usize, Scale), usize, usize)>,
    products: Vec<[u32; 2]>,
    first_product: usize,
    known: HashMap<[u32; 2], u32>,
}

impl List {
    fn new(document: &Document) -> Self {
        let mut degrees: HashMap<(usize, Scale), usize> = HashMap::new();
        for one in &document.figures {
            for (n, scale) in one.scales.iter().enumerate() {
                let degree = one.degrees.iter().map(|term| usize::from(term[n])).max();
                let largest = degrees.entry((n, *scale)).or_default();
                *largest = (*largest).max(degree.unwrap_or(0));
            }
        }
        let mut all: Vec<_> = degrees.into_iter().filter(|(_, degree)| *degree > 0).collect();
        all.sort_unstable();
        let mut next = 1;
        let axes = all.into_iter().map(|(of, degree)| {
            next += degree;
            (of, next - degree, degree)
        });
        Self {
            axes: axes.collect(),
            first_product: next,
            products: Vec::new(),
            known: HashMap::new(),
        }
    }

    /// Position of the product of these polynomials, which is added if necessary.
    fn product(&mut self, degrees: &[u8], scales: &[Scale]) -> u32 {
        let mut at = 0;
        for (of, degree) in scales.iter().copied().enumerate().zip(degrees) {
            if *degree == 0 {
                continue;
            }
            let axis = self.axes.iter().find(|(other, ..)| *other == of);
            let (_, first, _) = axis.expect("the largest degrees are known");
            let factor = narrow(first + usize::from(*degree) - 1);
            at = if at == 0 { factor } else { self.times([at, factor]) };
        }
        at
    }

    fn times(&mut self, pair: [u32; 2]) -> u32 {
        let next = narrow(self.first_product + self.products.len());
        *self.known.entry(pair).or_insert_with(|| {
            self.products.push(pair);
            next
        })
    }
}

fn narrow(n: usize) -> u32 {
    u32::try_from(n).expect("the terms of a document are limited")
}
