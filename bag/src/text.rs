//! What is known of a recording, as text for people.

use std::fmt;

use ferntast_msgs::counted;

use super::{info::BagInfo, repair::RepairReport};

impl fmt::Display for BagInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.path.display())?;
        writeln!(
            f,
            "  {:.3} s, {} messages, {:.1} MB in {}, {}",
            self.duration_s,
            self.messages,
            self.bytes as f64 / 1e6,
            counted(self.files.len(), "file"),
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
                    "  {}, the longest {:.3} s, at {:.3} s",
                    counted(topic.gap_count, "gap"),
                    longest.duration_s,
                    self.start
                        .map_or(0.0, |start| longest.start.seconds_since(start))
                )?,
            }
        }
        if self.topics.iter().all(|topic| topic.gap_count == 0) {
            writeln!(
                f,
                "  no gaps (a topic silent for 0.1 s and five of its intervals)"
            )?;
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
