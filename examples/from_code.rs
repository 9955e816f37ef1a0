//! A scene made in code, simulated and drawn: `cargo run --release --example from_code` writes into `cubes/`.

use localshape::sim::model::{mass_spring, shape_based};
use localshape::{
    AdapterChoice, BodyBuilder, FrameFolder, Gpu, Lattice, Limits, ObstacleBuilder, Renderer, Rotation, Runner, Scene,
    compose,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // 27 cubes of 10 cm, tilted and dropped; any mesh will do: `BodyBuilder::arrays(nodes, elements)`.
    let cubes = BodyBuilder::lattice(Lattice::new([3, 3, 3], 0.1));
    let mut scene = Scene::builder("cubes", cubes.rotation(Rotation::about([1.0, 0.0, 1.0], 0.4)).lowest(0.2))
        .gravity([0.0, -9.8, 0.0])
        .obstacle(ObstacleBuilder::floor(0.0).restitution(0.5))
        .run("Local shape", shape_based::Parameters { damping_ratio: Some(0.1), ..shape_based::Parameters::new(1e4) })
        .run("Springs", mass_spring::Parameters { damping_ratio: Some(0.1), ..mass_spring::Parameters::new(1e4) })
        .build(&Limits::default())?;
    scene.view.labels.letters = true; // `View` has all that pictures show.
    // Both runs half a second after the start, beside each other.
    let frame = Runner::new(&scene, &[0, 1]).frame(30);
    let gpu = Gpu::new(&AdapterChoice::Auto)?;
    let image = Renderer::new(&gpu, scene.view.size)?.draw(&compose(&scene, &frame))?;
    // `frame_00030.png` and a row of `diagnostics.csv` for each run.
    let mut folder = FrameFolder::create("cubes", &scene)?;
    folder.write_picture(&frame, &image, &gpu)?;
    folder.write_diagnostics(&frame)?;
    folder.finish()?;
    Ok(())
}
