//! Columns of a block of vehicles, each declared once: name, type, and what a new vehicle finds in it.
//!
//! A slot of a block is used by one vehicle after the other. The macro `columns!` makes the struct, its constructor and
//! [`Slots::clear`] from one list, so that no column can be left out of the reset of a slot.

use crate::lanes::{LANES, Lanes};

/// What keeps something for every slot of a block.
pub trait Slots {
    /// Makes a slot what it is in a new block.
    fn clear(&mut self, slot: usize);
}

impl<const N: usize> Slots for [Lanes; N] {
    fn clear(&mut self, slot: usize) {
        self.iter_mut().for_each(|column| column[slot] = 0.0);
    }
}

impl Slots for Vec<Lanes> {
    fn clear(&mut self, slot: usize) {
        self.iter_mut().for_each(|column| column[slot] = 0.0);
    }
}

/// A column whose first value is known only when the block is built.
#[derive(Debug, Clone)]
pub struct Column {
    /// The values.
    pub values: Lanes,
    first: f64,
}

impl Column {
    /// A column that begins with `first` in every slot.
    pub fn new(first: f64) -> Self {
        Self { values: [first; LANES], first }
    }
}

impl<T: Slots> Slots for Option<Box<T>> {
    fn clear(&mut self, slot: usize) {
        self.iter_mut().for_each(|columns| columns.clear(slot));
    }
}

impl Slots for Column {
    fn clear(&mut self, slot: usize) {
        self.values[slot] = self.first;
    }
}

/// Declares a struct of columns in three groups, each of which may be left out:
///
/// - `shared`: what belongs to the block as a whole, `name: type = value`; [`Slots::clear`] does not touch it.
/// - `parts`: what has slots of its own, `name: type = value`, with a type that is [`Slots`].
/// - `columns`: `name: type of one value = first value`; the field is an array with one value per slot.
///
/// `struct Name(argument: type)` gets `new(argument)`; without arguments it gets `Default`.
macro_rules! columns {
    (
        $(#[$about:meta])*
        $visibility:vis struct $name:ident $(($($argument:ident: $argument_type:ty),*))? {
            $(shared { $($(#[$shared_about:meta])* $shared_visibility:vis $shared:ident: $shared_type:ty = $shared_value:expr,)* })?
            $(parts { $($(#[$part_about:meta])* $part_visibility:vis $part:ident: $part_type:ty = $part_value:expr,)* })?
            $(columns { $($(#[$column_about:meta])* $column_visibility:vis $column:ident: $column_type:ty = $first:expr,)* })?
        }
    ) => {
        $(#[$about])*
        $visibility struct $name {
            $($($(#[$shared_about])* $shared_visibility $shared: $shared_type,)*)?
            $($($(#[$part_about])* $part_visibility $part: $part_type,)*)?
            $($($(#[$column_about])* $column_visibility $column: [$column_type; $crate::lanes::LANES],)*)?
        }

        $crate::columns::constructor! {
            $visibility $name $(($($argument: $argument_type),*))? {
                $($($shared: $shared_value,)*)?
                $($($part: $part_value,)*)?
                $($($column: std::array::from_fn(|_| $first),)*)?
            }
        }

        impl $crate::columns::Slots for $name {
            fn clear(&mut self, slot: usize) {
                $($($crate::columns::Slots::clear(&mut self.$part, slot);)*)?
                $($(self.$column[slot] = $first;)*)?
            }
        }
    };
}
pub(crate) use columns;

/// The constructor of `columns!`.
macro_rules! constructor {
    ($visibility:vis $name:ident { $($field:ident: $value:expr,)* }) => {
        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $value,)* }
            }
        }
    };
    ($visibility:vis $name:ident ($($argument:ident: $argument_type:ty),*) { $($field:ident: $value:expr,)* }) => {
        impl $name {
            /// A block of which every slot is free.
            $visibility fn new($($argument: $argument_type),*) -> Self {
                Self { $($field: $value,)* }
            }
        }
    };
}
pub(crate) use constructor;
