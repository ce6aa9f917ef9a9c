//! The page's files, inside the program.

use std::sync::LazyLock;

use axum::{
    Router,
    http::header,
    response::{IntoResponse, Response},
    routing::get,
};

/// A file of the page.
struct Asset {
    path: &'static str,
    kind: &'static str,
    text: &'static str,
}

macro_rules! assets {
    ($($path:literal $kind:ident $file:literal,)*) => {
        &[$(Asset { path: $path, kind: $kind, text: include_str!(concat!("../page/", $file)) },)*]
    };
}

const HTML: &str = "text/html; charset=utf-8";
const CSS: &str = "text/css; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";
const SVG: &str = "image/svg+xml";

const ASSETS: &[Asset] = assets![
    "/" HTML "index.html",
    "/icon.svg" SVG "icon.svg",
    "/style/base.css" CSS "style/base.css",
    "/style/console.css" CSS "style/console.css",
    "/style/lab.css" CSS "style/lab.css",
    "/main.js" SCRIPT "main.js",
    "/common/dom.js" SCRIPT "common/dom.js",
    "/common/mapping.js" SCRIPT "common/mapping.js",
    "/common/names.js" SCRIPT "common/names.js",
    "/common/numbers.js" SCRIPT "common/numbers.js",
    "/common/server.js" SCRIPT "common/server.js",
    "/common/strokes.js" SCRIPT "common/strokes.js",
    "/common/theme.js" SCRIPT "common/theme.js",
    "/console/console.js" SCRIPT "console/console.js",
    "/console/banner.js" SCRIPT "console/banner.js",
    "/console/channel.js" SCRIPT "console/channel.js",
    "/console/chart.js" SCRIPT "console/chart.js",
    "/console/connection.js" SCRIPT "console/connection.js",
    "/console/feel.js" SCRIPT "console/feel.js",
    "/console/gamepad.js" SCRIPT "console/gamepad.js",
    "/console/hand.js" SCRIPT "console/hand.js",
    "/console/log.js" SCRIPT "console/log.js",
    "/console/panel.js" SCRIPT "console/panel.js",
    "/console/picture.js" SCRIPT "console/picture.js",
    "/console/scene.js" SCRIPT "console/scene.js",
    "/console/strips.js" SCRIPT "console/strips.js",
    "/space/arm.js" SCRIPT "space/arm.js",
    "/space/bodies.js" SCRIPT "space/bodies.js",
    "/space/camera.js" SCRIPT "space/camera.js",
    "/space/ground.js" SCRIPT "space/ground.js",
    "/space/painter.js" SCRIPT "space/painter.js",
    "/space/picture.js" SCRIPT "space/picture.js",
    "/space/solids.js" SCRIPT "space/solids.js",
    "/space/turning.js" SCRIPT "space/turning.js",
    "/space/vectors.js" SCRIPT "space/vectors.js",
    "/space/views.js" SCRIPT "space/views.js",
    "/lab/lab.js" SCRIPT "lab/lab.js",
    "/lab/arm.js" SCRIPT "lab/arm.js",
    "/lab/charts.js" SCRIPT "lab/charts.js",
    "/lab/files.js" SCRIPT "lab/files.js",
    "/lab/findings.js" SCRIPT "lab/findings.js",
    "/lab/formulas.js" SCRIPT "lab/formulas.js",
    "/lab/mapping.js" SCRIPT "lab/mapping.js",
    "/lab/model.js" SCRIPT "lab/model.js",
    "/lab/reading.js" SCRIPT "lab/reading.js",
    "/lab/recordings.js" SCRIPT "lab/recordings.js",
    "/lab/signals.js" SCRIPT "lab/signals.js",
    "/lab/subject.js" SCRIPT "lab/subject.js",
];

/// plotly.js as the crate `plotly` carries it: the first of its script elements.
static PLOTLY: LazyLock<String> = LazyLock::new(|| {
    let sources = plotly::Plot::offline_js_sources();
    let begin = sources
        .find("<script")
        .and_then(|at| Some(at + sources.get(at..)?.find('>')? + 1));
    // The library mentions the end of a script element in strings of its own,
    // never at the begin of a line of the crate's template.
    let end = sources.find("</script>\n");
    match (begin, end) {
        (Some(begin), Some(end)) => sources.get(begin..end).unwrap_or_default().to_owned(),
        _ => String::new(),
    }
});

/// The files' addresses.
pub fn routes<S: Clone + Send + Sync + 'static>() -> Router<S> {
    let mut router = Router::new();
    for asset in ASSETS {
        let (kind, text) = (asset.kind, asset.text);
        router = router.route(
            asset.path,
            get(move || async move { file(kind, text, "no-cache") }),
        );
    }
    // It is named after its version, so that browsers may keep it.
    router.route(
        "/plotly.js",
        get(|| async { file(SCRIPT, PLOTLY.as_str(), "max-age=86400") }),
    )
}

fn file(kind: &'static str, text: &'static str, keep: &'static str) -> Response {
    (
        [(header::CONTENT_TYPE, kind), (header::CACHE_CONTROL, keep)],
        text,
    )
        .into_response()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plotly_is_whole_and_nothing_else() {
        assert!(PLOTLY.len() > 4_000_000, "{} bytes", PLOTLY.len());
        assert!(PLOTLY.contains("scattergl"));
        assert!(
            !PLOTLY.contains("MathJax.loader"),
            "a second script is in it"
        );
        assert!(!PLOTLY.trim_start().starts_with('<'));
    }

    #[test]
    fn the_page_asks_nothing_of_a_network() {
        for asset in ASSETS {
            for (number, line) in asset.text.lines().enumerate() {
                let foreign = line.replace("http://www.w3.org/", "");
                assert!(
                    !foreign.contains("http://") && !foreign.contains("https://"),
                    "{}:{}: {line}",
                    asset.path,
                    number + 1
                );
            }
        }
    }

    #[test]
    fn every_module_that_is_imported_is_served() {
        for asset in ASSETS.iter().filter(|asset| asset.kind == SCRIPT) {
            let folder = asset.path.rsplit_once('/').map_or("", |(folder, _)| folder);
            for line in asset
                .text
                .lines()
                .filter(|line| line.starts_with("import "))
            {
                let name = line.split('"').nth(1).unwrap_or_default();
                let path = match name.strip_prefix("../") {
                    Some(rest) => format!("/{rest}"),
                    None => format!("{folder}/{}", name.trim_start_matches("./")),
                };
                assert!(
                    ASSETS.iter().any(|other| other.path == path),
                    "{}: {name}",
                    asset.path
                );
            }
        }
    }
}
