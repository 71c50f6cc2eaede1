//! The page in the browser reads structs at the offsets of the wire format.

use std::path::Path;

use belvedere_bridge::schema;

/// The text of the page's decoders from this function on.
fn decoder(function: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("viewer/src/frame.ts");
    let text = std::fs::read_to_string(path).unwrap();
    let (_, decoder) = text.split_once(&format!("export function {function}(")).expect(function);
    decoder.to_owned()
}

fn field(name: &str, field: &str) -> &'static schema::Field {
    let layout = schema::structs().find(|layout| layout.name == name).unwrap();
    layout.fields.iter().find(|known| known.name == field).unwrap()
}

#[test]
fn the_page_reads_the_states_of_links_where_they_are() {
    let decoder = decoder("linkStates");
    for (name, count) in [("position", 3), ("orientation", 4)] {
        let field = field("ModelState", name);
        assert_eq!(field.type_name.replace(' ', ""), format!("[f64;{count}]"));
        let numbers: Vec<_> = (0..count).map(|at| format!("number({})", field.offset + 8 * at)).collect();
        let line = format!("{name}: [{}]", numbers.join(", "));
        assert!(decoder.contains(&line), "viewer/src/frame.ts has to read {line}");
    }
    let name = field("ModelState", "name");
    assert_eq!(name.offset, 0);
    let length = name.type_name.trim_start_matches("Text<").trim_end_matches('>').trim();
    let line = format!("new Uint8Array(payload.buffer, payload.byteOffset + at, {length})");
    assert!(decoder.contains(&line), "viewer/src/frame.ts has to read {line}");
}

#[test]
fn the_page_reads_the_velocity_where_it_is() {
    let [linear, angular] = ["linear", "angular"].map(|name| field("Odometry", name).offset);
    // Forwards, and about z.
    let line = format!("[payload.getFloat64({linear}, true), payload.getFloat64({}, true)]", angular + 2 * 8);
    assert!(decoder("velocity").contains(&line), "viewer/src/frame.ts has to read {line}");
}
