//! The wire format as data: each struct and each list of numbers is written once, and bindings are made of it.

/// A struct of the wire format.
#[derive(Clone, Copy, Debug)]
pub struct Struct {
    /// Its name in Rust.
    pub name: &'static str,
    /// What it is: lines of Rust's documentation.
    pub doc: &'static [&'static str],
    /// Bytes.
    pub size: usize,
    /// The kinds of streams that carry it, by their numbers; none for a part of another struct.
    pub kinds: &'static [u16],
    /// In the order of their offsets.
    pub fields: &'static [Field],
}

/// A field of a [`Struct`].
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// Its name in every language.
    pub name: &'static str,
    /// What it is: lines of Rust's documentation.
    pub doc: &'static [&'static str],
    /// Its type in Rust: a number, an array, [`Text`](crate::Text) or another struct.
    pub type_name: &'static str,
    /// Bytes before it.
    pub offset: usize,
    /// Rows and columns of an array that is a matrix, else nothing.
    pub shape: &'static [usize],
}

/// A list of numbers that stand for something.
#[derive(Clone, Copy, Debug)]
pub struct Enum {
    /// Its name in Rust.
    pub name: &'static str,
    /// What it is: lines of Rust's documentation.
    pub doc: &'static [&'static str],
    /// In the order of their numbers.
    pub values: &'static [Value],
}

/// A value of an [`Enum`].
#[derive(Clone, Copy, Debug)]
pub struct Value {
    /// Its name in Rust.
    pub name: &'static str,
    /// The name shown to people.
    pub text: &'static str,
    /// What it is: lines of Rust's documentation.
    pub doc: &'static [&'static str],
    /// Its number on the wire.
    pub number: u16,
    /// The type of an element that is so coded; empty where that is no matter of this list.
    pub element: &'static str,
    /// Its size in bytes, or 0.
    pub element_size: usize,
}

/// Structs, each with its size and the offsets of its fields, which are checked when this is compiled; what carries
/// them, as [`Message`](crate::payload::Message); and `STRUCTS`, the same as data.
macro_rules! wire_structs {
    ($(
        $(#[doc = $doc:literal])*
        $(with #[$attribute:meta])*
        pub struct $name:ident, $size:literal bytes $(, of [$($kind:path),+])? {
            $(
                $(#[doc = $field_doc:literal])*
                pub $field:ident: $type:ty = $offset:literal $(as [$($length:literal),+])?,
            )+
        }
    )+) => {
        $(
            $(#[doc = $doc])*
            #[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
            #[repr(C)]
            $(#[$attribute])*
            pub struct $name { $($(#[doc = $field_doc])* pub $field: $type,)+ }

            $(impl Message for $name { const KINDS: &'static [Kind] = &[$($kind),+]; })?

            const _: () = {
                assert!(size_of::<$name>() == $size);
                $(assert!(std::mem::offset_of!($name, $field) == $offset);)+
            };
        )+

        /// These structs as data.
        pub(super) const STRUCTS: &[$crate::wire::layout::Struct] = &[$(
            $crate::wire::layout::Struct {
                name: stringify!($name),
                doc: &[$($doc),*],
                size: $size,
                kinds: &[$($($kind as u16),+)?],
                fields: &[$(
                    $crate::wire::layout::Field {
                        name: stringify!($field),
                        doc: &[$($field_doc),*],
                        type_name: stringify!($type),
                        offset: $offset,
                        shape: &[$($($length),+)?],
                    },
                )+],
            },
        )+];
    };
}

/// Numbers that stand for something, their names, and `LAYOUT`, the same as data.
macro_rules! wire_enum {
    (
        $(#[doc = $doc:literal])*
        $name:ident {
            $($(#[doc = $value_doc:literal])* $value:ident = $number:literal $text:literal $(of $element:ty)?,)+
        }
    ) => {
        $(#[doc = $doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[repr(u16)]
        pub enum $name { $($(#[doc = $value_doc])* $value = $number,)+ }

        impl $name {
            /// Every value, in the order of its number.
            pub const ALL: &[Self] = &[$(Self::$value),+];

            /// This list as data.
            pub(super) const LAYOUT: $crate::wire::layout::Enum = $crate::wire::layout::Enum {
                name: stringify!($name),
                doc: &[$($doc),*],
                values: &[$(
                    $crate::wire::layout::Value {
                        name: stringify!($value),
                        text: $text,
                        doc: &[$($value_doc),*],
                        number: $number,
                        element: concat!($(stringify!($element))?),
                        element_size: 0 $(+ size_of::<$element>())?,
                    },
                )+],
            };

            /// The number on the wire.
            #[must_use]
            pub const fn to_wire(self) -> u16 { self as u16 }

            /// The meaning of a number on the wire; `None` for one that this version does not know.
            #[must_use]
            pub const fn from_wire(number: u16) -> Option<Self> {
                match number { $($number => Some(Self::$value),)+ _ => None }
            }

            /// The name shown to people and written into stream attributes.
            #[must_use]
            pub const fn as_str(self) -> &'static str {
                match self { $(Self::$value => $text,)+ }
            }
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result { f.pad(self.as_str()) }
        }

        impl std::str::FromStr for $name {
            type Err = ();
            fn from_str(text: &str) -> Result<Self, ()> {
                Self::ALL.iter().copied().find(|value| value.as_str() == text).ok_or(())
            }
        }
    };
}

pub(crate) use {wire_enum, wire_structs};
