//! Shader text: `#import` expansion, the map from expanded lines to source lines, hot reload.
//!
//! `#import "lib/phase.wgsl"` pastes a file once, textually. A name in braces is filled in from
//! the stage's choices: `#import "lib/spectrum_{channels}.wgsl"` becomes `spectrum_1` or
//! `spectrum_3`, `texture_storage_3d<{format}, write>` any format. In debug builds the files are read from
//! the source folder each time, so that an edit shows at once; a release carries them.

use std::borrow::Cow;

use super::GpuError;

#[derive(rust_embed::RustEmbed)]
#[folder = "shaders"]
#[include = "*.wgsl"]
struct Files;

/// An expanded shader.
#[derive(Debug, Clone)]
pub struct Shader {
    /// The whole text.
    pub text: String,
    lines: Vec<(String, usize)>,
}

impl Shader {
    /// Expands `name` (`raymarch.wgsl`) with the given choices.
    ///
    /// # Errors
    /// [`GpuError::Shader`] names the file and line of an import that cannot be resolved.
    pub fn expand(name: &str, choices: &[(&str, String)]) -> Result<Self, GpuError> {
        let mut shader = Self { text: String::new(), lines: Vec::new() };
        shader.paste(name, choices, &mut Vec::new(), "the stage list", 0)?;
        Ok(shader)
    }

    fn paste(
        &mut self,
        name: &str,
        choices: &[(&str, String)],
        seen: &mut Vec<String>,
        from: &str,
        from_line: usize,
    ) -> Result<(), GpuError> {
        if seen.iter().any(|done| done == name) {
            return Ok(());
        }
        seen.push(name.to_owned());
        let text = shader_text(name)
            .ok_or_else(|| GpuError::Shader(format!("{from}:{from_line}: no shader file '{name}'")))?;
        for (idx, line) in text.lines().enumerate() {
            let mut line = Cow::Borrowed(line);
            for (key, value) in choices {
                let placeholder = format!("{{{key}}}");
                if line.contains(&placeholder) {
                    line = Cow::Owned(line.replace(&placeholder, value));
                }
            }
            if let Some(rest) = line.trim().strip_prefix("#import ") {
                let path = rest.trim().trim_matches('"');
                self.paste(path, choices, seen, name, idx + 1)?;
            } else {
                self.text.push_str(&line);
                self.text.push('\n');
                self.lines.push((name.to_owned(), idx + 1));
            }
        }
        Ok(())
    }

    /// File and line of a line (from 1) of the expanded text.
    pub fn source(&self, line: usize) -> (&str, usize) {
        self.lines.get(line.saturating_sub(1)).map_or(("?", 0), |(file, line)| (file, *line))
    }

    /// Parses and validates the text as wgpu would.
    ///
    /// # Errors
    /// [`GpuError::Shader`] with the file and line of the source, not of the expanded text.
    pub fn validate(&self) -> Result<naga::Module, GpuError> {
        let at = |line: Option<u32>, what: String| {
            let (file, line) = self.source(line.unwrap_or(1) as usize);
            GpuError::Shader(format!("shaders/{file}:{line}: {what}"))
        };
        let module = naga::front::wgsl::parse_str(&self.text).map_err(|error| {
            let line = error.location(&self.text).map(|place| place.line_number);
            at(line, error.message().to_owned())
        })?;
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::all())
            .validate(&module)
            .map_err(|error| {
                let line = error.location(&self.text).map(|place| place.line_number);
                at(line, error.into_inner().to_string())
            })?;
        Ok(module)
    }
}

/// The text of one shader file as it stands, before expansion.
pub fn shader_text(name: &str) -> Option<String> {
    let file = Files::get(name)?;
    let text: Cow<'_, str> = String::from_utf8_lossy(&file.data);
    Some(text.into_owned())
}

/// All shader files, in order of their names.
pub fn shader_names() -> Vec<String> {
    let mut names: Vec<String> = Files::iter().map(|name| name.into_owned()).collect();
    names.sort();
    names
}
