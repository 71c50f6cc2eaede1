//! The wire format as data. Each struct and each list of numbers is defined once, and the bindings are generated from
//! it.

use super::{
    fields::{DescribeRows, RosType},
    point::PointLayout,
};

/// A struct of the wire format.
#[derive(Clone, Copy, Debug)]
pub struct Struct {
    /// Its name in Rust.
    pub name: &'static str,
    /// Lines of its Rust documentation.
    pub doc: &'static [&'static str],
    /// Its size in bytes.
    pub size: usize,
    /// The numbers of the kinds of streams that carry it; empty for a part of another struct.
    pub kinds: &'static [u16],
    /// Its fields in the order of their offsets.
    pub fields: &'static [Field],
    /// The types of ROS that streams of it are published as.
    pub ros: &'static [RosType],
    /// The description of a payload of it; none for a part of another struct.
    pub(super) describe: Option<DescribeRows>,
}

/// A field of a [`Struct`].
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// Its name in every language.
    pub name: &'static str,
    /// Lines of its Rust documentation.
    pub doc: &'static [&'static str],
    /// Its type in Rust: a number, an array, [`Text`](crate::Text) or another struct.
    pub type_name: &'static str,
    /// Its offset in bytes.
    pub offset: usize,
    /// Rows and columns of a matrix; empty for other fields.
    pub shape: &'static [usize],
}

/// An enumeration of the wire format.
#[derive(Clone, Copy, Debug)]
pub struct Enum {
    /// Its name in Rust.
    pub name: &'static str,
    /// Lines of its Rust documentation.
    pub doc: &'static [&'static str],
    /// Its values in the order of their numbers.
    pub values: &'static [Value],
}

/// A value of an [`Enum`].
#[derive(Clone, Copy, Debug)]
pub struct Value {
    /// Its name in Rust.
    pub name: &'static str,
    /// The name shown to people.
    pub text: &'static str,
    /// Lines of its Rust documentation.
    pub doc: &'static [&'static str],
    /// Its number on the wire.
    pub number: u16,
    /// The type of an element with this encoding; empty for points, and in other enumerations.
    pub element: &'static str,
    /// The layout of an element that is a point.
    pub point: Option<&'static PointLayout>,
    /// The size of an element in bytes, or 0.
    pub element_size: usize,
}

/// Defines structs with their sizes and the offsets of their fields, which are checked at compile time. Implements
/// [`Message`](crate::payload::Message) for those that streams carry, and describes all of them as data in `STRUCTS`.
/// Those that streams carry also implement [`Describe`](super::fields::Describe).
macro_rules! wire_structs {
    (@ros $name:ident) => { &[] };
    (@ros $name:ident $($kind:path),+) => { <$name as $crate::wire::fields::Describe>::ROS };
    (@describe $name:ident) => { None };
    (@describe $name:ident $($kind:path),+) => { Some($crate::wire::fields::describe_rows::<$name>) };
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
                ros: wire_structs!(@ros $name $($($kind),+)?),
                describe: wire_structs!(@describe $name $($($kind),+)?),
            },
        )+];
    };
}

/// Defines an enumeration with its numbers and names, and describes it as data in `LAYOUT`.
macro_rules! wire_enum {
    (@point) => { None };
    (@point $point:ident) => { Some(&$point::LAYOUT) };
    (
        $(#[doc = $doc:literal])*
        $name:ident {
            $(
                $(#[doc = $value_doc:literal])*
                $value:ident = $number:literal $text:literal $(of $element:ty)? $(as $point:ident)?,
            )+
        }
    ) => {
        $(#[doc = $doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[repr(u16)]
        pub enum $name {
            $(
                $(#[doc = $value_doc])*
                $(
                    #[doc = ""]
                    #[doc = concat!(
                        "Its fields are those of [`", stringify!($point), "`](crate::point::", stringify!($point), ")."
                    )]
                )?
                $value = $number,
            )+
        }

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
                        point: wire_enum!(@point $($point)?),
                        element_size: 0 $(+ size_of::<$element>())? $(+ $point::SIZE)?,
                    },
                )+],
            };

            /// Returns the number on the wire.
            #[must_use]
            pub const fn to_wire(self) -> u16 { self as u16 }

            /// Returns the value with this number on the wire; `None` if this version does not know it.
            #[must_use]
            pub const fn from_wire(number: u16) -> Option<Self> {
                match number { $($number => Some(Self::$value),)+ _ => None }
            }

            /// Returns the name shown to people and written into stream attributes.
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
