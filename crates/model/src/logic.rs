//! Discrete logic for a number type: counts of samples, named states, sets of safety functions, and decisions between them.
//!
//! Of a plain number these are `u32`, the enumeration itself, [`Functions`] and `bool`, and a decision is an `if`. A number that writes
//! down its operations keeps them open: [`Logic::paths`] runs the same lines once for each way through them, and writes down which
//! of the results holds where.

use crate::Scalar;
use crate::memory::MemoryVisitor;
pub use crate::named::Named;
use crate::supervisor::{Action, Function, Functions};
use core::fmt::Debug;

/// What discrete logic asks of a number type.
pub trait Logic: Scalar {
    /// Samples in a row.
    type Count: Count<Self::Mask>;
    /// Safety functions.
    type Set: FunctionSet<Self::Mask>;
    /// One of the values of an enumeration.
    type Code<E: Named>: Copy + Debug;

    /// A condition that is known.
    fn mask(holds: bool) -> Self::Mask;
    /// Whether the condition holds: a decision. A number that keeps it open takes both ways, within [`paths`](Self::paths) alone.
    fn holds(mask: Self::Mask) -> bool;
    /// The value of an enumeration.
    fn code<E: Named>(value: E) -> Self::Code<E>;
    /// Whether a code is that of `value`.
    fn is<E: Named>(code: Self::Code<E>, value: E) -> Self::Mask;
    /// Of which value a code is: a decision, as [`holds`](Self::holds).
    fn which<E: Named>(code: Self::Code<E>) -> E;
    /// The first function of a set, in the order of the table.
    fn first(set: Self::Set) -> Self::Code<Option<Function>>;
    /// A count as a number of the kind of `self`.
    fn number(self, count: Self::Count) -> Self;
    /// Changes a state by `work`, in which decisions are taken. Only what `work` leaves in the state may depend on them.
    fn paths<M: LogicState<Self>>(state: &mut M, work: impl Fn(&mut M));
}

/// A count of samples, no more than `u32::MAX`.
pub trait Count<M>: Copy + Debug {
    /// None.
    fn none() -> Self;
    /// One more; the largest stays.
    #[must_use]
    fn next(self) -> Self;
    /// The larger of two.
    #[must_use]
    fn larger(self, other: Self) -> Self;
    /// Whether it is `samples` or more.
    fn at_least(self, samples: u32) -> M;
    /// `self` where the condition holds, else none.
    #[must_use]
    fn only(self, condition: M) -> Self;
    /// One more where the condition holds, else none.
    #[inline(always)]
    #[must_use]
    #[track_caller]
    fn in_a_row(self, condition: M) -> Self {
        self.next().only(condition)
    }

    /// Whether it is more than `samples`.
    #[inline(always)]
    #[track_caller]
    fn above(self, samples: u32) -> M
    where
        M: core::ops::Not<Output = M>,
    {
        // The largest count is not above the largest limit.
        if samples == u32::MAX { !self.at_least(0) } else { self.at_least(samples + 1) }
    }
    /// Whether it is not none.
    #[inline(always)]
    #[track_caller]
    fn some(self) -> M {
        self.at_least(1)
    }
}

/// A set of safety functions, each in it or not.
pub trait FunctionSet<M>: Copy + Debug {
    /// None of them.
    fn none() -> Self;
    /// With `function` where the condition holds.
    #[must_use]
    fn with(self, function: Function, holds: M) -> Self;
    /// Those of both.
    #[must_use]
    fn and(self, other: Self) -> Self;
    /// Whether there is one that stops the loader.
    fn stops(self) -> M;
    /// Whether there is one that does so.
    fn does(self, action: Action) -> M;
    /// Whether `function` is one of them.
    fn has(self, function: Function) -> M;
    /// Those that stop the loader.
    #[must_use]
    fn stopping(self) -> Self;
    /// Without `function`.
    #[must_use]
    fn without(self, function: Function) -> Self;
}

/// Takes the numbers, flags, counts, codes and sets of a state one after the other, to read or to replace them.
pub trait LogicVisitor<S: Logic>: MemoryVisitor<S> {
    /// A count.
    fn count(&mut self, name: &'static str, count: &mut S::Count);
    /// A code.
    fn code<E: Named>(&mut self, name: &'static str, code: &mut S::Code<E>);
    /// A set.
    fn set(&mut self, name: &'static str, set: &mut S::Set);
    /// What follows belongs to a part of this name, up to its end.
    fn begin(&mut self, name: &'static str);
    /// The end of a part.
    fn end(&mut self);
}

/// A state that can be visited.
pub trait LogicState<S: Logic>: Clone {
    /// Visits all of it, always in the same order.
    fn visit(&mut self, visitor: &mut impl LogicVisitor<S>);
}

/// Names of the places of an array.
pub const PLACES: [&str; 8] = ["0", "1", "2", "3", "4", "5", "6", "7"];

/// A row a state: what is visited of it, each by what it is.
macro_rules! memory {
    ($State:ident { $( $kind:ident $($field:ident),+; )* }) => {
        impl<S: $crate::logic::Logic> $crate::logic::LogicState<S> for $State<S> {
            #[inline]
            fn visit(&mut self, visitor: &mut impl $crate::logic::LogicVisitor<S>) {
                $( $( $crate::logic::visit!($kind visitor stringify!($field), &mut self.$field); )+ )*
            }
        }
    };
}

macro_rules! visit {
    (numbers $visitor:ident $name:expr, $field:expr) => {
        $visitor.begin($name);
        for (place, number) in $crate::logic::PLACES.into_iter().zip($field) {
            $visitor.number(place, number);
        }
        $visitor.end();
    };
    (counts $visitor:ident $name:expr, $field:expr) => {
        $visitor.begin($name);
        for (place, count) in $crate::logic::PLACES.into_iter().zip($field) {
            $visitor.count(place, count);
        }
        $visitor.end();
    };
    (part $visitor:ident $name:expr, $field:expr) => {
        $visitor.begin($name);
        $crate::logic::LogicState::visit($field, $visitor);
        $visitor.end();
    };
    (parts $visitor:ident $name:expr, $field:expr) => {
        $visitor.begin($name);
        for (place, part) in $crate::logic::PLACES.into_iter().zip($field) {
            $crate::logic::visit!(part $visitor place, part);
        }
        $visitor.end();
    };
    ($kind:ident $visitor:ident $name:expr, $field:expr) => {
        $visitor.$kind($name, $field)
    };
}

pub(crate) use {memory, visit};

impl Count<bool> for u32 {
    #[inline(always)]
    fn none() -> Self {
        0
    }
    #[inline(always)]
    fn next(self) -> Self {
        self.saturating_add(1)
    }
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        self.max(other)
    }
    #[inline(always)]
    fn at_least(self, samples: u32) -> bool {
        self >= samples
    }
    #[inline(always)]
    fn only(self, condition: bool) -> Self {
        if condition { self } else { 0 }
    }
    #[inline(always)]
    fn in_a_row(self, condition: bool) -> Self {
        if condition { self.saturating_add(1) } else { 0 }
    }
}

impl FunctionSet<bool> for Functions {
    #[inline(always)]
    fn none() -> Self {
        Self::NONE
    }
    #[inline(always)]
    fn with(self, function: Function, holds: bool) -> Self {
        Self::with(self, function, holds)
    }
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        Self::and(self, other)
    }
    #[inline(always)]
    fn stops(self) -> bool {
        !Self::stopping(self).is_empty()
    }
    #[inline(always)]
    fn does(self, action: Action) -> bool {
        !self.that(action).is_empty()
    }
    #[inline(always)]
    fn has(self, function: Function) -> bool {
        Self::has(self, function)
    }
    #[inline(always)]
    fn stopping(self) -> Self {
        Self::stopping(self)
    }
    #[inline(always)]
    fn without(self, function: Function) -> Self {
        Self::only(self, function, false)
    }
}

macro_rules! plain {
    ($type:ty) => {
        impl Logic for $type {
            type Count = u32;
            type Set = Functions;
            type Code<E: Named> = E;

            #[inline(always)]
            fn mask(holds: bool) -> bool {
                holds
            }
            #[inline(always)]
            fn holds(mask: bool) -> bool {
                mask
            }
            #[inline(always)]
            fn code<E: Named>(value: E) -> E {
                value
            }
            #[inline(always)]
            fn is<E: Named>(code: E, value: E) -> bool {
                code == value
            }
            #[inline(always)]
            fn which<E: Named>(code: E) -> E {
                code
            }
            #[inline(always)]
            fn first(set: Functions) -> Option<Function> {
                set.first()
            }
            #[inline(always)]
            fn number(self, count: u32) -> Self {
                // It is zero but where some samples did not come, and a board need not convert that.
                if count == 0 { 0.0 } else { self.constant(f64::from(count)) }
            }
            #[inline(always)]
            fn paths<M: LogicState<Self>>(state: &mut M, work: impl Fn(&mut M)) {
                work(state);
            }
        }
    };
}

plain!(f64);
plain!(f32);
