//! The page is whole in itself, and holds what it was given.

use super::{
    thin::{MAX_POINTS, points},
    *,
};

fn data_of(page: &str) -> serde_json::Value {
    let (_, rest) = page
        .split_once("<script type=\"application/json\" id=\"data\">")
        .unwrap();
    let (data, _) = rest.split_once("</script>").unwrap();
    serde_json::from_str(data).unwrap()
}

#[test]
fn the_page_holds_the_data_and_asks_nothing_of_a_network() {
    let nasty = "</script><script>alert(1)</script><!-- @DATA@ @CHARTS@";
    let report = Report {
        title: nasty.to_owned(),
        notes: vec![nasty.to_owned()],
        traces: vec![Trace {
            title: "a".to_owned(),
            unit: "Nm".to_owned(),
            start: 5.0,
            period: 0.5,
            shades: Vec::new(),
            curves: vec![Curve {
                name: "measured".to_owned(),
                values: vec![1.0, f64::NAN, 1.234_567_89],
            }],
        }],
        ..Report::default()
    };
    let page = render(&report).unwrap();
    for address in [
        "http:", "https:", "src=", "href=", "@import", "url(", "fetch(", "import(",
    ] {
        assert!(!page.contains(address), "{address}");
    }
    assert!(!page.contains("<script>alert"));
    assert_eq!(page.matches("</script>").count(), 3);
    let data = data_of(&page);
    assert_eq!(data["notes"][0], nasty);
    let curve = &data["plots"][0]["curves"][0];
    assert_eq!(curve["x"], serde_json::json!([5.0, 5.5, 6.0]));
    assert_eq!(curve["y"], serde_json::json!([1.0, null, 1.23457]));
    // What was put in must not be searched for marks, and no mark may stay.
    let without = page
        .replace(&nasty.replace('<', "\\u003c"), "")
        .replace(&nasty.replace('<', "&lt;"), "");
    assert!(
        [
            "@TITLE@",
            "@STYLE@",
            "@CHARTS@",
            "@KIT@",
            "@SECTIONS@",
            "@DATA@"
        ]
        .iter()
        .all(|mark| !without.contains(mark))
    );
}

#[test]
fn a_long_curve_is_thinned_out_and_keeps_its_peaks() {
    let mut values: Vec<f64> = (0..600_000).map(|n| (f64::from(n) * 1e-3).sin()).collect();
    values[123_457] = 9.0;
    values[400_001] = -9.0;
    let points = points("measured", 0.0, 0.001, &values);
    assert!(
        points.x.len() <= MAX_POINTS && points.x.len() > MAX_POINTS / 2,
        "{}",
        points.x.len()
    );
    assert!(points.x.windows(2).all(|pair| pair[0] < pair[1]));
    for (time, value) in [(123.457, 9.0), (400.001, -9.0)] {
        let place = points.y.iter().position(|&y| y == value).unwrap();
        assert_eq!(points.x[place], time);
    }
}
