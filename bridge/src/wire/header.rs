//! [`FrameHeader`]: the 384 bytes before every payload.

use bytemuck::Zeroable as _;
#[cfg(feature = "shared-memory")]
use iceoryx2::prelude::ZeroCopySend;

use super::{DistortionModel, Encoding, FrameError, Kind, MAX_DISTORTION, Text, layout::wire_structs};

wire_structs! {
    /// The header of a frame: its content, the time and pose of its capture, and its layout in memory.
    ///
    /// It is aligned to 64 bytes, so that the payload behind it starts on a cache line and a SIMD register boundary.
    with #[cfg_attr(feature = "shared-memory", derive(ZeroCopySend))]
    with #[repr(align(64))]
    with #[cfg_attr(feature = "shared-memory", type_name("belvedere.FrameHeader.v2"))]
    pub struct FrameHeader, 384 bytes {
        /// [`FrameHeader::MAGIC`].
        pub magic: u32 = 0,
        /// Size of the header: 384.
        pub header_len: u16 = 4,
        /// [`FrameHeader::SCHEMA`].
        pub schema: u16 = 6,
        /// A [`Kind`] by its number.
        pub kind: u16 = 8,
        /// An [`Encoding`] by its number.
        pub encoding: u16 = 10,
        /// [`FrameHeader::HAS_INTENSITIES`], [`FrameHeader::REPLAYED`]; other bits are 0.
        pub flags: u32 = 12,
        /// Sequence number of the frame within one life of its publisher, from 0. Set by `send`.
        pub seq: u64 = 16,
        /// Random number of the publisher's life: a new value means that `seq` restarted. Set by `loan`.
        pub session: u64 = 24,
        /// Time of capture in simulated time, nanoseconds since the simulation started.
        pub stamp_ns: u64 = 32,
        /// Time of sending by `CLOCK_MONOTONIC`, nanoseconds. Set by `send`.
        pub publish_mono_ns: u64 = 40,
        /// Elements per row: pixels, rays, points; 1 for structs.
        pub width: u32 = 48,
        /// Rows: image rows, lidar layers; the number of structs.
        pub height: u32 = 52,
        /// Bytes from one row to the next.
        pub row_stride: u32 = 56,
        /// Bytes from one element to the next.
        pub elem_stride: u32 = 60,
        /// Valid bytes of the payload. Set by `loan`.
        pub payload_len: u64 = 64,
        /// The coordinate frame of the data.
        pub frame_id: Text<64> = 72,
        /// `world_from_sensor`: the sensor's origin in the world at `stamp_ns`, metres.
        pub position: [f64; 3] = 136,
        /// `world_from_sensor`: its orientation, x y z w.
        pub orientation: [f32; 4] = 160,
        /// The block that is specific to the kind: [`Intrinsics`] or [`ScanGeometry`].
        pub block: [u64; 26] = 176,
    }

    /// The mapping from pixels to directions; the block of images, depth images and organised clouds.
    with #[derive(Default, PartialEq)]
    pub struct Intrinsics, 208 bytes {
        /// Horizontal focal length, pixels.
        pub fx: f64 = 0,
        /// Vertical focal length, pixels.
        pub fy: f64 = 8,
        /// Column of the principal point. Pixel centres are integers, so that of a centred image is (width − 1) / 2.
        pub cx: f64 = 16,
        /// Row of the principal point.
        pub cy: f64 = 24,
        /// Skew, K\[1\]: pixels along a row per unit of y.
        pub skew: f64 = 32,
        /// Parameters of the model, in the order of [`DistortionModel`]; the first `distortion_len` are valid.
        pub distortion: [f64; MAX_DISTORTION] = 40,
        /// Smallest measured depth, metres.
        pub near: f32 = 152,
        /// Largest measured depth, metres.
        pub far: f32 = 156,
        /// P\[3\] = −fx · baseline of a stereo partner, else 0.
        pub tx: f32 = 160,
        /// A [`DistortionModel`] by its number; 0 for none.
        pub distortion_model: u16 = 164,
        /// Number of valid values in `distortion`.
        pub distortion_len: u16 = 166,
        /// Reserved; 0.
        pub reserved: [u64; 5] = 168,
    }

    /// Angles and limits of a lidar; the block of scans. Angles are in radians: horizontal ones counter-clockwise about
    /// +z from +x, vertical ones up.
    with #[derive(Default, PartialEq)]
    pub struct ScanGeometry, 208 bytes {
        /// Angle of the first ray of a layer.
        pub angle_min: f64 = 0,
        /// Angle from one ray to the next.
        pub angle_increment: f64 = 8,
        /// Seconds from one ray to the next.
        pub time_increment: f64 = 16,
        /// Seconds from one scan to the next.
        pub scan_time: f64 = 24,
        /// Smallest measured range, metres.
        pub range_min: f32 = 32,
        /// Largest measured range, metres.
        pub range_max: f32 = 36,
        /// Elevation of the first layer.
        pub vertical_angle_min: f64 = 40,
        /// Elevation from one layer to the next.
        pub vertical_angle_increment: f64 = 48,
        /// Reserved; 0.
        pub reserved: [u64; 19] = 56,
    }
}

const _: () = {
    assert!(cfg!(target_endian = "little"), "the wire format is little-endian");
    assert!(align_of::<FrameHeader>() == 64);
};

impl Intrinsics {
    /// Sets the distortion model and its parameters; ignores those beyond [`MAX_DISTORTION`].
    pub fn set_distortion(&mut self, model: DistortionModel, parameters: &[f64]) {
        let len = parameters.len().min(MAX_DISTORTION);
        self.distortion = [0.0; MAX_DISTORTION];
        self.distortion[..len].copy_from_slice(&parameters[..len]);
        self.distortion_model = model.to_wire();
        self.distortion_len = len as u16;
    }

    /// Returns the parameters of the distortion model.
    #[must_use]
    pub fn parameters(&self) -> &[f64] {
        &self.distortion[..usize::from(self.distortion_len).min(MAX_DISTORTION)]
    }

    /// Returns the distortion model; `None` if there is none, or if this version does not know it.
    #[must_use]
    pub fn model(&self) -> Option<DistortionModel> {
        DistortionModel::from_wire(self.distortion_model)
    }
}

impl ScanGeometry {
    /// Returns the angle of the last of `width` rays.
    #[must_use]
    pub fn angle_max(&self, width: u32) -> f64 {
        self.angle_min + f64::from(width.saturating_sub(1)) * self.angle_increment
    }
}

impl Default for FrameHeader {
    fn default() -> Self {
        Self {
            magic: Self::MAGIC,
            header_len: size_of::<Self>() as u16,
            schema: Self::SCHEMA,
            orientation: [0.0, 0.0, 0.0, 1.0],
            ..Self::zeroed()
        }
    }
}

impl FrameHeader {
    /// "BLVD" in memory order.
    pub const MAGIC: u32 = u32::from_le_bytes(*b"BLVD");
    /// The version of this layout and of the payloads.
    pub const SCHEMA: u16 = super::SCHEMA;
    /// Flag: a plane of intensities follows the ranges.
    pub const HAS_INTENSITIES: u32 = 1;
    /// Flag: the frame comes from a recording.
    pub const REPLAYED: u32 = 2;

    /// Creates an empty header of this kind and encoding.
    #[must_use]
    pub fn new(kind: Kind, encoding: Encoding) -> Self {
        Self { kind: kind.to_wire(), encoding: encoding.to_wire(), ..Self::default() }
    }

    /// Returns the kind of the payload; `None` if this version does not know it.
    #[must_use]
    pub fn kind(&self) -> Option<Kind> {
        Kind::from_wire(self.kind)
    }

    /// Returns the encoding of an element; `None` if this version does not know it.
    #[must_use]
    pub fn encoding(&self) -> Option<Encoding> {
        Encoding::from_wire(self.encoding)
    }

    /// Sets the size and strides for `height` packed rows of `width` elements. Returns the bytes of one plane of them.
    pub fn set_packed(&mut self, width: u32, height: u32) -> usize {
        let elem_size = self
            .encoding()
            .and_then(Encoding::elem_size)
            .or_else(|| self.kind().and_then(Kind::struct_size))
            .unwrap_or(1) as u32;
        self.width = width;
        self.height = height;
        self.elem_stride = elem_size;
        self.row_stride = width * elem_size;
        self.row_stride as usize * height as usize
    }

    /// Returns the intrinsics of an image, depth image or cloud; `None` for another kind.
    #[must_use]
    pub fn intrinsics(&self) -> Option<&Intrinsics> {
        matches!(self.kind(), Some(Kind::Image | Kind::DepthImage | Kind::PointCloud))
            .then(|| bytemuck::cast_ref(&self.block))
    }

    /// Sets the intrinsics of an image, depth image or cloud.
    pub fn set_intrinsics(&mut self, intrinsics: &Intrinsics) {
        self.block = bytemuck::cast(*intrinsics);
    }

    /// Returns the geometry of a scan; `None` for another kind.
    #[must_use]
    pub fn scan_geometry(&self) -> Option<&ScanGeometry> {
        (self.kind() == Some(Kind::LaserScan)).then(|| bytemuck::cast_ref(&self.block))
    }

    /// Sets the geometry of a scan.
    pub fn set_scan_geometry(&mut self, geometry: &ScanGeometry) {
        self.block = bytemuck::cast(*geometry);
    }

    /// Returns true if a plane of intensities follows the ranges.
    #[must_use]
    pub fn has_intensities(&self) -> bool {
        self.flags & Self::HAS_INTENSITIES != 0
    }

    /// Checks everything that a reader of `available` payload bytes relies on: no header that passes leads outside the
    /// payload.
    ///
    /// # Errors
    /// The first fault found.
    pub fn check(&self, available: usize) -> Result<(), FrameError> {
        if self.magic != Self::MAGIC {
            return Err(FrameError::Magic(self.magic));
        }
        if self.schema != Self::SCHEMA {
            return Err(FrameError::Schema(self.schema));
        }
        if usize::from(self.header_len) != size_of::<Self>() {
            return Err(FrameError::HeaderLen(self.header_len));
        }
        if self.payload_len > available as u64 {
            return Err(FrameError::PayloadLen { claimed: self.payload_len, available: available as u64 });
        }
        let elem_size = match self.encoding() {
            Some(Encoding::Struct) => self.kind().and_then(Kind::struct_size).unwrap_or(1),
            Some(encoding) => encoding.elem_size().unwrap_or(1),
            // An encoding of a later version: its element size is unknown, but its extent is checked.
            None => 1,
        } as u64;
        if self.width == 0 || self.height == 0 {
            return Ok(());
        }
        let (width, height) = (u64::from(self.width), u64::from(self.height));
        let (elem_stride, row_stride) = (u64::from(self.elem_stride), u64::from(self.row_stride));
        // The factors are u32, so no product or sum below overflows 64 bits, except the last, which is at most 2⁶⁵.
        let row_end = (width - 1) * elem_stride + elem_size;
        if elem_stride < elem_size || (height > 1 && row_stride < row_end) {
            return Err(FrameError::Stride {
                width: self.width,
                elem_stride: self.elem_stride,
                row_stride: self.row_stride,
            });
        }
        let planes_before = if self.has_intensities() { height * row_stride } else { 0 };
        let end = u128::from(planes_before) + u128::from((height - 1) * row_stride) + u128::from(row_end);
        if end > u128::from(self.payload_len) {
            return Err(FrameError::Extent { needed: end, payload_len: self.payload_len });
        }
        Ok(())
    }
}
