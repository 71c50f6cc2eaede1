//! Receives ten images of a running simulator.

use belvedere_bridge::{Domain, Node};
use std::time::Duration;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let node = Node::open(&Domain::from_env()?, "first-rust")?;
    let mut camera = node.subscriber("image_raw")?;
    let mut count = 0;
    while count < 10 && camera.wait(Duration::from_secs(5))? {
        if let Some(frame) = camera.take()? {
            let (header, pixels) = (frame.header(), frame.payload()); // in place: the memory that the simulator wrote
            println!("{} x {}, first pixel {:?}", header.width, header.height, &pixels[..3]);
            count += 1;
        }
    }
    if count < 10 {
        return Err("no image for 5 s; start a simulator (belvedere run)".into());
    }
    Ok(())
}
