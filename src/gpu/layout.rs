//! The check that a Rust struct and its WGSL mirror have the same members at the same offsets, and that a
//! constant which both state is the same.
//!
//! A struct that is sent to a shader is declared with [`mirror!`](crate::mirror), which keeps the
//! list of its members; the tests of each node compare that list with what naga reads from the WGSL.

use super::{GpuError, Shader};

/// A struct whose members are listed for the layout test.
pub trait Mirror {
    /// The WGSL struct's name.
    const NAME: &'static str;
    /// Members in order: name, byte offset.
    fn members() -> Vec<(&'static str, usize)>;
    /// Size in bytes.
    fn size() -> usize;
}

/// Declares a `#[repr(C)]` plain-data struct together with its [`Mirror`].
#[macro_export]
macro_rules! mirror {
    ($(#[$doc:meta])* $vis:vis struct $name:ident { $($(#[$member_doc:meta])* $member:ident : $kind:ty,)* }) => {
        $(#[$doc])*
        #[repr(C)]
        #[derive(Debug, Clone, Copy, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
        $vis struct $name { $($(#[$member_doc])* pub $member: $kind,)* }

        impl $crate::gpu::Mirror for $name {
            const NAME: &'static str = stringify!($name);

            fn members() -> Vec<(&'static str, usize)> {
                vec![$((stringify!($member), std::mem::offset_of!($name, $member)),)*]
            }

            fn size() -> usize {
                std::mem::size_of::<$name>()
            }
        }
    };
}

/// Members (name, offset) and size of a struct in an expanded shader, as naga lays them out.
///
/// # Errors
/// [`GpuError::Shader`] where the shader is invalid or has no such struct.
pub fn wgsl_members(shader: &Shader, name: &str) -> Result<(Vec<(String, usize)>, usize), GpuError> {
    let module = shader.validate()?;
    let found = module.types.iter().find_map(|(_, kind)| match &kind.inner {
        naga::TypeInner::Struct { members, span } if kind.name.as_deref() == Some(name) => Some((
            members
                .iter()
                .map(|member| (member.name.clone().unwrap_or_default(), member.offset as usize))
                .collect(),
            *span as usize,
        )),
        _ => None,
    });
    found.ok_or_else(|| GpuError::Shader(format!("no struct {name} in the shader")))
}

/// The number, or the numbers of the vector, that an expanded shader declares as `const NAME`.
///
/// # Errors
/// [`GpuError::Shader`] where the shader is invalid or has no such numbers.
pub fn wgsl_constant(shader: &Shader, name: &str) -> Result<Vec<f64>, GpuError> {
    let module = shader.validate()?;
    let found = module.constants.iter().find(|(_, constant)| constant.name.as_deref() == Some(name));
    let values = found.and_then(|(_, constant)| numbers(&module, constant.init));
    values.ok_or_else(|| GpuError::Shader(format!("no number or vector {name} in the shader")))
}

fn numbers(module: &naga::Module, value: naga::Handle<naga::Expression>) -> Option<Vec<f64>> {
    use naga::Literal::{F32, I32, U32};
    match &module.global_expressions[value] {
        naga::Expression::Literal(F32(value)) => Some(vec![f64::from(*value)]),
        naga::Expression::Literal(I32(value)) => Some(vec![f64::from(*value)]),
        naga::Expression::Literal(U32(value)) => Some(vec![f64::from(*value)]),
        naga::Expression::Compose { components, .. } => {
            let parts: Option<Vec<Vec<f64>>> = components.iter().map(|part| numbers(module, *part)).collect();
            parts.map(|parts| parts.concat())
        }
        _ => None,
    }
}
