//! The page, as `viewer/` builds it: nothing else is served from files.

/// A file of the page by its path: its kind and its bytes.
pub(super) fn file(path: &str) -> Option<(&'static str, &'static [u8])> {
    match path {
        "/" => Some(("text/html; charset=utf-8", include_bytes!("../../viewer/dist/index.html"))),
        "/viewer.js" => {
            Some(("text/javascript; charset=utf-8", include_bytes!("../../viewer/dist/viewer.js")))
        }
        "/viewer.css" => Some(("text/css; charset=utf-8", include_bytes!("../../viewer/dist/viewer.css"))),
        "/favicon.svg" => Some(("image/svg+xml", include_bytes!("../../viewer/dist/favicon.svg"))),
        _ => None,
    }
}
