//! The memory of a controller, a number at a time.

use crate::Scalar;

/// Takes the numbers of a memory one after the other, to read or to replace them.
pub trait MemoryVisitor<S: Scalar> {
    /// A number.
    fn number(&mut self, name: &'static str, number: &mut S);

    /// A number that a linear loop about neutral does not depend on.
    #[inline(always)]
    fn nonlinear(&mut self, name: &'static str, number: &mut S) {
        self.number(name, number);
    }

    /// A state that holds or not, on which no linear loop depends.
    fn flag(&mut self, name: &'static str, flag: &mut S::Mask);
}
