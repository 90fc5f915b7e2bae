//! A surrogate ready to be asked.
//!
//! All figures are made of one list of numbers, the [`Room`]: 1, the Chebyshev polynomials of each coordinate
//! in each scale that a figure needs, and the products of those, each of two numbers before it. A figure is a
//! sum over that list.

use crate::file::{Coordinate, Document, Fault, FittedFigure, Held, Key, Origin, Scale};
use std::collections::HashMap;

/// A surrogate.
#[derive(Clone, Debug)]
pub struct Surrogate {
    origin: Origin,
    keys: Vec<Key>,
    /// Quotients, which have bounds of their own.
    quotients: Vec<Quotient>,
    axes: Vec<Axis>,
    /// Each is the product of two numbers before it; the first one comes after the polynomials.
    products: Vec<[u32; 2]>,
    figures: Vec<Figure>,
    terms: Vec<(u32, f64)>,
    /// Numbers in all.
    length: usize,
}

#[derive(Clone, Debug)]
struct Quotient {
    of: usize,
    by: usize,
    from: f64,
    to: f64,
}

/// The polynomials of one coordinate in one scale.
#[derive(Clone, Debug)]
struct Axis {
    of: usize,
    by: Option<usize>,
    scale: Scale,
    /// `s = x · slope - shift`, or with `ln x`.
    slope: f64,
    shift: f64,
    /// Where the polynomial of degree 1 stands, and the largest degree.
    first: usize,
    degree: usize,
}

/// A figure of a surrogate.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Dotted key in `summary.json`.
    pub key: String,
    /// What it is, in words.
    pub words: String,
    /// Its error at points that the fit had not seen.
    pub held: Held,
    scale: Scale,
    sign: f64,
    /// The end of its terms; they begin where those of the figure before it end.
    end: usize,
}

/// Numbers of one evaluation; made once, used for any number of them.
#[derive(Clone, Debug)]
pub struct Room {
    numbers: Vec<f64>,
    figures: Vec<f64>,
}

/// A point outside of the region that a surrogate was made in.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{key} = {value}{unit} is outside {from} to {to}{unit}, where the surrogate was made")]
pub struct Outside {
    /// The key; of a quotient both, with a stroke between them.
    pub key: String,
    /// Its value \[SI\].
    pub value: f64,
    /// Least value that there is an answer for.
    pub from: f64,
    /// Largest value that there is an answer for.
    pub to: f64,
    /// A space and its unit; empty for a plain number.
    pub unit: String,
}

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refused {
    /// The point is outside.
    #[error(transparent)]
    Outside(#[from] Outside),
    /// Too many values, or too few.
    #[error("there are {given} values, and the surrogate has {keys} keys")]
    Count {
        /// Values given.
        given: usize,
        /// Keys of the surrogate.
        keys: usize,
    },
    /// A figure has no finite value at a point inside: its coefficients are none of a fit.
    #[error("{figure} has no finite value here; make the surrogate again")]
    NotFinite {
        /// Key of the figure.
        figure: String,
    },
}

impl Surrogate {
    /// Reads a file.
    ///
    /// # Errors
    /// It is no surrogate.
    pub fn read(text: &[u8]) -> Result<Self, Fault> {
        Ok(Self::of(&Document::read(text)?))
    }

    /// Makes a document that was just made, or read, ready to be asked.
    ///
    /// # Errors
    /// Something in it cannot be.
    pub fn new(document: &Document) -> Result<Self, Fault> {
        document.check()?;
        Ok(Self::of(document))
    }

    /// What it was made of.
    #[must_use]
    pub fn origin(&self) -> &Origin {
        &self.origin
    }

    /// The keys, in the order in which values are given.
    #[must_use]
    pub fn keys(&self) -> &[Key] {
        &self.keys
    }

    /// The figures, in the order of the answer.
    #[must_use]
    pub fn figures(&self) -> &[Figure] {
        &self.figures
    }

    /// Where a figure stands in the answer.
    #[must_use]
    pub fn position(&self, key: &str) -> Option<usize> {
        self.figures.iter().position(|one| one.key == key)
    }

    /// What an evaluation needs.
    #[must_use]
    pub fn room(&self) -> Room {
        Room { numbers: vec![1.0; self.length], figures: vec![0.0; self.figures.len()] }
    }

    /// All figures at a point, which has the value of each key \[SI\]. Nothing is allocated but the words of a
    /// refusal.
    ///
    /// # Errors
    /// The point is outside of the region that the surrogate was made in, or has another number of values.
    ///
    /// # Panics
    /// The room is that of another surrogate.
    pub fn ask<'a>(&self, at: &[f64], room: &'a mut Room) -> Result<&'a [f64], Refused> {
        self.admit(at)?;
        let Room { numbers, figures } = room;
        assert_eq!(
            (numbers.len(), figures.len()),
            (self.length, self.figures.len()),
            "a room of its own"
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

    /// Looks whether a point is where the surrogate was made.
    ///
    /// # Errors
    /// It is not, or has another number of values.
    pub fn admit(&self, at: &[f64]) -> Result<(), Refused> {
        if at.len() != self.keys.len() {
            return Err(Refused::Count { given: at.len(), keys: self.keys.len() });
        }
        for (key, value) in self.keys.iter().zip(at) {
            // What is no number is outside.
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
    /// Writes its polynomials from degree 1 on.
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

/// The list of numbers as it is laid out.
struct List {
    /// A coordinate in a scale, where its polynomials stand, and their largest degree.
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

    /// Where the product of these polynomials stands; it is added if it is not there.
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
