//! The name of the processor.

/// Returns maker, family and model as Linux reports them; empty if it does not.
pub fn processor() -> String {
    describe(&std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default())
}

fn describe(cpuinfo: &str) -> String {
    let value = |wanted: &str| {
        cpuinfo.lines().find_map(|line| {
            let (key, value) = line.split_once(':')?;
            (key.trim() == wanted).then(|| value.trim())
        })
    };
    let parts = [
        ("", "vendor_id"),
        ("family ", "cpu family"),
        ("model ", "model"),
        ("implementer ", "CPU implementer"),
        ("part ", "CPU part"),
    ];
    let parts = parts.into_iter().filter_map(|(name, key)| Some(format!("{name}{}", value(key)?)));
    parts.collect::<Vec<_>>().join(" ")
}
