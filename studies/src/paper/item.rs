//! What is told of one number or statement of the paper.

use std::fmt;

use serde::Serialize;

/// One number or statement.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Item {
    /// Where it stands and what it is: `table1/on_ground/b1`.
    pub item: String,
    /// The paper's number; `None` where it makes a statement without one.
    pub paper: Option<f64>,
    /// The number found here.
    pub here: Option<f64>,
    /// Its standard error.
    pub std_error: Option<f64>,
    /// Unit of all three.
    pub unit: &'static str,
    /// Whether the paper's system and this one agree.
    pub holds: bool,
    /// What is asked for.
    pub criterion: String,
    /// How it settled, where it is identified on line.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub on_line: Option<OnLineItem>,
}

/// How a parameter settled on line.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OnLineItem {
    /// Value by batch least squares, in the item's unit.
    pub off_line: f64,
    /// Its standard error.
    pub off_line_std_error: f64,
    /// With the variable forgetting factor.
    pub variable: Settling,
    /// With a fixed forgetting factor: plain exponential forgetting.
    pub fixed: Settling,
}

/// How an estimate settled under one rule of forgetting.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Settling {
    /// From when on it stays within a tenth of the value off line \[s\]; `null` if it never does.
    pub convergence_time_s: Option<f64>,
    /// Mean in the steady state over the value off line, less 1 \[1\].
    pub steady_state_deviation: Option<f64>,
    /// Standard deviation in the steady state over the value off line \[1\].
    pub fluctuation: Option<f64>,
    /// Largest standard deviation by the covariance over that at the start, in
    /// a run with ten minutes of rest: above 1 the estimator has wound up \[1\].
    pub wind_up_at_rest: f64,
    /// Largest distance from the value off line in the first seconds after that
    /// rest, as a share of it \[1\].
    pub burst_after_rest: Option<f64>,
}

impl fmt::Display for Settling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.convergence_time_s {
            Some(time) => write!(f, "from {time:.2} s")?,
            None => write!(f, "never there")?,
        }
        let percent = |share: Option<f64>| 100.0 * share.unwrap_or(f64::NAN);
        write!(
            f,
            ", deviation {:+.2} %, fluctuation {:.2} %; uncertainty at rest up to {:.2e} of the first, then off by up to {:.1} %",
            percent(self.steady_state_deviation),
            percent(self.fluctuation),
            self.wind_up_at_rest,
            percent(self.burst_after_rest)
        )
    }
}

impl Item {
    /// A number that has to agree with the paper's within three standard
    /// errors or `tolerance` (in its unit), whichever is more.
    pub fn near(
        name: &str,
        unit: &'static str,
        paper: f64,
        here: Option<f64>,
        std_error: Option<f64>,
        tolerance: f64,
    ) -> Item {
        let bound = tolerance.max(3.0 * std_error.filter(|e| e.is_finite()).unwrap_or(0.0));
        Item {
            item: name.to_owned(),
            paper: Some(paper),
            here: here.filter(|value| value.is_finite()),
            std_error: std_error.filter(|value| value.is_finite()),
            unit,
            holds: here.is_some_and(|here| (here - paper).abs() <= bound),
            criterion: {
                let within = format!("within {} {unit}", short(tolerance));
                format!("{} or 3 standard errors", within.trim_end())
            },
            on_line: None,
        }
    }

    /// A statement of the paper: the number found has to lie in `range`.
    pub fn inside(
        name: &str,
        unit: &'static str,
        here: Option<f64>,
        std_error: Option<f64>,
        range: [f64; 2],
        statement: &str,
    ) -> Item {
        let bounds = match range {
            [low, high] if high == f64::INFINITY => format!("at least {}", short(low)),
            [low, high] if low == f64::NEG_INFINITY => format!("at most {}", short(high)),
            [low, high] => format!("between {} and {}", short(low), short(high)),
        };
        Item {
            item: name.to_owned(),
            paper: None,
            here: here.filter(|value| value.is_finite()),
            std_error: std_error.filter(|value| value.is_finite()),
            unit,
            holds: here.is_some_and(|here| (range[0]..=range[1]).contains(&here)),
            criterion: format!("{statement}: {bounds} {unit}")
                .trim_end()
                .to_owned(),
            on_line: None,
        }
    }

    /// A growth: it has to be above zero by three standard errors.
    pub fn grows(
        name: &str,
        unit: &'static str,
        here: Option<f64>,
        std_error: Option<f64>,
        statement: &str,
    ) -> Item {
        let certain = match (here, std_error) {
            (Some(here), Some(error)) => here > 3.0 * error,
            _ => false,
        };
        Item {
            holds: certain,
            criterion: format!("{statement}: above 0 by 3 standard errors"),
            ..Item::inside(name, unit, here, std_error, [0.0, f64::INFINITY], statement)
        }
    }
}

/// A number with few digits.
fn short(value: f64) -> String {
    let text = format!("{value:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A curve of a chart.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Curve {
    /// Its name.
    pub name: String,
    /// Ascending.
    pub x: Vec<f64>,
    /// As many.
    pub y: Vec<f64>,
    /// Drawn as separate dots rather than as a line.
    pub dots: bool,
}

impl Curve {
    /// A line.
    pub fn line(name: &str, points: impl IntoIterator<Item = (f64, f64)>) -> Curve {
        let (x, y) = points.into_iter().unzip();
        Curve {
            name: name.to_owned(),
            x,
            y,
            dots: false,
        }
    }

    /// Dots, put in order.
    pub fn dots(name: &str, points: impl IntoIterator<Item = (f64, f64)>) -> Curve {
        let mut points: Vec<(f64, f64)> = points.into_iter().collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Curve {
            dots: true,
            ..Curve::line(name, points)
        }
    }
}

/// A chart.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Chart {
    /// Headline.
    pub title: String,
    /// What is to the right, with its unit.
    pub x: String,
    /// What is upwards, with its unit.
    pub y: String,
    /// The curves.
    pub curves: Vec<Curve>,
}

/// A table or figure of the paper.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Section {
    /// Its name: `Fig. 6`.
    pub name: String,
    /// What it shows.
    pub title: String,
    /// What the paper says, and how it was done here.
    pub text: String,
    /// Charts.
    pub charts: Vec<Chart>,
    /// Numbers and statements.
    pub items: Vec<Item>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_item_holds_only_inside_its_bound() {
        let near = |here| Item::near("a", "Nm", 10.0, Some(here), Some(0.1), 0.5).holds;
        assert!(near(10.4) && !near(10.6) && !near(9.4) && !near(f64::NAN));
        assert!(Item::near("a", "Nm", 10.0, Some(12.0), Some(1.0), 0.5).holds);
        assert!(!Item::near("a", "Nm", 10.0, None, None, 0.5).holds);
        let grows = |here, error| Item::grows("a", "", Some(here), Some(error), "it grows").holds;
        assert!(grows(1.0, 0.3) && !grows(1.0, 0.4) && !grows(-1.0, 0.1));
        let text = Item::inside("a", "N", None, None, [0.0, f64::INFINITY], "so");
        assert!(!text.holds && text.criterion == "so: at least 0 N");
    }
}
