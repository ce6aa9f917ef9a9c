//! The line that a person sees while a session runs.

use std::time::Duration;

use ferntast_msgs::{
    Time,
    sample::{Edge, OperatingState},
};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::{Monitor, Supervisor};
use crate::events::Event;

/// One line on stderr that follows the session. On a terminal it is redrawn
/// in place; elsewhere a line appears every [`QUIET_PERIOD`].
pub struct LiveLine {
    bar: ProgressBar,
    on_terminal: bool,
    last: Option<Time>,
}

/// Seconds between lines where there is no terminal.
const QUIET_PERIOD: f64 = 5.0;

impl LiveLine {
    /// A live line for a session of `duration` \[s\], if it has an end.
    pub fn new(duration: Option<f64>) -> LiveLine {
        let bar = match duration {
            Some(duration) => ProgressBar::new((duration * 10.0) as u64),
            None => ProgressBar::no_length(),
        };
        bar.set_draw_target(ProgressDrawTarget::stderr_with_hz(5));
        let template = if duration.is_some() {
            "{spinner} {bar:12} {msg}"
        } else {
            "{spinner} {msg}"
        };
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(200));
        let on_terminal = std::io::IsTerminal::is_terminal(&std::io::stderr());
        LiveLine {
            bar,
            on_terminal,
            last: None,
        }
    }

    /// A message that stays.
    pub fn note(&self, text: &str) {
        if self.on_terminal {
            self.bar.println(text);
        } else {
            eprintln!("{text}");
        }
    }

    /// An event, `elapsed` \[s\] after arming: it stays.
    pub fn tell(&self, elapsed: f64, event: &Event) {
        self.note(&format!("{elapsed:7.1} s  {}", event.text));
    }

    /// Shows where the session stands, `elapsed` \[s\] after arming.
    pub fn show(&mut self, now: Time, elapsed: f64, monitor: &Monitor, supervisor: &Supervisor) {
        let text = || describe(now, elapsed, monitor, supervisor);
        if self.on_terminal {
            self.bar.set_position((elapsed * 10.0) as u64);
            self.bar.set_message(text());
        } else if self
            .last
            .is_none_or(|last| now.seconds_since(last) >= QUIET_PERIOD)
        {
            self.last = Some(now);
            eprintln!("{}", text());
        }
    }

    /// Takes the line away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

fn describe(now: Time, elapsed: f64, monitor: &Monitor, supervisor: &Supervisor) -> String {
    let mut text = format!("{elapsed:5.1} s");
    for (device, view) in &monitor.operating {
        let Some(last) = view.last else {
            text.push_str(&format!(" · {device} ?"));
            continue;
        };
        text.push_str(&format!(" · {device} {}", last.state.name().unwrap_or("?")));
        // Who has to act reads why.
        if matches!(last.state, OperatingState::PAUSED | OperatingState::FAULT) {
            text.push_str(&format!(" ({})", last.reason));
        }
    }
    if let Some(servo) = monitor.nodes.get("servo").and_then(|view| view.last) {
        text.push_str(&format!(" · servo {:.0} Hz", servo.rate));
    }
    if let Some(link) = &monitor.link_status {
        if link.round_trip.is_finite() {
            text.push_str(&format!(
                " · rtt {:.1} ms, loss {:.1} %",
                link.round_trip * 1e3,
                link.loss * 100.0
            ));
        }
        if link.connected == 0 {
            text.push_str(" · LINK DOWN");
        }
    }
    if let Some(contact) = &monitor.contact_state {
        if contact.in_contact == 1 {
            let edge = contact.edge.name().filter(|_| contact.edge != Edge::NONE);
            text.push_str(&format!(
                " · contact {} {:.1} N",
                edge.unwrap_or(""),
                contact.normal_force
            ));
        } else {
            text.push_str(" · free");
        }
    }
    if monitor.operating.contains_key("leader") {
        text.push_str(&format!(" · hand {:.1} N", monitor.hand_force));
    }
    let dead: Vec<&str> = supervisor
        .nodes()
        .filter(|(node, process, _)| process.is_none() || !monitor.is_alive(node, now))
        .map(|(node, _, _)| node)
        .collect();
    if dead.is_empty() {
        text.push_str(&format!(" · {} nodes alive", supervisor.nodes().count()));
    } else {
        text.push_str(&format!(" · waiting for {}", dead.join(", ")));
    }
    text
}
