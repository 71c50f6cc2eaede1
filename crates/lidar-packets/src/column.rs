//! [`Column`]: the measurements of all lasers at one time.

/// The measurements of all lasers of a head in one firing sequence. A Velodyne's lasers are in the order in which they
/// fire, an Ouster's from the highest down.
#[derive(Debug, Clone, Copy)]
pub struct Column<'a> {
    /// The number of the frame, which is a turn of the head. An Ouster's packets have its lowest 16 bits.
    pub frame: u64,
    /// The number of the column in its frame, from 0. An Ouster's packets have it; a Velodyne's do not.
    pub number: usize,
    /// The time of its first firing in nanoseconds: for a Velodyne since the last full hour, for an Ouster on the clock of
    /// the device.
    pub time_ns: u64,
    /// The angle of the head at that time, clockwise seen from above, as a fraction of a turn. Whole turns are ignored.
    /// A Velodyne's packets contain it; an Ouster's contain the number of the column instead.
    pub turned: f64,
    /// Distances in metres from the origin of the beam; the returns of a laser are next to each other. A value means "no
    /// return" if it is not finite, if it rounds to 0, or if it is too large for the layout.
    pub ranges_m: &'a [f32],
    /// An intensity for each range: for a Velodyne the calibrated reflectivity from 0 to 255, for an Ouster the signal in
    /// photons. Values are rounded, and limited to the largest that the layout can hold.
    pub intensities: &'a [f32],
}

/// The reason why a column does not fit its lidar.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ColumnError {
    /// The number of ranges is not the number of lasers times the number of returns.
    #[error("a column has {found} ranges; {lasers} lasers with {returns} returns each have {}", lasers * returns)]
    Ranges {
        /// The number of ranges.
        found: usize,
        /// The number of lasers of the lidar.
        lasers: usize,
        /// The expected number of returns of each laser.
        returns: usize,
    },
    /// The number of intensities differs from the number of ranges.
    #[error("a column has {found} intensities for {ranges} ranges")]
    Intensities {
        /// The number of intensities.
        found: usize,
        /// The number of ranges.
        ranges: usize,
    },
    /// The frame has no column with this number.
    #[error("a column has the number {number}, and a frame only {columns} columns")]
    Number {
        /// The number of the column.
        number: usize,
        /// The number of columns of a frame.
        columns: u32,
    },
}

impl Column<'_> {
    /// Checks that it has this number of returns of each laser.
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
