//! Makes the samples in `data/`: a cumulus, plumes, a fire, an engine on its track, and skies.
//!
//! `cargo run --release --example make_samples [FOLDER [NAME…]]` writes into `data/` unless told otherwise, all
//! samples or those of these names. The cloud is the one of [`tyndall::volume::shapes`]; what the others are
//! stands in their modules. `tests/graphs.rs` reads what this wrote.

#[path = "make_samples/fire.rs"]
mod fire;
#[path = "make_samples/locomotive.rs"]
mod locomotive;
#[path = "make_samples/park.rs"]
mod park;
#[path = "make_samples/plume.rs"]
mod plume;
#[path = "make_samples/railway.rs"]
mod railway;
#[path = "make_samples/rolling_stock.rs"]
mod rolling_stock;
#[path = "make_samples/running_gear.rs"]
mod running_gear;
#[path = "make_samples/sky.rs"]
mod sky;
#[path = "make_samples/solid.rs"]
mod solid;

use std::path::Path;

use glam::{IVec3, Vec3};
use plume::Plume;
use sky::Sky;
use solid::Solid;
use tyndall::image;
use tyndall::volume::grid::Grid;
use tyndall::volume::shapes::{self, Kind};
use tyndall::volume::vdb::{self, WriteCompression, WriteOptions};

fn main() -> anyhow::Result<()> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().unwrap_or_else(|| "data".to_owned());
    let folder = Path::new(&folder);
    let names: Vec<String> = arguments.collect();
    let wants = |name: &str| names.is_empty() || names.iter().any(|wanted| wanted == name);
    std::fs::create_dir_all(folder)?;
    let volume = |name: &str, grids: &[Grid]| {
        let options = WriteOptions { compression: WriteCompression::Zip, half: true };
        vdb::write(&folder.join(name).with_extension("vdb"), grids, options)
    };
    if wants("cumulus") {
        volume("cumulus", &[cumulus()])?;
    }
    if wants("fire") {
        volume("fire", &fire::grids())?;
    }
    if wants("steam") {
        volume("steam", &[steam().grid()])?;
    }
    if wants("plume") {
        volume("plume", &[smoke().grid()])?;
    }
    if wants("engine") {
        let paints = locomotive::engine();
        let meshes: [(&str, &Solid); 13] = [
            ("green", &paints.green),
            ("maroon", &paints.maroon),
            ("cream", &paints.cream),
            ("black", &paints.black),
            ("red", &paints.red),
            ("brass", &paints.brass),
            ("steel", &paints.steel),
            ("coal", &rolling_stock::coal()),
            ("rails", &railway::rails()),
            ("sleepers", &railway::sleepers()),
            ("ballast", &railway::ballast()),
            ("meadow", &railway::meadow()),
            ("grass", &railway::grass()),
        ];
        write_meshes(&folder.join("engine"), &meshes)?;
    }
    if wants("park") {
        volume("mist", &[park::mist()])?;
        let [lawn, path] = park::grounds();
        let (lanterns, trees) = (park::lanterns(), park::trees());
        let meshes = [("lanterns", &lanterns), ("trees", &trees), ("lawn", &lawn), ("path", &path)];
        write_meshes(&folder.join("park"), &meshes)?;
    }
    if wants("wall") {
        write_meshes(folder, &[("wall", &park::wall())])?;
    }
    if wants("sky") {
        let sky = Sky::new(2.6, 24.0);
        image::exr::write(&folder.join("sky.exr"), &sky.map(256, false, Sky::radiance))?;
        image::exr::write(&folder.join("sky_sun.exr"), &sky.map(256, true, Sky::radiance))?;
        println!("towards the sun {}, its irradiance {:.3?}", sky.to_sun, sky.sun_irradiance());
    }
    if wants("evening") {
        let sky = Sky::new(3.0, 11.0);
        image::exr::write(&folder.join("evening.exr"), &sky.map(512, false, Sky::evening))?;
        println!("towards the evening sun {}, its irradiance {:.3?}", sky.to_sun, sky.sun_irradiance());
    }
    Ok(())
}

fn write_meshes(folder: &Path, meshes: &[(&str, &Solid)]) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder)?;
    for (name, solid) in meshes {
        println!("{name}: {} triangles", solid.n_triangles());
        solid.write_glb(&folder.join(name).with_extension("glb"))?;
    }
    Ok(())
}

fn cumulus() -> Grid {
    let cloud = shapes::generate(Kind::Cloud, [400.0, 240.0, 360.0], 128, 2);
    Grid::from_dense("density", 0.0, cloud.world_from_index, IVec3::ZERO, cloud.dims, &cloud.values)
}

/// Of the engine, which heads for +x.
fn steam() -> Plume {
    Plume {
        voxel_m: 0.12,
        source: locomotive::CHIMNEY_TOP.as_vec3() - 0.15 * Vec3::Y,
        radius: 0.27,
        wind: Vec3::new(-2.7, 0.0, 0.35),
        jet: [1.7, 0.45],
        rise: 0.85,
        growth: 0.42,
        stride: 0.7,
        oldest: 9.5,
        thinning: 0.6,
        tearing: 0.9,
        seed: 4,
    }
}

/// Of a fire that is not seen, in a breath of wind.
fn smoke() -> Plume {
    Plume {
        voxel_m: 0.08,
        source: Vec3::ZERO,
        radius: 0.55,
        wind: Vec3::new(0.75, 0.0, 0.15),
        jet: [0.4, 0.4],
        rise: 2.3,
        growth: 0.34,
        stride: 0.7,
        oldest: 8.5,
        thinning: 0.5,
        tearing: 0.75,
        seed: 21,
    }
}
