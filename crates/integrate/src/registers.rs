//! The vector registers that kernels run on: the widest of the processor, or narrower ones by request.
//!
//! Instruction sets round differently: AVX-512 has estimates of roots, and SSE2 no product and sum in one. A computation is
//! repeated to the last bit on the set that it was made on, which the environment may ask for.

use std::fmt;
use std::str::FromStr;
use std::sync::OnceLock;

use pulp::{Arch, Scalar128b, Simd, WithSimd};

/// A set of vector instructions that kernels are compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum InstructionSet {
    /// The least of the target: two lanes, SSE2 on x86-64.
    Baseline,
    /// Two lanes of ARM processors, with product and sum in one.
    Neon,
    /// Two lanes of browsers.
    Simd128,
    /// Four lanes: AVX2 with product and sum in one (x86-64-v3).
    Avx2,
    /// Eight lanes: AVX-512 F, BW, CD, DQ and VL (x86-64-v4).
    Avx512,
}

/// Why the set that the environment asks for cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{} = `{asked}`, must be one of {allowed}: the sets that this processor has and this build knows; unset it for the widest",
    InstructionSet::VARIABLE
)]
pub struct InstructionSetError {
    asked: String,
    allowed: String,
}

/// Handle to the registers of a set, which the processor has.
#[derive(Clone, Copy, Debug)]
pub struct Registers(Arch);

impl InstructionSet {
    /// Variable of the environment that lowers the set; read once, at the first use.
    pub const VARIABLE: &str = "CHAINDRIVE_INSTRUCTION_SET";

    /// All sets, from narrow to wide.
    pub const ALL: [Self; 5] = [
        Self::Baseline,
        Self::Neon,
        Self::Simd128,
        Self::Avx2,
        Self::Avx512,
    ];

    /// Name in results and in the environment.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Baseline if cfg!(target_arch = "x86_64") => "sse2",
            Self::Baseline => "baseline",
            Self::Neon => "neon",
            Self::Simd128 => "simd128",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// The sets that kernels of this build are compiled for.
    pub fn built() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(|set| match set {
            Self::Baseline => true,
            Self::Neon => cfg!(target_arch = "aarch64"),
            Self::Simd128 => cfg!(target_arch = "wasm32"),
            Self::Avx2 | Self::Avx512 => cfg!(target_arch = "x86_64"),
        })
    }

    /// Those that the processor has as well.
    pub fn available() -> impl Iterator<Item = Self> {
        Self::built().filter(|&set| Registers::of(set).is_some())
    }

    /// Those of them that are narrower than the one in use, the widest first.
    pub fn narrower() -> impl Iterator<Item = Self> {
        let own = Registers::in_use().set();
        let sets = Self::ALL.into_iter().rev();
        sets.filter(move |&set| set < own && Registers::of(set).is_some())
    }

    /// The set that this process uses: the widest, or the one that [`VARIABLE`](Self::VARIABLE) names.
    ///
    /// # Errors
    /// The environment asks for a set that is unknown, or that the processor does not have.
    pub fn in_use() -> Result<Self, &'static InstructionSetError> {
        chosen().as_ref().map(|it| it.set())
    }
}

impl fmt::Display for InstructionSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for InstructionSet {
    type Err = InstructionSetError;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        let names = || Self::available().map(Self::name);
        Self::available()
            .find(|set| set.name() == name)
            .ok_or_else(|| InstructionSetError {
                asked: name.to_owned(),
                allowed: names().collect::<Vec<_>>().join(", "),
            })
    }
}

impl Registers {
    /// The registers that this process uses. What the environment asks for in vain is refused where a run starts
    /// ([`Method::start`](crate::Method::start)), and does not count here.
    pub fn in_use() -> Self {
        chosen().as_ref().map_or_else(|_| Self::widest(), |it| *it)
    }

    /// The registers of a set, if the processor has them and the build knows them.
    pub fn of(set: InstructionSet) -> Option<Self> {
        match set {
            InstructionSet::Baseline => Some(Self(Arch::Scalar)),
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx2 => pulp::x86::V3::try_new().map(|it| Self(Arch::V3(it))),
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx512 => pulp::x86::V4::try_new().map(|it| Self(Arch::V4(it))),
            #[cfg(target_arch = "aarch64")]
            InstructionSet::Neon => pulp::aarch64::Neon::try_new().map(|it| Self(Arch::Neon(it))),
            #[cfg(target_arch = "wasm32")]
            InstructionSet::Simd128 => {
                pulp::wasm::Simd128::try_new().map(|it| Self(Arch::Simd128(it)))
            }
            _ => None,
        }
    }

    fn widest() -> Self {
        Self(Arch::new())
    }

    /// The set that they belong to.
    pub fn set(self) -> InstructionSet {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            Arch::V4(_) => InstructionSet::Avx512,
            #[cfg(target_arch = "x86_64")]
            Arch::V3(_) => InstructionSet::Avx2,
            #[cfg(target_arch = "aarch64")]
            Arch::Neon(_) => InstructionSet::Neon,
            #[cfg(target_arch = "wasm32")]
            Arch::Simd128(_) => InstructionSet::Simd128,
            _ => InstructionSet::Baseline,
        }
    }

    /// Runs a loop on them. SSE2, which the library does not name, has two lanes.
    #[inline]
    pub fn dispatch<Op: WithSimd>(self, op: Op) -> Op::Output {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            Arch::V4(simd) => Simd::vectorize(simd, op),
            #[cfg(target_arch = "x86_64")]
            Arch::V3(simd) => Simd::vectorize(simd, op),
            #[cfg(target_arch = "aarch64")]
            Arch::Neon(simd) => Simd::vectorize(simd, op),
            #[cfg(target_arch = "wasm32")]
            Arch::Simd128(simd) => Simd::vectorize(simd, op),
            // The arms stand here, and not in the library, so that no loop is compiled for its single lane.
            _ => op.with_simd(Scalar128b),
        }
    }
}

/// Declares a loop that is compiled for every instruction set, as a function that makes an operation of its arguments.
///
/// ```text
/// kernel!(
///     /// Twice as much.
///     fn doubled<'a, S: Simd>(_simd: S, numbers: &'a mut [f64]) { … }
/// );
/// registers.dispatch(doubled(&mut numbers));
/// ```
///
/// The loop is generic over the registers S, and over constants before and one type after them. Its first argument is made of the
/// registers, which stand in no call. Where a kernel calls another loop, [`pulp::Simd::vectorize`] takes the place of
/// [`dispatch`](Registers::dispatch).
#[macro_export]
macro_rules! kernel {
    (@found) => { () };
    (@found $found:ty) => { $found };
    (
        $(#[$about:meta])*
        $vis:vis fn $name:ident<
            $($life:lifetime,)* $(const $count:ident: $number:ty,)* S: Simd $(, $kind:ident: $bound:path)?
        >(
            $lanes:ident: $made:ty $(, $(#[$of:meta])* $given:ident: $type:ty)* $(,)?
        ) $(-> $found:ty)? $body:block
    ) => {
        $(#[$about])*
        #[inline(always)]
        $vis fn $name<$($life,)* $(const $count: $number,)* $($kind: $bound)?>(
            $($given: $type),*
        ) -> impl pulp::WithSimd<Output = $crate::kernel!(@found $($found)?)> {
            struct Loop<$($life,)* $(const $count: $number,)* $($kind: $bound)?> {
                $($(#[$of])* $given: $type,)*
            }

            impl<$($life,)* $(const $count: $number,)* $($kind: $bound)?> pulp::WithSimd
                for Loop<$($life,)* $($count,)* $($kind)?>
            {
                type Output = $crate::kernel!(@found $($found)?);

                // A loop that is not inlined here is compiled for the oldest processor.
                #[inline(always)]
                fn with_simd<S: pulp::Simd>(self, simd: S) -> Self::Output {
                    let Self { $($given),* } = self;
                    let $lanes = <$made>::from(simd);
                    $body
                }
            }

            Loop::<$($life,)* $($count,)* $($kind)?> { $($given),* }
        }
    };
}

fn chosen() -> &'static Result<Registers, InstructionSetError> {
    static CHOSEN: OnceLock<Result<Registers, InstructionSetError>> = OnceLock::new();
    CHOSEN.get_or_init(|| {
        let Some(asked) = std::env::var_os(InstructionSet::VARIABLE) else {
            return Ok(Registers::widest());
        };
        let set: InstructionSet = asked.to_string_lossy().parse()?;
        Ok(Registers::of(set).expect("what is available can be had"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every available set leads to its registers, and these back to it.
    #[test]
    fn names_lead_to_registers_and_back() {
        for set in InstructionSet::available() {
            assert_eq!(set.name().parse(), Ok(set));
            assert_eq!(Registers::of(set).unwrap().set(), set);
        }
        assert_eq!(
            InstructionSet::available().last(),
            Some(Registers::widest().set())
        );
    }

    #[test]
    fn an_unknown_set_is_told_with_those_there_are() {
        let error = "mmx".parse::<InstructionSet>().unwrap_err().to_string();
        let baseline = InstructionSet::Baseline.name();
        assert!(
            error.starts_with("CHAINDRIVE_INSTRUCTION_SET = `mmx`"),
            "{error}"
        );
        assert!(error.contains(baseline), "{error}");
    }
}
