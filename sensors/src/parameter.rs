//! Why a configuration is refused.

/// A parameter of a configuration is out of its range. It is the error of all sensors, lenses, devices and noise
/// models.
///
/// ```
/// use belvedere_sensors::{camera::*, optics::PinholeGrid, Rule};
/// let lens = PinholeGrid::from_fov(64, 48, 1.0)?;
/// let error = Camera::new(CameraConfig::new(lens).near_m(2.0).far_m(1.0)).unwrap_err();
/// assert_eq!((error.of, error.parameter, error.value), ("camera", "near_m", 2.0));
/// assert_eq!(error.rule, Rule::Text("more than 0 and less than far_m"));
/// assert_eq!(error.to_string(), "near_m of the camera is 2; it must be more than 0 and less than far_m");
/// # Ok::<(), belvedere_sensors::ParameterError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ParameterError {
    /// The object that the parameter belongs to, such as "camera".
    pub of: &'static str,
    /// The name of the parameter, the same as that of its field or argument.
    pub parameter: &'static str,
    /// The index of the list element that is wrong, counted from 0.
    pub index: Option<usize>,
    /// The value that was given.
    pub value: f64,
    /// The rule that the value must follow.
    pub rule: Rule,
    /// True if the parameter is an `f32`, whose value is displayed with as few digits as an `f32` needs.
    is_f32: bool,
}

/// The rule that the value of a parameter must follow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rule {
    /// Words that complete "it must be".
    Text(&'static str),
    /// A range from the first to the second number, both included.
    Range([f64; 2]),
}

impl ParameterError {
    pub(crate) const fn new(
        of: &'static str,
        parameter: &'static str,
        value: f64,
        rule: &'static str,
    ) -> Self {
        Self { of, parameter, index: None, value, rule: Rule::Text(rule), is_f32: false }
    }

    /// The same error for an element of a list.
    pub(crate) const fn at(mut self, index: usize) -> Self {
        self.index = Some(index);
        self
    }

    /// Refuses a value for which `holds` is not true; comparisons with NaN never are.
    pub(crate) fn require(
        of: &'static str,
        parameter: &'static str,
        value: f64,
        holds: bool,
        rule: &'static str,
    ) -> Result<(), Self> {
        if holds { Ok(()) } else { Err(Self::new(of, parameter, value, rule)) }
    }

    /// Refuses a single-precision value for which `holds` is not true.
    pub(crate) fn require_f32(
        of: &'static str,
        parameter: &'static str,
        value: f32,
        holds: bool,
        rule: &'static str,
    ) -> Result<(), Self> {
        let error = Self { is_f32: true, ..Self::new(of, parameter, value.into(), rule) };
        if holds { Ok(()) } else { Err(error) }
    }

    /// Refuses a value outside a range, of which both ends are allowed.
    pub(crate) fn require_in(
        of: &'static str,
        parameter: &'static str,
        value: f64,
        range: [f64; 2],
    ) -> Result<(), Self> {
        if value >= range[0] && value <= range[1] {
            Ok(())
        } else {
            Err(Self { of, parameter, index: None, value, rule: Rule::Range(range), is_f32: false })
        }
    }
}

impl core::fmt::Display for ParameterError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self { of, parameter, index, value, rule, is_f32 } = self;
        f.write_str(parameter)?;
        if let Some(index) = index {
            write!(f, " {index}")?;
        }
        write!(f, " of the {of} is ")?;
        if *is_f32 {
            write!(f, "{}", *value as f32)?;
        } else {
            write!(f, "{value}")?;
        }
        f.write_str("; it must be ")?;
        match rule {
            Rule::Text(text) => f.write_str(text),
            Rule::Range([least, most]) => write!(f, "from {least} to {most}"),
        }
    }
}

impl core::error::Error for ParameterError {}
