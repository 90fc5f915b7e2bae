//! Tables of a run that returns to earlier states: what has been written when, without a copy of all of it.

/// What a table held at a state: its first bytes, which are still in the file, and the rows behind them that
/// have been cut since.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Branch {
    start: u64,
    rest: Vec<u8>,
}

impl Branch {
    /// Of a table as it is, of this length \[byte\].
    pub(super) fn at(length: u64) -> Self {
        Self { start: length, rest: Vec::new() }
    }

    /// The table goes back to this length, and then on with [`Branch::rest`].
    pub(super) fn start(&self) -> u64 {
        self.start
    }

    /// Rows behind the start.
    pub(super) fn rest(&self) -> &[u8] {
        &self.rest
    }

    /// The table has been cut to this length, and these rows were behind it.
    pub(super) fn cut(&mut self, length: u64, rows: &[u8]) {
        if self.start > length {
            let own = usize::try_from(self.start - length).unwrap_or(usize::MAX).min(rows.len());
            self.rest.splice(0..0, rows[..own].iter().copied());
            self.start = length;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A table, cut and written to at will, gives every state what it held.
    fn play(moves: &[(bool, u8)]) {
        let mut table: Vec<u8> = Vec::new();
        let mut kept: Vec<(Branch, Vec<u8>)> = Vec::new();
        for (number, (back, which)) in moves.iter().enumerate() {
            if *back && !kept.is_empty() {
                let place = usize::from(*which) % kept.len();
                let (start, rest) = (kept[place].0.start(), kept[place].0.rest().to_vec());
                let cut = table.split_off(start as usize);
                kept.iter_mut().for_each(|(branch, _)| branch.cut(start, &cut));
                table.extend(rest);
                assert_eq!(table, kept[place].1);
            } else {
                table.extend(vec![number as u8; usize::from(*which % 5)]);
                kept.push((Branch::at(table.len() as u64), table.clone()));
            }
        }
    }

    proptest! {
        #[test]
        fn every_state_has_what_it_held(moves in prop::collection::vec(any::<(bool, u8)>(), 0..60)) {
            play(&moves);
        }
    }
}
