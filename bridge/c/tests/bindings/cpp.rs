//! Generates assertions of all offsets, which the compiler of each user of the C header checks.

use std::fmt::Write as _;

use belvedere_bridge::schema;

use crate::names::{c_type, snake};

pub(crate) fn layout() -> String {
    let mut text = "\
// The offsets in Belvedere's frames, checked at compile time against compiler flags that change layouts.
// SPDX-License-Identifier: MIT OR Apache-2.0
//
// Generated from bridge/src/wire by bridge/c/tests/bindings; do not edit.
#ifndef BELVEDERE_WIRE_HPP
#define BELVEDERE_WIRE_HPP

#include <cstddef>
#include <cstdint>

#include \"belvedere.h\"

#define BELVEDERE_AT(type, field, offset) \\
    static_assert(offsetof(type, field) == (offset), #type \".\" #field \" is not where the wire format has it\")
"
    .to_owned();
    for layout in schema::structs() {
        let name = c_type(layout.name);
        let _ = writeln!(text, "static_assert(sizeof({name}) == {}, \"wire format\");", layout.size);
        for field in layout.fields {
            let _ = writeln!(text, "BELVEDERE_AT({name}, {}, {});", field.name, field.offset);
        }
    }
    text += "\
#undef BELVEDERE_AT

namespace belvedere {
namespace detail {

/// Returns true if streams of this kind carry Ts.
template <class T>
constexpr bool carries(std::uint16_t kind) = delete;
";
    for layout in schema::structs().filter(|layout| !layout.kinds.is_empty()) {
        let is_one: Vec<String> =
            layout.kinds.iter().map(|&kind| format!("kind == BV_KIND_{}", kind_name(kind))).collect();
        let _ = write!(
            text,
            "template <>\nconstexpr bool carries<{}>(std::uint16_t kind) {{\n    return {};\n}}\n",
            c_type(layout.name),
            is_one.join(" || ")
        );
    }
    text + "\n}  // namespace detail\n}  // namespace belvedere\n\n#endif  // BELVEDERE_WIRE_HPP\n"
}

fn kind_name(number: u16) -> String {
    let kinds = schema::ENUMS.iter().find(|numbers| numbers.name == "Kind").unwrap();
    let kind = kinds.values.iter().find(|kind| kind.number == number).unwrap();
    snake(kind.name).to_uppercase()
}
