//! Where everything lies, asserted by whoever's compiler reads the C header.

use std::fmt::Write as _;

use belvedere_bridge::schema;

use crate::names::c_type;

pub(crate) fn layout() -> String {
    let mut text = "\
// Where everything lies in Belvedere's frames, held at compile time: no flag of a compiler may move it.
// SPDX-License-Identifier: MIT OR Apache-2.0
//
// Made from bridge/src/wire by bridge/c/tests/bindings; do not edit.
#ifndef BELVEDERE_WIRE_HPP
#define BELVEDERE_WIRE_HPP

#include <cstddef>

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
    text + "#undef BELVEDERE_AT\n\n#endif  // BELVEDERE_WIRE_HPP\n"
}
