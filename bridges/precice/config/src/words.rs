//! Enumerations whose variants are words of the configuration.

/// A choice between words.
pub(crate) trait Words: Copy + Sized + 'static {
    /// All variants with their words.
    const ALL: &'static [(&'static str, Self)];

    /// Returns the variant with this word.
    fn from_word(word: &str) -> Option<Self> {
        Self::ALL.iter().find(|(known, _)| *known == word).map(|(_, variant)| *variant)
    }
}

/// Defines an enumeration with the word of each variant.
macro_rules! words {
    ($(#[$about:meta])* $name:ident { $($(#[$line:meta])* $variant:ident = $word:literal,)+ }) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub enum $name {
            $($(#[$line])* $variant,)+
        }

        impl $crate::words::Words for $name {
            const ALL: &'static [(&'static str, Self)] = &[$(($word, Self::$variant)),+];
        }

        impl $name {
            /// Returns the word in the configuration.
            #[must_use]
            pub fn word(self) -> &'static str {
                match self {
                    $(Self::$variant => $word,)+
                }
            }
        }
    };
}

pub(crate) use words;
