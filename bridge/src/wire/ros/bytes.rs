//! [`RosBytes`]: the bytes of a message, field after field.

use super::{FrameHeader, Ros};

/// Appends the fields of a message to a buffer, in the encoding of ROS 1 or ROS 2. Both are little-endian.
///
/// A message of ROS 2 is CDR: it begins with four bytes that name the encoding, and after these each number is aligned
/// to its size. Texts have a 0 at their end, which their length counts.
#[derive(Debug)]
pub struct RosBytes<'a> {
    ros: Ros,
    out: &'a mut Vec<u8>,
    /// The length of `out` from which alignment counts.
    start: usize,
    /// False if a value is out of the range of its type.
    is_complete: bool,
}

macro_rules! numbers {
    ($($type:ident),+) => {
        $(
            #[doc = concat!("Appends a number of the type `", stringify!($type), "`.")]
            pub fn $type(&mut self, value: $type) {
                self.number(value.to_le_bytes());
            }
        )+
    };
}

impl<'a> RosBytes<'a> {
    /// CDR, little-endian, and two bytes without a meaning.
    const CDR: [u8; 4] = [0, 1, 0, 0];

    /// Begins a message at the end of `out`.
    pub fn begin(ros: Ros, out: &'a mut Vec<u8>) -> Self {
        if ros == Ros::Two {
            out.extend_from_slice(&Self::CDR);
        }
        Self { ros, start: out.len(), out, is_complete: true }
    }

    /// Ends the message. Returns `None` if a value was out of the range of its type.
    #[must_use]
    pub fn end(self) -> Option<()> {
        // A struct of CDR is never empty, so ROS 2 gives an empty message one byte.
        if self.ros == Ros::Two && self.out.len() == self.start {
            self.out.push(0);
        }
        self.is_complete.then_some(())
    }

    /// Returns the length of the buffer: the place at which [`raw`](Self::raw) appends.
    #[must_use]
    pub fn place(&self) -> usize {
        self.out.len()
    }

    numbers! { u8, i8, u16, u32, u64, i64, f32, f64 }

    /// Appends the number of elements of an array, which follow.
    pub fn count(&mut self, count: usize) {
        self.is_complete &= u32::try_from(count).is_ok();
        self.u32(count as u32);
    }

    /// Appends a text.
    pub fn text(&mut self, text: &str) {
        self.count(text.len() + usize::from(self.ros == Ros::Two));
        self.raw(text.as_bytes());
        if self.ros == Ros::Two {
            self.raw(&[0]);
        }
    }

    /// Appends the name of a coordinate frame, without the leading slash that tf2 refuses.
    pub fn frame_id(&mut self, name: &str) {
        self.text(name.strip_prefix('/').unwrap_or(name));
    }

    /// Appends an array of bytes.
    pub fn bytes(&mut self, bytes: &[u8]) {
        self.count(bytes.len());
        self.raw(bytes);
    }

    /// Appends bytes as they are, such as elements of an array of bytes.
    pub fn raw(&mut self, bytes: &[u8]) {
        self.out.extend_from_slice(bytes);
    }

    /// Appends a time as seconds and nanoseconds, of 32 bits each. The seconds of ROS 2 have a sign.
    pub fn time(&mut self, time_ns: u64) {
        let last = match self.ros {
            Ros::One => u32::MAX,
            Ros::Two => i32::MAX as u32,
        };
        let seconds = time_ns / 1_000_000_000;
        self.is_complete &= seconds <= u64::from(last);
        self.u32(seconds.min(last.into()) as u32);
        self.u32((time_ns % 1_000_000_000) as u32);
    }

    /// Appends a `std_msgs/Header`: that of the frame, or one with another frame id.
    pub fn header(&mut self, header: &FrameHeader, frame_id: Option<&str>) {
        if self.ros == Ros::One {
            self.u32(header.seq as u32);
        }
        self.time(header.stamp_ns);
        self.frame_id(frame_id.unwrap_or(header.frame_id.as_str()));
    }

    fn number<const N: usize>(&mut self, bytes: [u8; N]) {
        if self.ros == Ros::Two {
            let aligned = (self.out.len() - self.start).next_multiple_of(N);
            self.out.resize(self.start + aligned, 0);
        }
        self.raw(&bytes);
    }
}
