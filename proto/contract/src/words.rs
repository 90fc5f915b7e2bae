//! Enums whose variants are words of a case.

/// Declares an enum with one word of a case per variant, such as the values of `coupling.scheme`.
///
/// The words, their meanings, parsing and printing all follow from the one list of variants. The
/// crate that declares such an enum must depend on serde. A default is marked as for
/// `#[derive(Default)]`:
///
/// ```
/// contract::words! {
///     /// Gauges of a track.
///     #[derive(Default)]
///     pub enum Gauge {
///         /// 1435 mm.
///         #[default]
///         Standard = "standard",
///         /// 1000 mm.
///         Metre = "metre",
///     }
/// }
///
/// assert_eq!(Gauge::WORDS, ["standard", "metre"]);
/// assert_eq!(Gauge::from_word("metre"), Some(Gauge::Metre));
/// assert_eq!(Gauge::default().word(), "standard");
/// ```
#[macro_export]
macro_rules! words {
    ($(#[$doc:meta])* $visibility:vis enum $name:ident {
        $($(#[$of:meta])* $variant:ident = $word:literal,)*
    }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
        $visibility enum $name { $($(#[$of])* #[serde(rename = $word)] $variant,)* }

        #[allow(dead_code, reason = "not every enum is used in every direction")]
        impl $name {
            /// All variants.
            $visibility const ALL: [Self; [$($word),*].len()] = [$(Self::$variant),*];
            /// All words, as written in a case.
            $visibility const WORDS: &[&str] = &[$($word),*];

            /// Returns the word in the case file.
            #[must_use]
            $visibility fn word(self) -> &'static str {
                match self { $(Self::$variant => $word,)* }
            }

            /// Returns the variant of a word.
            #[must_use]
            $visibility fn from_word(word: &str) -> Option<Self> {
                match word { $($word => Some(Self::$variant),)* _ => None }
            }
        }
    };
}
