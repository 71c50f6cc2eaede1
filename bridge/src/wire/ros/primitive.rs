//! [`RosPrimitive`]: the types of ROS that are not messages.

/// Defines the types with their names in definitions, and their numbers in the descriptions of ROS 2's types.
macro_rules! primitives {
    ($($name:ident = $number:literal $word:literal,)+) => {
        /// A type of ROS that is not a message.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum RosPrimitive {
            $(#[doc = concat!("`", $word, "`")] $name,)+
        }

        impl RosPrimitive {
            /// Returns its name in definitions, of ROS 1 and of ROS 2.
            #[must_use]
            pub const fn word(self) -> &'static str {
                match self { $(Self::$name => $word,)+ }
            }

            /// Returns the type with this name; `None` if it is the name of a message, or of no type.
            #[must_use]
            pub fn of_word(word: &str) -> Option<Self> {
                match word { $($word => Some(Self::$name),)+ _ => None }
            }

            /// Returns its number in `type_description_interfaces/FieldType`, from which ROS 2 computes hashes of types.
            #[must_use]
            pub const fn number(self) -> u32 {
                match self { $(Self::$name => $number,)+ }
            }
        }
    };
}

primitives! {
    Int8 = 2 "int8",
    Uint8 = 3 "uint8",
    Int16 = 4 "int16",
    Uint16 = 5 "uint16",
    Int32 = 6 "int32",
    Uint32 = 7 "uint32",
    Int64 = 8 "int64",
    Uint64 = 9 "uint64",
    Float32 = 10 "float32",
    Float64 = 11 "float64",
    Bool = 15 "bool",
    Byte = 16 "byte",
    String = 17 "string",
}
