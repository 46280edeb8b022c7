//! The declaration of tables and queues.

/// Declares a table or a queue: one column per field, and the plain row that is read and written by field name.
///
/// A `table` has as many rows as it was made with, each the state of one lane. A `queue` has a length, is filled from
/// the front and holds [`LANES`](crate::lanes::LANES) rows more than its capacity, so that eight rows can always be
/// stored at its end.
#[macro_export]
macro_rules! columns {
    (
        $(#[$doc:meta])* table $Table:ident of $Row:ident
        { $( $(#[$field_doc:meta])* $field:ident : $ty:ty ),* $(,)? }
    ) => {
        $crate::columns!(@storage $(#[$doc])* $Table $Row { $( $(#[$field_doc])* $field : $ty ),* } {});

        impl<'q> $Table<'q> {
            /// A zeroed table of at least `rows` rows.
            pub fn new_in(arena: &'q bumpalo::Bump, rows: usize) -> Self {
                Self { $( $field: <$ty as $crate::columns::Field>::column(arena, rows) ),* }
            }
        }
    };
    (
        $(#[$doc:meta])* queue $Queue:ident of $Row:ident, $Batch:ident
        { $( $(#[$field_doc:meta])* $field:ident : $ty:ty ),* $(,)? }
    ) => {
        $crate::columns!(@storage $(#[$doc])* $Queue $Row { $( $(#[$field_doc])* $field : $ty ),* } {
            /// Rows in use, counted from the front.
            pub len: usize,
            /// Rows that fit.
            pub capacity: usize,
        });

        #[doc = concat!("Eight rows of [`", stringify!($Queue), "`].")]
        #[derive(Clone, Copy)]
        pub struct $Batch { $( $(#[$field_doc])* pub $field : <$ty as $crate::columns::Field>::Batch ),* }

        impl<'q> $Queue<'q> {
            /// An empty queue for `capacity` rows.
            pub fn new_in(arena: &'q bumpalo::Bump, capacity: usize) -> Self {
                let rows = capacity + $crate::lanes::LANES;
                Self {
                    $( $field: <$ty as $crate::columns::Field>::column(arena, rows), )*
                    len: 0,
                    capacity,
                }
            }

            /// Appends a row.
            ///
            /// # Panics
            /// If the queue is full: capacities follow from the wavefront's size, so this is a design error.
            pub fn push(&mut self, row: $Row) {
                assert!(self.len < self.capacity, concat!(stringify!($Queue), " overflows its {} rows"), self.capacity);
                self.set_row(self.len, row);
                self.len += 1;
            }

            /// Overwrites batch `b`.
            #[inline(always)]
            pub fn set_batch(&mut self, b: usize, batch: $Batch) {
                $( <$ty as $crate::columns::Field>::set_batch(&mut self.$field, b, batch.$field); )*
            }

            /// Appends the rows of `batch` whose bit is set in `bits`, in lane order.
            ///
            /// # Panics
            /// If they do not fit, as [`Self::push`].
            #[inline(always)]
            pub fn push_batch(&mut self, bits: u32, batch: $Batch) {
                if bits == 0 {
                    return;
                }
                assert!(
                    self.len + bits.count_ones() as usize <= self.capacity,
                    concat!(stringify!($Queue), " overflows its {} rows"), self.capacity
                );
                self.store_packed(self.len, $crate::lanes::pack_order(bits), batch);
                self.len += bits.count_ones() as usize;
            }

            /// Overwrites eight rows from row `at` on with those of `batch` in the sequence `order`.
            #[inline(always)]
            pub fn store_packed(&mut self, at: usize, order: wide::u32x8, batch: $Batch) {
                $( <$ty as $crate::columns::Field>::store_packed(&mut self.$field, at, order, batch.$field); )*
            }
        }
    };
    (
        @storage $(#[$doc:meta])* $Table:ident $Row:ident
        { $( $(#[$field_doc:meta])* $field:ident : $ty:ty ),* } { $($extra:tt)* }
    ) => {
        $(#[$doc])*
        pub struct $Table<'q> {
            $( $(#[$field_doc])* pub $field : <$ty as $crate::columns::Field>::Column<'q>, )*
            $($extra)*
        }

        #[doc = concat!("One row of [`", stringify!($Table), "`].")]
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $Row { $( $(#[$field_doc])* pub $field : $ty ),* }

        impl $Table<'_> {
            /// Reads row `row`.
            #[inline]
            pub fn row(&self, row: usize) -> $Row {
                $Row { $( $field: <$ty as $crate::columns::Field>::row(&self.$field, row) ),* }
            }

            /// Overwrites row `row`.
            #[inline]
            pub fn set_row(&mut self, row: usize, value: $Row) {
                $( <$ty as $crate::columns::Field>::set_row(&mut self.$field, row, value.$field); )*
            }
        }

        impl $crate::columns::ColumnSet for $Table<'_> {
            fn visit(&self, visit: &mut dyn FnMut(&'static str, $crate::columns::ColumnRef<'_>)) {
                $( <$ty as $crate::columns::Field>::visit(
                    &self.$field, &mut |column| visit(stringify!($field), column),
                ); )*
            }

            fn visit_mut(&mut self, visit: &mut dyn FnMut(&'static str, $crate::columns::ColumnMut<'_>)) {
                $( <$ty as $crate::columns::Field>::visit_mut(
                    &mut self.$field, &mut |column| visit(stringify!($field), column),
                ); )*
            }
        }
    };
}
