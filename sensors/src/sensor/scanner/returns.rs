//! Echoes of a pulse, and the returns that are reported.

use crate::ParameterError;

/// The largest number of returns of a firing.
pub const MAX_RETURNS: usize = 5;

/// The returns that are reported for each firing.
///
/// The hits of the rays of a [`Beam`](super::Beam), ordered by range, form one return as long as each is nearer to the
/// previous one than the scanner's [`pulse_m`](super::ScannerConfig::pulse_m). The range of a return is their mean,
/// weighted by power. If a firing has fewer returns than are reported, the remaining ranges are +∞.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Returns {
    /// The strongest return; the nearer one of two equally strong ones.
    #[default]
    Strongest,
    /// The nearest return.
    First,
    /// The farthest return.
    Last,
    /// Two returns: the last and the strongest. If these are the same, the second is the second strongest.
    Dual,
    /// The given number of returns, 1 to 5, ordered by range from the nearest. If there are more, the strongest are
    /// reported.
    Several(u8),
    /// The given number of returns, 1 to 5, ordered by power from the strongest.
    Ranked(u8),
    /// One return: the mean of everything that the beam hits, as measured by phase-based scanners. At edges it lies
    /// between the surfaces.
    Mean,
}

impl Returns {
    /// Returns the number of returns per firing.
    pub const fn count(self) -> usize {
        match self {
            Self::Strongest | Self::First | Self::Last | Self::Mean => 1,
            Self::Dual => 2,
            Self::Several(count) | Self::Ranked(count) => count as usize,
        }
    }

    pub(super) fn check(self) -> Result<(), ParameterError> {
        match self {
            Self::Several(count) | Self::Ranked(count) if !(1..=MAX_RETURNS).contains(&count.into()) => {
                Err(ParameterError::new("scanner", "number of returns", f64::from(count), "1 to 5"))
            }
            _ => Ok(()),
        }
    }
}

/// An echo: a surface or particle that sends part of a pulse back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Echo {
    /// The range in metres.
    pub(super) range: f64,
    /// The power that comes back.
    pub(super) weight: f64,
    /// The contribution to the intensity; see [`Intensity::signal`](super::Intensity::signal).
    pub(super) signal: f64,
}

impl Echo {
    const NONE: Self = Self { range: f64::INFINITY, weight: 0.0, signal: 0.0 };
}

/// The echoes of a pulse, ordered by range from the nearest.
pub(super) struct Echoing<const N: usize> {
    echoes: [Echo; N],
    count: usize,
}

impl<const N: usize> Echoing<N> {
    pub(super) const fn new() -> Self {
        Self { echoes: [Echo::NONE; N], count: 0 }
    }

    pub(super) fn clear(&mut self) {
        self.count = 0;
    }

    /// Adds an echo. Echoes for which there is no more room are dropped.
    #[inline(always)]
    pub(super) fn push(&mut self, echo: Echo) {
        if self.count == N {
            return;
        }
        let mut place = self.count;
        while place > 0 && self.echoes[place - 1].range > echo.range {
            self.echoes[place] = self.echoes[place - 1];
            place -= 1;
        }
        self.echoes[place] = echo;
        self.count += 1;
    }

    /// Returns the reported returns in the order of [`Returns`]. Those weaker than `least` are not detected.
    pub(super) fn returns(
        &mut self,
        which: Returns,
        pulse_m: f64,
        least: f64,
    ) -> [Option<Echo>; MAX_RETURNS] {
        let apart = if which == Returns::Mean { f64::INFINITY } else { pulse_m };
        self.merge(apart);
        self.leave(least);
        let found = &self.echoes[..self.count];
        let at = |index: Option<usize>| index.map(|index| found[index]);
        let mut returns = [None; MAX_RETURNS];
        match which {
            Returns::Strongest | Returns::Mean => returns[0] = at(strongest(found, None)),
            Returns::First => returns[0] = found.first().copied(),
            Returns::Last => returns[0] = found.last().copied(),
            Returns::Dual => {
                let last = found.len().checked_sub(1);
                returns[0] = at(last);
                let most = strongest(found, None);
                returns[1] = at(if most == last { strongest(found, last) } else { most });
            }
            Returns::Several(count) => {
                let count = usize::from(count).min(MAX_RETURNS);
                while self.count > count {
                    self.take_out_weakest();
                }
                for (place, echo) in returns.iter_mut().zip(&self.echoes[..self.count]) {
                    *place = Some(*echo);
                }
            }
            Returns::Ranked(count) => {
                for place in returns.iter_mut().take(count.into()) {
                    let Some(most) = strongest(&self.echoes[..self.count], None) else { break };
                    *place = Some(self.echoes[most]);
                    self.take_out(most);
                }
            }
        }
        returns
    }

    /// Merges echoes that are nearer to the previous one than `apart`.
    fn merge(&mut self, apart: f64) {
        let (mut merged, mut next) = (0, 0);
        while next < self.count {
            let (mut sum, mut farthest) =
                (Echo { range: 0.0, weight: 0.0, signal: 0.0 }, self.echoes[next].range);
            let first = next;
            while next < self.count && (next == first || self.echoes[next].range - farthest < apart) {
                let Echo { range, weight, signal } = self.echoes[next];
                // Ranges are added relative to the first, so that equal ranges stay exact.
                sum.range += (range - self.echoes[first].range) * weight;
                sum.weight += weight;
                sum.signal += signal;
                farthest = range;
                next += 1;
            }
            let beyond = if sum.weight > 0.0 { sum.range / sum.weight } else { 0.0 };
            self.echoes[merged] = Echo { range: self.echoes[first].range + beyond, ..sum };
            merged += 1;
        }
        self.count = merged;
    }

    /// Removes echoes weaker than `least`, and those without any power.
    fn leave(&mut self, least: f64) {
        let mut kept = 0;
        for index in 0..self.count {
            let echo = self.echoes[index];
            if echo.weight >= least && echo.weight > 0.0 {
                self.echoes[kept] = echo;
                kept += 1;
            }
        }
        self.count = kept;
    }

    fn take_out_weakest(&mut self) {
        let mut weakest = 0;
        for index in 1..self.count {
            if self.echoes[index].weight <= self.echoes[weakest].weight {
                weakest = index;
            }
        }
        self.take_out(weakest);
    }

    fn take_out(&mut self, index: usize) {
        self.echoes.copy_within(index + 1..self.count, index);
        self.count -= 1;
    }
}

/// Returns the index of the strongest echo other than `but`; the nearer one of two equally strong ones.
fn strongest(echoes: &[Echo], but: Option<usize>) -> Option<usize> {
    let mut most: Option<usize> = None;
    for (index, echo) in echoes.iter().enumerate() {
        if Some(index) != but && most.is_none_or(|most| echo.weight > echoes[most].weight) {
            most = Some(index);
        }
    }
    most
}
