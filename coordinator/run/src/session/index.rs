//! Indices into the lists of a session.

coupling::index! {
    /// A tap: a field of the run.
    pub TapIndex
}

coupling::index! {
    /// A field of the coupling data.
    pub(super) PartIndex
}

coupling::index! {
    /// A field that is mapped for a consumer.
    pub(super) MappedIndex
}

coupling::index! {
    /// A grid that may move.
    pub(super) MovingIndex
}
