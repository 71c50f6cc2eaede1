//! The files of the page, as built in `viewer/` and included in the program.

/// Returns the media type and the bytes of a file of the page.
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
