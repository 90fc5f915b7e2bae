//! Indices with types: none takes the place of another, or of a plain number.

/// Declares an index; lists that it is an index of are `typed_index_collections::TiVec`.
#[macro_export]
macro_rules! index {
    ($(#[$doc:meta])* $visibility:vis $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        $visibility struct $name(usize);

        impl $name {
            /// The index of the first one.
            #[allow(dead_code, reason = "not every index is needed by itself")]
            $visibility const FIRST: Self = Self(0);
        }

        impl From<usize> for $name {
            fn from(index: usize) -> Self {
                Self(index)
            }
        }

        impl From<$name> for usize {
            fn from(index: $name) -> Self {
                index.0
            }
        }
    };
}

index! {
    /// A participant, by its place in the order in which data flows.
    pub ParticipantIndex
}
