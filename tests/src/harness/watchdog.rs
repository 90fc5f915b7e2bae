//! Clock of the watchdogs: time as it would pass on an idle machine.
//!
//! On a loaded machine a wall clock ends tests that only wait for a processor. This clock leaves
//! that time out. It looks at all threads of this process and of the processes below it: how long
//! they ran, and how long they waited for a processor (`/proc/PID/task/TID/schedstat`). Threads
//! that want no processor hang, or wait for somebody: their time counts in full.

use std::collections::HashMap;
use std::fs;
use std::sync::Once;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// Time between two looks at the threads.
const LOOK: Duration = Duration::from_millis(500);

/// Returns the time on the clock, which starts with the first call.
pub(super) fn now() -> Duration {
    static STARTED: Once = Once::new();
    static MILLISECONDS: AtomicU64 = AtomicU64::new(0);
    STARTED.call_once(|| {
        thread::spawn(|| {
            let mut threads = Threads::default();
            threads.look();
            loop {
                let since = Instant::now();
                thread::sleep(LOOK);
                let wall = since.elapsed();
                let counted = counted(wall, threads.look());
                MILLISECONDS.fetch_add(counted.as_millis() as u64, Ordering::Relaxed);
            }
        });
    });
    Duration::from_millis(MILLISECONDS.load(Ordering::Relaxed))
}

/// Processor time of threads: time in which they ran, and in which they waited for a processor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Processor {
    ran: Duration,
    waited: Duration,
}

/// Returns the part of a time that counts. Threads that wait in turn lose the time for which they
/// waited. Threads that wait at the same time advance by the share that they ran.
fn counted(wall: Duration, processor: Processor) -> Duration {
    let Processor { ran, waited } = processor;
    let wanted = (ran + waited).as_secs_f64();
    let share = if wanted > 0.0 { ran.as_secs_f64() / wanted } else { 1.0 };
    wall.mul_f64(share).max(wall.saturating_sub(waited))
}

/// Processor times of all threads at the last look, by thread.
#[derive(Debug, Default)]
struct Threads(HashMap<String, Processor>);

impl Threads {
    /// Returns the processor time since the last look.
    fn look(&mut self) -> Processor {
        let (mut found, mut sum) = (HashMap::new(), Processor::default());
        let mut processes = vec![std::process::id().to_string()];
        while let Some(process) = processes.pop() {
            for task in
                fs::read_dir(format!("/proc/{process}/task")).into_iter().flatten().flatten()
            {
                let read = |name| fs::read_to_string(task.path().join(name)).unwrap_or_default();
                processes.extend(read("children").split_whitespace().map(str::to_owned));
                let Some(now) = parse(&read("schedstat")) else { continue };
                let thread = task.path().display().to_string();
                let before = self.0.get(&thread).copied().unwrap_or_default();
                sum.ran += now.ran.saturating_sub(before.ran);
                sum.waited += now.waited.saturating_sub(before.waited);
                found.insert(thread, now);
            }
        }
        self.0 = found;
        sum
    }
}

/// Reads nanoseconds in which a thread ran and waited.
fn parse(schedstat: &str) -> Option<Processor> {
    let mut times = schedstat.split_whitespace().map(|time| time.parse().ok());
    let mut next = || times.next().flatten().map(Duration::from_nanos);
    Some(Processor { ran: next()?, waited: next()? })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_without_a_processor_does_not_count() {
        let second = |seconds: f64| Duration::from_secs_f64(seconds);
        let of = |ran, waited| {
            counted(second(1.0), Processor { ran: second(ran), waited: second(waited) })
                .as_secs_f64()
        };
        assert_eq!(of(0.0, 0.0), 1.0, "everybody hangs");
        assert_eq!(of(1.0, 0.0), 1.0, "somebody computes without end");
        assert_eq!(of(0.01, 0.09), 0.91, "heartbeats alone");
        assert_eq!(of(0.25, 0.75), 0.25, "one process on a loaded machine");
        assert_eq!(of(2.0, 6.0), 0.25, "eight threads on two processors");
    }

    #[test]
    fn the_time_of_this_process_is_found() {
        let mut threads = Threads::default();
        threads.look();
        let mut ran = Duration::ZERO;
        while ran.is_zero() {
            std::hint::black_box((0..100_000_u64).sum::<u64>());
            ran = threads.look().ran;
        }
        assert_eq!(
            parse("12 34 5\n"),
            Some(Processor { ran: Duration::from_nanos(12), waited: Duration::from_nanos(34) })
        );
        assert_eq!(parse(""), None);
    }
}
