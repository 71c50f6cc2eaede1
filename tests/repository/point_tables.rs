//! The tables of points in the book have the fields of the wire format.

use belvedere_bridge::Encoding;
use belvedere_bridge::point::Number;

#[test]
fn clouds_of_lidars_have_the_fields_of_the_wire_format() {
    let text = include_str!("../../docs/lidars.md");
    for encoding in [Encoding::XyzIrF32, Encoding::XyzIrtF32, Encoding::OusterPoint, Encoding::LivoxPoint] {
        let point = encoding.point().unwrap();
        let begin = format!("encoding {} `{encoding}`", encoding.to_wire());
        let (_, section) = text.split_once(&begin).expect(&begin);
        assert!(section.lines().next().unwrap().contains(&format!("with {} bytes per point", point.size)));
        let rows = section.lines().skip_while(|line| !line.starts_with("|---:")).skip(1);
        let mut found = Vec::new();
        for row in rows.take_while(|line| line.starts_with('|')) {
            let [_, offsets, of, names, ..] = row.split('|').map(str::trim).collect::<Vec<_>>()[..] else {
                panic!("{row}")
            };
            for (offset, name) in offsets.split(", ").zip(names.split(", ")) {
                found.push((offset.parse().unwrap(), of, name));
            }
        }
        let word = |number| match number {
            Number::U8 => "u8",
            Number::U16 => "u16",
            Number::U32 => "u32",
            Number::F32 => "f32",
            Number::F64 => "f64",
            Number::Colour => "colour",
        };
        let fields = point.fields.iter().map(|field| (field.offset, word(field.number), field.name));
        assert_eq!(found, fields.collect::<Vec<_>>(), "{encoding}");
    }
}
