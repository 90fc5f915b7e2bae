//! A thread that steps the upper body while the caller steps the lower one.

use super::block::Block;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

/// The thread; it ends when this is dropped.
pub struct Helper {
    to: SyncSender<(Block, f64)>,
    back: Receiver<Block>,
}

impl Helper {
    /// Starts it.
    #[must_use]
    pub fn start() -> Self {
        let ((to, from), (back_to, back)) = (sync_channel::<(Block, f64)>(1), sync_channel(1));
        std::thread::spawn(move || {
            while let Ok((mut block, step)) = from.recv() {
                block.step(step);
                if back_to.send(block).is_err() {
                    return;
                }
            }
        });
        Self { to, back }
    }

    /// A step [s] of both bodies at the same time.
    ///
    /// # Panics
    /// The thread has.
    pub fn both(&self, [upper, lower]: &mut [Block; 2], step: f64) {
        self.to.send((upper.lent(), step)).expect("the thread lives as long as the channel");
        lower.step(step);
        *upper = self.back.recv().expect("the thread panics on its own");
    }
}
