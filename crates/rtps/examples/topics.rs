//! Writes pictures or clouds of points, or prints the commands that come, as a node of ROS 2.
//!
//! `cargo run --release -p belvedere-rtps --example topics -- image reliable 180`

use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use belvedere_rtps::{Node, Participant, Qos, Range, Topic};

type Failure = Box<dyn std::error::Error>;

/// Appends values of CDR, each at a multiple of its size from behind the header of four bytes.
struct Cdr(Vec<u8>);

impl Cdr {
    fn new(mut buffer: Vec<u8>) -> Cdr {
        buffer.extend_from_slice(&[0, 1, 0, 0]);
        Cdr(buffer)
    }

    fn u32(&mut self, value: u32) -> &mut Cdr {
        self.0.resize(self.0.len().next_multiple_of(4), 0);
        self.0.extend_from_slice(&value.to_le_bytes());
        self
    }

    fn string(&mut self, value: &str) -> &mut Cdr {
        self.u32(value.len() as u32 + 1);
        self.0.extend_from_slice(value.as_bytes());
        self.0.push(0);
        self
    }

    /// The header of a message: now, and the frame.
    fn header(&mut self) -> &mut Cdr {
        let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        self.u32(now.as_secs() as u32).u32(now.subsec_nanos()).string("camera")
    }
}

const IMAGE: Topic<'_> = Topic {
    name: "/camera/image_raw",
    message: "sensor_msgs/msg/Image",
    hash: "RIHS01_d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47",
};
const CLOUD: Topic<'_> = Topic {
    name: "/points",
    message: "sensor_msgs/msg/PointCloud2",
    hash: "RIHS01_9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5",
};
const WORDS: Topic<'_> = Topic {
    name: "/robot_description",
    message: "std_msgs/msg/String",
    hash: "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18",
};
const TWIST: Topic<'_> = Topic {
    name: "/cmd_vel",
    message: "geometry_msgs/msg/Twist",
    hash: "RIHS01_9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a",
};

/// Makes a message in a buffer.
type Make = fn(Vec<u8>) -> Vec<u8>;

fn image(buffer: Vec<u8>) -> Vec<u8> {
    let mut cdr = Cdr::new(buffer);
    cdr.header().u32(480).u32(640).string("rgb8").0.push(0);
    cdr.u32(3 * 640).u32(3 * 640 * 480);
    let end = cdr.0.len() + 3 * 640 * 480;
    cdr.0.resize(end, 7);
    cdr.0
}

fn cloud(buffer: Vec<u8>) -> Vec<u8> {
    let mut cdr = Cdr::new(buffer);
    cdr.header().u32(480).u32(640).u32(4);
    for (number, name) in ["x", "y", "z", "intensity"].into_iter().enumerate() {
        cdr.string(name).u32(4 * number as u32).0.push(7);
        cdr.u32(1);
    }
    cdr.0.push(0);
    cdr.u32(16).u32(16 * 640).u32(16 * 640 * 480);
    let end = cdr.0.len() + 16 * 640 * 480;
    cdr.0.resize(end, 7);
    cdr.0.push(1);
    cdr.0
}

fn main() -> Result<(), Failure> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let what = words.first().map_or("image", String::as_str);
    let best_effort = words.get(1).is_some_and(|word| word == "best_effort");
    let count: u32 = words.get(2).map_or(Ok(180), |word| word.parse())?;
    let settle: u64 = words.get(3).map_or(Ok(1000), |word| word.parse())?;
    let domain = std::env::var("ROS_DOMAIN_ID").map_or(Ok(0), |word| word.parse())?;
    let participant = Participant::join(&Node {
        domain,
        range: Range::Subnet,
        peers: &[],
        namespace: "/",
        name: "belvedere",
    })?;
    let qos = if best_effort { Qos::best_effort(5) } else { Qos::volatile(5) };
    let (topic, rate, make): (_, _, Make) = match what {
        "twist" => {
            let reader = participant.reader(TWIST, qos, 4096)?;
            for _ in 0..count {
                let Some(sample) = reader.take(Duration::from_secs(60)) else { break };
                let speed = sample.get(4..12).ok_or("a Twist has 48 bytes")?;
                println!("{}", f64::from_le_bytes(speed.try_into()?));
            }
            return Ok(());
        }
        "latched" => {
            let writer = participant.writer(WORDS, Qos::latched())?;
            let mut cdr = Cdr::new(writer.buffer());
            cdr.string("written before anyone listened");
            writer.write(cdr.0);
            std::thread::sleep(Duration::from_secs(u64::from(count)));
            return Ok(());
        }
        "cloud" => (CLOUD, 10, cloud),
        _ => (IMAGE, 30, image),
    };
    let writer = participant.watched_writer(topic, qos, |count| eprintln!("{count} readers"))?;
    while writer.matched() == 0 {
        std::thread::sleep(Duration::from_millis(10));
    }
    std::thread::sleep(Duration::from_millis(settle));
    let start = Instant::now();
    let used = cpu();
    for number in 0..count {
        let due = start + Duration::from_secs(1) * number / rate;
        std::thread::sleep(due.saturating_duration_since(Instant::now()));
        writer.write(make(writer.buffer()));
    }
    std::thread::sleep(Duration::from_millis(100));
    println!("processor time of a sample: {:.3} ms", (cpu() - used) / f64::from(count));
    std::thread::sleep(Duration::from_millis(900));
    Ok(())
}

/// Processor time of all threads, in milliseconds.
fn cpu() -> f64 {
    let threads = std::fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
    let texts = threads.filter_map(|thread| std::fs::read_to_string(thread.path().join("schedstat")).ok());
    let times = texts.filter_map(|text| text.split(' ').next()?.parse::<u64>().ok());
    times.sum::<u64>() as f64 / 1e6
}
