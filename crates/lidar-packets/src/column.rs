//! What a lidar measures at a time.

/// What all lasers of a head measure in one go, in the order of the lasers: from the first to fire for a Velodyne, from
/// the highest down for an Ouster.
#[derive(Debug, Clone, Copy)]
pub struct Column<'a> {
    /// The number of the frame, which is a turn of the head. An Ouster's packets have its lowest 16 bits.
    pub frame: u64,
    /// The number of the column in its frame, from 0. An Ouster's packets have it; a Velodyne's do not.
    pub number: usize,
    /// The time of its first firing in nanoseconds: for a Velodyne since a full hour, for an Ouster as its clock has it.
    pub time_ns: u64,
    /// How far the head has turned at that time, clockwise seen from above, as a share of a turn from 0 on. Whole turns
    /// are left out. A Velodyne's packets have it; an Ouster's have the number of the column instead.
    pub turned: f64,
    /// Distances in metres from where the beam begins; the returns of a laser are next to each other. A value that is not
    /// finite is no return, and neither is one that rounds to 0 or is farther than the layout can say.
    pub ranges_m: &'a [f32],
    /// As many intensities: for a Velodyne the calibrated reflectivity from 0 to 255, for an Ouster the signal in photons.
    /// Values are rounded and limited to what the layout can say.
    pub intensities: &'a [f32],
}

/// A column does not fit its lidar.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ColumnError {
    /// There are not as many ranges as lasers, or as lasers and returns.
    #[error("a column has {found} ranges; {lasers} lasers with {returns} returns each have {}", lasers * returns)]
    Ranges {
        /// How many ranges there are.
        found: usize,
        /// How many lasers the lidar has.
        lasers: usize,
        /// How many returns of each laser are expected.
        returns: usize,
    },
    /// There are not as many intensities as ranges.
    #[error("a column has {found} intensities for {ranges} ranges")]
    Intensities {
        /// How many intensities there are.
        found: usize,
        /// How many ranges there are.
        ranges: usize,
    },
    /// The number of the column is not one of its frame.
    #[error("a column has the number {number}, and a frame only {columns} columns")]
    Number {
        /// The number of the column.
        number: usize,
        /// How many columns a frame has.
        columns: u32,
    },
}

impl Column<'_> {
    /// Checks that it has so many returns of each laser.
    pub(crate) fn check(&self, lasers: usize, returns: usize) -> Result<(), ColumnError> {
        let (ranges, intensities) = (self.ranges_m.len(), self.intensities.len());
        if ranges != lasers * returns {
            return Err(ColumnError::Ranges { found: ranges, lasers, returns });
        }
        if intensities != ranges {
            return Err(ColumnError::Intensities { found: intensities, ranges });
        }
        Ok(())
    }
}
