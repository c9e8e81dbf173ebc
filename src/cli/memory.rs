//! Whether the machine has the memory that a run would take.

use super::output::Screen;
use super::output::failure::Failure;
use crate::plan::assess::forecast_bytes;
use crate::problem::Problem;

/// What is warned of where the machine does not say what it has, in bytes.
const MUCH: f64 = 8e9;

/// Sweeps up to so many configurations are not looked at beforehand: they need some hundred megabytes.
const HARMLESS: usize = 500_000;

/// The machine's memory in bytes, as far as it tells.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Memory {
    total: Option<f64>,
    free: Option<f64>,
}

impl Memory {
    /// Of this machine, or of the group of processes that this one is in.
    pub(super) fn here() -> Self {
        let read = |path: &str| std::fs::read_to_string(path).ok();
        let meminfo = read("/proc/meminfo").unwrap_or_default();
        let limit = |path: &str| read(path).and_then(|text| text.trim().parse::<f64>().ok());
        let most = limit("/sys/fs/cgroup/memory.max");
        let used = limit("/sys/fs/cgroup/memory.current");
        Self::from_meminfo(&meminfo).within(most, most.zip(used).map(|(most, used)| most - used))
    }

    fn from_meminfo(text: &str) -> Self {
        let bytes = |key: &str| {
            let line = text.lines().find_map(|line| line.strip_prefix(key))?;
            Some(line.trim_start_matches(':').trim().trim_end_matches("kB").trim().parse::<f64>().ok()? * 1024.0)
        };
        Self { total: bytes("MemTotal"), free: bytes("MemAvailable") }
    }

    /// With a limit that others have set.
    fn within(self, total: Option<f64>, free: Option<f64>) -> Self {
        let less = |a: Option<f64>, b: Option<f64>| a.into_iter().chain(b).reduce(f64::min);
        Self { total: less(self.total, total), free: less(self.free, free) }
    }

    /// A warning, if a run that takes `bytes` may not find them.
    pub(super) fn warning(&self, bytes: f64) -> Option<String> {
        let there = match self.free {
            Some(free) if bytes > free => format!("more than the {} that this machine has free", gigabytes(free)),
            None if bytes > MUCH => "which may be too much".to_owned(),
            _ => return None,
        };
        Some(format!("the run would take {} of memory, {there}: {REMEDY}", gigabytes(bytes)))
    }
}

/// What to do about too many candidates.
const REMEDY: &str = "use a larger step, a sample (`sample = 200_000`) with `refine = 2`, narrower joint limits, or \
                      `axis = \"zone\"`, which keeps only the configurations that point at the zone";

fn gigabytes(bytes: f64) -> String {
    if bytes < 1e9 { format!("{:.0} MB", bytes / 1e6) } else { format!("{:.1} GB", bytes / 1e9) }
}

/// Refuses a run that takes more memory than there is, before it dies of it; warns where it is more than is free.
///
/// # Errors
/// [`Failure::Memory`].
pub(super) fn hold_against_memory(problem: &Problem, screen: &Screen) -> Result<(), Failure> {
    let tried = problem.space.len() + problem.refinement.rounds * problem.refinement.sample;
    if tried <= HARMLESS {
        return Ok(());
    }
    let (memory, bytes) = (Memory::here(), forecast_bytes(problem));
    if memory.total.is_some_and(|total| bytes > total) {
        let total = memory.total.map(gigabytes).unwrap_or_default();
        return Err(Failure::Memory { needed: gigabytes(bytes), total, remedy: REMEDY });
    }
    if let Some(warning) = memory.warning(bytes) {
        screen.warn(&warning);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_there_is_warned_of() {
        let memory = Memory::from_meminfo("MemTotal:       16000000 kB\nMemFree: 1 kB\nMemAvailable:    8000000 kB\n");
        assert_eq!(memory, Memory { total: Some(16.384e9), free: Some(8.192e9) });
        assert_eq!(memory.warning(8e9), None);
        let warning = memory.warning(17.7e9).unwrap();
        assert!(
            warning.starts_with("the run would take 17.7 GB of memory, more than the 8.2 GB")
                && warning.contains("larger step")
        );
        assert_eq!(memory.within(Some(4e9), Some(1e9)), Memory { total: Some(4e9), free: Some(1e9) });
        assert!(Memory::default().warning(7e9).is_none() && Memory::default().warning(9e9).is_some());
    }
}
