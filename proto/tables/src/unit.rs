//! Units of measurement: symbols, prefixes, products and powers.
//!
//! A unit is a vector of exponents over m, kg, s, K, A, mol, cd and byte, and a scale to SI. The
//! scale is stored as `10^ten · num / den` with the powers of ten apart. A decimal number is thus
//! scaled by shifting its exponent, without rounding.

/// Exponents of m, kg, s, K, A, mol, cd, byte.
pub(crate) type Dimension = [i32; 8];

/// Maximum nesting of parentheses in a unit.
const DEEPEST: u32 = 8;
/// Maximum power of a symbol.
const LARGEST_POWER: i32 = 9;

/// A unit: its dimension, and its scale to SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Unit {
    pub(crate) dimension: Dimension,
    /// Decimal exponent of the scale.
    pub(crate) ten: i32,
    /// Numerator of the scale.
    pub(crate) num: f64,
    /// Denominator of the scale.
    pub(crate) den: f64,
    /// Degrees Celsius, with zero at 273.15 K.
    pub(crate) celsius: bool,
}

/// Reason why a unit cannot be parsed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum UnitError {
    /// The unknown symbol, and a similar known one.
    Unknown(String, Option<String>),
    /// The text is not a product of powers of symbols.
    Syntax,
    /// Degrees Celsius occur in a product, power or quotient.
    Celsius,
}

impl Unit {
    const ONE: Self = Self { dimension: [0; 8], ten: 0, num: 1.0, den: 1.0, celsius: false };

    fn times(&self, other: &Self) -> Self {
        let mut dimension = self.dimension;
        for (mine, theirs) in dimension.iter_mut().zip(other.dimension) {
            *mine = mine.saturating_add(theirs);
        }
        Self {
            dimension,
            ten: self.ten.saturating_add(other.ten),
            num: self.num * other.num,
            den: self.den * other.den,
            celsius: self.celsius || other.celsius,
        }
    }

    fn inverse(&self) -> Self {
        Self {
            dimension: self.dimension.map(i32::saturating_neg),
            ten: self.ten.saturating_neg(),
            num: self.den,
            den: self.num,
            celsius: self.celsius,
        }
    }

    /// Returns the quotient of two units.
    pub(crate) fn over(&self, other: &Self) -> Self {
        self.times(&other.inverse())
    }

    fn power(&self, power: i32) -> Self {
        let base = if power < 0 { self.inverse() } else { *self };
        (0..power.unsigned_abs()).fold(Self::ONE, |product, _| product.times(&base))
    }
}

struct Symbol {
    name: &'static str,
    dimension: Dimension,
    ten: i32,
    num: f64,
    den: f64,
    prefixed: bool,
}

const fn symbol(name: &'static str, dimension: Dimension, ten: i32, prefixed: bool) -> Symbol {
    Symbol { name, dimension, ten, num: 1.0, den: 1.0, prefixed }
}

const fn scaled(name: &'static str, dimension: Dimension, ten: i32, num: f64, den: f64) -> Symbol {
    Symbol { name, dimension, ten, num, den, prefixed: false }
}

const NONE: Dimension = [0; 8];
const METRE: Dimension = [1, 0, 0, 0, 0, 0, 0, 0];
const MASS: Dimension = [0, 1, 0, 0, 0, 0, 0, 0];
const TIME: Dimension = [0, 0, 1, 0, 0, 0, 0, 0];
const KELVIN: Dimension = [0, 0, 0, 1, 0, 0, 0, 0];
const BYTE: Dimension = [0, 0, 0, 0, 0, 0, 0, 1];
const PRESSURE: Dimension = [-1, 1, -2, 0, 0, 0, 0, 0];

/// Common spellings of units in lower case, and their symbols here.
const HABITS: &[(&str, &str)] = &[
    ("kmh", "km/h"),
    ("kph", "km/h"),
    ("kmph", "km/h"),
    ("mps", "m/s"),
    ("sec", "s"),
    ("msec", "ms"),
    ("usec", "us"),
    ("c", "°C"),
    ("celsius", "°C"),
    ("kelvin", "K"),
    ("newton", "N"),
    ("pascal", "Pa"),
    ("watt", "W"),
    ("joule", "J"),
    ("metre", "m"),
    ("meter", "m"),
    ("micron", "um"),
    ("microns", "um"),
];

/// All symbols, with a flag for those that take prefixes.
const SYMBOLS: &[Symbol] = &[
    symbol("m", METRE, 0, true),
    symbol("g", MASS, -3, true),
    symbol("s", TIME, 0, true),
    symbol("K", KELVIN, 0, true),
    symbol("A", [0, 0, 0, 0, 1, 0, 0, 0], 0, true),
    symbol("mol", [0, 0, 0, 0, 0, 1, 0, 0], 0, true),
    symbol("cd", [0, 0, 0, 0, 0, 0, 1, 0], 0, true),
    symbol("Hz", [0, 0, -1, 0, 0, 0, 0, 0], 0, true),
    symbol("N", [1, 1, -2, 0, 0, 0, 0, 0], 0, true),
    symbol("Pa", PRESSURE, 0, true),
    symbol("bar", PRESSURE, 5, true),
    symbol("J", [2, 1, -2, 0, 0, 0, 0, 0], 0, true),
    symbol("W", [2, 1, -3, 0, 0, 0, 0, 0], 0, true),
    symbol("V", [2, 1, -3, 0, -1, 0, 0, 0], 0, true),
    symbol("Ohm", [2, 1, -3, 0, -2, 0, 0, 0], 0, true),
    symbol("Ω", [2, 1, -3, 0, -2, 0, 0, 0], 0, true),
    symbol("t", MASS, 3, false),
    scaled("in", METRE, -4, 254.0, 1.0),
    scaled("min", TIME, 1, 6.0, 1.0),
    scaled("h", TIME, 2, 36.0, 1.0),
    symbol("%", NONE, -2, false),
    symbol("rad", NONE, 0, true),
    scaled("deg", NONE, -1, std::f64::consts::PI, 18.0),
    scaled("°", NONE, -1, std::f64::consts::PI, 18.0),
    symbol("°C", KELVIN, 0, false),
    symbol("degC", KELVIN, 0, false),
    symbol("B", BYTE, 0, false),
    symbol("kB", BYTE, 3, false),
    symbol("MB", BYTE, 6, false),
    symbol("GB", BYTE, 9, false),
    symbol("TB", BYTE, 12, false),
    scaled("KiB", BYTE, 0, 1024.0, 1.0),
    scaled("MiB", BYTE, 0, 1_048_576.0, 1.0),
    scaled("GiB", BYTE, 0, 1_073_741_824.0, 1.0),
];

/// Prefixes and their decimal exponents; micro has two different characters.
pub(crate) const PREFIXES: &[(&str, i32)] = &[
    ("f", -15),
    ("p", -12),
    ("n", -9),
    ("u", -6),
    ("µ", -6),
    ("μ", -6),
    ("m", -3),
    ("c", -2),
    ("d", -1),
    ("k", 3),
    ("M", 6),
    ("G", 9),
    ("T", 12),
    ("P", 15),
];

fn look_up(name: &str) -> Option<Unit> {
    let whole = SYMBOLS.iter().find(|s| s.name == name).map(|s| (s, 0));
    let (symbol, prefix) = whole.or_else(|| {
        PREFIXES.iter().find_map(|(prefix, ten)| {
            let rest = name.strip_prefix(prefix)?;
            SYMBOLS.iter().find(|s| s.prefixed && s.name == rest).map(|s| (s, *ten))
        })
    })?;
    Some(Unit {
        dimension: symbol.dimension,
        ten: symbol.ten + prefix,
        num: symbol.num,
        den: symbol.den,
        celsius: symbol.name.ends_with('C'),
    })
}

fn unknown(name: &str) -> UnitError {
    let prefixed = SYMBOLS
        .iter()
        .filter(|s| s.prefixed)
        .flat_map(|s| PREFIXES.iter().map(move |(prefix, _)| format!("{prefix}{}", s.name)));
    let all: Vec<String> = SYMBOLS.iter().map(|s| s.name.to_owned()).chain(prefixed).collect();
    let words = || all.iter().map(String::as_str);
    let habit = HABITS.iter().find(|(word, _)| *word == name.to_lowercase());
    if let Some((_, unit)) = habit {
        return UnitError::Unknown(name.to_owned(), Some((*unit).to_owned()));
    }
    let other_case = words().find(|word| word.to_lowercase() == name.to_lowercase());
    let near = other_case.or_else(|| crate::suggest::nearest(name, words()));
    UnitError::Unknown(name.to_owned(), near.map(str::to_owned))
}

/// Returns the exponents of m, kg, s, K, A, mol and cd of an SI unit; `None` for other dimensions
/// or another scale.
#[must_use]
pub fn si_exponents(unit: &str) -> Option<[i32; 7]> {
    let Unit { dimension, ten, num, den, celsius } = parse_unit(unit).ok()?;
    let coherent = ten == 0 && num == den && !celsius && dimension[7] == 0;
    coherent.then(|| std::array::from_fn(|k| dimension[k]))
}

/// Parses a unit: symbols with powers (`m^2`, `m2`, `m²`, `s^-1`), products (space, `*`, `·`),
/// quotients (`/`, from left to right) and parentheses.
pub(crate) fn parse_unit(text: &str) -> Result<Unit, UnitError> {
    let mut parser = Parser { rest: text.trim(), depth: 0 };
    let unit = parser.product()?;
    if !parser.rest.is_empty() {
        return Err(UnitError::Syntax);
    }
    // The zero of °C has a meaning only if the degree Celsius stands alone.
    let lone = matches!(text.trim(), "°C" | "degC");
    if unit.celsius && !lone { Err(UnitError::Celsius) } else { Ok(unit) }
}

struct Parser<'a> {
    rest: &'a str,
    depth: u32,
}

impl Parser<'_> {
    fn take(&mut self, wanted: impl Fn(char) -> bool) -> bool {
        let mut chars = self.rest.chars();
        let found = chars.next().is_some_and(wanted);
        if found {
            self.rest = chars.as_str();
        }
        found
    }

    fn skip_space(&mut self) -> bool {
        let trimmed = self.rest.trim_start();
        let skipped = trimmed.len() < self.rest.len();
        self.rest = trimmed;
        skipped
    }

    fn product(&mut self) -> Result<Unit, UnitError> {
        self.skip_space();
        let mut product = self.term()?;
        loop {
            let space = self.skip_space();
            if self.rest.is_empty() || self.rest.starts_with(')') {
                return Ok(product);
            }
            let divide = self.take(|c| c == '/');
            let multiply = !divide && self.take(|c| matches!(c, '*' | '·' | '⋅' | '×'));
            if !divide && !multiply && !space {
                return Err(UnitError::Syntax);
            }
            self.skip_space();
            let factor = self.term()?;
            product = if divide { product.over(&factor) } else { product.times(&factor) };
        }
    }

    fn term(&mut self) -> Result<Unit, UnitError> {
        if self.take(|c| c == '1') {
            return Ok(Unit::ONE);
        }
        let base = if self.take(|c| c == '(') { self.parenthesis()? } else { self.symbol()? };
        let power = self.power()?;
        Ok(if power == 1 { base } else { base.power(power) })
    }

    fn parenthesis(&mut self) -> Result<Unit, UnitError> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(UnitError::Syntax);
        }
        let inner = self.product()?;
        self.depth -= 1;
        if self.take(|c| c == ')') { Ok(inner) } else { Err(UnitError::Syntax) }
    }

    fn symbol(&mut self) -> Result<Unit, UnitError> {
        let end = self.rest.find(|c: char| !(c.is_alphabetic() || c == '%' || c == '°'));
        let (name, rest) = self.rest.split_at(end.unwrap_or(self.rest.len()));
        if name.is_empty() {
            return Err(UnitError::Syntax);
        }
        self.rest = rest;
        look_up(name).ok_or_else(|| unknown(name))
    }

    fn power(&mut self) -> Result<i32, UnitError> {
        let raised = self.take(|c| c == '^');
        let open = raised && self.take(|c| c == '(');
        let negative = self.take(|c| c == '-' || c == '⁻');
        let mut power = None;
        while let Some(digit) = self.rest.chars().next().and_then(digit) {
            self.take(|_| true);
            power = Some(power.unwrap_or(0) * 10 + digit);
            if power > Some(LARGEST_POWER) {
                return Err(UnitError::Syntax);
            }
        }
        let closed = !open || self.take(|c| c == ')');
        match power {
            Some(power) if closed => Ok(if negative { -power } else { power }),
            None if !raised && !negative => Ok(1),
            _ => Err(UnitError::Syntax),
        }
    }
}

/// Returns the value of a plain or superscript digit.
fn digit(c: char) -> Option<i32> {
    let superscript = "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().position(|s| s == c);
    let value = c.to_digit(10).map_or_else(|| superscript, |d| Some(d as usize))?;
    i32::try_from(value).ok()
}
