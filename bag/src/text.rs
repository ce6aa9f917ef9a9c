//! What is known of a recording, as text for people.

use std::fmt;

use super::{info::BagInfo, repair::RepairReport};

impl fmt::Display for BagInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.path.display())?;
        writeln!(
            f,
            "  {:.3} s, {} messages, {:.1} MB in {} file(s), {}",
            self.duration_s,
            self.messages,
            self.bytes as f64 / 1e6,
            self.files.len(),
            if self.closed {
                "closed"
            } else {
                "NOT CLOSED: repair it with `ferntast bag repair`"
            }
        )?;
        for place in &self.breaks {
            writeln!(
                f,
                "  broken at byte {} of {}: {}",
                place.offset,
                place.path.display(),
                place.reason
            )?;
        }
        for topic in &self.topics {
            write!(
                f,
                "  {:34} {:36} {:8} {:8.1} Hz",
                topic.name, topic.interface, topic.messages, topic.rate_hz
            )?;
            match topic.gaps.first() {
                None => writeln!(f)?,
                Some(longest) => writeln!(
                    f,
                    "  {} gap(s), the longest {:.3} s",
                    topic.gap_count, longest.duration_s
                )?,
            }
        }
        Ok(())
    }
}

impl fmt::Display for RepairReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: {} messages", self.path.display(), self.messages)?;
        for file in &self.files {
            if file.breaks.is_empty() {
                writeln!(f, "  {}: it was whole", file.path.display())?;
            }
            for place in &file.breaks {
                writeln!(
                    f,
                    "  {}: {} messages recovered; it broke at byte {}: {}",
                    file.path.display(),
                    file.messages,
                    place.offset,
                    place.reason
                )?;
            }
            if let Some(backup) = &file.backup {
                writeln!(f, "  the broken one is kept as {}", backup.display())?;
            }
        }
        Ok(())
    }
}
