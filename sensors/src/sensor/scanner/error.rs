//! Why a scanner cannot be made.

/// A parameter is out of its range.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ScannerError {
    /// The parameter, as its field is called.
    pub parameter: &'static str,
    /// Which of several it is of, from 0.
    pub index: Option<usize>,
    /// What it was.
    pub value: f64,
    /// What it must be.
    pub rule: &'static str,
}

impl core::fmt::Display for ScannerError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self { parameter, index, value, rule } = self;
        write!(f, "a scanner's {parameter}")?;
        if let Some(index) = index {
            write!(f, " {index}")?;
        }
        write!(f, " is {value}; it must be {rule}")
    }
}

impl core::error::Error for ScannerError {}
