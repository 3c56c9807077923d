//! Parts of the feel that depend on the displacement alone, beside its spring: forces at the grip that add up.
//!
//! A part is one row: when it acts, its coefficients, its equation. Its numbers are rows of the table of parameters, and nothing else
//! knows of it: the step, the statics, the exported C and what holds a control at rest follow.

use crate::Scalar;
use crate::parameters::Feel;

/// Units in which a feel is computed.
#[derive(Debug, Clone, Copy)]
pub struct FeelUnits<S> {
    /// `mu R_p`: torque per force at the grip.
    pub grip_force: S,
    /// `lambda`: unit of the displacement per radian.
    pub per_angle: S,
}

/// Where a feel stands, in the unit of its displacement.
#[derive(Debug, Clone, Copy)]
pub struct FeelPlace<S> {
    /// Displacement from the trimmed neutral.
    pub from_neutral: S,
    /// Displacement.
    pub delta: S,
    /// Slider of the hysteresis.
    pub slider: S,
}

/// One row a part: meaning, name, type of its coefficients; the parameter that makes it act; `biased` where it pushes a control that rests
/// at neutral; its coefficients and its torque.
macro_rules! parts {
    (
        ($feel:ident, $units:ident, $own:ident, $at:ident)
        $( $(#[doc = $doc:literal])+ $name:ident: $type:ty, if $row:ident $($biased:ident)?: $coefficients:expr => $torque:expr; )*
    ) => {
        /// The parts of one feel.
        #[derive(Debug, Clone, Copy)]
        pub struct FeelParts<S> { $( $(#[doc = $doc])+ pub $name: $type, )* }

        impl<S: Scalar> FeelParts<S> {
            /// The coefficients of a feel.
            #[inline(always)]
            pub fn new($feel: &Feel<S>, $units: FeelUnits<S>) -> Self {
                Self { $( $name: $coefficients, )* }
            }

            /// Torque of all parts.
            #[inline(always)]
            pub fn torque(&self, $at: &FeelPlace<S>) -> S {
                parts!(@sum $( { let $own = &self.$name; $torque } )*)
            }
        }

        impl Feel<f64> {
            /// Whether a part acts.
            pub fn has_parts(&self) -> bool {
                [$( self.$row, )*].iter().any(|&number| number != 0.0)
            }

            /// Whether a part pushes a control that rests at neutral.
            pub fn has_biased_parts(&self) -> bool {
                false $( || parts!(@biased self.$row $(, $biased)?) )*
            }
        }
    };
    (@sum $first:block $( $other:block )*) => { $first $( + $other )* };
    (@biased $number:expr, biased) => { $number != 0.0 };
    (@biased $number:expr) => { false };
}

parts! {
    (feel, units, own, at)

    /// Breakout: force that it takes to leave neutral.
    breakout: Ramp<S>, if breakout:
        Ramp::new(feel.breakout * units.grip_force, feel.breakout_travel * units.per_angle)
        => own.held(at.from_neutral);
    /// Detent, and its place.
    detent: (Ramp<S>, S), if detent_force biased:
        (
            Ramp::new(feel.detent_force * units.grip_force, feel.detent_travel * units.per_angle),
            feel.detent_angle * units.per_angle,
        )
        => own.0.passed(at.delta - own.1);
    /// Hysteresis: force by which the way and the way back differ from their mean.
    hysteresis: Ramp<S>, if hysteresis:
        Ramp::new(feel.hysteresis * units.grip_force, feel.hysteresis_travel * units.per_angle)
        => own.held(at.delta - at.slider);
}

/// A force that builds up over a travel.
#[derive(Debug, Clone, Copy)]
pub struct Ramp<S> {
    slope: S,
    /// Travel over which it builds up.
    pub travel: S,
}

impl<S: Scalar> Ramp<S> {
    /// The full force, and the travel over which it builds up.
    #[inline(always)]
    pub fn new(force: S, travel: S) -> Self {
        Self { slope: force / travel, travel }
    }

    /// Up to the full force, and no further: `(|x + t| - |x - t|) / 2` is `x` within `t`. Magnitudes cost a small processor less than
    /// comparisons.
    #[inline(always)]
    pub fn held(&self, x: S) -> S {
        self.slope.times(0.5) * ((x + self.travel).abs() - (x - self.travel).abs())
    }

    /// Up to the full force and back to nothing after as much travel again: `min(|x|, 2 t - |x|)` is `z = t - |t - |x||`, and of that
    /// `max(z, 0)` is `(z + |z|) / 2`.
    #[inline(always)]
    pub fn passed(&self, x: S) -> S {
        let height = self.travel - (self.travel - x.abs()).abs();
        self.slope.times(0.5) * (height + height.abs()).times_sign(x)
    }
}
