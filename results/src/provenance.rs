//! Provenance of a row: build, machine, time.

use std::thread::available_parallelism;

use jiff::Timestamp;
use sysinfo::{CpuRefreshKind, MemoryRefreshKind, RefreshKind, System};

use crate::error::RowError;
use crate::schema::Provenance;

impl Provenance {
    /// Describes this build, on this machine, now.
    ///
    /// # Errors
    ///
    /// If any field would be empty, or no thread is named.
    pub fn gather(commit: &str, rustc: &str, profile: &str, threads: u32) -> Result<Self, RowError> {
        let provenance = Self {
            commit: commit.trim().to_owned(),
            processor: processor()?,
            processors: available_parallelism().map_or(0, |number| number.get() as u32),
            threads,
            rustc: rustc.trim().to_owned(),
            profile: profile.trim().to_owned(),
            started_utc: now(),
            other_code: String::new(),
        };
        provenance.check()?;
        Ok(provenance)
    }

    /// Returns the same provenance for a run that begins now.
    #[must_use]
    pub fn restarted(&self) -> Self {
        Self { started_utc: now(), ..self.clone() }
    }

    /// Refuses what could not be traced.
    ///
    /// # Errors
    ///
    /// If a field is empty, or no thread is named.
    pub fn check(&self) -> Result<(), RowError> {
        let texts = [
            ("commit", &self.commit),
            ("processor", &self.processor),
            ("rustc", &self.rustc),
            ("profile", &self.profile),
            ("started_utc", &self.started_utc),
        ];
        match texts.into_iter().find(|(_, text)| text.trim().is_empty()) {
            Some((name, _)) => Err(RowError::Untraced(name)),
            None if self.threads == 0 => Err(RowError::Untraced("threads")),
            None => Ok(()),
        }
    }
}

/// Processes that ran or waited to, on average over the last minute (–); NaN where the system does not tell.
pub fn load_average() -> f64 {
    System::load_average().map_or(f64::NAN, |load| load.one)
}

/// Returns the memory that this process can still take (B); `None` where the system does not tell.
pub fn available_memory() -> Option<u64> {
    let wanted = RefreshKind::nothing().with_memory(MemoryRefreshKind::nothing().with_ram());
    let system = System::new_with_specifics(wanted).ok()?;
    // What a group keeps of files, the system takes back when it is needed.
    let of_group = system.cgroup_limits().map_or(u64::MAX, |l| l.total_memory.saturating_sub(l.rss));
    Some(system.available_memory().min(of_group)).filter(|free| *free > 0)
}

fn now() -> String {
    Timestamp::now().strftime("%Y-%m-%dT%H:%M:%SZ").to_string()
}

fn processor() -> Result<String, RowError> {
    let wanted = RefreshKind::nothing().with_cpu(CpuRefreshKind::nothing());
    let system = System::new_with_specifics(wanted).map_err(|e| RowError::System(format!("{e:?}")))?;
    Ok(system.cpus().first().map(|cpu| cpu.brand().trim().to_owned()).unwrap_or_default())
}
