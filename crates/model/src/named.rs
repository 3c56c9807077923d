//! Enumerations whose values have names.

use core::fmt::Debug;

/// An enumeration whose values have names.
pub trait Named: Copy + PartialEq + Debug + 'static {
    /// All values, in their order.
    const ALL: &'static [Self];
    /// The name of a value.
    fn name(self) -> &'static str;
}
