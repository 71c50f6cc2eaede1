//! Publishes a moving test image, to try consumers without a simulator:
//! `cargo run --release -p belvedere-bridge --example publish_pattern -- [topic] [rate_hz] [seconds] [domain]`

use std::time::{Duration, Instant};

use belvedere_bridge::{Domain, Encoding, Intrinsics, Kind, Node, StreamSpec};

const WIDTH: u32 = 640;
const HEIGHT: u32 = 480;
const LEN: usize = (WIDTH * HEIGHT * 3) as usize;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let topic = args.next().unwrap_or_else(|| "camera/rgb/image_raw".to_owned());
    let rate_hz: f64 = args.next().map_or(Ok(30.0), |text| text.parse())?;
    let seconds: f64 = args.next().map_or(Ok(f64::INFINITY), |text| text.parse())?;
    let domain = args.next().map_or(Ok(Domain::default()), |name| Domain::new(&name))?;

    let node = Node::open(&domain, "publish_pattern")?;
    let spec = StreamSpec::new(topic, Kind::Image, Encoding::Rgb8, LEN)
        .frame_id("camera_rgb_optical_frame")
        .rate_hz(rate_hz);
    let publisher = node.publisher(&spec)?;

    let started = Instant::now();
    let mut costs_ns = Vec::new();
    for count in 0_u32.. {
        let due = Duration::from_secs_f64(f64::from(count) / rate_hz);
        if due.as_secs_f64() >= seconds {
            break;
        }
        std::thread::sleep(due.saturating_sub(started.elapsed()));

        let before_loan = Instant::now();
        let mut frame = publisher.loan(LEN)?;
        let mut cost = before_loan.elapsed();

        paint(frame.payload_mut(), count);
        let header = frame.header_mut();
        header.set_packed(WIDTH, HEIGHT);
        header.stamp_ns = due.as_nanos() as u64;
        header.set_intrinsics(&Intrinsics {
            fx: 525.0,
            fy: 525.0,
            cx: 319.5,
            cy: 239.5,
            ..Intrinsics::default()
        });

        let before_send = Instant::now();
        frame.send()?;
        cost += before_send.elapsed();
        costs_ns.push(cost.as_nanos());
    }
    costs_ns.sort_unstable();
    if let Some(median) = costs_ns.get(costs_ns.len() / 2) {
        println!(
            "{} frames; loan + send: median {median} ns, p99 {} ns",
            costs_ns.len(),
            costs_ns[costs_ns.len() * 99 / 100]
        );
    }
    Ok(())
}

/// Draws coloured gradients with a white bar that moves one pixel per frame.
fn paint(pixels: &mut [u8], count: u32) {
    for (y, row) in pixels.chunks_exact_mut(WIDTH as usize * 3).enumerate() {
        for (x, pixel) in row.chunks_exact_mut(3).enumerate() {
            let bar = (x as u32 + WIDTH - count % WIDTH) % WIDTH < 16;
            let colour = if bar { [255; 3] } else { [(x * 255 / 640) as u8, (y * 255 / 480) as u8, 96] };
            pixel.copy_from_slice(&colour);
        }
    }
}
