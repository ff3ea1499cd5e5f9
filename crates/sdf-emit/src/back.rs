//! What naga's back ends make of the WGSL text: SPIR-V, Metal's language and HLSL.
//!
//! The program has been made total before, its loops have constant bounds and nothing is indexed at run time. So
//! naga is asked for no bounds checks, no bounds of loops and no zeros: they could only cost.

use crate::symbols::Symbols;
use crate::validate::{ValidationError, with_wgsl};
use crate::{EmitError, Header, Target, comment, print, wrapper};
use naga::back::{hlsl, msl, spv};
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};
use naga::valid::ModuleInfo;
use naga::{Module, ResourceBinding};
use sdf_ir::Program;

/// Where the uniform block is bound.
const BLOCK: ResourceBinding = ResourceBinding { group: 0, binding: 0 };

const NO_CHECKS: BoundsCheckPolicies = BoundsCheckPolicies {
    index: BoundsCheckPolicy::Unchecked,
    buffer: BoundsCheckPolicy::Unchecked,
    image_load: BoundsCheckPolicy::Unchecked,
    binding_array: BoundsCheckPolicy::Unchecked,
};

/// A module of SPIR-V 1.0, which every Vulkan takes: `vs_main`, `fs_main` and the uniform block in set 0 at binding 0,
/// with the names of functions and variables.
pub(crate) fn spir_v(program: &Program, header: &Header) -> Result<Vec<u8>, EmitError> {
    let target = spv::BindingInfo { descriptor_set: 0, binding: 0, ..spv::BindingInfo::default() };
    let options = spv::Options {
        lang_version: (1, 0),
        flags: spv::WriterFlags::DEBUG | spv::WriterFlags::LABEL_VARYINGS,
        fake_missing_bindings: false,
        binding_map: [(BLOCK, target)].into(),
        bounds_check_policies: NO_CHECKS,
        zero_initialize_workgroup_memory: spv::ZeroInitializeWorkgroupMemoryMode::None,
        force_loop_bounding: false,
        emit_int_div_checks: false,
        ..spv::Options::default()
    };
    let words = written(program, header, |module, info| {
        spv::write_vec(module, info, &options, None).map_err(text_of)
    })?;
    Ok(words.into_iter().flat_map(u32::to_le_bytes).collect())
}

/// A text in the Metal Shading Language 2.0 (macOS 10.13, iOS 11): `vs_main`, and `fs_main` with the uniform block in
/// buffer 0.
pub(crate) fn metal(program: &Program, header: &Header) -> Result<String, EmitError> {
    let target = msl::BindTarget { buffer: Some(0), ..msl::BindTarget::default() };
    let resources = msl::EntryPointResources {
        resources: [(BLOCK, target)].into(),
        ..msl::EntryPointResources::default()
    };
    let entries = ["vs_main", "fs_main"].map(|name| (name.to_owned(), resources.clone()));
    let options = msl::Options {
        lang_version: (2, 0),
        per_entry_point_map: entries.into(),
        fake_missing_bindings: false,
        bounds_check_policies: NO_CHECKS,
        zero_initialize_workgroup_memory: false,
        force_loop_bounding: false,
        emit_int_div_checks: false,
        ..msl::Options::default()
    };
    let pipeline = msl::PipelineOptions::default();
    let (text, reflection) = written(program, header, |module, info| {
        msl::write_string(module, info, &options, &pipeline).map_err(text_of)
    })?;
    must_have_entries(reflection.entry_point_names)?;
    Ok(headed(program, header, "buffer(0) of fs_main", text))
}

/// A text in HLSL of shader model 5.0, which Direct3D 11 and 12 both take: `vs_main`, `fs_main`, and the uniform block
/// in register b0.
pub(crate) fn hlsl(program: &Program, header: &Header) -> Result<String, EmitError> {
    let target = hlsl::BindTarget { space: 0, register: 0, ..hlsl::BindTarget::default() };
    let options = hlsl::Options {
        shader_model: hlsl::ShaderModel::V5_0,
        binding_map: [(BLOCK, target)].into(),
        fake_missing_bindings: false,
        zero_initialize_workgroup_memory: false,
        restrict_indexing: false,
        force_loop_bounding: false,
        ..hlsl::Options::default()
    };
    let pipeline = hlsl::PipelineOptions::default();
    let (text, reflection) = written(program, header, |module, info| {
        let mut text = String::new();
        let reflection =
            hlsl::Writer::new(&mut text, &options, &pipeline).write(module, info, None).map_err(text_of)?;
        Ok((text, reflection))
    })?;
    must_have_entries(reflection.entry_point_names)?;
    Ok(headed(program, header, "register(b0)", text))
}

/// The text with our head above it.
fn headed(program: &Program, header: &Header, binding: &str, text: String) -> String {
    let symbols = Symbols::of(program, Target::Wgsl);
    let block = wrapper::described(program, &symbols, binding, ["uint", "float", "float2", "float3"]);
    let lines = header.lines.iter().chain(&block).map(|line| comment(line) + "\n");
    lines.collect::<String>() + "\n" + &text
}

/// What a back end makes of the program's WGSL text.
fn written<T: Send>(
    program: &Program,
    header: &Header,
    write: impl FnOnce(&Module, &ModuleInfo) -> Result<T, String> + Send,
) -> Result<T, EmitError> {
    let text = print(program, Target::Wgsl, header)?;
    with_wgsl(&text, write).map_err(EmitError::Invalid)
}

fn text_of(error: impl std::error::Error) -> String {
    error.to_string()
}

/// Both entries must have been written, under their own names.
fn must_have_entries(names: Vec<Result<String, impl std::error::Error>>) -> Result<(), EmitError> {
    let names: Vec<String> =
        names.into_iter().map(|name| name.unwrap_or_else(|error| error.to_string())).collect();
    if names == ["vs_main", "fs_main"] {
        return Ok(());
    }
    Err(EmitError::Invalid(ValidationError { message: format!("the entries are {}", names.join(", ")) }))
}
