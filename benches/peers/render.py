"""Times a frame of other programs and of this one, from the same meshes, and prints one table.

Blocks of cubes, whose surfaces have 588 and 20 172 triangles, fall on a floor and are drawn as two panels, 1280×720 together.
Told is the processor time of all threads for a frame (ms), PNG included, without start-up and first frame. What is not installed
is skipped with a notice: pip install numpy pillow matplotlib pyvista mujoco wgpu.

    cargo build --release && python3 benches/peers/render.py [CUBES ...]

The work differs: this program also draws a floor, shadows, lines and words; the others draw lit surfaces alone, smooth at their
borders (matplotlib: flat faces). Their meshes are states of this program, read from its `states.npz`.
"""

import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PROGRAM = Path(__file__).parents[2] / "target" / "release" / "localshape"
WIDTH, HEIGHT, FRAMES = 640, 720, 12
COLOUR, GROUND = (0.35, 0.55, 0.75), (1.0, 1.0, 1.0)
EYE, ANGLE = (2.2, 1.6, 2.6), 35.0


def scene(folder, cubes):
    path = Path(folder) / "block.toml"
    path.write_text(f"""
        title = "block"
        gravity = [0, -9.8, 0]
        time = {{ duration = {(1 + FRAMES) / 60}, step = "T/50", frames_per_second = 60 }}
        body = {{ lattice = {{ cells = [{cubes}, {cubes}, {cubes}], side = {1 / cubes} }}, mass = 1.0, lowest = 0.0, velocity = [0, -1, 0] }}
        obstacle = [{{ kind = "floor" }}]
        [[run]]
        name = "shape"
        model = {{ kind = "shape-based", stiffness = 1e4, damping_ratio = 0.1 }}
        [[run]]
        name = "springs"
        model = {{ kind = "mass-spring", stiffness = 1e4, damping_ratio = 0.1 }}
        [view]
        size = [{2 * WIDTH}, {HEIGHT}]
    """)
    return path


def localshape(command, path, folder, *words):
    subprocess.run([PROGRAM, command, path, "--quiet", "--overwrite", "-o", folder, *words], check=True)
    return Path(folder)


def ours(cubes):
    """What a longer sequence takes more than a shorter one, by the program's own clock, from stored states."""
    with tempfile.TemporaryDirectory() as folder:
        path = scene(folder, cubes)
        states = localshape("simulate", path, f"{folder}/states", "--states") / "states.npz"

        def cost(frames):
            out = localshape("render", path, f"{folder}/out", "--from-states", states, "--frames", f"0-{frames}")
            times = json.loads((out / "run.json").read_text())["times"]
            return sum(times[stage]["cpu"] for stage in ("compose", "draw", "encode"))

        return statistics.median((cost(1 + FRAMES) - cost(1)) / FRAMES for _ in range(3))


def meshes(cubes):
    """Positions of both bodies in each frame, and the triangles of the surface."""
    import numpy as np

    with tempfile.TemporaryDirectory() as folder:
        states = np.load(localshape("simulate", scene(folder, cubes), f"{folder}/out", "--states") / "states.npz")
        faces = states["faces"]
        assert len(faces) == 6 * cubes**2, "the surface alone"
        triangles = np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]]).astype(np.int32)
        used, triangles = np.unique(triangles, return_inverse=True)
        frames = [states[f"{name}.position"][:, used] - [0, 0.5, 0] for name in ("shape", "springs")]
        return [frame.astype(np.float32) for frame in frames], triangles.reshape(-1, 3).astype(np.int32)


def normals(points, triangles):
    import numpy as np

    corners = points[triangles]
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sums = np.stack([np.bincount(triangles.ravel(), np.repeat(faces[:, axis], 3), len(points)) for axis in range(3)], 1)
    return (sums / np.maximum(np.linalg.norm(sums, axis=1, keepdims=True), 1e-12)).astype(np.float32)


def matplotlib(bodies, triangles):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    figure = plt.figure(figsize=(2 * WIDTH / 100, HEIGHT / 100), dpi=100)
    panels = [figure.add_subplot(1, 2, at + 1, projection="3d") for at in range(2)]

    def draw(frame, file):
        for panel, body in zip(panels, bodies):
            panel.clear()
            # Its third axis points upwards.
            points = body[frame][:, [0, 2, 1]] * [1, -1, 1]
            panel.add_collection3d(Poly3DCollection(points[triangles], facecolors=COLOUR, shade=True))
            panel.set(xlim=(-0.8, 0.8), ylim=(-0.8, 0.8), zlim=(-0.8, 0.8))
            panel.set_axis_off()
        figure.savefig(file, dpi=100)

    return draw


def pyvista(bodies, triangles):
    import numpy as np
    import pyvista

    plotter = pyvista.Plotter(shape=(1, 2), off_screen=True, window_size=(2 * WIDTH, HEIGHT), border=False)
    faces = np.insert(triangles, 0, 3, axis=1).ravel()
    drawn = []
    for at, body in enumerate(bodies):
        plotter.subplot(0, at)
        mesh = pyvista.PolyData(body[0].copy(), faces)
        mesh.point_data.active_normals = normals(body[0], triangles)
        plotter.add_mesh(mesh, color=COLOUR, smooth_shading=False).prop.interpolation = "Gouraud"
        plotter.camera_position = [EYE, (0, 0, 0), (0, 1, 0)]
        plotter.camera.view_angle = ANGLE
        drawn.append((mesh, body))
    plotter.set_background(GROUND)
    plotter.enable_anti_aliasing("msaa", multi_samples=4, all_renderers=True)

    def draw(frame, file):
        for mesh, body in drawn:
            mesh.points = body[frame]
            mesh.point_data.active_normals = normals(body[frame], triangles)
        plotter.render()
        plotter.screenshot(file)

    return draw


def mujoco(bodies, triangles):
    os.environ.setdefault("MUJOCO_GL", "egl")
    import mujoco
    import numpy as np
    from PIL import Image

    upwards = lambda points: points[:, [0, 2, 1]] * np.float32([1, -1, 1])
    words = lambda numbers: " ".join(map(str, numbers.ravel()))
    views = []
    for body in bodies:
        model = mujoco.MjModel.from_xml_string(f"""<mujoco>
            <visual><global offwidth="{WIDTH}" offheight="{HEIGHT}" fovy="{ANGLE}"/><quality offsamples="4" shadowsize="0"/>
                <headlight ambient="0.4 0.4 0.4" diffuse="0.6 0.6 0.6"/></visual>
            <asset><mesh name="body" vertex="{words(upwards(body[0]))}" face="{words(triangles)}" inertia="shell" smoothnormal="true"/></asset>
            <worldbody><geom type="mesh" mesh="body" rgba="{' '.join(map(str, COLOUR))} 1"/></worldbody>
        </mujoco>""")
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        camera = mujoco.MjvCamera()
        camera.distance, camera.azimuth, camera.elevation = float(np.linalg.norm(EYE)), 130, -25
        views.append((model, data, camera, mujoco.Renderer(model, height=HEIGHT, width=WIDTH), body))

    def draw(frame, file):
        halves = []
        for model, data, camera, renderer, body in views:
            model.mesh_vert[:] = upwards(body[frame])
            if len(model.mesh_normal) == len(model.mesh_vert):
                model.mesh_normal[:] = upwards(normals(body[frame], triangles))
            renderer._gl_context.make_current()
            mujoco.mjr_uploadMesh(model, renderer._mjr_context, 0)
            renderer.update_scene(data, camera)
            halves.append(renderer.render().copy())
        Image.fromarray(np.concatenate(halves, axis=1)).save(file, compress_level=1)

    return draw


SHADER = """
struct Corner { @builtin(position) place: vec4f, @location(0) normal: vec3f }
@group(0) @binding(0) var<uniform> clip: mat4x4f;
@vertex fn corner(@location(0) at: vec3f, @location(1) normal: vec3f) -> Corner { return Corner(clip * vec4f(at, 1.0), normal); }
@fragment fn lit(corner: Corner) -> @location(0) vec4f {
    let light = 0.35 + 0.65 * max(dot(normalize(corner.normal), normalize(vec3f(0.4, 0.8, 0.5))), 0.0);
    return vec4f(light * vec3f(COLOUR), 1.0);
}
"""


def wgpu(bodies, triangles):
    import numpy as np
    import wgpu
    from PIL import Image

    device = wgpu.gpu.request_adapter_sync().request_device_sync()
    away = np.array(EYE) / np.linalg.norm(EYE)
    right = np.cross((0, 1, 0), away) / np.linalg.norm(np.cross((0, 1, 0), away))
    view = np.eye(4)
    view[:3, :3] = right, np.cross(away, right), away
    view[2, 3] = -np.linalg.norm(EYE)
    focal, near, far = 1 / np.tan(np.radians(ANGLE) / 2), 0.1, 20.0
    lens = np.zeros((4, 4))
    lens[0, 0], lens[1, 1], lens[2, 2] = focal * HEIGHT / WIDTH, focal, far / (near - far)
    lens[2, 3], lens[3, 2] = near * far / (near - far), -1
    buffer = lambda data, usage: device.create_buffer_with_data(data=data, usage=usage | wgpu.BufferUsage.COPY_DST)
    clip = buffer((lens @ view).T.astype(np.float32).tobytes(), wgpu.BufferUsage.UNIFORM)
    indices = buffer(triangles.astype(np.uint32).tobytes(), wgpu.BufferUsage.INDEX)
    corners = [buffer(np.hstack([body[0], body[0]]).tobytes(), wgpu.BufferUsage.VERTEX) for body in bodies]
    module = device.create_shader_module(code=SHADER.replace("COLOUR", ", ".join(map(str, COLOUR))))
    attributes = [{"format": "float32x3", "offset": 12 * at, "shader_location": at} for at in range(2)]
    layout = {"array_stride": 24, "step_mode": "vertex", "attributes": attributes}
    pipeline = device.create_render_pipeline(
        layout="auto",
        vertex={"module": module, "entry_point": "corner", "buffers": [layout]},
        primitive={"topology": "triangle-list", "cull_mode": "back"},
        depth_stencil={"format": "depth32float", "depth_write_enabled": True, "depth_compare": "less"},
        multisample={"count": 4},
        fragment={"module": module, "entry_point": "lit", "targets": [{"format": "rgba8unorm"}]},
    )
    bind = {"binding": 0, "resource": {"buffer": clip, "offset": 0, "size": 64}}
    group = device.create_bind_group(layout=pipeline.get_bind_group_layout(0), entries=[bind])

    def target(samples, kind, usage=0):
        usage |= wgpu.TextureUsage.RENDER_ATTACHMENT
        return device.create_texture(size=(2 * WIDTH, HEIGHT, 1), sample_count=samples, format=kind, usage=usage)

    picture = target(1, "rgba8unorm", wgpu.TextureUsage.COPY_SRC)
    samples, depth = target(4, "rgba8unorm").create_view(), target(4, "depth32float").create_view()

    def draw(frame, file):
        for body, place in zip(bodies, corners):
            device.queue.write_buffer(place, 0, np.hstack([body[frame], normals(body[frame], triangles)]).tobytes())
        commands = device.create_command_encoder()
        colour = {"view": samples, "resolve_target": picture.create_view(), "clear_value": (*GROUND, 1), "load_op": "clear", "store_op": "discard"}
        deep = {"view": depth, "depth_clear_value": 1.0, "depth_load_op": "clear", "depth_store_op": "discard"}
        run = commands.begin_render_pass(color_attachments=[colour], depth_stencil_attachment=deep)
        run.set_pipeline(pipeline)
        run.set_bind_group(0, group)
        run.set_index_buffer(indices, "uint32")
        for at, place in enumerate(corners):
            run.set_viewport(at * WIDTH, 0, WIDTH, HEIGHT, 0, 1)
            run.set_vertex_buffer(0, place)
            run.draw_indexed(triangles.size)
        run.end()
        device.queue.submit([commands.finish()])
        rows = device.queue.read_texture({"texture": picture}, {"bytes_per_row": 8 * WIDTH}, (2 * WIDTH, HEIGHT, 1))
        pixels = np.frombuffer(rows, np.uint8).reshape(HEIGHT, 2 * WIDTH, 4)
        Image.fromarray(np.ascontiguousarray(pixels[..., :3])).save(file, compress_level=1)

    return draw


PEERS = {"wgpu-py, surfaces alone": wgpu, "MuJoCo": mujoco, "PyVista": pyvista, "matplotlib": matplotlib}


def peer(name, cubes):
    bodies, triangles = meshes(cubes)
    draw = PEERS[name](bodies, triangles)
    with tempfile.TemporaryDirectory() as folder:
        folder = os.environ.get("KEEP", folder)  # To look at them.
        draw(0, f"{folder}/{PEERS[name].__name__}0.png")
        start = time.process_time()
        for frame in range(1, 1 + FRAMES):
            draw(frame, f"{folder}/{PEERS[name].__name__}{frame}.png")
        return (time.process_time() - start) / FRAMES


def main():
    if len(sys.argv) == 4 and sys.argv[1] == "one":
        name, cubes = sys.argv[2], int(sys.argv[3])
        print((peer(name, cubes) if name in PEERS else ours(cubes)) * 1e3)
        return
    sizes = [int(size) for size in sys.argv[1:]] or [7, 41]
    print(f"{'CPU ms a frame; triangles':32}" + "".join(f"{12 * size**2:>10}" for size in sizes))
    for name in ["localshape, everything", *PEERS]:
        row = ""
        for size in sizes:
            # Each in a process of its own: libraries keep state.
            command = [sys.executable, __file__, "one", name, str(size)]
            done = subprocess.run(command, capture_output=True, text=True)
            if done.returncode != 0:
                row += "   skipped: " + (done.stderr.strip().splitlines() or ["it crashed"])[-1]
                break
            row += f"{float(done.stdout.splitlines()[-1]):10.1f}"
        print(f"{name:32}{row}", flush=True)


if __name__ == "__main__":
    main()
