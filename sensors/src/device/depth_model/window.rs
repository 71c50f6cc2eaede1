//! The part of the image from which a pixel's depth is taken.

use super::dots::{DotWindow, Dots};
use super::lateral::{LateralNoise, Shift};
use super::time_of_flight::{ModulatedLight, TimeOfFlight};
use crate::ParameterError;

/// The part of the image from which a pixel's depth is taken.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Window {
    /// The pixel's own ray.
    Own,
    /// A ray beside the pixel's own.
    Lateral(LateralNoise),
    /// The dots of a projected pattern around the pixel.
    Dots(DotWindow),
    /// All modulated light that reaches the pixel.
    TimeOfFlight(TimeOfFlight),
}

impl From<LateralNoise> for Window {
    fn from(noise: LateralNoise) -> Self {
        Self::Lateral(noise)
    }
}

impl From<DotWindow> for Window {
    fn from(dots: DotWindow) -> Self {
        Self::Dots(dots)
    }
}

impl From<TimeOfFlight> for Window {
    fn from(time_of_flight: TimeOfFlight) -> Self {
        Self::TimeOfFlight(time_of_flight)
    }
}

impl Window {
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        match self {
            Self::Own => Ok(()),
            Self::Lateral(noise) => noise.check(),
            Self::Dots(dots) => dots.check(),
            Self::TimeOfFlight(time_of_flight) => time_of_flight.check(),
        }
    }
}

/// The window of a checked device.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Look {
    Own,
    Beside(Shift),
    Dots(Dots),
    Light(ModulatedLight),
}

impl Look {
    pub(super) fn new(window: &Window) -> Self {
        match window {
            Window::Own => Self::Own,
            Window::Lateral(noise) => Shift::new(noise).map_or(Self::Own, Self::Beside),
            Window::Dots(dots) => Self::Dots(Dots::new(dots)),
            Window::TimeOfFlight(time_of_flight) => Self::Light(ModulatedLight::new(time_of_flight)),
        }
    }

    /// The lateral noise with which pixels look beside their own ray, if any.
    pub(crate) fn shift(&self) -> Option<Shift> {
        match self {
            Self::Beside(shift) => Some(*shift),
            Self::Dots(dots) => dots.shift,
            Self::Own | Self::Light(_) => None,
        }
    }

    pub(super) fn wants_incidence(&self) -> bool {
        matches!(self, Self::Light(_)) || self.shift().is_some_and(Shift::wants_incidence)
    }
}
