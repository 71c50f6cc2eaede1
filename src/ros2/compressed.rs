//! [`Compressed`]: the images of a stream as `sensor_msgs/msg/CompressedImage`.

use super::messages::Message;
use super::{NAP, Ros2Error};
use belvedere_bridge::{Encoding, FrameView, Kind, Node, Ros, RosBytes, StreamInfo, Subscriber};
use belvedere_rtps::{Participant, Qos, Topic, Writer};
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder as _, ImageError};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

/// The number of images that are left out before a warning says so. A computer that is busy for a moment leaves out fewer.
const MANY: u64 = 10;

/// How an image is compressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    Jpeg(ExtendedColorType),
    Png(ExtendedColorType),
}

impl Form {
    /// Returns the form of images with this encoding, which `image_transport` uses, too; `None` if it has none.
    fn of(encoding: Encoding) -> Option<Self> {
        Some(match encoding {
            Encoding::Rgb8 | Encoding::Bgr8 | Encoding::Rgba8 => Self::Jpeg(ExtendedColorType::Rgb8),
            Encoding::Mono8 => Self::Jpeg(ExtendedColorType::L8),
            // JPEG has no 16 bits, and would mix the colours of a mosaic.
            Encoding::BayerRggb8 | Encoding::BayerBggr8 | Encoding::BayerGbrg8 | Encoding::BayerGrbg8 => {
                Self::Png(ExtendedColorType::L8)
            }
            Encoding::Mono16
            | Encoding::BayerRggb16
            | Encoding::BayerBggr16
            | Encoding::BayerGbrg16
            | Encoding::BayerGrbg16 => Self::Png(ExtendedColorType::L16),
            _ => return None,
        })
    }

    /// Returns the text by which `image_transport` knows how to decompress the image.
    fn format(self, encoding: Encoding) -> String {
        let encoding = encoding.as_str();
        match self {
            Self::Jpeg(ExtendedColorType::Rgb8) => format!("{encoding}; jpeg compressed bgr8"),
            Self::Jpeg(_) => format!("{encoding}; jpeg compressed "),
            Self::Png(_) => format!("{encoding}; png compressed "),
        }
    }

    /// Compresses pixels without gaps.
    fn compress(
        self,
        pixels: &[u8],
        [width, height]: [u32; 2],
        quality: u8,
        out: &mut Vec<u8>,
    ) -> Result<(), ImageError> {
        match self {
            Self::Jpeg(colour) => {
                JpegEncoder::new_with_quality(out, quality).encode(pixels, width, height, colour)
            }
            // The encoder converts from the machine's byte order, which is the wire's, to PNG's.
            Self::Png(colour) => {
                PngEncoder::new_with_quality(out, CompressionType::Fast, FilterType::Adaptive)
                    .write_image(pixels, width, height, colour)
            }
        }
    }
}

/// A topic with compressed images. They are compressed by a thread of its own, so that other topics are not delayed, and
/// only while somebody reads them. The thread starts with the first reader.
#[derive(Debug)]
pub(super) struct Compressed {
    work: Work,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// What the thread needs.
#[derive(Debug, Clone)]
struct Work {
    node: Node,
    /// The stream's topic in the domain.
    topic: String,
    writer: Arc<Writer>,
    quality: u8,
}

impl Compressed {
    /// Returns true if the images of a stream can be compressed.
    pub(super) fn is_possible(stream: &StreamInfo) -> bool {
        stream.kind == Some(Kind::Image) && stream.encoding.and_then(Form::of).is_some()
    }

    /// Publishes the images of a stream under this name, as JPEG of this quality (1 to 100), or as PNG.
    pub(super) fn new(
        participant: &Participant,
        node: &Node,
        topic: &str,
        name: &str,
        qos: Qos,
        quality: u8,
    ) -> Result<Self, Ros2Error> {
        let message = Message::COMPRESSED_IMAGE;
        let topic_of_ros = Topic { name, message: &message.name(), hash: &message.hash() };
        let writer = Arc::new(participant.writer(topic_of_ros, qos)?);
        let work = Work { node: node.clone(), topic: topic.to_owned(), writer, quality };
        Ok(Self { work, stop: Arc::default(), thread: None })
    }

    /// Starts to compress if somebody reads the topic.
    pub(super) fn follow(&mut self) {
        if self.thread.is_some() || self.work.writer.matched() == 0 {
            return;
        }
        let (work, stop) = (self.work.clone(), self.stop.clone());
        let thread = std::thread::Builder::new().name("compressed".to_owned());
        match thread.spawn(move || work.run(&stop)) {
            Ok(thread) => self.thread = Some(thread),
            // The next call tries again.
            Err(error) => tracing::debug!(topic = self.work.topic, %error, "no thread compresses images"),
        }
    }
}

impl Drop for Compressed {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has reported it.
            let _ = thread.join();
        }
    }
}

impl Work {
    /// Compresses images until `stop` is set.
    fn run(&self, stop: &AtomicBool) {
        let mut subscriber: Option<Subscriber> = None;
        let mut state = State::default();
        while !stop.load(Ordering::Relaxed) {
            if self.writer.matched() == 0 {
                subscriber = None;
                std::thread::sleep(NAP);
                continue;
            }
            let came = match &mut subscriber {
                None => self.node.subscriber(&self.topic).map(|opened| subscriber = Some(opened)),
                Some(open) => open.wait(NAP).and_then(|_| open.take_newest()).map(|frame| {
                    if let Some(frame) = frame {
                        state.count(frame.missed(), &self.topic);
                        self.publish(&frame.view(), &mut state);
                    }
                }),
            };
            if let Err(error) = came {
                state.report(&self.topic, &error);
                subscriber = None;
                std::thread::sleep(NAP);
            }
        }
    }

    fn publish(&self, frame: &FrameView<'_>, state: &mut State) {
        let head = frame.header();
        let Some((encoding, form)) =
            head.encoding().and_then(|encoding| Some((encoding, Form::of(encoding)?)))
        else {
            return;
        };
        let State { pixels, compressed, .. } = state;
        compressed.clear();
        pack(frame, encoding, pixels);
        if let Err(error) = form.compress(pixels, [head.width, head.height], self.quality, compressed) {
            return state.report(&self.topic, &error);
        }
        let mut message = self.writer.buffer();
        let mut bytes = RosBytes::begin(Ros::Two, &mut message);
        bytes.header(head, None);
        bytes.text(&form.format(encoding));
        bytes.bytes(compressed);
        // An image with a time beyond ROS 2's is left out, as it is on the topic itself.
        if bytes.end().is_some() {
            self.writer.write(message);
        }
        state.has_failed = false;
    }
}

/// Writes the pixels of a frame without gaps to `out`, replacing its contents: red, green, blue, or single numbers.
fn pack(frame: &FrameView<'_>, encoding: Encoding, out: &mut Vec<u8>) {
    out.clear();
    for row in frame.rows() {
        match encoding {
            Encoding::Bgr8 => out.extend(row.as_chunks::<3>().0.iter().flat_map(|&[b, g, r]| [r, g, b])),
            Encoding::Rgba8 => out.extend(row.as_chunks::<4>().0.iter().flat_map(|&[r, g, b, _]| [r, g, b])),
            _ => out.extend_from_slice(row),
        }
    }
}

/// The memory of the thread, and what it has reported.
#[derive(Debug, Default)]
struct State {
    pixels: Vec<u8>,
    compressed: Vec<u8>,
    missed: u64,
    has_failed: bool,
}

impl State {
    /// Counts images that came while an earlier one was compressed, and reports once that there are many.
    fn count(&mut self, missed: u64, topic: &str) {
        let before = self.missed;
        self.missed += missed;
        if before < MANY && self.missed >= MANY {
            tracing::warn!(
                topic,
                "images come faster than they can be compressed, so some are left out of the topic compressed; \
                 use smaller images, a lower rate, or the topic itself"
            );
        }
    }

    /// Reports an error, but not again while it lasts.
    fn report(&mut self, topic: &str, error: &dyn std::fmt::Display) {
        if !std::mem::replace(&mut self.has_failed, true) {
            tracing::warn!(topic, %error, "compressed images are not published in ROS 2");
        }
    }
}
