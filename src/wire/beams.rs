//! Uncollided light in a medium: a list of beams and the optical depth that each has come through.

use std::sync::Arc;

use glam::DVec3;

use super::{Channels, LightField, RadialGrids};
use crate::gpu::{Bind, Buffer, Format, Gpu, GpuError, Recorder, Texture};
use crate::light::Window;
use crate::mirror;
use crate::optics::octahedral;
use crate::volume::Lattice;

/// Where a beam comes from, in index space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Place {
    /// Unit direction of travel.
    Parallel(DVec3),
    /// Position of the light.
    Point(DVec3),
}

/// One light in the medium.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beam {
    /// Direction or position.
    pub place: Place,
    /// Irradiance [W/m²] of a parallel beam, intensity [W/sr] of a point light.
    pub power: [f64; 3],
    /// Spread of the region it stands for, in (0, 1].
    pub a0: f64,
    /// Where its forward share comes from the environment's stack.
    pub window: Option<Window>,
    /// Of a point that shines by the cosine the unit vector that it faces; its power is then the mean intensity.
    pub facing: Option<DVec3>,
}

/// Beams with their optical depths.
#[derive(Clone)]
pub struct Beams {
    /// The lights, in the order of the atlas.
    pub beams: Vec<Beam>,
    /// tau at the corners of cells; `None` where no light is looked up, or a run was only foretold.
    pub tau: Option<TauAtlas>,
    /// Radiance from everywhere, which needs no beams [W/(m² sr)].
    pub ambient: [f64; 3],
    /// The grid of the medium that they went through.
    pub lattice: Lattice,
    /// Whether surfaces were in the way: only then are corners of the atlas marked as hidden
    /// (`shaders/lib/shadow.wgsl`).
    pub has_shadows: bool,
    /// Whether their forward peaks widen as they go.
    pub widens: bool,
    /// Depths by which E\* = E exp(−k tau) where the peak widens; without them, those of `tau`.
    pub peak: Option<TauAtlas>,
    /// Whether light goes to and fro along parallel beams (`optics/backward.rs`).
    pub returns: bool,
    /// The depths that are ahead of such light at the corners; `None` also where a run was only foretold.
    pub ahead: Option<TauAtlas>,
    /// The last so many of the beams have no depths at corners, but on grids of their own.
    pub n_radial: usize,
    /// Those grids; `None` where there are none, or a run was only foretold.
    pub radial: Option<RadialGrids>,
    /// Light that is known already, besides the beams; the residual hands it on to the camera.
    pub fields: Vec<LightField>,
}

/// The depths of beams as stages read them.
pub struct Depths {
    /// Of light that nothing has scattered.
    pub tau: TauAtlas,
    /// Of the light that is counted as not scattered: the same, where the peak does not widen.
    pub star: TauAtlas,
    /// Ahead of the light, where it comes back; else nothing that is read.
    pub ahead: TauAtlas,
}

/// Optical depths at the corners of cells. One or two beams have a 32-bit texel each; of more, four share a
/// texel of half floats (an error of at most 5e-4 tau exp(-tau)), which costs a sample the same as one
/// beam. Packs stand one beyond the other along z, then along y.
#[derive(Clone)]
pub struct TauAtlas {
    /// The texels.
    pub texture: Arc<Texture>,
    /// Corners of cells along x, y, z.
    pub corners: [usize; 3],
    /// Packs that stand along z.
    pub packs_per_column: usize,
    /// Beams that share a texel: 1 or 4.
    pub pack: usize,
}

mirror! {
    /// `Beam` of `shaders/lib/beam.wgsl`.
    pub struct BeamTexel {
        /// Direction of travel or position, and 0, or 1 for a point, or 2 for one that shines by the cosine.
        place: [f32; 4],
        /// Power of three channels, and a0.
        power: [f32; 4],
        /// Cosines of the window's inner and outer angle; 2 and 2, which no cosine reaches, for none. Then of
        /// parallel light the window's share and nothing, of a point what it faces, octahedral.
        window: [f32; 4],
    }
}

impl Beam {
    /// Whether its light comes from afar.
    pub fn is_parallel(&self) -> bool {
        matches!(self.place, Place::Parallel(_))
    }

    /// The same light the other way; of a point light itself.
    pub fn reversed(&self) -> Self {
        match self.place {
            Place::Parallel(direction) => Self { place: Place::Parallel(-direction), ..*self },
            Place::Point(_) => *self,
        }
    }

    /// For the shaders, with the power of the channels that are solved.
    pub fn texel(&self, power: [f64; 3]) -> BeamTexel {
        let (place, point) = match self.place {
            Place::Parallel(direction) => (direction, 0.0),
            Place::Point(position) => (position, if self.facing.is_some() { 2.0 } else { 1.0 }),
        };
        let share = [self.window.map_or(0.0, |window| window.share), 0.0];
        let rest = self.facing.map_or(share, octahedral::from_direction);
        let power = power.map(|p| p as f32);
        let [inner, outer] = self.window.map_or([2.0; 2], Window::cosines);
        BeamTexel {
            place: place.as_vec3().extend(point).to_array(),
            power: [power[0], power[1], power[2], self.a0 as f32],
            window: [inner as f32, outer as f32, rest[0] as f32, rest[1] as f32],
        }
    }
}

mirror! {
    /// `RepackParams` of `shaders/repack.wgsl`.
    pub struct RepackParams {
        /// Corners of cells.
        corners: [u32; 3],
        /// 1 or 2.
        n_beams: u32,
        /// First texels of the beams.
        origins: [[u32; 4]; 2],
        /// First texel of the pack.
        origin: [u32; 3],
        /// Unused.
        pad: u32,
    }
}

/// Up to so many beams have texels of their own.
const SINGLE: usize = 2;

/// How an atlas is laid out.
#[derive(Debug, Clone, Copy)]
pub struct AtlasLayout {
    /// Texels along x, y, z.
    pub dims: [usize; 3],
    /// Of a texel.
    pub format: Format,
    /// Packs that stand along z.
    pub packs_per_column: usize,
    /// Beams that share a texel: 1 or 4.
    pub pack: usize,
}

impl AtlasLayout {
    /// Of so many beams, for textures of at most `max_axis` texels.
    pub fn new(max_axis: usize, lattice: &Lattice, n_beams: usize) -> Self {
        let corners = lattice.dims.map(|n| n + 1);
        let (pack, format) = if n_beams <= SINGLE { (1, Format::R32Float) } else { (4, Format::Rgba16Float) };
        let n_packs = n_beams.div_ceil(pack).max(1);
        let packs_per_column = (max_axis / corners[2]).clamp(1, n_packs);
        let columns = n_packs.div_ceil(packs_per_column);
        let dims = [corners[0], corners[1] * columns, corners[2] * packs_per_column];
        Self { dims, format, packs_per_column, pack }
    }

    /// Memory that it takes.
    pub fn bytes(&self) -> u64 {
        self.dims.iter().product::<usize>() as u64 * self.format.texel_bytes()
    }
}

impl TauAtlas {
    /// Room for `n_beams`.
    ///
    /// # Errors
    /// [`GpuError`] where the device has no room.
    pub fn new(gpu: &Gpu, lattice: &Lattice, n_beams: usize) -> Result<Self, GpuError> {
        let AtlasLayout { dims, format, packs_per_column, pack } =
            AtlasLayout::new(gpu.max_texture_3d() as usize, lattice, n_beams);
        let remedy = "lower light_decomposition.count or medium.max_resolution";
        let texture = gpu.texture3("optical depths of the beams", dims, format, remedy)?;
        Ok(Self { texture: Arc::new(texture), corners: lattice.dims.map(|n| n + 1), packs_per_column, pack })
    }

    /// First texel of a pack.
    pub fn origin(&self, pack: usize) -> [u32; 3] {
        let column = pack / self.packs_per_column;
        let row = pack % self.packs_per_column;
        [0, (column * self.corners[1]) as u32, (row * self.corners[2]) as u32]
    }

    /// What shaders that read or write it are told.
    pub fn choices(&self) -> [(&'static str, String); 2] {
        [("pack", self.pack.to_string()), ("format", self.texture.format().wgsl().to_owned())]
    }

    /// Copies a pack of this atlas of `n_beams` to another's; what has texels of its own becomes one texel of
    /// four where the other has those. By a stage: an H200's driver (580.159) never came back from such a stage
    /// that was followed by 48 copies.
    fn copy_pack(
        &self,
        gpu: &Gpu,
        recorder: &mut Recorder,
        pack: usize,
        n_beams: usize,
        into: &TauAtlas,
        into_pack: usize,
    ) -> Result<(), GpuError> {
        let is_repacked = self.pack != into.pack;
        let beam = |n: usize| {
            let [x, y, z] = self.origin(if is_repacked { n.min(n_beams - 1) } else { pack });
            [x, y, z, 0]
        };
        let params = RepackParams {
            corners: into.corners.map(|n| n as u32),
            n_beams: n_beams as u32,
            origins: [beam(0), beam(1)],
            origin: into.origin(into_pack),
            pad: 0,
        };
        let [of_texels, format] = into.choices();
        let stage = gpu.stage("repack", &[of_texels, format, ("singles", is_repacked.to_string())])?;
        let inputs = [Bind::Texture(&self.texture)];
        let bound = stage.bind(gpu, &params, &inputs, &[Bind::Texture(&into.texture)]);
        recorder.dispatch(&bound, into.corners);
        Ok(())
    }
}

impl Beams {
    /// Light without depths.
    pub fn new(lattice: &Lattice, beams: Vec<Beam>) -> Self {
        Self {
            beams,
            tau: None,
            ambient: [0.0; 3],
            lattice: lattice.clone(),
            has_shadows: false,
            widens: false,
            peak: None,
            returns: false,
            ahead: None,
            n_radial: 0,
            radial: None,
            fields: Vec::new(),
        }
    }

    /// All of `parts` as one; a single part is shared, not copied. Of parts with and without depths those
    /// without have no light, and are dropped.
    ///
    /// # Errors
    /// [`GpuError`] where the device has no room.
    pub fn merge(gpu: &Gpu, lattice: &Lattice, parts: &[&Beams]) -> Result<Self, GpuError> {
        let is_carried = |part: &&Beams| part.tau.is_some() || part.radial.is_some();
        let carried: Vec<&Beams> = parts.iter().copied().filter(is_carried).collect();
        let ambient = std::array::from_fn(|c| parts.iter().map(|part| part.ambient[c]).sum());
        let fields = parts.iter().flat_map(|part| part.fields.iter().cloned()).collect();
        let merged = match carried.as_slice() {
            [] => Self::new(lattice, parts.iter().flat_map(|part| part.beams.iter().copied()).collect()),
            [one] => (*one).clone(),
            _ => {
                let at_corners: Vec<&Beams> =
                    carried.iter().copied().filter(|part| part.tau.is_some()).collect();
                let corners = match at_corners.as_slice() {
                    [] => Self::new(lattice, Vec::new()),
                    [one] => (*one).clone(),
                    _ => Self::concatenate(gpu, lattice, &at_corners)?,
                };
                corners.with_radial(gpu, &carried)?
            }
        };
        Ok(Self { ambient, fields, ..merged })
    }

    /// The same, followed by the beams of `parts` that have grids of their own.
    fn with_radial(mut self, gpu: &Gpu, parts: &[&Beams]) -> Result<Self, GpuError> {
        let grids: Vec<&RadialGrids> = parts.iter().filter_map(|part| part.radial.as_ref()).collect();
        if grids.is_empty() {
            return Ok(self);
        }
        // Packs of the atlas are full, so that a pack is either in it or not.
        if let Some(last) = self.beams.last().copied() {
            let dark = Beam { power: [0.0; 3], ..last };
            self.beams.resize(self.beams.len().next_multiple_of(self.pack()), dark);
        }
        for part in parts.iter().filter(|part| part.radial.is_some()) {
            self.beams.extend(&part.beams);
            self.n_radial += part.beams.len();
            self.has_shadows |= part.has_shadows;
        }
        self.radial = Some(RadialGrids::merge(gpu, &grids)?);
        Ok(self)
    }

    /// Whether all are parallel, lit by one depth at each corner and from one side.
    pub fn is_plain(&self) -> bool {
        !self.has_shadows && !self.widens && !self.returns && self.beams.iter().all(Beam::is_parallel)
    }

    /// Beams whose depths stand at corners.
    pub fn n_at_corners(&self) -> usize {
        self.beams.len() - self.n_radial
    }

    /// For shaders: the beams with the power of the channels that are solved; one without power where there are
    /// none.
    ///
    /// # Errors
    /// [`GpuError`] where the device has no room.
    pub fn list(&self, gpu: &Gpu, channels: &Channels) -> Result<Buffer, GpuError> {
        Self::list_of(gpu, &self.beams, channels)
    }

    /// The same of any beams.
    ///
    /// # Errors
    /// [`GpuError`] where the device has no room.
    pub fn list_of(gpu: &Gpu, beams: &[Beam], channels: &Channels) -> Result<Buffer, GpuError> {
        let texels: Vec<_> = beams.iter().map(|beam| beam.texel(channels.project(beam.power))).collect();
        let texels = if texels.is_empty() { vec![bytemuck::Zeroable::zeroed()] } else { texels };
        gpu.buffer_from("beams", &texels, "lower light_decomposition.count")
    }

    /// For shaders: the grids, and where each stands; where there are none, one that no beam has.
    ///
    /// # Errors
    /// [`GpuError`] where the device has no room.
    pub fn radial_binds(&self, gpu: &Gpu) -> Result<(Arc<Texture>, Buffer), GpuError> {
        let grids = match &self.radial {
            Some(grids) => grids.clone(),
            None => RadialGrids::none(gpu)?,
        };
        Ok((Arc::clone(&grids.texture), grids.list(gpu)?))
    }

    /// Beams that share a texel of the depths.
    pub fn pack(&self) -> usize {
        self.tau.as_ref().map_or(1, |tau| tau.pack)
    }

    /// The depths that stages are bound to; of light that is not looked up, an atlas of nothing.
    ///
    /// # Errors
    /// [`GpuError`] where the device has no room.
    pub fn depths(&self, gpu: &Gpu) -> Result<Depths, GpuError> {
        let tau = match &self.tau {
            Some(tau) => tau.clone(),
            None => TauAtlas::new(gpu, &Lattice { dims: [0; 3], ..self.lattice.clone() }, 0)?,
        };
        let star = self.peak.clone().unwrap_or_else(|| tau.clone());
        let ahead = self.ahead.clone().unwrap_or_else(|| tau.clone());
        Ok(Depths { tau, star, ahead })
    }

    /// Whether some are parallel, and none of them comes back.
    fn goes_one_way(&self) -> bool {
        !self.returns && self.beams.iter().any(Beam::is_parallel)
    }

    /// Packs of four are copied whole: a part whose number of beams is no multiple of 4 is filled up with
    /// beams without power.
    fn concatenate(gpu: &Gpu, lattice: &Lattice, parts: &[&Beams]) -> Result<Self, GpuError> {
        let n_beams: usize = parts.iter().map(|part| part.beams.len()).sum();
        let pack = if n_beams <= SINGLE { 1 } else { 4 };
        let n_packs: usize = parts.iter().map(|part| part.beams.len().div_ceil(pack)).sum();
        let mut beams: Vec<Beam> = Vec::new();
        for part in parts {
            let dark = Beam { power: [0.0; 3], ..part.beams[0] };
            beams.extend(&part.beams);
            beams.resize(beams.len().next_multiple_of(pack), dark);
        }
        let depths = parts.iter().map(|part| part.depths(gpu)).collect::<Result<Vec<_>, _>>()?;
        let joined = |atlas_of: fn(&Depths) -> &TauAtlas| -> Result<TauAtlas, GpuError> {
            let joined = TauAtlas::new(gpu, lattice, pack * n_packs)?;
            let mut recorder = gpu.recorder("merge beams");
            let mut to = 0;
            for (part, depths) in parts.iter().zip(&depths) {
                let n_beams = part.beams.len();
                for four in 0..n_beams.div_ceil(pack) {
                    atlas_of(depths).copy_pack(gpu, &mut recorder, four, n_beams, &joined, to)?;
                    to += 1;
                }
            }
            recorder.finish()?;
            Ok(joined)
        };
        let tau = Some(joined(|depths| &depths.tau)?);
        let has_peak = parts.iter().any(|part| part.peak.is_some());
        let peak = if has_peak { Some(joined(|depths| &depths.star)?) } else { None };
        // Who looks at beams takes all parallel ones alike: where one went among surfaces, none comes back.
        let returns = parts.iter().any(|part| part.returns) && !parts.iter().any(|part| part.goes_one_way());
        let ahead = if returns { Some(joined(|depths| &depths.ahead)?) } else { None };
        let has_shadows = parts.iter().any(|part| part.has_shadows);
        let widens = parts.iter().any(|part| part.widens);
        Ok(Self { tau, peak, ahead, has_shadows, widens, returns, ..Self::new(lattice, beams) })
    }
}
