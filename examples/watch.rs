//! Watches a stream from another process: prints rate, latency and gaps every second, and can save an image.
//!
//! ```text
//! Terminal 1:  cargo run --release
//! Terminal 2:  cargo run --release --example watch -- camera/rgb/image_raw --save picture.png
//! ```
//! The latency is the time from the publisher's `send` until this program has read every byte. The program may be started
//! before the simulator, and continues after the simulator is killed and restarted.

use std::{
    hint::black_box,
    path::PathBuf,
    process::ExitCode,
    sync::atomic::{AtomicBool, Ordering},
    time::{Duration, Instant},
};

use belvedere::{
    cli::{snapshot::OutputPicture, statistics::StreamStatistics},
    picture,
};
use belvedere_bridge::{Domain, Node};
use clap::Parser;

/// Watch a stream: rate, jitter, latency until every byte was read, gaps.
#[derive(Parser)]
struct Args {
    /// The topic, with or without a leading slash
    topic: String,
    /// Name of the simulation
    #[arg(long, default_value_t, env = "BELVEDERE_DOMAIN")]
    domain: Domain,
    /// Stop after this number of seconds
    #[arg(long, value_parser = belvedere::cli::follow::seconds)]
    duration: Option<Duration>,
    /// Stop after this number of frames
    #[arg(long)]
    count: Option<u64>,
    /// Save the last frame as an image
    #[arg(long, value_name = "FILE")]
    save: Option<PathBuf>,
    /// Print one JSON object per line
    #[arg(long)]
    json: bool,
}

static STOP: AtomicBool = AtomicBool::new(false);

fn main() -> ExitCode {
    match watch(&Args::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn watch(args: &Args) -> Result<(), Box<dyn std::error::Error>> {
    ctrlc::set_handler(|| STOP.store(true, Ordering::Relaxed))?;
    let mut output = args.save.as_deref().map(OutputPicture::create).transpose()?;

    let node = Node::open(&args.domain, "watch")?;
    let mut subscriber = node.subscriber(&args.topic)?;

    let (mut second, mut whole) = (StreamStatistics::default(), StreamStatistics::default());
    let mut last = None;
    let mut count = 0;
    let started = Instant::now();
    let mut next_report = started + Duration::from_secs(1);
    while !STOP.load(Ordering::Relaxed)
        && args.duration.is_none_or(|duration| started.elapsed() < duration)
        && args.count.is_none_or(|wanted| count < wanted)
    {
        // Returns when a frame arrives, or after 50 ms to check whether the program should stop.
        if subscriber.wait(Duration::from_millis(50))? {
            // Release the previous frame, because a subscriber may hold only two at a time.
            last = None;
            if let Some(frame) = subscriber.take()? {
                black_box(sum_of_bytes(frame.payload()));
                let (now, latency_ns) = (Instant::now(), frame.age_ns());
                if frame.restarted() {
                    eprintln!("the publisher was restarted");
                }
                // A frame that was sent before this program connected has an image, but its age is not the latency.
                if !frame.is_from_history() {
                    second.add(now, latency_ns, frame.missed());
                    whole.add(now, latency_ns, frame.missed());
                }
                count += 1;
                last = Some(frame);
            }
        }
        if Instant::now() >= next_report {
            next_report += Duration::from_secs(1);
            report(args, &second);
            second.start_anew();
        }
    }
    report(args, &whole);
    if let (Some(output), Some(frame)) = (&mut output, &last) {
        output.save(&picture::draw(&frame.view())?)?;
    }
    if count == 0 { Err(format!("no frame of {} arrived", args.topic).into()) } else { Ok(()) }
}

/// Reads every byte, eight at a time.
fn sum_of_bytes(bytes: &[u8]) -> u64 {
    let (words, rest) = bytes.as_chunks::<8>();
    let words = words.iter().map(|&word| u64::from_ne_bytes(word)).fold(0, u64::wrapping_add);
    words.wrapping_add(rest.iter().map(|&byte| u64::from(byte)).sum())
}

fn report(args: &Args, statistics: &StreamStatistics) {
    let summary = statistics.summary();
    if args.json {
        println!("{}", summary.json(&args.topic));
    } else {
        println!("{}: {summary}", args.topic);
    }
}
