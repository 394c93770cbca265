//! A stage: one compiled entry point, and its bindings.

use std::sync::Arc;

use super::field::Counted;
use super::{Buffer, Gpu, GpuError, Sampler, Shader, Texture};

/// A compiled compute pipeline with its three bind group layouts.
pub(super) struct Pipeline {
    text: String,
    pub(super) pipeline: wgpu::ComputePipeline,
    workgroup: [u32; 3],
}

/// A stage that can be bound and dispatched.
#[derive(Clone)]
pub struct Stage {
    label: String,
    pipeline: Arc<Pipeline>,
}

/// One resource in a list of inputs or outputs.
#[derive(Clone, Copy)]
pub enum Bind<'a> {
    /// A texture, sampled, loaded or written as the shader says.
    Texture(&'a Texture),
    /// A whole buffer.
    Buffer(&'a Buffer),
    /// A sampler.
    Sampler(&'a Sampler),
}

impl<'a> Bind<'a> {
    fn counted(&self) -> Option<Arc<Counted>> {
        match self {
            Bind::Texture(texture) => Some(Arc::clone(&texture.counted)),
            Bind::Buffer(buffer) => Some(Arc::clone(&buffer.counted)),
            Bind::Sampler(_) => None,
        }
    }

    fn resource(&self) -> wgpu::BindingResource<'a> {
        match *self {
            Bind::Texture(texture) => wgpu::BindingResource::TextureView(&texture.view),
            Bind::Buffer(buffer) => buffer.buffer.as_entire_binding(),
            Bind::Sampler(sampler) => wgpu::BindingResource::Sampler(&sampler.0),
        }
    }
}

/// A stage with its resources, ready to be dispatched any number of times.
pub struct Bound {
    pub(super) label: String,
    pub(super) pipeline: Arc<Pipeline>,
    /// Or why they could not be made, which the recorder tells.
    pub(super) groups: Result<[wgpu::BindGroup; 3], GpuError>,
    /// The bind groups keep their fields alive, so these stay on the account.
    _held: Vec<Arc<Counted>>,
}

impl Gpu {
    /// The stage of `shaders/NAME.wgsl` with the given import choices; compiled once.
    ///
    /// # Errors
    /// [`GpuError::Shader`] names file and line.
    pub fn stage(&self, name: &str, choices: &[(&str, String)]) -> Result<Stage, GpuError> {
        let shader = Shader::expand(&format!("{name}.wgsl"), choices)?;
        let key = format!("{name} {choices:?}");
        let known = self.pipelines.lock().unwrap().get(&key).cloned();
        let pipeline = match known {
            Some(pipeline) if pipeline.text == shader.text => pipeline,
            _ => {
                let pipeline = Arc::new(self.compile(name, shader)?);
                self.pipelines.lock().unwrap().insert(key, Arc::clone(&pipeline));
                pipeline
            }
        };
        Ok(Stage { label: name.to_owned(), pipeline })
    }

    fn compile(&self, name: &str, shader: Shader) -> Result<Pipeline, GpuError> {
        let module = shader.validate()?;
        let workgroup = module.entry_points[0].workgroup_size;
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(name),
            source: wgpu::ShaderSource::Wgsl(shader.text.as_str().into()),
        });
        let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(name),
            layout: None,
            module: &module,
            entry_point: None,
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        if let Some(error) = pollster::block_on(scope.pop()) {
            return Err(GpuError::Shader(format!("shaders/{name}.wgsl: {error}")));
        }
        Ok(Pipeline { text: shader.text, pipeline, workgroup })
    }
}

impl Stage {
    /// Binds parameters (group 0, binding 0), inputs (group 1) and outputs (group 2). Where the device has
    /// no room for the parameters, the recorder that is given the stage says so.
    pub fn bind<P: bytemuck::Pod>(&self, gpu: &Gpu, params: &P, inputs: &[Bind], outputs: &[Bind]) -> Bound {
        let mut held: Vec<Arc<Counted>> = inputs.iter().chain(outputs).filter_map(Bind::counted).collect();
        let groups = self.uniform(gpu, bytemuck::bytes_of(params)).map(|uniform| {
            held.push(Arc::clone(&uniform.counted));
            let binds = [&[Bind::Buffer(&uniform)], inputs, outputs];
            std::array::from_fn(|idx| self.group(gpu, idx as u32, binds[idx]))
        });
        Bound { label: self.label.clone(), pipeline: Arc::clone(&self.pipeline), groups, _held: held }
    }

    fn uniform(&self, gpu: &Gpu, contents: &[u8]) -> Result<Buffer, GpuError> {
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        // Sizes of copies are multiples of 4, and so are those of all parameters.
        let uniform = gpu.allocate(&self.label, contents.len() as u64, usage, "")?;
        gpu.queue.write_buffer(&uniform.buffer, 0, contents);
        Ok(uniform)
    }

    fn group(&self, gpu: &Gpu, index: u32, binds: &[Bind]) -> wgpu::BindGroup {
        let entries: Vec<wgpu::BindGroupEntry> = binds
            .iter()
            .enumerate()
            .map(|(idx, bind)| wgpu::BindGroupEntry { binding: idx as u32, resource: bind.resource() })
            .collect();
        gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(&self.label),
            layout: &self.pipeline.pipeline.get_bind_group_layout(index),
            entries: &entries,
        })
    }
}

impl Bound {
    /// Workgroups that cover `threads`.
    pub(super) fn workgroups(&self, threads: [usize; 3]) -> [u32; 3] {
        std::array::from_fn(|axis| (threads[axis] as u32).div_ceil(self.pipeline.workgroup[axis]).max(1))
    }
}
